//! Lights, and VXCT's cameras.

use std::f32::consts::PI;

use glam::Vec3;

use super::keys::{LIGHT, RGB, Values, XYZ};
use super::tree::Block;
use crate::{Attenuation, Camera, Light, SceneError};

/// The light of a block, the `number`th of its scene.
///
/// VXCT lights a surface by `colour * cos / (c + l d + q d²)` times its own colour, and shows the
/// result without conversion. Here a surface of albedo a that faces a lamp of I candela at a metre
/// has a radiance of a I / pi. So with I = pi / (c + l + q) both agree at a metre, if one unit is 1
/// cd/m².
pub(super) fn light(
    block: &Block<'_>,
    number: usize,
    values: &mut Values<'_>,
) -> Result<Light, SceneError> {
    values.check(block, &LIGHT);
    let position = values.vector(block, "position", &XYZ, Vec3::ZERO)?;
    let color = values.vector(block, "color", &RGB, Vec3::ONE)?;
    if color.cmplt(Vec3::ZERO).any() {
        values.warn(block.at, "the light's colour is below 0 and became 0");
    }
    let attenuation = attenuation(block, values)?;
    Ok(Light {
        name: format!("light {number}"),
        intensity: PI * attenuation.at(1.0),
        color: color.max(Vec3::ZERO),
        position,
        attenuation: Some(attenuation),
        ..Light::default()
    })
}

fn attenuation(block: &Block<'_>, values: &mut Values<'_>) -> Result<Attenuation, SceneError> {
    let default = Attenuation::default();
    let given = [
        values.number(block, "att_constant", default.constant)?,
        values.number(block, "att_linear", default.linear)?,
        values.number(block, "att_quadratic", default.quadratic)?,
    ];
    let [constant, linear, quadratic] = given.map(|part| part.max(0.0));
    if given.iter().any(|&part| part < 0.0) {
        values.warn(block.at, "the light's attenuation is below 0 and became 0");
    }
    let attenuation = Attenuation { constant, linear, quadratic };
    let at_a_metre = PI * attenuation.at(1.0);
    if at_a_metre > 0.0 && at_a_metre.is_finite() {
        return Ok(attenuation);
    }
    values.warn(
        block.at,
        "the light's attenuation leaves none of it or no end of it: 1, 0.15, 0.45 stand in",
    );
    Ok(default)
}

/// VXCT's initial camera, and the two cameras of its console.
pub(super) fn cameras() -> Vec<Camera> {
    let camera = |name: &str, position: Vec3, forward: Vec3| Camera {
        name: name.to_owned(),
        position,
        forward,
        ..Camera::default()
    };
    vec![
        camera("vxct", Vec3::new(0.0, 0.0, 3.0), Vec3::NEG_Z),
        camera("pos1", Vec3::new(1.26, 0.10, 1.73), forward(-126.0, -4.0)),
        camera("pos2", Vec3::new(0.0, 0.0, 1.8), Vec3::NEG_Z),
    ]
}

/// The line of sight for a yaw from +x towards +z and a pitch upwards, in degrees.
fn forward(yaw_deg: f32, pitch_deg: f32) -> Vec3 {
    let (sin_yaw, cos_yaw) = yaw_deg.to_radians().sin_cos();
    let (sin_pitch, cos_pitch) = pitch_deg.to_radians().sin_cos();
    Vec3::new(cos_yaw * cos_pitch, sin_pitch, sin_yaw * cos_pitch)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_yaw_of_minus_90_degrees_looks_along_minus_z() {
        assert!(forward(-90.0, 0.0).abs_diff_eq(Vec3::NEG_Z, 1e-6));
        assert!(forward(0.0, 90.0).abs_diff_eq(Vec3::Y, 1e-6));
        // The camera pos1 looks at the middle of the cube.
        let [_, pos1, _] = <[Camera; 3]>::try_from(cameras()).unwrap();
        let along = (-pos1.position).dot(pos1.forward);
        assert!((pos1.position + pos1.forward * along).length() < 0.06);
    }
}
