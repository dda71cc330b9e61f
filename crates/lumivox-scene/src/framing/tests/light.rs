//! The scene's own light, and added light.

use super::super::light::Emission;
use super::*;
use crate::{Environment, Light, Sampler, Shading, Texture, TextureRef, Unlit};

pub(super) const NONE: Emission = Emission::NONE;

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

/// White in a studio is not brighter than an emissive thing, so that the thing glows.
#[test]
fn studio_light_is_dimmed_below_emitters() {
    let dimmed = |radiance: f32| {
        let mut scene = glowing(helmet(), 3, radiance);
        let Some(DefaultLight::Studio { studio, dimmed, .. }) = lit(&mut scene, None) else {
            panic!("a helmet stands in a studio")
        };
        assert_eq!(scene.environment.radiance, Vec3::splat(dimmed));
        (dimmed, studio.ground_lux * dimmed / PI)
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
    // The texture makes the emission black, except for the noise of compression.
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
    // The light of a strong lamp inside the thing reaches no visible surface.
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
    // The notes explain why a scene lit only by its emission looks dark.
    let furnace = builtin::scene("furnace").unwrap().stage(&SightOptions::default());
    assert!(furnace.notes[0].text.starts_with("its own emission alone, "), "{:?}", furnace.notes);
}

#[test]
fn two_rooms_get_two_lamps() {
    let mut scene = builtin::scene("two-rooms-closed").unwrap();
    scene.lights.clear();
    scene.cameras.clear();
    scene.materials.iter_mut().for_each(|material| material.emissive = Vec3::ZERO);
    assert!(Framing::of(&scene).is_enclosed());
    let Some(DefaultLight::Lamps(lamps)) = lit(&mut scene, None) else {
        panic!("no sun reaches a closed room")
    };
    assert_eq!(lamps.len(), 2);
    assert!(lamps[0].position.x * lamps[1].position.x < 0.0, "{lamps:?}");
    assert_eq!(scene.lights, lamps);
    scene.validate().unwrap();
    assert_eq!(lit(&mut scene, None), None, "now it is lit");
}

#[test]
fn lamps_give_300_lux_in_the_mean() {
    for scale in [1e-3, 1.0, 1e3] {
        let mut scene = scaled(&scene([room()], false), scale);
        let Some(DefaultLight::Lamps(lamps)) = lit(&mut scene, None) else {
            panic!("no sun reaches a closed room")
        };
        let [lamp] = lamps.as_slice() else { panic!("one room, {} lamps", lamps.len()) };
        assert_eq!((lamp.kind, lamp.range_m), (LightKind::Point, None));
        let area_m2 = 2.0 * (6.0 * 3.0 + 6.0 * 4.0 + 3.0 * 4.0) * scale * scale;
        let mean_lux = 4.0 * PI * lamp.intensity / area_m2;
        // The area is measured by 2048 rays; grazing ones miss a little of it.
        assert!((mean_lux - 300.0).abs() < 9.0, "{mean_lux} lux at scale {scale}");
        let position = lamp.position / scale;
        assert!(position.y > 2.2 && position.y < 2.6, "below the ceiling: {position}");
        assert!(position.x.abs() < 1.5 && position.z.abs() < 0.7, "in the middle: {position}");
        assert!(lamp.radius_m > 0.0 && lamp.radius_m < 0.1 * scale);
    }
}

/// A lamp in the middle of a cube without one wall loses a sixth of its flux, and makes up for it
/// by its intensity.
#[test]
fn lamps_compensate_for_light_lost_through_openings() {
    let walls = without(interior(Vec3::NEG_ONE, Vec3::ONE), |p| p.x > 0.9);
    let framing = Framing::of(&scene([walls], false));
    let lamp = lights::lamp(&framing.rays, Vec3::ZERO).unwrap();
    let landing_lm = 4.0 * PI * lamp.intensity * 5.0 / 6.0;
    let mean_lux = landing_lm / 20.0;
    assert!((mean_lux - 300.0).abs() < 9.0, "{mean_lux} lux");
}

#[test]
fn things_are_lit_from_the_left_of_the_camera() {
    let mut scene = helmet();
    let camera = scene.default_camera(ASPECT);
    let Some(DefaultLight::Studio { studio, rotation_rad, .. }) = lit(&mut scene, Some(&camera))
    else {
        panic!("things stand in a studio")
    };
    let (mut brightest, mut towards) = (0.0, Vec3::ZERO);
    for (index, texel) in studio.map.rgb.iter().enumerate() {
        if texel[0] > brightest {
            let (x, y) = (index as u32 % studio.map.width, index as u32 / studio.map.width);
            brightest = texel[0];
            towards = studio.map.direction(x as f32 + 0.5, y as f32 + 0.5);
        }
    }
    let towards = glam::Mat3::from_rotation_y(rotation_rad) * towards;
    let seen = camera.camera_from_world().transform_vector3(towards);
    assert!(seen.x < -0.3 && seen.y > 0.0 && seen.z > 0.0, "{seen}");
    scene.validate().unwrap();
}

#[test]
fn shines_considers_every_kind_of_light() {
    type Change<'a> = (&'a str, bool, bool, &'a dyn Fn(&mut Scene));
    let mut dark = builtin::scene("cornell").unwrap();
    dark.lights.clear();
    dark.materials.iter_mut().for_each(|material| material.emissive = Vec3::ZERO);
    let unlit = Shading::Unlit(Unlit::default());
    let black = |light: f32| Light { color: Vec3::splat(light), ..Light::default() };
    let changes: [Change<'_>; 8] = [
        ("nothing", false, false, &|_| {}),
        ("a sky", true, false, &|scene| scene.environment.radiance = Vec3::Z * 1e-6),
        ("a lamp", true, false, &|scene| scene.lights.push(black(1.0))),
        ("a black lamp", false, false, &|scene| scene.lights.push(black(0.0))),
        ("emission", true, true, &|scene| scene.materials[0].emissive = Vec3::X),
        ("emission and a lamp", true, false, &|scene| {
            scene.materials[0].emissive = Vec3::X;
            scene.lights.push(black(1.0));
        }),
        ("an unlit surface", false, false, &|scene| scene.materials[0].shading = unlit),
        ("unlit surfaces", true, false, &|scene| {
            scene.materials.iter_mut().for_each(|material| material.shading = unlit);
        }),
    ];
    for (what, shines, emits, change) in changes {
        let mut scene = dark.clone();
        change(&mut scene);
        assert_eq!((scene.shines(), scene.is_lit_by_emission_alone()), (shines, emits), "{what}");
    }
}

/// A square of 4 m² that emits 10 cd/m², with a texture, on a matt one of 16 m².
#[test]
fn emitted_flux_is_scaled_by_the_texture() {
    let (black, white, half) = ([3, 8, 5, 255], [255; 4], [188, 188, 188, 255]);
    let small = quad(Vec3::Y, Vec3::X, Vec3::Z);
    let large = quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0);
    for (texels, share) in [
        ([white; 4], 1.0),
        ([white, black, black, black], 0.25),
        ([half; 4], 0.5),
        ([black; 4], 0.0),
    ] {
        let mut scene = glowing(scene([small.clone(), large.clone()], false), 0, 10.0);
        scene.textures.push(Texture {
            name: String::new(),
            width: 2,
            height: 2,
            rgba8: texels.concat(),
            sampler: Sampler::default(),
        });
        scene.materials[1].emissive_texture = Some(TextureRef::new(0));
        assert_eq!(scene.shines(), share > 0.0);
        let emission = Emission::of(&scene, &Framing::of(&scene).rays);
        let mean_lux = 2.0 * PI * share;
        assert!((emission.mean_lux - mean_lux).abs() < 0.02, "{} lux", emission.mean_lux);
        let luminance = if texels[0] == half { 5.0 } else { 10.0 * share.min(1.0).ceil() };
        assert!((emission.luminance - luminance).abs() < 0.05, "{} cd/m²", emission.luminance);
    }
}
