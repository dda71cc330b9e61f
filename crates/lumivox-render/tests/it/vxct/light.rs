//! What becomes of light in the look of VXCT: suns, shadows that dim what cones gather, surroundings in gloss.

use super::*;

/// Suns do not fade: irradiance / pi, wherever they stand.
#[test]
fn suns_shine_as_bright_as_they_are() {
    let sun = Light {
        kind: LightKind::Directional { illuminance_lux: 3.0, angular_radius_rad: 0.0 },
        direction: Vec3::new(0.6, -0.8, 0.0),
        position: Vec3::splat(7.0),
        ..Light::default()
    };
    let shown = render(&floor(0.0, matte(), sun), look(phong_alone()));
    let expected = 0.8 * (0.08 + 0.8) * 3.0 / PI;
    for pixel in [UVec2::new(24, 18), UVec2::new(14, 12), UVec2::new(34, 26)] {
        let lit = rgb(&shown, pixel).x;
        assert!((lit / expected - 1.0).abs() < 0.01, "{pixel}: {lit} is not {expected}");
    }
}

/// Where no lamp reaches, the diffuse cones count nothing, whatever they gather; where one does, all of it.
#[test]
fn shadows_dim_what_diffuse_cones_gather() {
    let mut scene = room(&matte(), vxct_light(Vec3::new(0.0, 0.5, 0.0), Vec3::ONE));
    add_square(&mut scene, Vec3::ZERO, UP, 0.5, matte());
    let seen = |target: Vec3| {
        let mut scene = scene.clone();
        scene.cameras = vec![Camera::look_at(Vec3::new(0.0, -0.3, 0.95), target, 0.2)];
        let shown = |view, components| {
            let vxct = VxctSettings { components, shadow_strength: 1.5, ..usual() };
            middle(&render(&scene, RenderSettings { view, ..look(vxct) })).x
        };
        let gathered = shown(View::Diffuse, Components::All);
        let visible = shown(View::Shadow, Components::All);
        (visible, gathered, shown(View::Final, Components::Diffuse))
    };
    let (visible, gathered, diffuse) = seen(Vec3::NEG_Y);
    assert!(visible < 0.01 && gathered > 0.05, "{visible} visible, {gathered} gathered");
    assert!(diffuse < 0.01 * gathered, "{diffuse} of {gathered} in the shadow");
    let (visible, gathered, diffuse) = seen(Vec3::new(1.0, 0.5, 0.0));
    assert!(visible > 0.99, "{visible} visible");
    assert!(
        (diffuse / (0.8 * gathered) - 1.0).abs() < 0.02,
        "{diffuse} of {gathered} in the light"
    );
}

/// A glossy floor in even surroundings, with nothing else to mirror: they fade by the way through the grid, as what is in
/// it does.
#[test]
fn surroundings_fade_in_gloss() {
    let gloss = vxct_material(Vec3::ZERO, 32.0, 0.5);
    let mut scene = floor(-1.0, gloss, vxct_light(Vec3::ZERO, Vec3::ZERO));
    scene.environment.radiance = Vec3::ONE;
    // From the floor's middle up at 45 degrees: out through the side of the cube, sqrt(2) of half its edge away.
    let middle = Vec3::NEG_Y;
    scene.cameras = vec![Camera::look_at(Vec3::new(2.0, 1.0, 0.0), middle, 0.1)];
    let mirrored = |shininess_falloff| {
        let vxct = VxctSettings { shininess_falloff, ..usual() };
        let shown = render(&scene, RenderSettings { view: View::Specular, ..look(vxct) });
        mean_luminance(&shown)
    };
    let whole = mirrored(0.0);
    for falloff in [1.0_f32, 3.0] {
        let share = mirrored(falloff) / whole;
        let expected = f64::from((1.0 + 2.0_f32.sqrt()).powf(-falloff));
        println!("falloff {falloff}: {share:.4}, {expected:.4} at the cube's side");
        // A cone is felt to end up to a wide cell farther.
        assert!(share < 1.05 * expected && share > 0.6 * expected, "falloff {falloff}: {share}");
    }
}
