//! Tests of single-sided and double-sided walls with light from behind.

use glam::Vec3;
use lumivox_render::{RenderSettings, ShadowMethod, View};
use lumivox_scene::{Camera, Light, LightKind, Material, Scene, TextureRef};

use crate::surfaces::stage::*;

/// In the middle of a voxel: if a double-sided wall is at a voxel's edge, cones that start on it
/// see the other side (6 % of its light).
const WALL_X: f32 = 0.03;

/// A white wall that faces +x, on a white floor, with a lamp on one side; the camera looks down at
/// the floor around `seen_x`.
fn wall(double_sided: bool, lamp_x: f32, seen_x: f32) -> Scene {
    let mut scene = scene();
    let white = Material::diffuse("white", Vec3::splat(0.8));
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0), white.clone());
    let wall = quad(Vec3::new(WALL_X, 1.0, 0.0), Vec3::NEG_Z * 2.0, Vec3::Y);
    add(&mut scene, wall, Material { double_sided, ..white });
    scene.lights.push(Light {
        intensity: 10.0,
        position: Vec3::new(lamp_x, 0.7, 0.0),
        ..Light::default()
    });
    let target = Vec3::new(seen_x, 0.0, 0.0);
    scene.cameras = vec![Camera::look_at(target + Vec3::new(0.5 * seen_x, 1.0, 0.0), target, 0.3)];
    scene
}

/// Both sides of every wall cast shadows, in maps and for cones, even if the wall is single-sided.
#[test]
#[ignore = "slow: over three seconds"]
fn a_lamp_behind_a_wall_does_not_shine_through() {
    for double_sided in [false, true] {
        for shadows in [ShadowMethod::Map, ShadowMethod::Cone] {
            let lit = |lamp_x, seen_x| {
                let scene = wall(double_sided, lamp_x, seen_x);
                let settings = RenderSettings { shadows, resolution: 64, ..settings(View::Direct) };
                mean(&render(&scene, settings)).x
            };
            // The wall faces the visible floor, and the lamp is behind the wall.
            let behind = lit(-0.7, 0.7);
            let beside = lit(0.7, 0.7);
            assert!(beside > 1.0, "the lamp lights its own side: {beside}");
            assert!(behind < 0.01 * beside, "{shadows:?}, {double_sided}: {behind} of {beside}");
            // The wall faces the lamp, and the visible floor is behind the wall.
            let behind = lit(0.7, -0.7);
            assert!(behind < 0.01 * beside, "{shadows:?}, {double_sided}: {behind} of {beside}");
        }
    }
}

/// Cones pass the back of a wall that is open from behind, but not its front.
#[test]
fn an_open_back_lets_light_pass() {
    let lit = |lamp_x, seen_x| {
        let mut scene = wall(false, lamp_x, seen_x);
        for material in &mut scene.materials {
            material.open_behind = true;
        }
        let settings = RenderSettings {
            shadows: ShadowMethod::Cone,
            resolution: 64,
            ..settings(View::Direct)
        };
        mean(&render(&scene, settings)).x
    };
    let beside = lit(0.7, 0.7);
    let (to_the_front, to_the_back) = (lit(0.7, -0.7), lit(-0.7, 0.7));
    assert!(to_the_front > 0.05 * beside, "{to_the_front} of {beside}");
    assert!(to_the_back < 0.01 * beside, "{to_the_back} of {beside}");
}

/// A wall reflects light only on the lamp's side.
#[test]
#[ignore = "slow: over three seconds"]
fn a_wall_lit_from_behind_stays_dark_in_front() {
    for double_sided in [false, true] {
        let indirect = |lamp_x, seen_x| {
            let scene = wall(double_sided, lamp_x, seen_x);
            let settings = RenderSettings { bounces: 2, resolution: 64, ..settings(View::Diffuse) };
            mean(&render(&scene, settings)).x
        };
        let (lit, dark) = (indirect(0.7, 0.7), indirect(-0.7, 0.7));
        println!("double-sided {double_sided}: {lit} from the lit side, {dark} from behind");
        assert!(lit > 0.1 && dark < 0.03 * lit, "{double_sided}: {dark} of {lit}");
    }
}

/// A room of double-sided walls: whichever half of its voxels a wall is in, cones near it start
/// inside the room, and not outside, where it is dark.
#[test]
#[ignore = "slow: over three seconds"]
fn a_room_of_two_sided_walls_has_no_dark_edges() {
    let mut room = scene();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [axis, -axis] {
            let along = axis.any_orthonormal_vector();
            let wall = quad(side, along, side.cross(along));
            add(&mut room, wall, Material { double_sided: true, ..glowing(Vec3::ONE) });
        }
    }
    room.cameras = vec![Camera::look_at(Vec3::ZERO, Vec3::new(-1.0, -1.0, 0.0), 0.2)];
    for eighths in [3, 5] {
        let grid_offset = Vec3::splat(0.125 * eighths as f32);
        // Each frame samples one point of all walls for a pixel.
        let drawn = RenderSettings { frames: 256, ..settings(View::Diffuse) };
        let picture = render(&room, RenderSettings { bounces: 1, grid_offset, ..drawn });
        let light = || picture.hdr.iter().map(|pixel| pixel[0]);
        let (darkest, brightest) = (light().fold(f32::MAX, f32::min), light().fold(0.0, f32::max));
        println!("{grid_offset}: {darkest} to {brightest}");
        assert!(darkest > 0.9 && brightest < 1.1, "{grid_offset}: {darkest} to {brightest}");
    }
}

#[test]
fn each_side_shows_the_light_on_that_side() {
    let seen = |double_sided, lamp_x, from_x: f32| {
        let mut scene = wall(double_sided, lamp_x, 1.0);
        scene.meshes.remove(0);
        scene.instances.remove(0);
        scene.instances[0].mesh = 0;
        let eye = Vec3::new(from_x, 1.0, 0.3);
        scene.cameras = vec![Camera::look_at(eye, Vec3::Y, 0.3)];
        let picture = render(&scene, RenderSettings { frames: 1, ..settings(View::Direct) });
        (mean(&picture).x, picture.hdr.iter().all(|pixel| pixel[3] > 0.0))
    };
    for (double_sided, from_x, is_there) in
        [(false, 2.0_f32, true), (false, -2.0, false), (true, 2.0, true), (true, -2.0, true)]
    {
        let (lit, filled) = seen(double_sided, 0.7 * from_x.signum(), from_x);
        let (from_behind, _) = seen(double_sided, -0.7 * from_x.signum(), from_x);
        assert_eq!(filled, is_there, "double-sided {double_sided}, seen from {from_x}");
        assert!(from_behind <= 0.0, "lit from behind: {from_behind}");
        assert!((lit > 1.0) == is_there, "double-sided {double_sided}, from {from_x}: {lit}");
    }
}

/// With bent normals, a surface shows no light from behind its plane, not even near its border,
/// where nothing blocks grazing light.
#[test]
fn bent_normals_catch_no_light_from_behind() {
    let lit_from = |z: f32| {
        let mut scene = scene();
        // (0.8, 0, 0.6) in bytes.
        scene.textures.push(texture(1, 1, |_, _| [230, 128, 204, 255]));
        let mut material = Material::diffuse("bent", Vec3::ONE);
        material.normal_texture = Some(TextureRef::new(0));
        add(&mut scene, quad(Vec3::ZERO, Vec3::X * 0.5, Vec3::Y * 0.5), material);
        scene.lights.push(Light {
            kind: LightKind::Directional,
            intensity: 1.0,
            direction: Vec3::new(-1.0, 0.0, -z).normalize(),
            ..Light::default()
        });
        render(&scene, RenderSettings { frames: 1, ..settings(View::Direct) })
    };
    assert!(mean(&lit_from(0.3)).x > 0.1, "from the front it is lit");
    for z in [-0.3, -0.01, -0.001] {
        let brightest = lit_from(z).hdr.iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
        assert!(brightest <= 0.0, "{z}: a pixel has {brightest}");
    }
}
