//! The surfaces that the camera sees at one step, and which of them were hidden or off screen one
//! step before.

use glam::{UVec2, Vec2, Vec3};
use lumivox_scene::{Camera, Pick, Picker, Scene};

/// A point counts as hidden if the first surface along its ray is nearer by more than this share. A
/// visible point lies on that surface, up to rounding.
const SAME_DISTANCE: f32 = 1e-3;

/// The view of one step.
#[derive(Debug)]
pub struct Seen {
    scene: Scene,
    camera: Camera,
    picker: Picker,
    /// The surface in the middle of each pixel, row by row from the top.
    picks: Vec<Option<Pick>>,
    size: UVec2,
}

impl Seen {
    /// Finds the surface in the middle of each pixel, on the CPU.
    pub fn new(scene: &Scene, camera: &Camera, size: UVec2) -> Self {
        let picker = Picker::new(scene);
        let pixels =
            (0..size.y).flat_map(|y| (0..size.x).map(move |x| Vec2::new(x as f32, y as f32)));
        let pick = |pixel: Vec2| {
            let (eye, direction) = camera.ray(pixel + 0.5, size);
            picker.pick(eye, direction)
        };
        let picks = pixels.map(pick).collect();
        Self { scene: scene.clone(), camera: camera.clone(), picker, picks, size }
    }

    /// The pixels whose surface was hidden or off screen in `before`; `false` for pixels without a
    /// surface.
    pub fn disoccluded_since(&self, before: &Self) -> Vec<bool> {
        let is_same_camera = self.camera == before.camera;
        let is_new = |(pixel, pick): (usize, &Option<Pick>)| {
            let Some(pick) = *pick else { return false };
            let Some(position) = self.position_in(&before.scene, pick) else { return true };
            let stays = position.distance(pick.position) <= SAME_DISTANCE * pick.distance_m;
            if is_same_camera && stays {
                // The ray is the same in both steps: compare its surfaces, which also works along
                // edges.
                let was = before.picks[pixel];
                return was.is_none_or(|was| was.instance != pick.instance);
            }
            !before.shows(position)
        };
        self.picks.iter().enumerate().map(is_new).collect()
    }

    /// The position of a picked point in another pose of the scene; `None` if its triangle does not
    /// exist there.
    fn position_in(&self, other: &Scene, pick: Pick) -> Option<Vec3> {
        let corners = |scene: &Scene| {
            let instance = scene.instances.get(pick.instance)?;
            let mesh = scene.meshes.get(instance.mesh)?;
            let indices = mesh.indices.get(3 * pick.triangle..3 * pick.triangle + 3)?;
            let corner = |index: u32| {
                let local = *mesh.positions.get(index as usize)?;
                Some(instance.world_from_local.transform_point3(local))
            };
            Some([corner(indices[0])?, corner(indices[1])?, corner(indices[2])?])
        };
        let [a, b, c] = corners(&self.scene)?;
        let [weight_b, weight_c] = barycentric([a, b, c], pick.position);
        let [a, b, c] = corners(other)?;
        Some(a + weight_b * (b - a) + weight_c * (c - a))
    }

    /// Whether a point of a surface is on screen and not hidden.
    fn shows(&self, position: Vec3) -> bool {
        let local = self.camera.camera_from_world().transform_point3(position);
        if local.z >= -self.camera.near_m {
            return false;
        }
        let half_height = (0.5 * self.camera.vertical_fov_rad).tan();
        let aspect = self.size.x as f32 / self.size.y as f32;
        let place = local.truncate() / (-local.z * half_height * Vec2::new(aspect, 1.0));
        let eye = self.camera.position;
        let distance = eye.distance(position);
        // A ray to an edge may miss both of its triangles; the point is then not hidden.
        let first = self.picker.pick(eye, position - eye);
        let is_hidden =
            first.is_some_and(|first| first.distance_m < (1.0 - SAME_DISTANCE) * distance);
        place.abs().max_element() <= 1.0 && !is_hidden
    }
}

/// The weights of the second and third corner of a triangle at a point in its plane.
fn barycentric([a, b, c]: [Vec3; 3], position: Vec3) -> [f32; 2] {
    let [a, b, c, position] = [a, b, c, position].map(Vec3::as_dvec3);
    let (u, v, w) = (b - a, c - a, position - a);
    let normal = u.cross(v);
    let square = normal.length_squared();
    if square == 0.0 {
        return [0.0; 2];
    }
    [w.cross(v).dot(normal) / square, u.cross(w).dot(normal) / square].map(|weight| weight as f32)
}

#[cfg(test)]
mod tests {
    use glam::Mat4;
    use lumivox_scene::{Instance, Material, Mesh};

    use super::*;

    /// A wall at z = 0 that fills the view from z = 1, and a square 0.5 m wide at z = 0.5.
    fn scene(square_x: f32) -> Scene {
        let quad = |half: f32| Mesh {
            positions: vec![
                Vec3::new(-half, -half, 0.0),
                Vec3::new(half, -half, 0.0),
                Vec3::new(half, half, 0.0),
                Vec3::new(-half, half, 0.0),
            ],
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO; 4],
            tangents: vec![Vec3::X.extend(1.0); 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Mesh::default()
        };
        let square = Instance {
            mesh: 1,
            world_from_local: Mat4::from_translation(Vec3::new(square_x, 0.0, 0.5)),
            ..Instance::default()
        };
        Scene {
            meshes: vec![quad(10.0), quad(0.25)],
            instances: vec![Instance::default(), square],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    fn camera(x: f32) -> Camera {
        // A square 2 m wide at z = 0.
        Camera::look_at(Vec3::new(x, 0.0, 1.0), Vec3::new(x, 0.0, 0.0), FRAC_PI_2)
    }
    use std::f32::consts::FRAC_PI_2;

    const SIZE: UVec2 = UVec2::new(16, 16);

    fn columns(mask: &[bool], row: u32) -> Vec<u32> {
        (0..SIZE.x).filter(|x| mask[(row * SIZE.x + x) as usize]).collect()
    }

    /// The square, at half the distance, covers columns 4 to 11. Moved by a quarter of the view's
    /// width there, it covers four other columns, and uncovers four of the wall. No point of the
    /// square itself is new: its points have moved with it.
    #[test]
    fn surface_uncovered_by_a_moving_object_is_disoccluded() {
        let camera = camera(0.0);
        let before = Seen::new(&scene(0.0), &camera, SIZE);
        let now = Seen::new(&scene(0.25), &camera, SIZE);
        let mask = now.disoccluded_since(&before);
        assert_eq!(columns(&mask, 8), [4, 5, 6, 7]);
        assert_eq!(columns(&mask, 1), [0_u32; 0]);
        assert!(before.disoccluded_since(&before).iter().all(|is_new| !is_new));
    }

    /// A camera that moves a quarter of a metre to the right sees two new columns at the right
    /// edge. The square moves twice as far in the picture as the wall behind it, so it uncovers two
    /// columns on its right.
    #[test]
    fn a_moving_camera_disoccludes_picture_edges_and_hidden_surface() {
        let now = Seen::new(&scene(0.0), &camera(0.25), SIZE);
        let mask = now.disoccluded_since(&Seen::new(&scene(0.0), &camera(0.0), SIZE));
        assert_eq!(columns(&mask, 1), [14, 15]);
        assert_eq!(columns(&mask, 8), [8, 9, 14, 15]);
    }
}
