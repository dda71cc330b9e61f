//! Forward rendering: transparent surfaces, forward materials, apps with multisampling.

use bevy::asset::RenderAssetUsages;
use bevy::light::{IrradianceVolume, LightProbe};
use bevy::material::OpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_lumivox::{GiVolume, LumivoxGi};

use crate::common::headless::{self, Shot};
use crate::common::scene;
use crate::stage::{Stage, alone, difference, quick, without_lamp};
use crate::truth::{self, Expected};

/// Probes blur more than cones of pixels: the same mean brightness, a larger error.
#[test]
fn the_forward_cornell_box_is_near_the_path_tracer() {
    let _alone = alone();
    let mut stage = Stage::forward(&scene::builtin("cornell"), truth::SIZE);
    let [forward, own] = truth::errors_of(Expected::of_cornell(), &mut stage, "cornell-forward");
    assert!(forward.bias_percent.abs() <= own.bias_percent.abs() + 5.0);
    assert!(forward.rmse_percent <= 25.0);
    multisampling_stays_where_all_is_drawn_forward(&mut stage);
}

fn multisampling_stays_where_all_is_drawn_forward(stage: &mut Stage) {
    stage.use_small_shadow_maps();
    let mut camera = stage.app.world_mut().get_mut::<Camera>(stage.camera);
    camera.as_mut().expect("a camera").sub_camera_view = None;
    let direct = without_lamp(&stage.settled());
    stage.camera().insert(quick());
    headless::wait_until_ready(&mut stage.app);
    let smooth = without_lamp(&stage.settled());
    assert_eq!(stage.camera().get::<Msaa>(), Some(&Msaa::Sample4));
    stage.camera().insert(Msaa::Off);
    let rough = without_lamp(&stage.settled());
    smooth.save("target/pictures/forward-msaa.png", 2.0);
    rough.save("target/pictures/forward-no-msaa.png", 2.0);
    println!("{} {} {}", direct.mean_luminance(), smooth.mean_luminance(), rough.mean_luminance());
    println!("multisampling changes {}", difference(&smooth, &rough));
    assert!(smooth.mean_luminance() > 1.2 * direct.mean_luminance());
    // A new volume replaces the old one once its probes are lit: no frame in between is dark.
    stage.gi().volume = GiVolume::Scene { resolution: 40 };
    let meanwhile = stage.until_ready();
    let darkest = meanwhile.iter().map(|shot| without_lamp(shot).mean_luminance());
    let darkest = darkest.fold(f32::INFINITY, f32::min);
    println!("darkest frame while another volume is made: {darkest}");
    assert!(darkest > 0.95 * rough.mean_luminance());
    assert!((smooth.mean_luminance() / rough.mean_luminance() - 1.0).abs() < 0.05);
    // Only edges differ.
    assert!(difference(&smooth, &rough) > 0.01);
    assert!(difference(&smooth, &rough) < 0.3);
}

#[test]
fn forward_and_blended_surfaces_match_deferred_light() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let whole = stage.settled();
    let direct = nothing_is_lit_twice(&mut stage, &whole);
    let [whole, direct] = [whole, direct].map(|shot| without_lamp(&shot));
    the_whole_room_may_be_drawn_forward(&mut stage, &whole, &direct);
    a_panel_may_be_blended(&mut stage);
}

/// A speck of glass needs probes, whose light must not be added to deferred surfaces. The app's own
/// volume, which nothing occludes, must light neither. Returns the picture with direct light only.
fn nothing_is_lit_twice(stage: &mut Stage, without: &Shot) -> Shot {
    let mesh = Mesh3d(stage.add(Mesh::from(Sphere::new(0.02))));
    let glass = MeshMaterial3d(stage.add(StandardMaterial {
        base_color: Color::linear_rgba(1.0, 1.0, 1.0, 0.5),
        alpha_mode: AlphaMode::Blend,
        ..default()
    }));
    let place = Transform::from_xyz(0.0, 1.0, 0.0);
    let speck_of_glass = stage.app.world_mut().spawn((mesh, glass, place)).id();
    let speck = stage.settled();
    // Also while Bevy's pipelines change back after the speck is hidden.
    stage.app.world_mut().entity_mut(speck_of_glass).insert(Visibility::Hidden);
    let brightest = (0..12).map(|_| stage.next().mean_luminance()).fold(0.0, f32::max);
    println!("brightest frame after the speck has gone: {}", brightest / without.mean_luminance());
    assert!(brightest < 1.03 * without.mean_luminance());
    stage.app.world_mut().entity_mut(speck_of_glass).insert(Visibility::Inherited);
    let texel =
        [0_u16, 0, 0, 0].map(|_| half::f16::from_f32(1.0)).map(half::f16::to_le_bytes).concat();
    let voxels = stage.add(Image::new_fill(
        Extent3d { width: 1, height: 2, depth_or_array_layers: 3 },
        TextureDimension::D3,
        &texel,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::all(),
    ));
    let volume = IrradianceVolume { voxels, intensity: 50.0, ..default() };
    let parts = (LightProbe::new(), volume, Transform::from_scale(Vec3::splat(10.0)));
    let own = stage.app.world_mut().spawn(parts).id();
    let with_own = stage.settled();
    stage.camera().remove::<LumivoxGi>();
    let bevys = stage.settled();
    let [lit_by_speck, lit_by_own, lit_by_bevy] =
        [&speck, &with_own, &bevys].map(|shot| difference(shot, without));
    println!("{lit_by_speck} {lit_by_own} {lit_by_bevy}");
    speck.save("target/pictures/forward-speck.png", 2.0);
    assert!(lit_by_speck < 0.03 && lit_by_own < 0.03);
    // Without GI the app's volume lights as usual.
    assert!(lit_by_bevy > 0.3);
    for entity in [own, speck_of_glass] {
        stage.app.world_mut().despawn(entity);
    }
    let direct = stage.settled();
    stage.camera().insert(quick());
    direct
}

fn the_whole_room_may_be_drawn_forward(stage: &mut Stage, deferred: &Shot, direct: &Shot) {
    let set_method = |stage: &mut Stage, method| {
        let mut materials = stage.app.world_mut().resource_mut::<Assets<StandardMaterial>>();
        for id in materials.ids().collect::<Vec<_>>() {
            materials.get_mut(id).expect("it is there").opaque_render_method = method;
        }
    };
    set_method(stage, OpaqueRendererMethod::Forward);
    let forward = without_lamp(&stage.settled());
    set_method(stage, OpaqueRendererMethod::Auto);
    forward.save("target/pictures/forward.png", 2.0);
    deferred.save("target/pictures/forward-deferred.png", 2.0);
    let added = |shot: &Shot| shot.mean_luminance() - direct.mean_luminance();
    println!("direct light {}", direct.mean_luminance());
    println!("indirect light: deferred {}, forward {}", added(deferred), added(&forward));
    println!("pictures differ by {}", difference(&forward, deferred));
    assert!(added(deferred) > 0.2 * direct.mean_luminance());
    assert!((added(&forward) / added(deferred) - 1.0).abs() < 0.08);
    assert!(difference(&forward, deferred) < 0.16);
}

fn a_panel_may_be_blended(stage: &mut Stage) {
    let panel = Mesh3d(stage.add(Mesh::from(Rectangle::new(0.9, 0.9))));
    let paint = stage.add(StandardMaterial { perceptual_roughness: 1.0, ..default() });
    let place = Transform::from_xyz(-0.3, 1.2, 0.3);
    stage.app.world_mut().spawn((panel, MeshMaterial3d(paint.clone()), place));
    let deferred = without_lamp(&stage.settled());
    let mut materials = stage.app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let mut material = materials.get_mut(&paint).expect("it is there");
    material.alpha_mode = AlphaMode::Blend;
    material.base_color.set_alpha(0.999);
    drop(material);
    let blended = without_lamp(&stage.settled());
    deferred.save("target/pictures/forward-panel.png", 2.0);
    blended.save("target/pictures/forward-blended.png", 2.0);
    println!("a blended panel {}", difference(&blended, &deferred));
    assert!(difference(&blended, &deferred) < 0.1);
}
