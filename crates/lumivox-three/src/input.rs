//! Input from JavaScript, as rows of numbers.
//!
//! Rows are plain arrays, so that a frame with a thousand objects is passed in one call.
//! `draws.js`, `materials.js`, `lights.js` and `gi.js` in `js/` write them; the tests here check
//! the order of the numbers.

use glam::{Affine2, Mat4, Vec2, Vec3, Vec4};
use lumivox::{CameraView, Draw, Gloss, Light, LightSource, Shadow, SurfaceMaterial};

use crate::error::PageError;

/// Numbers of a material.
pub const MATERIAL: usize = 14;
/// Numbers of a light.
pub const LIGHT: usize = 14;
/// Integers of a draw; its matrix has 16 further numbers.
pub const DRAW: usize = 5;
/// Numbers of a camera.
pub const CAMERA: usize = 22;

/// A material: reflectance RGBA; the gloss's reflectance at normal incidence, its roughness, and
/// the share of glossy surface; emission RGB; transmission; then flags, 0 or 1: alpha is coverage,
/// double-sided, reserved.
///
/// # Errors
/// When there are not [`MATERIAL`] numbers, or one is not finite.
pub fn material(row: &[f32]) -> Result<SurfaceMaterial, PageError> {
    let row = row_of::<MATERIAL>(row, "material")?;
    Ok(SurfaceMaterial {
        reflectance: Vec4::from_slice(&row[..4]),
        gloss: Gloss::new(row[4], row[5]).of_share(row[6]),
        emission: Vec3::from_slice(&row[7..10]),
        transmission: row[10],
        alpha_is_coverage: row[11] != 0.0,
        double_sided: row[12] != 0.0,
        ..SurfaceMaterial::default()
    })
}

/// The transform of texture coordinates: three.js's matrix of three rows, column by column.
pub fn texture_transform(row: &[f32]) -> Affine2 {
    match row {
        [a, b, _, c, d, _, x, y, ..] => {
            Affine2::from_cols(Vec2::new(*a, *b), Vec2::new(*c, *d), Vec2::new(*x, *y))
        }
        _ => Affine2::IDENTITY,
    }
}

/// Draws with the numbers of their geometries. A row is geometry, first index, number of indices,
/// material, and 1 if static; each row has a matrix, column by column.
///
/// # Errors
/// When a row or a matrix is incomplete, or there are not as many rows as matrices.
pub fn draws(rows: &[u32], matrices: &[f32]) -> Result<Vec<(u32, Draw)>, PageError> {
    let (rows, rest) = rows.as_chunks::<DRAW>();
    let (matrices, beyond) = matrices.as_chunks::<16>();
    if !rest.is_empty() || !beyond.is_empty() || rows.len() != matrices.len() {
        return Err(PageError::value(format!(
            "there are {} draws and {} matrices; give one for each",
            rows.len(),
            matrices.len()
        )));
    }
    let draw = |([geometry, first, count, material, stays], matrix): (&[u32; DRAW], &[f32; 16])| {
        let world_from_local = Mat4::from_cols_array(matrix);
        let is_static = *stays != 0;
        // An object whose matrix is not finite has no surface.
        let count = if world_from_local.is_finite() { *count } else { 0 };
        let draw = Draw { world_from_local, is_static, ..Draw::new(*first, count, *material) };
        (*geometry, draw)
    };
    Ok(rows.iter().zip(matrices).map(draw).collect())
}

/// Lights: kind (0 directional, 1 point, 2 spot), position, direction, intensity, radius (m; rad
/// for a directional light), range (m; 0: unlimited), inner and outer angle of a spot (rad).
///
/// # Errors
/// When a row is incomplete, or a number is not finite.
pub fn lights(rows: &[f32]) -> Result<Vec<Light>, PageError> {
    let (rows, rest) = rows.as_chunks::<LIGHT>();
    if !rest.is_empty() {
        return Err(PageError::value("the lights are not whole rows of numbers"));
    }
    rows.iter().map(light).collect()
}

fn light(row: &[f32; LIGHT]) -> Result<Light, PageError> {
    let row = row_of::<LIGHT>(row, "light")?;
    let position = Vec3::from_slice(&row[1..4]);
    let direction = Vec3::from_slice(&row[4..7]).normalize_or(Vec3::NEG_Y);
    let intensity = Vec3::from_slice(&row[7..10]);
    let radius_m = row[10];
    let range_m = Some(row[11]).filter(|range| *range > 0.0);
    let source = match row[0] as u32 {
        0 => LightSource::Directional {
            direction,
            irradiance: intensity,
            angular_radius_rad: radius_m,
        },
        1 => LightSource::Point { position, intensity, radius_m, range_m },
        _ => LightSource::Spot {
            position,
            direction,
            intensity,
            inner_angle_rad: row[12],
            outer_angle_rad: row[13],
            radius_m,
            range_m,
        },
    };
    Ok(Light { source, shadow: Shadow::Cone })
}

/// A camera: the matrix to clip space without jitter, position, jitter in pixels, and 1 if z is
/// reversed, 0 if z is 0 at the near plane.
///
/// # Errors
/// When there are not [`CAMERA`] numbers, or one is not finite.
pub fn camera(row: &[f32]) -> Result<CameraView, PageError> {
    let row = row_of::<CAMERA>(row, "camera")?;
    // 1 - z, in clip space.
    let reverse = if row[21] == 0.0 {
        Mat4::from_cols(Vec4::X, Vec4::Y, -Vec4::Z, Vec4::new(0.0, 0.0, 1.0, 1.0))
    } else {
        Mat4::IDENTITY
    };
    let clip_from_world = reverse * Mat4::from_cols_slice(&row[..16]);
    let mut camera = CameraView::new(clip_from_world, Vec3::from_slice(&row[16..19]));
    camera.jitter = Vec2::from_slice(&row[19..21]);
    Ok(camera)
}

/// A row of exactly `N` finite numbers.
fn row_of<'a, const N: usize>(row: &'a [f32], what: &str) -> Result<&'a [f32; N], PageError> {
    let row: &[f32; N] = row.try_into().map_err(|_| {
        PageError::value(format!("a {what} is {N} numbers, but there are {}", row.len()))
    })?;
    match row.iter().position(|number| !number.is_finite()) {
        Some(at) => Err(PageError::value(format!("number {at} of a {what} is {}", row[at]))),
        None => Ok(row),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_rows_are_read_in_field_order() {
        let mut row = [0.0; 2 * LIGHT];
        row[..LIGHT].copy_from_slice(&[
            2.0, 1.0, 2.0, 3.0, 0.0, -2.0, 0.0, 4.0, 5.0, 6.0, 0.1, 9.0, 0.2, 0.4,
        ]);
        let lights = lights(&row).unwrap();
        let LightSource::Spot { position, direction, intensity, range_m, outer_angle_rad, .. } =
            lights[0].source
        else {
            panic!("{lights:?}")
        };
        assert_eq!((position, direction), (Vec3::new(1.0, 2.0, 3.0), Vec3::NEG_Y));
        assert_eq!((intensity, range_m), (Vec3::new(4.0, 5.0, 6.0), Some(9.0)));
        assert!((outer_angle_rad - 0.4).abs() < 1e-6);
        assert!(matches!(lights[1].source, LightSource::Directional { .. }));
    }

    #[test]
    fn a_camera_of_three_gets_reversed_depth() {
        // Near 1, far 10, as in three.js for WebGPU: z / w is 0 at the near plane and 1 at the far
        // plane.
        let clip = glam::camera::rh::proj::directx::perspective(1.0, 1.0, 1.0, 10.0);
        let mut row = [0.0; CAMERA];
        row[..16].copy_from_slice(&clip.to_cols_array());
        let camera = camera(&row).unwrap();
        let depth = |z: f32| camera.clip_from_world.project_point3(Vec3::new(0.0, 0.0, z)).z;
        assert!((depth(-1.0) - 1.0).abs() < 1e-6 && depth(-10.0).abs() < 1e-6);
    }

    #[test]
    fn draws_with_nan_matrices_have_no_indices() {
        let rows = [7, 3, 6, 1, 1, 7, 9, 6, 1, 0];
        let mut matrices = [Mat4::IDENTITY.to_cols_array(); 2].concat();
        matrices[20] = f32::NAN;
        let draws = draws(&rows, &matrices).unwrap();
        assert_eq!((draws[0].0, draws[0].1.index_count, draws[0].1.is_static), (7, 6, true));
        assert_eq!((draws[1].1.index_count, draws[1].1.is_static), (0, false));
        assert!(super::draws(&rows, &matrices[..16]).is_err());
    }

    #[test]
    fn non_finite_material_numbers_are_refused() {
        let mut row = [0.5; MATERIAL];
        assert!(material(&row).is_ok());
        row[8] = f32::INFINITY;
        let error = material(&row).unwrap_err();
        assert!(error.message.contains("number 8 of a material is inf"), "{error}");
        assert!(material(&row[..3]).unwrap_err().message.contains("14 numbers"));
    }

    #[test]
    fn texture_transforms_follow_three_js() {
        // Shifted by (0.25, 0.5) and scaled by (2, 3).
        let place = texture_transform(&[2.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.25, 0.5, 1.0]);
        assert_eq!(place.transform_point2(Vec2::ONE), Vec2::new(2.25, 3.5));
    }
}
