//! Tests of texture coordinates, transforms and vertex colours in pictures and shadows.

use glam::{Affine2, Mat4, UVec2, Vec2, Vec3, Vec4};
use lumivox_render::{RenderSettings, View};
use lumivox_scene::{
    AlphaMode, Clearcoat, Light, LightKind, Material, MetallicRoughness, Scene, TextureRef,
};

use crate::surfaces::stage::*;

/// The albedo of the picture's quarters: upper left, upper right, lower left, lower right.
fn quarters(scene: &Scene, view: View) -> [Vec3; 4] {
    let picture = render(scene, RenderSettings { frames: 1, ..settings(view) });
    [(2, 2), (20, 2), (2, 20), (20, 20)]
        .map(|(x, y)| mean_of(&picture, UVec2::new(x, y), UVec2::new(x + 10, y + 10)))
}

/// A quad that exactly fills the picture, in the plane z = 0, with texture coordinates from 0 to 1.
fn screen() -> lumivox_scene::Mesh {
    let half = 4.0 * 0.15_f32.tan();
    quad(Vec3::ZERO, Vec3::X * half, Vec3::Y * half)
}

const COLORS: [[u8; 4]; 4] =
    [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
const RED: Vec3 = Vec3::X;
const GREEN: Vec3 = Vec3::Y;
const BLUE: Vec3 = Vec3::Z;
const WHITE: Vec3 = Vec3::ONE;

fn textured(reference: TextureRef) -> Scene {
    let mut scene = scene();
    scene.textures.push(texture(2, 2, |x, y| COLORS[(2 * y + x) as usize]));
    let material = with(Material::diffuse("screen", Vec3::ONE), |shading| {
        shading.base_color_texture = Some(reference);
    });
    add(&mut scene, screen(), material);
    scene
}

fn assert_quarters(what: &str, actual: [Vec3; 4], expected: [Vec3; 4]) {
    for (actual, expected) in actual.into_iter().zip(expected) {
        assert_near(what, actual, expected, 0.005);
    }
}

#[test]
fn textures_use_their_transform_and_uv_set() {
    let plain = textured(TextureRef::new(0));
    assert_quarters("plain", quarters(&plain, View::Albedo), [RED, GREEN, BLUE, WHITE]);
    // First a quarter turn: (u, v) becomes (v, 1 - u); then the right half of the texture.
    let transform = Affine2::from_cols(Vec2::new(0.0, -1.0), Vec2::X, Vec2::Y);
    let turned = textured(TextureRef { transform, ..TextureRef::new(0) });
    assert_quarters("turned", quarters(&turned, View::Albedo), [BLUE, RED, WHITE, GREEN]);
    let transform = Affine2::from_scale_angle_translation(Vec2::new(0.5, 1.0), 0.0, Vec2::X * 0.5);
    let halved = textured(TextureRef { transform, ..TextureRef::new(0) });
    assert_quarters("halved", quarters(&halved, View::Albedo), [GREEN, GREEN, WHITE, WHITE]);
    // The second set is mirrored; without one, the first is used.
    let second = TextureRef { uv_set: 1, ..TextureRef::new(0) };
    let mut mirrored = textured(second);
    assert_quarters("one set", quarters(&mirrored, View::Albedo), [RED, GREEN, BLUE, WHITE]);
    let mesh = &mut mirrored.meshes[0];
    mesh.uvs1 = mesh.uvs.iter().map(|uv| Vec2::new(1.0 - uv.x, uv.y)).collect();
    assert_quarters("two sets", quarters(&mirrored, View::Albedo), [GREEN, RED, WHITE, BLUE]);
    // Also under layers.
    mirrored.materials[0].clearcoat = Clearcoat { strength: 1.0, ..Clearcoat::default() };
    assert_quarters("varnished", quarters(&mirrored, View::Albedo), [GREEN, RED, WHITE, BLUE]);
}

#[test]
fn vertex_colours_multiply_the_base_colour_and_nothing_else() {
    let mut scene = textured(TextureRef::new(0));
    // Vertices are in the order lower left, lower right, upper right, upper left.
    let tint = Vec4::new(0.5, 0.25, 1.0, 1.0);
    scene.meshes[0].colors = vec![tint; 4];
    let tint = tint.truncate();
    let expected = [RED, GREEN, BLUE, WHITE].map(|color| color * tint);
    assert_quarters("tinted", quarters(&scene, View::Albedo), expected);
    scene.materials[0].emissive = Vec3::ONE;
    assert_quarters("emission", quarters(&scene, View::Direct), [WHITE; 4]);
    // Colours are interpolated linearly: the centres of the quarters are at a quarter and three
    // quarters.
    let mut ramp = textured(TextureRef::new(0));
    ramp.textures[0] = texture(1, 1, |_, _| [255; 4]);
    ramp.meshes[0].colors = [0.0, 1.0, 1.0, 0.0].map(|x| Vec3::splat(x).extend(1.0)).to_vec();
    let expected = [7.0, 25.0, 7.0, 25.0].map(|pixel| Vec3::splat(pixel / 32.0));
    assert_quarters("ramp", quarters(&ramp, View::Albedo), expected);
}

/// If a wall at 45 degrees becomes three times as high, it is steeper, and its normal turns with
/// it.
#[test]
fn normals_are_correct_under_nonuniform_scale() {
    let mut scene = scene();
    let wall = quad(Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, -1.0));
    add(&mut scene, wall, Material::diffuse("wall", Vec3::ONE));
    scene.instances[0].world_from_local = Mat4::from_scale(Vec3::new(1.0, 3.0, 1.0));
    let shown = mean(&render(&scene, RenderSettings { frames: 1, ..settings(View::Normal) }));
    assert_near("normal", shown, Vec3::new(0.0, 1.0, 3.0).normalize(), 0.002);
}

/// Red bends a normal along the tangent, green along normal x tangent times the tangent's sign:
/// glTF 2.0, sections 3.7.2.1 and 3.9.3.
#[test]
#[ignore = "slow: over three seconds"]
fn normal_textures_bend_along_tangent_and_bitangent() {
    // (0.6, 0, 0.8) and (0, 0.6, 0.8), in bytes.
    for (texel, along_tangent) in [([204, 128, 230, 255], true), ([128, 204, 230, 255], false)] {
        let mut scene = scene();
        scene.textures.push(texture(1, 1, |_, _| texel));
        let mut material = Material::diffuse("bent", Vec3::ONE);
        material.normal_texture = Some(TextureRef::new(0));
        add(&mut scene, screen(), material);
        for (tangent, sign) in [(Vec3::X, 1.0), (Vec3::X, -1.0), (Vec3::NEG_Y, 1.0)] {
            scene.meshes[0].tangents = vec![tangent.extend(sign); 4];
            let aside = if along_tangent { tangent } else { Vec3::Z.cross(tangent) * sign };
            let shown =
                mean(&render(&scene, RenderSettings { frames: 1, ..settings(View::Normal) }));
            // A byte is 0.8 % of the range from -1 to 1.
            assert_near("bent normal", shown, 0.6 * aside + 0.8 * Vec3::Z, 0.01);
        }
    }
}

/// Masks use the coordinates of their texture, in the picture and in the shadow.
#[test]
#[ignore = "slow: over three seconds"]
fn masks_use_their_own_texture_coordinates() {
    let mut scene = scene();
    scene.textures.push(texture(2, 1, |x, _| [255, 255, 255, if x == 0 { 255 } else { 0 }]));
    let reference = TextureRef { uv_set: 1, ..TextureRef::new(0) };
    let shading = MetallicRoughness { base_color_texture: Some(reference), ..Default::default() };
    let mask = Material {
        alpha: AlphaMode::Mask { cutoff: 0.5 },
        ..metallic_roughness(MetallicRoughness { specular: 0.0, ..shading })
    };
    let mut mesh = screen();
    mesh.uvs1 = mesh.uvs.iter().map(|uv| Vec2::new(0.0, uv.x)).collect();
    // With the first set, the mask is opaque everywhere; with the second, turned by the transform,
    // it ends in the middle.
    mesh.uvs = vec![Vec2::splat(0.25); 4];
    add(&mut scene, mesh, mask);
    let transform = Affine2::from_cols(Vec2::Y, Vec2::X, Vec2::ZERO);
    scene.materials[0] = with(scene.materials[0].clone(), |shading| {
        shading.base_color_texture = Some(TextureRef { transform, ..reference });
    });
    add(
        &mut scene,
        quad(Vec3::NEG_Z, Vec3::X * 2.0, Vec3::Y * 2.0),
        Material::diffuse("wall", Vec3::ZERO),
    );
    let shown = quarters(&scene, View::Albedo);
    assert_quarters("mask", shown, [WHITE, Vec3::ZERO, WHITE, Vec3::ZERO]);
    // In light from the side, the shadow of the left half is on the right half of the wall; only
    // holes of the mask let light through.
    scene.lights.push(Light {
        kind: LightKind::Directional,
        intensity: 1.0,
        direction: Vec3::new(0.7, 0.0, -1.0).normalize(),
        ..Light::default()
    });
    let [_, right, ..] = quarters(&scene, View::Shadow);
    assert_near("shadow of the left half", right, Vec3::ZERO, 0.1);
    scene.meshes[0].uvs1 =
        scene.meshes[0].uvs1.iter().map(|uv| Vec2::new(0.0, uv.y + 0.5)).collect();
    let [_, right, ..] = quarters(&scene, View::Albedo);
    assert_near("the other half", right, WHITE, 0.005);
}
