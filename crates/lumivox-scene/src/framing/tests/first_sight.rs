//! The light and the view of a scene whose file does not provide them.

use super::*;
use crate::{Environment, Light, Sampler, Texture, TextureRef};

/// A scene of which one mesh emits, in cd/m².
fn glowing(mut scene: Scene, mesh: usize, radiance: f32) -> Scene {
    let mut lamp = Material::diffuse("lamp", Vec3::ZERO);
    lamp.emissive = Vec3::splat(radiance);
    scene.materials.push(lamp);
    scene.instances[mesh].material = scene.materials.len() - 1;
    scene
}

/// A block of 4 x 3 x 4 m with a window of a square metre, on a ground.
fn house_with_a_lit_window(radiance: f32) -> Scene {
    let block = cuboid(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 3.0, 2.0), Faces::NO_BOTTOM);
    let window = quad(Vec3::new(0.0, 1.5, 2.01), Vec3::X * 0.5, Vec3::Y * 0.5);
    let ground = quad(Vec3::ZERO, Vec3::X * 4.0, Vec3::NEG_Z * 4.0);
    glowing(scene([block, window, ground], false), 1, radiance)
}

fn light_of(scene: &Scene) -> Option<DefaultLight> {
    lit(&mut scene.clone(), None)
}

#[test]
fn scenes_with_faint_emitters_get_default_light() {
    for radiance in [1e-3, 1e3] {
        // The neck of a helmet glows, or a window of a diorama.
        let helmet = light_of(&glowing(helmet(), 3, radiance));
        assert!(matches!(helmet, Some(DefaultLight::Studio { .. })), "{helmet:?} at {radiance}");
        assert!(light_of(&house_with_a_lit_window(radiance)).is_some(), "at {radiance} cd/m²");
    }
}

/// A studio is not brighter than an emissive thing in it, which is therefore seen to glow; its
/// units are stated nevertheless.
#[test]
fn studio_light_is_dimmed_below_emitters() {
    let dimmed = |radiance: f32| {
        let mut scene = glowing(helmet(), 3, radiance);
        let Some(DefaultLight::Studio { studio, dimmed, .. }) = lit(&mut scene, None) else {
            panic!("a helmet stands in a studio")
        };
        assert_eq!(scene.environment.radiance, Vec3::splat(dimmed));
        (dimmed, studio.ground_lux * dimmed / std::f32::consts::PI)
    };
    let (share, white) = dimmed(1.0);
    assert!(share < 0.01 && (white - 1.0).abs() < 1e-3, "{white} cd/m²");
    assert_eq!(dimmed(1e4).0, 1.0);
}

#[test]
fn rooms_with_enough_lamp_light_get_no_default() {
    let lamp = quad(Vec3::new(0.0, 2.99, 0.0), Vec3::X * 0.5, Vec3::Z * 0.5);
    let mut room = glowing(scene([room(), lamp], false), 1, 1.0);
    assert_eq!(light_of(&room), None, "pi lm on 108 m²");
    // The texture leaves nothing of it but the noise of its compression.
    room.textures.push(Texture {
        name: String::new(),
        width: 1,
        height: 1,
        rgba8: vec![4, 3, 6, 255],
        sampler: Sampler::default(),
    });
    room.materials[1].emissive_texture = Some(TextureRef::new(0));
    assert!(matches!(light_of(&room), Some(DefaultLight::Lamps(_))));
}

#[test]
fn an_object_under_one_dim_lamp_gets_default_light() {
    let lamp = |intensity: f32| {
        let mut scene = helmet();
        scene.lights.push(Light {
            intensity,
            position: Vec3::new(1.5, 6.0, 5.0),
            ..Light::default()
        });
        scene
    };
    let mut dim = lamp(1.0);
    let light = lit(&mut dim, None);
    assert!(matches!(light, Some(DefaultLight::Studio { .. })), "{light:?}");
    assert_eq!(dim.lights.len(), 1, "the lamp stays");
    assert_eq!(light_of(&lamp(100.0)), None);
    // A strong one within reaches nothing that is seen.
    let mut hidden = lamp(1e5);
    hidden.lights[0].position = Vec3::new(0.0, 3.0, 0.0);
    assert!(light_of(&hidden).is_some());
    // The sun of a file whose light has no unit.
    let mut sun = lamp(0.0);
    (sun.lights[0].kind, sun.lights[0].intensity) = (LightKind::Directional, 3.0);
    sun.lights[0].direction = Vec3::new(-0.3, -0.8, -0.6).normalize();
    assert_eq!(light_of(&sun), None);
    sun.lights[0].direction = Vec3::Y;
    assert!(light_of(&sun).is_some(), "from below it lights nothing that is seen");
}

#[test]
fn staging_does_not_change_built_in_scenes() {
    for name in builtin::names() {
        let original = builtin::scene(name).unwrap();
        let mut staged = original.clone();
        let sight = staged.stage(&SightOptions::default());
        assert!(sight.light.is_none(), "{name}: {:?}", sight.notes);
        assert!(staged == original, "{name}");
    }
}

#[test]
fn requested_staging_is_applied() {
    let staged = |scene: &Scene, staging| {
        let mut scene = scene.clone();
        let sight = scene.stage(&SightOptions { staging, ..SightOptions::default() });
        scene.validate().unwrap();
        (sight.light, scene)
    };
    for scene in [helmet(), hall()] {
        let bounds = scene.bounds();
        let (light, dark) = staged(&scene, Staging::None);
        assert_eq!((light, dark.lights.len(), dark.environment), (None, 0, Environment::default()));
        let (light, studio) = staged(&scene, Staging::Studio);
        assert!(matches!(light, Some(DefaultLight::Studio { .. })));
        assert_eq!(studio.environment.map.map(|map| map.name.clone()).as_deref(), Some("studio"));
        assert_eq!(studio.instances.last().unwrap().name, "studio ground");
        let ground = scene.instances.len()..studio.instances.len();
        assert!(studio.instances[ground].iter().all(|instance| instance.is_backdrop));
        let (light, sky) = staged(&scene, Staging::Sky);
        assert!(matches!(light, Some(DefaultLight::SunAndSky { .. })));
        assert_eq!(sky.bounds(), bounds, "a ground is no part of it");
    }
}

#[test]
fn landscapes_get_a_sky_and_a_ground() {
    let mut scene = terrain();
    let Some(DefaultLight::SunAndSky { ground: Some(ground), .. }) = lit(&mut scene, None) else {
        panic!("a landscape lies in the open")
    };
    let bounds = scene.bounds();
    assert!(ground.center.y < bounds.min.y && ground.center.y > bounds.min.y - 0.1);
    assert!(ground.radius_m > 10.0 * bounds.radius_m());
}

#[test]
fn notes_name_the_options_that_override_choices() {
    let mut scene = helmet();
    let sight = scene.stage(&SightOptions::default());
    let told: Vec<String> = sight.notes.iter().map(Note::to_string).collect();
    assert_eq!(
        told,
        [
            "from outside, where most of it is seen (--camera inside)",
            &format!(
                "a studio of {:.0} lux: it has none of its own (--surroundings sky or none)",
                crate::studio::Studio::new().ground_lux
            ),
        ]
    );
    assert_eq!(sight.notes.iter().map(|note| note.about).collect::<Vec<_>>(), ["camera", "light"]);
    let cornell = builtin::scene("cornell").unwrap().stage(&SightOptions::default());
    let told: Vec<String> = cornell.notes.iter().map(Note::to_string).collect();
    assert!(
        told[0].starts_with("its own, ") && told[0].contains(" lux on what is seen"),
        "{told:?}"
    );
    // A scene that glows and has no other light looks dark for a reason.
    let furnace = builtin::scene("furnace").unwrap().stage(&SightOptions::default());
    assert!(furnace.notes[0].text.starts_with("its own emission alone, "), "{:?}", furnace.notes);
}

#[test]
fn cameras_look_into_open_boxes_at_any_scale() {
    let (low, high) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
    let blocks = || {
        [(-0.4, -0.3, 1.2), (0.4, 0.4, 0.6)].map(|(x, z, height)| {
            let foot = Vec3::new(x, 0.0, z);
            let half = Vec3::new(0.3, 0.0, 0.3);
            cuboid(foot - half, foot + half + Vec3::Y * height, Faces::NO_BOTTOM)
        })
    };
    // Walls that are seen from within, from both sides, and thick ones; each open towards +z.
    let is_front = |mesh: &Mesh, t: &[u32], z: f32| {
        t.iter().all(|&i| (mesh.positions[i as usize].z - z).abs() < 1e-4)
    };
    let without = |mut mesh: Mesh, z: f32| {
        let kept = mesh.indices.chunks(3).filter(|t| !is_front(&mesh, t, z));
        mesh.indices = kept.flatten().copied().collect();
        mesh
    };
    let inner = || without(interior(low, high), 1.0);
    let outer = || {
        let wall = Vec3::splat(0.1);
        without(cuboid(low - wall, high + wall.with_z(0.0), Faces::ALL), 1.0)
    };
    let boxes = [
        scene([inner()].into_iter().chain(blocks()), false),
        scene([inner()].into_iter().chain(blocks()), true),
        scene([inner(), outer()].into_iter().chain(blocks()), false),
        scene([inner()], false),
    ];
    for (number, original) in boxes.iter().enumerate() {
        for turn in
            [0.0, std::f32::consts::FRAC_PI_2].into_iter().take(if number == 0 { 2 } else { 1 })
        {
            let mut turned = original.clone();
            turned.transform(Mat4::from_rotation_y(turn));
            let opening = Mat4::from_rotation_y(turn).transform_vector3(Vec3::Z);
            for scale in [1e-3, 1.0].into_iter().take(if number == 0 { 2 } else { 1 }) {
                let camera = scaled(&turned, scale).default_camera(ASPECT);
                let where_from = format!("box {number} turned by {turn} at scale {scale}");
                assert!(camera.forward.dot(opening) < -0.99, "{where_from}: {camera:?}");
                assert!(camera.position.dot(opening) > 1.5 * scale, "{where_from}: {camera:?}");
            }
        }
    }
}

#[test]
fn cameras_view_boards_along_their_thin_axis() {
    // A picture frame, a circuit board with its parts, a shelf's side.
    for (thin, half) in [
        (Vec3::Z, Vec3::new(0.8, 0.6, 0.01)),
        (Vec3::Y, Vec3::new(0.8, 0.01, 0.5)),
        (Vec3::X, Vec3::new(0.01, 0.9, 0.5)),
    ] {
        for is_double_sided in [false, true] {
            let mut board = cuboid(-half, half, Faces::ALL);
            if thin == Vec3::Y {
                let part = cuboid(Vec3::new(0.1, 0.01, 0.1), Vec3::new(0.2, 0.02, 0.2), Faces::ALL);
                board = merge([board, part]);
            }
            let scene = scene([board], is_double_sided);
            let camera = scene.default_camera(ASPECT);
            assert!(camera.forward.dot(thin).abs() > 0.99, "{thin}: {}", camera.forward);
            assert_fits(&scene, &camera, ASPECT);
        }
    }
}

#[test]
fn small_things_on_a_large_ground_fill_the_picture() {
    let thing = || cuboid(Vec3::new(2.0, 0.0, 1.0), Vec3::new(3.0, 1.2, 2.0), Faces::NO_BOTTOM);
    let ground = || quad(Vec3::ZERO, Vec3::X * 50.0, Vec3::NEG_Z * 50.0);
    let mut dome = sphere(80.0, 24);
    dome.flip_winding();
    let alone = scene([thing()], false);
    for scene in [
        scene([thing(), ground()], false),
        // In one mesh as well.
        scene([merge([ground(), thing()])], false),
        scene([thing(), dome], false),
    ] {
        let camera = scene.default_camera(ASPECT);
        assert_fits(&alone, &camera, ASPECT);
        assert!(camera.position.y > 0.0);
    }
    // A town on its plain is large enough to be seen with it.
    let town = scene(
        [
            cuboid(Vec3::new(-30.0, 0.0, -30.0), Vec3::new(30.0, 8.0, 30.0), Faces::NO_BOTTOM),
            ground(),
        ],
        false,
    );
    assert_fits(&town, &town.default_camera(ASPECT), ASPECT);
}

#[test]
fn cameras_view_stage_sets_from_the_open_side() {
    let things = || {
        [-1.0, 0.2, 1.3].map(|x| {
            cuboid(Vec3::new(x - 0.3, 0.0, -0.3), Vec3::new(x + 0.3, 0.7, 0.3), Faces::NO_BOTTOM)
        })
    };
    for turn in [0.0, 2.5] {
        // A stage set: floor and back wall of some thickness.
        let wall = cuboid(Vec3::new(-2.0, 0.0, -1.1), Vec3::new(2.0, 2.0, -1.0), Faces::ALL);
        let floor = cuboid(Vec3::new(-2.0, -0.1, -1.0), Vec3::new(2.0, 0.0, 1.0), Faces::ALL);
        let mut scene = scene(things().into_iter().chain([wall, floor]), false);
        scene.transform(Mat4::from_rotation_y(turn));
        let camera = scene.default_camera(ASPECT);
        let front = Mat4::from_rotation_y(turn).transform_vector3(Vec3::Z);
        assert!(camera.forward.dot(front) < -0.3, "turned by {turn}: {}", camera.forward);
    }
}

/// Rays count what they are tested against, which is the same on every machine.
#[test]
fn framing_slivers_needs_a_bounded_number_of_tests() {
    for corners in [50_000, 200_000_u32] {
        // A disc of slivers around its middle, as CAD writes them.
        let at = |i: u32| {
            let (sin, cos) = (i as f32 / corners as f32 * std::f32::consts::TAU).sin_cos();
            Vec3::new(cos, sin, 0.0)
        };
        let mut disc = Mesh { positions: vec![Vec3::ZERO], ..Mesh::default() };
        disc.positions.extend((0..corners).map(at));
        disc.indices = (0..corners).flat_map(|i| [0, 1 + i, 1 + (i + 1) % corners]).collect();
        disc.normals = vec![Vec3::Z; disc.positions.len()];
        disc.uvs = vec![Vec2::ZERO; disc.positions.len()];
        disc.tangents = vec![Vec3::X.extend(1.0); disc.positions.len()];
        let scene = scene([disc], false);
        let framing = Framing::of(&scene);
        let camera = framing.camera(ASPECT);
        framing.light(&camera, 0.0);
        let tests = framing.rays.tests();
        // A box of as many well-shaped triangles takes some three million.
        assert!(tests < 30_000_000, "{corners} corners: {tests} tests");
        assert!(camera.forward.z < -0.99, "{}", camera.forward);
    }
}
