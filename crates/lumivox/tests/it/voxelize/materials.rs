//! Textures, alpha, emission.

use glam::{Vec2, Vec3, Vec4};
use lumivox::{Geometry, Gloss, SurfaceMaterial, SurfaceTexture};

use crate::voxelize::read::{Lab, along, morton_decode};
use crate::voxelize::scenes::{unit_grid, upload};
use crate::voxelize::textures::{columns, texture, textured, wall};

#[test]
fn a_texture_much_finer_than_the_voxels_gives_its_mean() {
    let lab = Lab::new();
    // A checkerboard of single texels, 32 by 32 in a voxel: without mips it would alias.
    let view =
        texture(
            &lab,
            256,
            |x, y| if (x + y) % 2 == 0 { [255, 0, 128, 255] } else { [0, 100, 128, 255] },
        );
    let material = SurfaceMaterial {
        reflectance: Vec4::new(0.8, 0.5, 1.0, 1.0),
        reflectance_texture: Some(textured(&lab, view)),
        ..Default::default()
    };
    let faces = columns(&lab, &wall().geometry(&lab.device, material));
    assert_eq!(faces.len(), 64);
    for (column, face) in faces {
        let expected = Vec3::new(0.8 * 0.5, 0.5 * 50.0 / 255.0, 128.0 / 255.0);
        // Mips are rounded to 8 bits.
        let error = (Vec3::from(face.reflectance) - expected).abs().max_element();
        assert!(error < 0.004, "{column:?}: {:?}", face.reflectance);
    }
}

#[test]
fn a_texture_of_the_voxels_size_is_read_where_it_is() {
    let lab = Lab::new();
    let view = texture(&lab, 8, |x, y| [(x * 30) as u8, (y * 30) as u8, 7, 255]);
    let material = SurfaceMaterial {
        reflectance: Vec4::ONE,
        emission_texture: Some(textured(&lab, view.clone())),
        emission: Vec3::new(20.0, 10.0, 0.0),
        reflectance_texture: Some(textured(&lab, view)),
        ..Default::default()
    };
    let faces = columns(&lab, &wall().geometry(&lab.device, material));
    assert_eq!(faces.len(), 64);
    for ([x, y], face) in faces {
        // The diagonal's voxels have two pieces, off the texel's centre towards the corners; their
        // errors cancel. Border texels wrap around.
        if [x, y].iter().any(|i| [4, 11].contains(i)) {
            continue;
        }
        let texel = Vec3::new((x - 4) as f32 * 30.0, (y - 4) as f32 * 30.0, 7.0) / 255.0;
        let error = (Vec3::from(face.reflectance) - texel).abs().max_element();
        assert!(error < 2e-3, "{x} {y}: {:?}, not {texel}", face.reflectance);
        let error = Vec3::from(face.emission) - texel * Vec3::new(20.0, 10.0, 0.0);
        assert!(error.abs().max_element() < 0.04, "{x} {y}: {:?}", face.emission);
    }
}

#[test]
fn alpha_halves_the_area() {
    let lab = Lab::new();
    let view = texture(&lab, 256, |x, y| [255, 255, 255, if (x + y) % 2 == 0 { 255 } else { 0 }]);
    let material = SurfaceMaterial {
        reflectance: Vec4::ONE,
        reflectance_texture: Some(textured(&lab, view)),
        alpha_is_coverage: true,
        ..Default::default()
    };
    let faces = columns(&lab, &wall().geometry(&lab.device, material.clone()));
    assert_eq!(faces.len(), 64);
    for (column, face) in faces {
        assert!((along(&face) - 128.0 / 255.0).abs() < 1e-3, "{column:?}: {face:?}");
        assert!(face.reflectance[0] > 0.989, "{column:?}: {face:?}");
    }
    // Alpha that is not coverage does not change the area.
    let opaque = SurfaceMaterial { alpha_is_coverage: false, ..material };
    for (column, face) in columns(&lab, &wall().geometry(&lab.device, opaque)) {
        assert!((along(&face) - 1.0).abs() < 1e-5, "{column:?}: {face:?}");
    }
}

#[test]
fn cut_out_texels_occupy_no_voxels() {
    let lab = Lab::new();
    // The left half is cut out; a texel is as large as an eighth of a voxel.
    let view = texture(&lab, 64, |x, _| [255, 255, 255, if x < 32 { 0 } else { 255 }]);
    let material = SurfaceMaterial {
        reflectance_texture: Some(textured(&lab, view)),
        alpha_is_coverage: true,
        ..Default::default()
    };
    let list = lab.voxelize(&unit_grid(16), &wall().geometry(&lab.device, material));
    for [x, y, _] in list.voxels() {
        // Filtering reaches half a texel of the mip, that is half a voxel, over the edge and
        // around.
        assert!(x >= 7 || x == 4, "{x} {y} is occupied");
    }
    for x in 8..12 {
        for y in 4..12 {
            assert!(list.voxels().contains(&[x, y, 6]), "{x} {y} is missing");
        }
    }
}

#[test]
fn materials_with_and_without_textures_mix() {
    let lab = Lab::new();
    let view = texture(&lab, 4, |_, _| [51, 102, 204, 255]);
    let textured = SurfaceMaterial {
        reflectance: Vec4::ONE,
        reflectance_texture: Some(textured(&lab, view)),
        ..Default::default()
    };
    let red = SurfaceMaterial {
        reflectance: Vec4::new(0.9, 0.1, 0.1, 1.0),
        emission: Vec3::new(3.0, 2.0, 1.0),
        gloss: Gloss { mean: 0.05, grazing: 0.2, kept_out: 0.04 },
        ..Default::default()
    };
    let green = SurfaceMaterial {
        reflectance: Vec4::new(0.1, 2.0, 0.1, 1.0),
        gloss: Gloss { mean: 1.0, grazing: -0.25, kept_out: 0.5 },
        emission: Vec3::new(0.0, 300.0, 0.0),
        ..Default::default()
    };
    let mut geometry = Geometry::new(Vec::new(), vec![textured, red, green]);
    // One batch whose draws alternate between materials; each wall in its own layer.
    let mut batch = wall().batch(&lab.device, 0);
    let whole = batch.draws[0];
    batch.draws = (0..6)
        .map(|i| lumivox::Draw {
            material: i % 3,
            world_from_local: glam::Mat4::from_translation(Vec3::new(0.0, 0.0, i as f32)),
            ..whole
        })
        .collect();
    geometry.batches.push(batch);
    let list = lab.voxelize(&unit_grid(16), &geometry);
    let expected = [
        (Vec3::new(0.2, 0.4, 0.8), Vec3::ZERO, Vec3::ZERO),
        (Vec3::new(0.9, 0.1, 0.1), Vec3::new(3.0, 2.0, 1.0), Vec3::new(0.05, 0.2, 0.04)),
        (Vec3::new(0.1, 0.99, 0.1), Vec3::new(0.0, 300.0, 0.0), Vec3::new(1.0, -0.25, 0.5)),
    ];
    let mut seen = 0;
    for face in list.faces.iter().filter(|face| along(face) > 1e-4) {
        let z = morton_decode(face.cell).to_array()[2];
        let (reflectance, emission, gloss) = expected[(z as usize - 6) % 3];
        let error = (Vec3::from(face.gloss) - gloss).abs().max_element();
        assert!(error < 1e-5, "{z}: {face:?}");
        let error = (Vec3::from(face.reflectance) - reflectance).abs().max_element();
        assert!(error < 1e-5, "{z}: {face:?}");
        // Relative to the largest emission, 300; sums resolve about 2^-24 of it.
        let error = (Vec3::from(face.emission) - emission).abs().max_element();
        assert!(error < 1e-3, "{z}: {face:?}");
        seen += 1;
    }
    assert_eq!(seen, 6 * 64);
}

/// Positions of the square's corners, two sets of coordinates and a colour, in a layout as of an
/// engine: the colour, data of the engine's own, the second set, the first set.
fn interleaved(lab: &Lab, second: [Vec2; 4], colors: [[u16; 4]; 4]) -> lumivox::VertexAttributes {
    let first = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let words: Vec<u32> = (0..4)
        .flat_map(|i| {
            let [r, g, b, a] = colors[i].map(u32::from);
            let floats = [second[i].x, second[i].y, first[i].x, first[i].y].map(f32::to_bits);
            [&[r | g << 16, b | a << 16, 0xdead_beef][..], &floats].concat()
        })
        .collect();
    let buffer = upload(&lab.device, "attributes", &words);
    let mut attributes = lumivox::VertexAttributes::new(buffer, 28);
    attributes.texcoords = [Some(20), Some(12)];
    attributes.color = Some(0);
    attributes
}

const WHITE: [u16; 4] = [u16::MAX; 4];

#[test]
fn every_texture_has_coordinates_and_a_transform_of_its_own() {
    let lab = Lab::new();
    let view = texture(&lab, 8, |x, y| [(x * 30) as u8, (y * 30) as u8, 7, 255]);
    // The first set turned by a quarter: (u, v) becomes (v, 1 - u). The second set is mirrored
    // along u, and the transform mirrors it back.
    let turned = glam::Affine2::from_cols(Vec2::new(0.0, -1.0), Vec2::X, Vec2::Y);
    let mirrored = glam::Affine2::from_cols(Vec2::NEG_X, Vec2::Y, Vec2::X);
    let material = SurfaceMaterial {
        reflectance: Vec4::ONE,
        reflectance_texture: Some(SurfaceTexture {
            transform: turned,
            ..textured(&lab, view.clone())
        }),
        emission: Vec3::splat(20.0),
        emission_texture: Some(SurfaceTexture {
            texcoord_set: 1,
            transform: mirrored,
            ..textured(&lab, view)
        }),
        ..Default::default()
    };
    let mut geometry = wall().geometry(&lab.device, material);
    let second = [Vec2::X, Vec2::ZERO, Vec2::Y, Vec2::ONE];
    geometry.batches[0].attributes = Some(interleaved(&lab, second, [WHITE; 4]));
    let faces = columns(&lab, &geometry);
    assert_eq!(faces.len(), 64);
    let texel = |x: u32, y: u32| Vec3::new(x as f32 * 30.0, y as f32 * 30.0, 7.0) / 255.0;
    for ([x, y], face) in faces {
        // At wrapped coordinates, two ends of the image mix.
        if [x, y].iter().any(|i| [4, 11].contains(i)) {
            continue;
        }
        let (column, row) = (x - 4, y - 4);
        let error = Vec3::from(face.reflectance) - texel(row, 7 - column);
        assert!(error.abs().max_element() < 2e-3, "{x} {y}: {:?}", face.reflectance);
        let error = Vec3::from(face.emission) - 20.0 * texel(column, row);
        assert!(error.abs().max_element() < 0.04, "{x} {y}: {:?}", face.emission);
    }
}

#[test]
fn colours_of_vertices_multiply_reflectance_and_alpha() {
    let lab = Lab::new();
    let material = SurfaceMaterial {
        reflectance: Vec4::new(0.8, 0.5, 1.0, 1.0),
        emission: Vec3::splat(3.0),
        alpha_is_coverage: true,
        ..Default::default()
    };
    let mut geometry = wall().geometry(&lab.device, material);
    // Red grows along x; alpha falls along y from 1 to 0.
    let (none, full) = (0, u16::MAX);
    let colors =
        [[none, full, full, full], WHITE, [full, full, full, none], [none, full, full, none]];
    let shares = colors.map(|color| color.map(|channel| f32::from(channel) / f32::from(u16::MAX)));
    let alone = |format, words: &[u32]| {
        let buffer = upload(&lab.device, "colours", words);
        let mut attributes = lumivox::VertexAttributes::new(buffer, words.len() as u32);
        (attributes.color, attributes.color_format) = (Some(0), format);
        attributes
    };
    let floats: Vec<u32> = shares.iter().flatten().map(|share| share.to_bits()).collect();
    let bytes = shares.map(|color| u32::from_le_bytes(color.map(|share| (255.0 * share) as u8)));
    let stored = [
        interleaved(&lab, [Vec2::ZERO; 4], colors),
        alone(wgpu::VertexFormat::Float32x4, &floats),
        alone(wgpu::VertexFormat::Unorm8x4, &bytes),
    ];
    for attributes in stored {
        geometry.batches[0].attributes = Some(attributes);
        for ([x, y], face) in columns(&lab, &geometry) {
            let (u, v) = ((x as f32 - 3.5) / 8.0, (y as f32 - 3.5) / 8.0);
            // Two pieces share the diagonal's voxels, and the one with more coverage weighs more.
            let error = (Vec3::from(face.reflectance) - Vec3::new(0.8 * u, 0.5, 0.99)).abs();
            assert!(error.max_element() < 0.01, "{x} {y}: {:?}", face.reflectance);
            assert!((along(&face) - (1.0 - v)).abs() < 2e-3, "{x} {y}: {face:?}");
            assert!((face.emission[0] - 3.0).abs() < 1e-4, "{x} {y}: {:?}", face.emission);
        }
    }
}

#[test]
fn transmission_reduces_blocking_and_the_rest_reflects() {
    let lab = Lab::new();
    // The left half transmits 0.8 of the light that it does not absorb, the right half nothing.
    let view = texture(&lab, 64, |x, _| [if x < 32 { 255 } else { 0 }, 0, 0, 255]);
    let color = Vec3::new(0.2, 0.9, 0.4);
    let material = SurfaceMaterial {
        reflectance: color.extend(0.5),
        transmission: 0.8,
        transmission_texture: Some(textured(&lab, view)),
        ..Default::default()
    };
    let passed = 0.8 * color.dot(Vec3::new(0.2126, 0.7152, 0.0722));
    for ([x, y], face) in columns(&lab, &wall().geometry(&lab.device, material)) {
        // Alpha that is not coverage does not change the area; the middle and the edges mix both
        // halves.
        let (blocked, reflectance) = match x {
            5 | 6 => (1.0 - passed, 0.2 * color / (1.0 - passed)),
            9 | 10 => (1.0, color),
            _ => continue,
        };
        assert!((along(&face) - blocked).abs() < 1e-3, "{x} {y}: {face:?}, not {blocked}");
        let error = (Vec3::from(face.reflectance) - reflectance).abs().max_element();
        assert!(error < 2e-3, "{x} {y}: {:?}, not {reflectance}", face.reflectance);
    }
}

#[test]
fn attributes_that_do_not_fit_are_refused() {
    let lab = Lab::new();
    let good = || wall().geometry(&lab.device, SurfaceMaterial::default());
    let error_of = |change: &dyn Fn(&mut lumivox::VertexAttributes)| {
        let mut geometry = good();
        change(geometry.batches[0].attributes.as_mut().expect("coordinates"));
        super::promises::error_of(&lab, &unit_grid(16), &geometry).to_string()
    };
    assert!(error_of(&|a| a.stride = 10).contains("multiple of 4"));
    assert!(error_of(&|a| a.texcoords[1] = Some(4)).contains("byte 4"));
    assert!(error_of(&|a| a.color = Some(u32::MAX - 3)).contains("stride of 8"));
    let format = wgpu::VertexFormat::Float32x4;
    assert!(error_of(&|a| (a.color, a.color_format) = (Some(0), format)).contains("stride of 8"));
    let format = wgpu::VertexFormat::Float32x3;
    assert!(error_of(&|a| a.color_format = format).contains("Float32x3"));
}
