//! Tests of the share and colour of transmitted light, and of the visible sides of surfaces.

use glam::Vec4;
use lumivox_scene::{AlphaMode, Filter, MetallicRoughness, Shading, Transmission};

use super::*;

/// Pixels along each edge of a cell of the picture, and cells along each edge of the picture.
const CELL: u32 = 6;
const CELLS: u32 = 3;

fn blended(radiance: Vec3, alpha: f32) -> Material {
    let mut material = Material { alpha: AlphaMode::Blend, ..glowing(radiance) };
    if let Shading::MetallicRoughness(shading) = &mut material.shading {
        shading.base_color.w = alpha;
    }
    material
}

/// Thin glass without reflection.
fn glass(color: Vec3, factor: f32) -> Material {
    let shading = MetallicRoughness {
        base_color: color.extend(1.0),
        specular: 0.0,
        ..MetallicRoughness::default()
    };
    Material {
        shading: Shading::MetallicRoughness(shading),
        transmission: Transmission { factor, texture: None },
        double_sided: true,
        ..Material::default()
    }
}

/// A leaf with holes in half of its area.
fn leaf(scene: &mut Scene) -> Material {
    let texels = [255, 0, 0, 255].into_iter().flat_map(|alpha| [255, 255, 255, alpha]);
    let checker = texture(scene, UVec2::splat(2), Filter::Nearest, texels.collect());
    let mut leaf = Material { alpha: AlphaMode::Mask { cutoff: 0.5 }, ..glowing(Vec3::ZERO) };
    if let Shading::MetallicRoughness(shading) = &mut leaf.shading {
        shading.base_color_texture = Some(checker);
    }
    leaf
}

/// The centre of a cell; cells of one metre are centred around the origin, x to the right, y up.
fn middle(cell: u32) -> Vec3 {
    let at = |index: u32| index as f32 - 0.5 * (CELLS - 1) as f32;
    Vec3::new(at(cell % CELLS), -at(cell / CELLS), 0.0)
}

/// The inner pixels of a cell.
fn cell_pixels(cell: u32) -> impl Iterator<Item = usize> {
    let (x, y) = (CELL * (cell % CELLS) + 1, CELL * (cell / CELLS) + 1);
    (y..y + CELL - 2)
        .flat_map(move |y| (x..x + CELL - 2).map(move |x| (y * CELL * CELLS + x) as usize))
}

#[track_caller]
fn assert_cell(what: &str, layers: &[[f32; 3]], variances: &[f32], cell: u32, expected: Vec3) {
    let seen = Estimate::over(cell_pixels(cell), layers, variances);
    seen.assert_is(what, mean(expected.as_dvec3().to_array()));
    // Single channels: none has more than three times the mean variance.
    for channel in 0..3 {
        let alone = |value: &[f32; 3]| [value[channel]; 3];
        let values: Vec<[f32; 3]> = layers.iter().map(alone).collect();
        let one = Estimate::over(cell_pixels(cell), &values, variances);
        let tolerance = 4.0 * 3.0_f64.sqrt() * seen.error + 1e-4;
        let difference = (one.mean - f64::from(expected[channel])).abs();
        assert!(difference <= tolerance, "{what}, channel {channel}: {one:?}, not {expected}");
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn panes_show_the_background_in_proportion_to_transparency() {
    let behind = Vec3::new(1.0, 0.5, 0.25);
    let before = Vec3::new(0.2, 0.9, 0.4);
    let mut scene = stage();
    let leaf = Material { emissive: before, ..leaf(&mut scene) };
    add(&mut scene, quad(Vec3::NEG_Z * 2.0, Vec3::X * 4.0, Vec3::Y * 4.0), glowing(behind));
    let square = |cell: u32, z: f32| quad(middle(cell) + Vec3::Z * z, Vec3::X * 0.5, Vec3::Y * 0.5);
    let back = |cell: u32| quad(middle(cell), Vec3::NEG_X * 0.5, Vec3::Y * 0.5);
    // Two panes with a coverage of a half, one in front of the other.
    add(&mut scene, square(0, 0.0), blended(before, 0.5));
    add(&mut scene, square(0, 0.01), blended(before, 0.5));
    let mut faint = square(1, 0.0);
    faint.colors = vec![Vec4::new(1.0, 1.0, 1.0, 0.5); 4];
    add(&mut scene, faint, blended(before, 0.5));
    let mut holes = square(2, 0.0);
    holes.uvs.iter_mut().for_each(|uv| *uv *= 40.0);
    add(&mut scene, holes, leaf);
    let red = Vec3::new(0.9, 0.3, 0.0);
    add(&mut scene, square(3, 0.0), glass(red, 0.8));
    add(&mut scene, back(4), glowing(before));
    add(&mut scene, back(5), Material { double_sided: true, ..glowing(before) });
    // Mirrored: its front remains the front.
    add(&mut scene, square(6, 0.0), glowing(before));
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let there = Mat4::from_translation(Vec3::X * 2.0 * middle(6).x);
    if let Some(instance) = scene.instances.last_mut() {
        instance.world_from_local = there * mirror;
    }
    // Below the cutoff the surface does not exist.
    let mut gone = blended(before, 0.4);
    gone.alpha = AlphaMode::Mask { cutoff: 0.5 };
    add(&mut scene, square(7, 0.0), gone.clone());
    gone.alpha = AlphaMode::Mask { cutoff: 0.3 };
    add(&mut scene, square(8, 0.0), gone);
    let distance = 400.0_f32;
    let fov = 2.0 * (0.5 * CELLS as f32 / distance).atan();
    scene.cameras = vec![Camera::look_at(Vec3::Z * distance, Vec3::ZERO, fov)];
    let layers = traced(&scene, &settings(CELL * CELLS, 64));
    let mixed = |share: f32| share * before + (1.0 - share) * behind;
    for (cell, (what, expected)) in [
        ("two of a half", mixed(0.75)),
        ("a half of a half", mixed(0.25)),
        ("a leaf", mixed(0.5)),
        ("red glass", 0.8 * red * behind),
        ("a back", behind),
        ("the back of both sides", before),
        ("mirrored", before),
        ("below the cutoff", behind),
        ("above the cutoff", before),
    ]
    .into_iter()
    .enumerate()
    {
        let (values, variances) = (&layers.radiance, &layers.radiance_variance);
        assert_cell(what, values, variances, cell as u32, expected);
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn shadow_depth_follows_the_casters_opacity() {
    let mut scene = stage();
    let leaf = leaf(&mut scene);
    let white = Material::diffuse("wall", Vec3::ONE);
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0), white);
    // A wall, seen and lit along z. The casters of shadows are behind the camera.
    let square = |cell: u32, z: f32| quad(middle(cell) + Vec3::Z * z, Vec3::X * 0.5, Vec3::Y * 0.5);
    let turned =
        |cell: u32, z: f32| quad(middle(cell) + Vec3::Z * z, Vec3::NEG_X * 0.5, Vec3::Y * 0.5);
    let black = Vec3::ZERO;
    let green = Vec3::new(0.2, 0.9, 0.4);
    add(&mut scene, square(0, 9.0), blended(black, 0.25));
    add(&mut scene, square(1, 9.0), blended(black, 0.5));
    add(&mut scene, turned(1, 9.1), blended(black, 0.5));
    let mut holes = square(2, 9.0);
    holes.uvs.iter_mut().for_each(|uv| *uv *= 40.0);
    add(&mut scene, holes, leaf);
    add(&mut scene, square(3, 9.0), glass(green, 0.7));
    add(&mut scene, square(4, 9.0), glass(green, 1.0));
    add(&mut scene, square(4, 9.1), glass(Vec3::new(1.0, 0.5, 0.5), 1.0));
    // Both sides of solid surfaces cast shadows, even if one side is invisible.
    add(&mut scene, square(5, 9.0), glowing(black));
    add(&mut scene, turned(6, 9.0), glowing(black));
    add(&mut scene, square(7, 9.0), glass(green, 1.0));
    add(&mut scene, turned(7, 9.2), glowing(black));
    let distance = 8.0_f32;
    let fov = 2.0 * (0.5 * CELLS as f32 / distance).atan();
    scene.cameras = vec![Camera::look_at(Vec3::Z * distance, Vec3::ZERO, fov)];
    scene.lights = vec![sun(Vec3::NEG_Z, std::f32::consts::PI, 0.0)];
    let layers = traced(&scene, &settings(CELL * CELLS, 64));
    for (cell, (what, expected)) in [
        ("a quarter", Vec3::splat(0.75)),
        ("two of a half", Vec3::splat(0.25)),
        ("a leaf", Vec3::splat(0.5)),
        ("green glass", 0.7 * green),
        ("two panes of glass", green * Vec3::new(1.0, 0.5, 0.5)),
        ("solid", Vec3::ZERO),
        ("a solid back", Vec3::ZERO),
        ("a solid back behind glass", Vec3::ZERO),
        ("nothing", Vec3::ONE),
    ]
    .into_iter()
    .enumerate()
    {
        assert_cell(what, &layers.direct, &layers.direct_variance, cell as u32, expected);
    }
}
