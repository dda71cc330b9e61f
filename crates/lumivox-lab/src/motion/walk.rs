//! The scene of the sequence `walk`: a skinned figure walks through an open room with one lamp.
//!
//! It is made as a glTF file in memory and loaded like any other, so that it takes the code path of
//! files. The figure is one mesh of tubes, whose vertices have two joints each.

use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

use glam::{Mat4, Quat, Vec3};
use lumivox_scene::{LoadOptions, Scene, SceneError};
use serde_json::{Value, json};

/// The name of the file, which exists only in memory.
const FILE: &str = "walk.gltf";
/// Key frames of the animation, the first at 0 s and the last at 1 s.
const KEYS: usize = 17;
/// Sides and rings of a tube.
const SIDES: usize = 10;
const RINGS: usize = 12;

/// A joint: its name, its parent, and its place at rest in metres. The figure looks along +x.
const JOINTS: [(&str, Option<usize>, Vec3); 8] = [
    ("hips", None, Vec3::new(0.0, 0.75, 0.0)),
    ("chest", Some(0), Vec3::new(0.0, 0.95, 0.0)),
    ("left thigh", Some(0), Vec3::new(0.0, 0.75, 0.09)),
    ("left shin", Some(2), Vec3::new(0.0, 0.40, 0.09)),
    ("right thigh", Some(0), Vec3::new(0.0, 0.75, -0.09)),
    ("right shin", Some(4), Vec3::new(0.0, 0.40, -0.09)),
    ("left arm", Some(1), Vec3::new(0.0, 1.18, 0.2)),
    ("right arm", Some(1), Vec3::new(0.0, 1.18, -0.2)),
];

/// A vertical part of the figure.
struct Tube {
    /// The middle of its lower end.
    foot: Vec3,
    height_m: f32,
    /// Along x and z.
    radii_m: [f32; 2],
    /// The joints that move it below and above the bend.
    joints: [usize; 2],
    /// The height at which it bends.
    bend_m: f32,
}

const fn tube(
    foot: Vec3,
    height_m: f32,
    radii_m: [f32; 2],
    joints: [usize; 2],
    bend_m: f32,
) -> Tube {
    Tube { foot, height_m, radii_m, joints, bend_m }
}

/// Trunk, head, legs and arms.
const TUBES: [Tube; 6] = [
    tube(Vec3::new(0.0, 0.70, 0.0), 0.55, [0.11, 0.17], [0, 1], 0.95),
    tube(Vec3::new(0.0, 1.28, 0.0), 0.22, [0.1, 0.09], [1, 1], 1.3),
    tube(Vec3::new(0.0, 0.02, 0.09), 0.72, [0.075, 0.07], [3, 2], 0.40),
    tube(Vec3::new(0.0, 0.02, -0.09), 0.72, [0.075, 0.07], [5, 4], 0.40),
    tube(Vec3::new(0.0, 0.68, 0.22), 0.54, [0.05, 0.05], [6, 1], 1.18),
    tube(Vec3::new(0.0, 0.68, -0.22), 0.54, [0.05, 0.05], [7, 1], 1.18),
];
/// Half the height over which a tube bends, m.
const BEND_M: f32 = 0.06;

/// Makes the scene.
///
/// # Errors
/// The loader's errors; none is expected.
pub fn scene() -> Result<Scene, SceneError> {
    let mut gltf = Gltf::default();
    let document = gltf.document();
    let files = HashMap::from([
        (FILE.to_owned(), document.to_string().into_bytes()),
        ("walk.bin".to_owned(), gltf.bytes),
    ]);
    let mut options = LoadOptions { files: Some(&files), ..LoadOptions::default() };
    Scene::load_with(FILE, &mut options)
}

/// The parts of a file that grow while it is made.
#[derive(Default)]
struct Gltf {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

/// Vertices and triangles.
#[derive(Default)]
struct Surface {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    joints: Vec<[u8; 4]>,
    weights: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

impl Gltf {
    /// Stores numbers, and returns the number of their accessor. `kind` is its type, `component`
    /// its component type (glTF 2.0, section 5.1).
    fn store(&mut self, bytes: &[u8], count: usize, kind: &str, component: u32) -> usize {
        let view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1,
            "componentType": component,
            "count": count,
            "type": kind,
        }));
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        self.store(&bytes, values.len(), kind, 5126)
    }

    fn vectors(&mut self, values: &[Vec3]) -> usize {
        let accessor = self.floats(&values.iter().map(Vec3::to_array).collect::<Vec<_>>(), "VEC3");
        let least = values.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let most = values.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        self.accessors[accessor]["min"] = json!(least.to_array());
        self.accessors[accessor]["max"] = json!(most.to_array());
        accessor
    }

    fn primitive(&mut self, surface: &Surface, material: usize) -> Value {
        let indices: Vec<u8> = surface.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let mut attributes = json!({
            "POSITION": self.vectors(&surface.positions),
            "NORMAL": self.vectors(&surface.normals),
        });
        if !surface.joints.is_empty() {
            let joints = surface.joints.as_flattened();
            attributes["JOINTS_0"] = json!(self.store(joints, surface.joints.len(), "VEC4", 5121));
            attributes["WEIGHTS_0"] = json!(self.floats(&surface.weights, "VEC4"));
        }
        let indices = self.store(&indices, surface.indices.len(), "SCALAR", 5125);
        json!({ "attributes": attributes, "indices": indices, "material": material })
    }

    fn document(&mut self) -> Value {
        let [white, red, green] = [[0.73; 3], [0.63, 0.065, 0.05], [0.14, 0.45, 0.091]];
        let walls = room().map(|(surface, material)| self.primitive(&surface, material));
        let figure = self.primitive(&figure(), 3);
        let inverse: Vec<[f32; 16]> =
            JOINTS.map(|(_, _, place)| Mat4::from_translation(-place).to_cols_array()).to_vec();
        let inverse = self.floats(&inverse, "MAT4");
        let (samplers, channels) = self.animation();
        let first_joint = 4;
        let mut nodes = vec![
            json!({ "name": "room", "mesh": 0 }),
            json!({ "name": "figure", "mesh": 1, "skin": 0 }),
            json!({
                "name": "lamp", "translation": [0.0, 1.6, 0.5],
                "extensions": { "KHR_lights_punctual": { "light": 0 } },
            }),
            json!({ "name": "front", "translation": [0.0, 1.0, 3.8], "camera": 0 }),
        ];
        for (joint, (name, parent, place)) in JOINTS.iter().enumerate() {
            let from = parent.map_or(Vec3::ZERO, |parent| JOINTS[parent].2);
            let is_child = |other: &usize| JOINTS[*other].1 == Some(joint);
            let children: Vec<usize> =
                (0..JOINTS.len()).filter(is_child).map(|child| first_joint + child).collect();
            let mut node = json!({ "name": name, "translation": (*place - from).to_array() });
            if !children.is_empty() {
                node["children"] = json!(children);
            }
            nodes.push(node);
        }
        let diffuse = |color: [f32; 3]| {
            let [r, g, b] = color;
            json!({ "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0,
            }, "extensions": { "KHR_materials_specular": { "specularFactor": 0.0 } } })
        };
        json!({
            "asset": { "version": "2.0" },
            "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_specular"],
            "extensions": { "KHR_lights_punctual": { "lights": [
                { "type": "point", "intensity": 20.0, "name": "lamp" },
            ] } },
            "scene": 0,
            "scenes": [{ "nodes": [0, 1, 2, 3, first_joint] }],
            "nodes": nodes,
            "cameras": [{
                "type": "perspective",
                "perspective": { "yfov": 2.0 * (1.02_f32 / 2.8).atan(), "znear": 0.01 },
            }],
            "meshes": [{ "primitives": walls }, { "primitives": [figure] }],
            "materials": [diffuse(white), diffuse(red), diffuse(green), diffuse([0.2, 0.3, 0.65])],
            "skins": [{
                "inverseBindMatrices": inverse,
                "joints": (0..JOINTS.len()).map(|joint| first_joint + joint).collect::<Vec<_>>(),
            }],
            "animations": [{ "name": "walk", "samplers": samplers, "channels": channels }],
            "buffers": [{ "uri": "walk.bin", "byteLength": self.bytes.len() }],
            "bufferViews": self.views,
            "accessors": self.accessors,
        })
    }

    /// The samplers and channels of a step with each leg, over 0.8 m.
    fn animation(&mut self) -> (Vec<Value>, Vec<Value>) {
        let time = |key: usize| key as f32 / (KEYS - 1) as f32;
        let times: Vec<[f32; 1]> = (0..KEYS).map(|key| [time(key)]).collect();
        let input = self.floats(&times, "SCALAR");
        self.accessors[input]["min"] = json!([0.0]);
        self.accessors[input]["max"] = json!([1.0]);
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        let mut add = |output: usize, joint: usize, path: &str| {
            samplers.push(json!({ "input": input, "output": output }));
            let target = json!({ "node": 4 + joint, "path": path });
            channels.push(json!({ "sampler": samplers.len() - 1, "target": target }));
        };
        let place = |key: usize| {
            let bob = 0.015 * (2.0 * TAU * time(key)).cos();
            JOINTS[0].2 + Vec3::new(0.8 * time(key) - 0.4, bob, 0.1)
        };
        let places: Vec<Vec3> = (0..KEYS).map(place).collect();
        add(self.vectors(&places), 0, "translation");
        for (joint, swing_rad, phase_rad) in
            [(2, 0.5, 0.0), (4, 0.5, PI), (6, 0.4, PI), (7, 0.4, 0.0), (1, 0.05, 0.5 * PI)]
        {
            let turn = |key: usize| swing_rad * (TAU * time(key) + phase_rad).sin();
            add(self.turns(turn), joint, "rotation");
        }
        // Knees bend backwards, while their leg swings forwards.
        for (joint, phase_rad) in [(3, 0.0), (5, PI)] {
            let turn = |key: usize| -0.9 * (TAU * time(key) + phase_rad).cos().max(0.0);
            add(self.turns(turn), joint, "rotation");
        }
        (samplers, channels)
    }

    /// Rotations about z at all keys.
    fn turns(&mut self, angle_rad: impl Fn(usize) -> f32) -> usize {
        let turn = |key| Quat::from_rotation_z(angle_rad(key)).to_array();
        self.floats(&(0..KEYS).map(turn).collect::<Vec<_>>(), "VEC4")
    }
}

impl Surface {
    /// Adds a parallelogram; `u` x `v` is its front.
    fn quad(&mut self, middle: Vec3, u: Vec3, v: Vec3) {
        let first = self.positions.len() as u32;
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            self.positions.push(middle + a * u + b * v);
            self.normals.push(u.cross(v).normalize());
        }
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }

    /// Adds a vertex that two joints move.
    fn vertex(&mut self, position: Vec3, normal: Vec3, joints: [usize; 2], share: f32) {
        self.positions.push(position);
        self.normals.push(normal);
        let [below, above] = joints.map(|joint| joint as u8);
        // One joint must not be named twice with weights (glTF 2.0, section 3.7.3.3).
        let is_one = below == above;
        self.joints.push([below, if is_one { 0 } else { above }, 0, 0]);
        let share = if is_one { 0.0 } else { share };
        self.weights.push([1.0 - share, share, 0.0, 0.0]);
        if self.weights.last().is_some_and(|weights| weights[1] == 0.0) {
            // A joint with a weight of 0 must be joint 0.
            if let Some(joints) = self.joints.last_mut() {
                joints[1] = 0;
            }
        }
    }
}

/// The walls of a room of 2 m, open at +z, each with its material.
fn room() -> [(Surface, usize); 3] {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let [mut white, mut red, mut green] = [0; 3].map(|_| Surface::default());
    white.quad(Vec3::ZERO, x, -z);
    white.quad(2.0 * y, x, z);
    white.quad(y - z, x, y);
    red.quad(y - x, -z, y);
    green.quad(y + x, z, y);
    [(white, 0), (red, 1), (green, 2)]
}

/// The figure at rest.
fn figure() -> Surface {
    let mut surface = Surface::default();
    for Tube { foot, height_m, radii_m: [radius_x_m, radius_z_m], joints, bend_m } in TUBES {
        let first = surface.positions.len() as u32;
        let share = |y: f32| ((y - bend_m) / (2.0 * BEND_M) + 0.5).clamp(0.0, 1.0);
        for ring in 0..=RINGS {
            let y = foot.y + height_m * ring as f32 / RINGS as f32;
            for side in 0..SIDES {
                let (sin, cos) = (TAU * side as f32 / SIDES as f32).sin_cos();
                let offset = Vec3::new(radius_x_m * cos, y - foot.y, radius_z_m * sin);
                let normal = Vec3::new(cos / radius_x_m, 0.0, sin / radius_z_m).normalize();
                surface.vertex(foot + offset, normal, joints, share(y));
            }
        }
        let sides = SIDES as u32;
        let corner = |ring: u32, side: u32| first + ring * sides + side % sides;
        for (ring, side) in (0..RINGS as u32).flat_map(|r| (0..sides).map(move |s| (r, s))) {
            let [a, b] = [side, side + 1].map(|side| corner(ring, side));
            let [c, d] = [side, side + 1].map(|side| corner(ring + 1, side));
            surface.indices.extend([a, c, b, b, c, d]);
        }
        for (ring, normal) in [(0, Vec3::NEG_Y), (RINGS as u32, Vec3::Y)] {
            let y = foot.y + height_m * ring as f32 / RINGS as f32;
            let middle = surface.positions.len() as u32;
            surface.vertex(Vec3::new(foot.x, y, foot.z), normal, joints, share(y));
            for side in 0..sides {
                let at = surface.positions[corner(ring, side) as usize];
                surface.vertex(at, normal, joints, share(y));
            }
            for side in 0..sides {
                let (a, b) = (middle + 1 + side, middle + 1 + (side + 1) % sides);
                let is_top = ring > 0;
                surface.indices.extend(if is_top { [middle, b, a] } else { [middle, a, b] });
            }
        }
    }
    surface
}

#[cfg(test)]
mod tests {
    use lumivox_scene::{AnimationChoice, Bounds, InstanceBounds};

    use super::*;

    fn figure_in(scene: &Scene) -> Bounds {
        let figure = scene.instances.iter().position(|instance| instance.name.contains("figure"));
        InstanceBounds::of(scene).get(figure.unwrap())
    }

    #[test]
    fn the_figure_walks_upright_through_the_room() {
        let mut scene = scene().unwrap();
        scene.validate().unwrap();
        assert_eq!((scene.lights.len(), scene.cameras.len()), (1, 1));
        assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
        let duration_s = scene.animations()[0].duration_s;
        assert!((duration_s - 1.0).abs() < 1e-6);
        let mut middles = Vec::new();
        for step in 0..=8 {
            scene.pose(AnimationChoice::One(0), step as f32 / 8.0).unwrap();
            let bounds = figure_in(&scene);
            middles.push(bounds.center().x);
            assert!(bounds.min.y > -0.05 && bounds.min.y < 0.15, "{bounds:?}");
            assert!(bounds.max.y > 1.45 && bounds.max.y < 1.55, "{bounds:?}");
            assert!(bounds.min.x > -0.95 && bounds.max.x < 0.95, "{bounds:?}");
        }
        assert!(middles[8] - middles[0] > 0.7, "{middles:?}");
    }

    /// The volume by the divergence theorem is positive, and that of the ellipses: all triangles
    /// face outwards.
    #[test]
    fn the_figure_is_closed_and_faces_outwards() {
        let surface = figure();
        let corner = |i: u32| surface.positions[i as usize].as_dvec3();
        let volume: f64 = surface
            .indices
            .chunks_exact(3)
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0)
            .sum();
        let polygon = SIDES as f32 / TAU * (TAU / SIDES as f32).sin() * PI;
        let expected: f32 =
            TUBES.iter().map(|t| polygon * t.radii_m[0] * t.radii_m[1] * t.height_m).sum();
        assert!((volume - f64::from(expected)).abs() < 1e-4, "{volume} is not {expected}");
    }
}
