//! The motion of the sequences: their poses, and what they add to scenes.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat4, Quat, Vec3};
use lumivox_console::Failure;
use lumivox_scene::{Camera, Instance, Light, Mesh, Scene};

/// A moment of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The step's number, from 0.
    pub index: u32,
    /// Index of the step's phase.
    pub phase: usize,
    /// The finished share of the phase's motion, above 0 and up to 1.
    pub share: f32,
}

/// A scene before anything moves.
#[derive(Clone, Debug)]
pub struct Start {
    pub scene: Scene,
    pub camera: Camera,
    /// The length of the scene's first animation, s.
    pub duration_s: f32,
}

/// Everything that may move, at one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    pub camera: Camera,
    pub lights: Vec<Light>,
    /// Objects by name, and their places in the world.
    pub places: Vec<(&'static str, Mat4)>,
    /// The time of the first animation, s; `None` without one.
    pub time_s: Option<f32>,
}

impl Pose {
    /// The pose before anything moved.
    pub fn of(start: &Start) -> Self {
        Self {
            camera: start.camera.clone(),
            lights: start.scene.lights.clone(),
            places: Vec::new(),
            time_s: None,
        }
    }
}

/// The finished share of a phase: 0 before it and 1 after it.
fn progress(step: &Step, phase: usize) -> f32 {
    match step.phase {
        now if now < phase => 0.0,
        now if now == phase => step.share,
        _ => 1.0,
    }
}

pub(super) fn orbit(start: &Start, step: &Step) -> Pose {
    const ANGLE_RAD: f32 = 15.0 / 180.0 * PI;
    let turn = Quat::from_rotation_y(ANGLE_RAD * progress(step, 1));
    let pivot = start.scene.bounds().center();
    let camera = &start.camera;
    Pose {
        camera: Camera {
            position: pivot + turn * (camera.position - pivot),
            forward: turn * camera.forward,
            up: turn * camera.up,
            ..camera.clone()
        },
        ..Pose::of(start)
    }
}

pub(super) fn lamp(start: &Start, step: &Step) -> Pose {
    let mut pose = Pose::of(start);
    let share = if step.phase == 1 { step.share } else { 0.0 };
    let size = start.scene.bounds().size();
    let way = Vec3::new(0.3, -0.25, 0.2) * size * share;
    let lamp = pose.lights.iter_mut().find(|light| !light.kind.is_parallel());
    if let Some(lamp) = lamp {
        lamp.position += way;
    }
    pose
}

pub(super) fn switch(start: &Start, step: &Step) -> Pose {
    let mut pose = Pose::of(start);
    if step.phase == 1 {
        pose.lights.retain(|light| light.kind.is_parallel());
    }
    pose
}

/// The block that moves.
pub(super) const BLOCK: &str = "short block";

pub(super) fn block(start: &Start, step: &Step) -> Pose {
    let share = if step.phase == 1 { step.share } else { 0.0 };
    let instance = start.scene.instances.iter().find(|instance| instance.name == BLOCK);
    let rest = instance.map_or(Mat4::IDENTITY, |instance| instance.world_from_local);
    let way = Vec3::new(-0.75, 0.0, 0.12) * share;
    let place = Mat4::from_translation(way) * rest * Mat4::from_rotation_y(FRAC_PI_2 * share);
    Pose { places: vec![(BLOCK, place)], ..Pose::of(start) }
}

/// The door that moves.
pub(super) const DOOR: &str = "door";
/// Half the thickness of the door's wall, as in the built-in scene.
const WALL_HALF_M: f32 = 0.0025;
/// A point on the axis of the hinges, which is parallel to y.
const HINGE: Vec3 = Vec3::new(-WALL_HALF_M, 0.0, 0.13);

/// Adds a 4 cm thick door before the doorway, on the lit side, 2 cm larger on each side.
pub(super) fn add_door(scene: &mut Scene) -> Result<(), Failure> {
    let missing = || Failure::input("the built-in scene has no wall to hang a door on".to_owned());
    let wall = scene.instances.iter().find(|instance| instance.name == "dividing wall");
    let material = wall.ok_or_else(missing)?.material;
    scene.meshes.push(cuboid(Vec3::new(-0.04, 0.0, 0.0), Vec3::new(0.0, 1.62, 0.84)));
    scene.instances.push(Instance {
        name: DOOR.to_owned(),
        mesh: scene.meshes.len() - 1,
        material,
        world_from_local: Mat4::from_translation(HINGE),
        is_static: false,
        ..Instance::default()
    });
    Ok(())
}

pub(super) fn door(start: &Start, step: &Step) -> Pose {
    let open = 1.0 - progress(step, 1) + progress(step, 3);
    // The door opens into the lit room.
    let place = Mat4::from_translation(HINGE) * Mat4::from_rotation_y(-FRAC_PI_2 * open);
    Pose { places: vec![(DOOR, place)], ..Pose::of(start) }
}

pub(super) fn sun(start: &Start, step: &Step) -> Pose {
    const HALF_ARC_RAD: f32 = 35.0 / 180.0 * PI;
    let mut pose = Pose::of(start);
    let angle_rad = HALF_ARC_RAD * (2.0 * progress(step, 1) - 1.0);
    for light in &mut pose.lights {
        if light.kind.is_parallel() {
            let noon = Vec3::new(0.0, light.direction.y, light.direction.z).normalize();
            light.direction = Quat::from_rotation_z(angle_rad) * noon;
        }
    }
    pose
}

pub(super) fn animation(start: &Start, step: &Step) -> Pose {
    Pose { time_s: Some(start.duration_s * progress(step, 1)), ..Pose::of(start) }
}

/// An axis-aligned box, its faces outwards.
fn cuboid(min: Vec3, max: Vec3) -> Mesh {
    let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let mut mesh = Mesh { name: "cuboid".to_owned(), ..Mesh::default() };
    for (axis, u, v) in
        [(Vec3::X, Vec3::Y, Vec3::Z), (Vec3::Y, Vec3::Z, Vec3::X), (Vec3::Z, Vec3::X, Vec3::Y)]
    {
        for normal in [axis, -axis] {
            // u x v is the normal, so that corners are counter-clockwise seen from outside.
            let u = if normal == axis { u } else { -u };
            let first = mesh.positions.len() as u32;
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions.push(middle + half * (normal + a * u + b * v));
                mesh.normals.push(normal);
                mesh.uvs.push(glam::Vec2::new(a, b) * 0.5 + 0.5);
                mesh.tangents.push(u.extend(1.0));
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
        }
    }
    mesh
}
