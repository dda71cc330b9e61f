//! A tube that three bones bend and a morph target bulges.

use std::f32::consts::{FRAC_1_SQRT_2, TAU};

use glam::{Vec2, Vec3};
use serde_json::json;

use super::File;

/// Rings along the tube's axis, and corners of each ring.
pub const RINGS: usize = 31;
pub const CORNERS: usize = 24;
/// The tube starts at the origin and has this height and radius, in metres.
pub const HEIGHT_M: f32 = 3.0;
pub const RADIUS_M: f32 = 0.4;

/// The file, and its nodes that tests change.
pub struct Tube {
    pub file: File,
    /// The node with mesh and skin.
    pub body: usize,
    pub joints: [usize; 3],
}

/// The tube along +y. Bones are at heights 0, 1 and 2 m. The animation "bend" takes two seconds:
/// the two upper bones rotate by 45 degrees each about z, towards -x, and the middle swells to
/// twice its radius.
pub fn tube() -> Tube {
    let mut file = File::new();
    let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let (mut joints, mut weights): (Vec<u8>, Vec<[f32; 4]>) = (Vec::new(), Vec::new());
    let (mut bulge, mut indices) = (Vec::new(), Vec::new());
    for ring in 0..RINGS {
        let share = ring as f32 / (RINGS - 1) as f32;
        // Each bone moves one metre of the tube, with a blend around the borders.
        let height = share * HEIGHT_M;
        let blend = |border: f32| ((height - border) / 0.8 + 0.5).clamp(0.0, 1.0);
        let (second, third) = (blend(1.0), blend(2.0));
        let swell = (1.0 - ((height - 1.5) / 0.6).powi(2)).max(0.0);
        for corner in 0..=CORNERS {
            let u = corner as f32 / CORNERS as f32;
            let (sin, cos) = (u * TAU).sin_cos();
            positions.push([RADIUS_M * sin, height, RADIUS_M * cos]);
            normals.push([sin, 0.0, cos]);
            uvs.push(Vec2::new(u, 1.0 - share).to_array());
            bulge.push([RADIUS_M * swell * sin, 0.0, RADIUS_M * swell * cos]);
            joints.extend([0, 1, 2, 0]);
            weights.push([1.0 - second, second - third, third, 0.0]);
            if ring > 0 && corner > 0 {
                let here = (ring * (CORNERS + 1) + corner) as u16;
                let below = here - (CORNERS + 1) as u16;
                indices.extend([below - 1, below, here, below - 1, here, here - 1]);
            }
        }
    }
    let view = file.view(&joints);
    let joints = file.accessor(view, 5121, positions.len(), "VEC4");
    let attributes = json!({
        "POSITION": file.vectors(&positions),
        "NORMAL": file.vectors(&normals),
        "TEXCOORD_0": file.vectors(&uvs),
        "JOINTS_0": joints,
        "WEIGHTS_0": file.vectors(&weights),
    });
    let (indices, bulge) = (file.indices(&indices), file.vectors(&bulge));
    let mesh = file.mesh(json!({
        "attributes": attributes, "indices": indices, "targets": [{ "POSITION": bulge }],
    }));

    let joints = [0, 1, 2_u8].map(|i| {
        file.node(json!({ "name": format!("bone {i}"), "translation": [0, i.min(1), 0] }), i == 0)
    });
    file.json["nodes"][joints[0]]["children"] = json!([joints[1]]);
    file.json["nodes"][joints[1]]["children"] = json!([joints[2]]);
    let binds =
        [0.0, -1.0, -2.0].map(|y| glam::Mat4::from_translation(Vec3::Y * y).to_cols_array());
    let bytes: Vec<u8> = binds.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let binds = file.accessor(view, 5126, 3, "MAT4");
    let skin = file.push("skins", json!({ "joints": joints, "inverseBindMatrices": binds }));
    let body = file.node(json!({ "name": "tube", "mesh": mesh, "skin": skin }), true);

    let (sin, cos) = (std::f32::consts::FRAC_PI_8).sin_cos();
    assert!((sin * cos - FRAC_1_SQRT_2 / 2.0).abs() < 1e-6);
    let turn = file.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, sin, cos]]);
    let swell = file.floats(&[0.0, 1.0]);
    file.animation(
        "bend",
        &[0.0, 2.0],
        &[
            (joints[1], "rotation", "LINEAR", turn),
            (joints[2], "rotation", "LINEAR", turn),
            (body, "weights", "LINEAR", swell),
        ],
    );
    Tube { file, body, joints }
}
