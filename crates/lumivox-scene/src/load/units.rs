//! Files that are not in metres with y up, such as most CAD files.

use std::path::Path;

use glam::{Mat3, Mat4, Vec3};

use super::LoadOptions;
use crate::{Scene, SceneError};

/// The axis of a file that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// As in glTF and in this crate's scenes.
    #[default]
    Y,
    /// As in CAD and scans: the file's y then points away from the viewer, to -z.
    Z,
}

impl UpAxis {
    /// The rotation that turns the axis to +y. Exact.
    fn rotation(self) -> Mat3 {
        match self {
            Self::Y => Mat3::IDENTITY,
            Self::Z => Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y),
        }
    }
}

/// Checks that the options' unit is a length.
pub(super) fn check(file: &Path, options: &LoadOptions<'_>) -> Result<(), SceneError> {
    let unit_m = options.unit_m;
    if unit_m.is_finite() && unit_m > 0.0 {
        return Ok(());
    }
    Err(SceneError::OutOfRange {
        file: file.to_owned(),
        part: "the length of a unit in metres".to_owned(),
        value: unit_m.to_string(),
        expected: "finite and above 0, such as 0.001 for millimetres".to_owned(),
    })
}

/// Rotates and scales a loaded scene according to the options: positions and lengths, not
/// intensities.
pub(super) fn apply(
    scene: &mut Scene,
    file: &Path,
    options: &LoadOptions<'_>,
) -> Result<(), SceneError> {
    let (up, unit_m) = (options.up, options.unit_m);
    let rotation = Mat4::from_mat3(up.rotation());
    let scale = Mat4::from_scale(Vec3::splat(unit_m));
    if scale * rotation == Mat4::IDENTITY {
        return Ok(());
    }
    scene.transform(rotation);
    // The decimal number that was meant: the rounding error of f32 is centimetres in map
    // coordinates.
    let exact_m: f64 = unit_m.to_string().parse().unwrap_or(f64::from(unit_m));
    scene.origin = exact_m * (up.rotation().as_dmat3() * scene.origin);
    // Animations get the unit, too.
    if let Some(rig) = &mut scene.rig {
        rig.transform(scale);
    }
    for instance in &mut scene.instances {
        instance.world_from_local = scale * instance.world_from_local;
    }
    for light in &mut scene.lights {
        light.position *= unit_m;
        light.radius_m *= unit_m;
        if let Some(attenuation) = &mut light.attenuation {
            let at_a_metre = attenuation.at(1.0);
            attenuation.linear /= unit_m;
            attenuation.quadratic /= unit_m * unit_m;
            // The intensity is defined by the light that arrives at a distance of a metre.
            if !light.kind.is_parallel() {
                light.intensity *= attenuation.at(1.0) / at_a_metre;
            }
        }
        light.range_m = light.range_m.map(|range_m| range_m * unit_m);
    }
    if let Some(bounds) = &mut scene.grid_bounds {
        bounds.min *= unit_m;
        bounds.max *= unit_m;
    }
    for camera in &mut scene.cameras {
        camera.position *= unit_m;
        camera.near_m *= unit_m;
    }
    // Extreme units may overflow numbers, or flatten small things.
    crate::validate::validate(scene, file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attenuation, Bounds};

    #[test]
    fn z_becomes_y_and_handedness_stays() {
        let rotation = UpAxis::Z.rotation();
        assert_eq!(rotation * Vec3::Z, Vec3::Y);
        assert_eq!(rotation * Vec3::Y, Vec3::NEG_Z);
        assert_eq!(rotation * Vec3::X, Vec3::X);
        assert_eq!(rotation.determinant(), 1.0);
    }

    #[test]
    fn unit_and_axis_conversion_covers_lights_and_bounds() {
        let mut scene = crate::builtin::scene("cornell").unwrap();
        scene.lights.push(crate::Light {
            name: "lamp".to_owned(),
            intensity: 5.0,
            range_m: Some(4.0),
            color: Vec3::ONE,
            position: Vec3::new(1.0, 2.0, 3.0),
            direction: Vec3::NEG_Z,
            radius_m: 0.5,
            attenuation: Some(Attenuation { constant: 1.0, linear: 0.5, quadratic: 3.0 }),
            ..crate::Light::default()
        });
        scene.grid_bounds = Some(Bounds { min: Vec3::NEG_ONE, max: Vec3::new(1.0, 2.0, 3.0) });
        let before = scene.bounds();
        let options = LoadOptions { up: UpAxis::Z, unit_m: 0.5, ..LoadOptions::default() };
        apply(&mut scene, Path::new("cornell"), &options).unwrap();
        let after = scene.bounds();
        let expected = Vec3::new(before.max.x, before.max.z, -before.min.y) * 0.5;
        assert!((after.max - expected).length() < 1e-6, "{} {expected}", after.max);
        let lamp = scene.lights.last().unwrap();
        assert_eq!(lamp.position, Vec3::new(0.5, 1.5, -1.0));
        assert_eq!(lamp.radius_m, 0.25);
        // Gives the same share of light at the same point, which is half as far away.
        let attenuation = Attenuation { constant: 1.0, linear: 1.0, quadratic: 12.0 };
        assert_eq!(lamp.attenuation, Some(attenuation));
        let grid = Bounds { min: Vec3::new(-0.5, -0.5, -1.0), max: Vec3::new(0.5, 1.5, 0.5) };
        assert_eq!(scene.grid_bounds, Some(grid));
        // The intensity follows the light at a metre, which was two units away before.
        assert!((lamp.intensity - 5.0 * 4.5 / 14.0).abs() < 1e-6, "{}", lamp.intensity);
        assert_eq!(lamp.range_m, Some(2.0));
    }

    #[test]
    fn units_must_be_positive_and_finite() {
        for unit_m in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let options = LoadOptions { unit_m, ..LoadOptions::default() };
            let error = check(Path::new("box"), &options).unwrap_err().to_string();
            assert!(error.contains("unit in metres") && error.contains("0.001"), "{error}");
        }
    }
}
