//! The moving cases: a block and a lamp that move in a scene, a little in every frame.

use glam::{Mat4, Vec2, Vec3, Vec3Swizzles as _};
use lumivox_scene::{Bounds, Instance, Light, Material, Mesh, Scene};

/// The edge of the block, as a share of the scene's shortest side.
const BLOCK_SHARE: f32 = 0.12;
/// The radii of the circles of the block and of a lamp, as shares of the same side.
const BLOCK_REACH: f32 = 0.15;
const LAMP_REACH: f32 = 0.05;
/// The height of the circle above the scene's middle, as a share of its height.
const RISE: f32 = 0.2;
/// The turn per frame, radians: one circle in a second at 60 frames a second.
const TURN_RAD: f32 = std::f32::consts::TAU / 60.0;
/// The largest turn of a sun to either side, radians.
const SUN_TURN_RAD: f32 = 0.05;

/// A scene in which only a block and the first light move.
#[derive(Clone, Debug)]
pub struct MovingScene {
    pub scene: Scene,
    /// The number of the block's instance.
    pub block: usize,
    bounds: Bounds,
    /// The scene's first light before it moves.
    light: Option<Light>,
    step: u32,
}

impl MovingScene {
    /// Adds the block to a valid scene.
    pub fn new(mut scene: Scene) -> Self {
        let bounds = scene.voxel_bounds();
        scene.grid_bounds = Some(bounds);
        for instance in &mut scene.instances {
            instance.is_static = true;
        }
        let block = scene.instances.len();
        scene.instances.push(Instance {
            name: "moving block".to_owned(),
            mesh: scene.meshes.len(),
            material: scene.materials.len(),
            is_static: false,
            ..Instance::default()
        });
        scene.meshes.push(cube(BLOCK_SHARE * shortest(bounds)));
        scene.materials.push(Material::diffuse("moving block", Vec3::new(0.7, 0.5, 0.2)));
        let light = scene.lights.first().cloned();
        let mut moving = Self { scene, block, bounds, light, step: 0 };
        moving.advance();
        moving
    }

    /// Moves block and light by one frame.
    pub fn advance(&mut self) {
        self.step += 1;
        let turn = Vec2::from_angle(TURN_RAD * self.step as f32);
        let around = Vec3::new(turn.x, 0.0, turn.y) * shortest(self.bounds);
        let middle = self.bounds.center() + Vec3::Y * (RISE * self.bounds.size().y);
        self.scene.instances[self.block].world_from_local =
            Mat4::from_translation(middle + BLOCK_REACH * around);
        let Some((light, rest)) = self.scene.lights.first_mut().zip(self.light.as_ref()) else {
            return;
        };
        if light.kind.is_parallel() {
            light.direction = Mat4::from_rotation_y(SUN_TURN_RAD * turn.y)
                .transform_vector3(rest.direction)
                .normalize();
        } else {
            light.position = rest.position + LAMP_REACH * around;
        }
    }
}

fn shortest(bounds: Bounds) -> f32 {
    bounds.size().min_element()
}

/// A cube about the origin.
fn cube(edge_m: f32) -> Mesh {
    let mut mesh = Mesh { name: "moving block".to_owned(), ..Mesh::default() };
    for normal in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
        // A side that faces `normal`, the cross product of u and v.
        let u = normal.yzx();
        let v = normal.cross(u);
        let first = mesh.positions.len() as u32;
        for corner in [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::ONE, Vec2::new(-1.0, 1.0)]
        {
            mesh.positions.push((normal + corner.x * u + corner.y * v) * (0.5 * edge_m));
            mesh.normals.push(normal);
            mesh.uvs.push((corner + 1.0) * 0.5);
            mesh.tangents.push(u.extend(1.0));
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    mesh
}

#[cfg(test)]
mod tests {
    use lumivox_scene::InstanceBounds;

    use super::*;

    #[test]
    fn the_block_and_the_lamp_move_within_the_scene() {
        for name in ["cornell", "atrium"] {
            let mut moving = MovingScene::new(lumivox_scene::builtin::scene(name).unwrap());
            moving.scene.validate().unwrap();
            let bounds = moving.bounds;
            let mut places = Vec::new();
            for _ in 0..60 {
                moving.advance();
                let block = InstanceBounds::of(&moving.scene).get(moving.block);
                assert!(bounds.contains(block.min) && bounds.contains(block.max), "{name}");
                let light = &moving.scene.lights[0];
                places.push((block.min.to_array(), light.position.to_array(), light.direction));
            }
            let is_new = places
                .windows(2)
                .all(|two| two[0].0 != two[1].0 && (two[0].1 != two[1].1 || two[0].2 != two[1].2));
            assert!(is_new, "{name}: {places:?}");
        }
    }

    #[test]
    fn the_cube_faces_outwards() {
        let mesh = cube(2.0);
        assert_eq!(mesh.triangle_count(), 12);
        for [a, b, c] in mesh.triangles() {
            let [a, b, c] = [a, b, c].map(|corner| mesh.positions[corner]);
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(a + b + c) > 0.0);
        }
    }
}
