//! Interactive camera motion.

use glam::{Quat, Vec2, Vec3};
use lumivox_scene::{Bounds, Camera};

/// The steepest pitch, rad: past the vertical, left and right would swap.
const STEEPEST_RAD: f32 = 1.55;

/// Rotates the camera about a point by angles to the right and down, rad. The point stays where it
/// is in the picture.
pub fn orbit(camera: &Camera, pivot: Vec3, angles_rad: Vec2) -> Camera {
    let turn = turn(camera, -angles_rad);
    let position = pivot + turn * (camera.position - pivot);
    Camera { position, forward: (turn * camera.forward).normalize(), up: Vec3::Y, ..camera.clone() }
}

/// Rotates the camera in place by angles to the right and down, rad.
pub fn look(camera: &Camera, angles_rad: Vec2) -> Camera {
    let turn = turn(camera, -angles_rad);
    Camera { forward: (turn * camera.forward).normalize(), up: Vec3::Y, ..camera.clone() }
}

/// A rotation to the left about the vertical, then up, at most to [`STEEPEST_RAD`].
fn turn(camera: &Camera, angles_rad: Vec2) -> Quat {
    let elevation = camera.forward.y.clamp(-1.0, 1.0).asin();
    let raised = (elevation + angles_rad.y).clamp(-STEEPEST_RAD, STEEPEST_RAD);
    let right = camera.world_from_camera().x_axis.truncate();
    Quat::from_rotation_y(angles_rad.x) * Quat::from_axis_angle(right, raised - elevation)
}

/// Moves the camera to its right, up in the world and forwards, m.
pub fn fly(camera: &Camera, way_m: Vec3) -> Camera {
    let right = camera.world_from_camera().x_axis.truncate();
    let by = right * way_m.x + Vec3::Y * way_m.y + camera.forward * way_m.z;
    Camera { position: camera.position + by, ..camera.clone() }
}

/// Moves the camera towards a point (factors below 1) or away from it, without turning it.
pub fn dolly(camera: &Camera, pivot: Vec3, factor: f32) -> Camera {
    let distance = (pivot - camera.position).dot(camera.forward).max(camera.near_m * 4.0);
    fly(camera, Vec3::new(0.0, 0.0, distance * (1.0 - factor)))
}

/// Moves the camera in the picture's plane. `shares` are shares of the picture's height at the
/// distance of `pivot`, so that `pivot` follows the pointer.
pub fn pan(camera: &Camera, pivot: Vec3, shares: Vec2) -> Camera {
    let distance = (pivot - camera.position).dot(camera.forward).max(camera.near_m * 4.0);
    let height = 2.0 * distance * (0.5 * camera.vertical_fov_rad).tan();
    let axes = camera.world_from_camera();
    let by =
        -axes.x_axis.truncate() * shares.x * height + axes.y_axis.truncate() * shares.y * height;
    Camera { position: camera.position + by, ..camera.clone() }
}

/// Moves the camera, without turning it, so that a box fills a picture of this aspect (width over
/// height).
pub fn frame(camera: &Camera, bounds: Bounds, aspect: f32) -> Camera {
    let half = 0.5 * camera.vertical_fov_rad;
    let narrower = half.min((half.tan() * aspect).atan());
    let radius_m = bounds.radius_m().max(1e-4);
    let position = bounds.center() - camera.forward * (radius_m / narrower.sin());
    Camera { position, near_m: camera.near_m.min(radius_m * 1e-3).max(1e-6), ..camera.clone() }
}

/// The command that sets this camera with a target at `distance_m`.
pub fn command(camera: &Camera, distance_m: f32) -> String {
    let p = camera.position;
    let t = p + camera.forward * distance_m.max(camera.near_m);
    let fov_deg = camera.vertical_fov_rad.to_degrees();
    format!("camera {},{},{},{},{},{},{fov_deg}", p.x, p.y, p.z, t.x, t.y, t.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::new(0.0, 1.0, 0.0), 0.8)
    }

    #[test]
    fn an_orbit_keeps_its_pivot_in_the_picture() {
        let pivot = Vec3::new(1.0, 0.5, -1.0);
        let before = camera().camera_from_world().transform_point3(pivot);
        let turned = orbit(&camera(), pivot, Vec2::new(0.7, -0.3));
        let after = turned.camera_from_world().transform_point3(pivot);
        assert!(before.abs_diff_eq(after, 1e-4), "{before} {after}");
        // A drag to the right turns the scene to the right: the camera moves to the left.
        let (eye, left) = (turned.position, orbit(&camera(), pivot, Vec2::new(0.1, 0.0)).position);
        assert!(left.x < camera().position.x && eye != left, "{left}");
    }

    #[test]
    fn looking_down_never_flips_the_camera() {
        let mut turned = camera();
        for _ in 0..50 {
            turned = look(&turned, Vec2::new(0.1, 0.2));
            assert!(turned.forward.is_normalized() && turned.forward.y.abs() < 0.9999);
        }
        assert!(turned.forward.y < -0.99, "{}", turned.forward);
        let raised = look(&turned, Vec2::new(0.0, -1.55));
        assert!(raised.forward.y.abs() < 0.05, "{}", raised.forward);
    }

    #[test]
    fn flying_follows_the_view() {
        let moved = fly(&camera(), Vec3::new(1.0, 2.0, 3.0));
        assert!(moved.position.abs_diff_eq(Vec3::new(1.0, 3.0, 2.0), 1e-5), "{}", moved.position);
        assert_eq!(moved.forward, camera().forward);
        let nearer = dolly(&camera(), Vec3::new(0.0, 1.0, 0.0), 0.5);
        assert!(nearer.position.abs_diff_eq(Vec3::new(0.0, 1.0, 2.5), 1e-5), "{}", nearer.position);
        let panned = pan(&camera(), Vec3::new(0.0, 1.0, 0.0), Vec2::new(0.5, 0.0));
        let height = 2.0 * 5.0 * 0.4_f32.tan();
        assert!((panned.position.x + 0.5 * height).abs() < 1e-4, "{}", panned.position);
    }

    #[test]
    fn framing_a_box_shows_all_of_it() {
        let bounds = Bounds { min: Vec3::new(-1.0, 2.0, 3.0), max: Vec3::new(4.0, 5.0, 9.0) };
        for aspect in [0.5_f32, 2.0] {
            let framed = frame(&camera(), bounds, aspect);
            let tangent = 0.4_f32.tan();
            for corner in bounds.corners() {
                let seen = framed.camera_from_world().transform_point3(corner);
                assert!(seen.z < 0.0, "{seen}");
                assert!(seen.y.abs() <= -seen.z * tangent * 1.001, "{seen}");
                assert!(seen.x.abs() <= -seen.z * tangent * aspect * 1.001, "{seen}");
            }
        }
    }

    #[test]
    fn the_camera_command_restores_the_camera() {
        let at = look(&camera(), Vec2::new(0.4, 0.1));
        let line = command(&at, 3.0);
        let choice = crate::args::camera::camera(line.strip_prefix("camera ").unwrap()).unwrap();
        let scene = lumivox_scene::builtin::scene("cornell").unwrap();
        let back = crate::args::camera::resolve(Some(&choice), &scene, 1.0).unwrap();
        assert_eq!(back.position, at.position);
        assert!(back.forward.abs_diff_eq(at.forward, 1e-5));
        assert!((back.vertical_fov_rad - at.vertical_fov_rad).abs() < 1e-6);
    }
}
