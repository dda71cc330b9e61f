//! A model's material in physical terms.
//!
//! VXCT adds up, for each light of colour L: `ambient_str * colour * L`, which no orientation changes,
//! `diffuse_str * colour * L cos`, and `specular_str * L cos^shininess` about the mirror direction, and
//! shows the sum as it is.
//!
//! A lamp that gives a white diffuse surface a radiance of L has an irradiance of E = pi L where it is met
//! at right angles. The diffuse albedo that gives `diffuse_str * colour * L` is `diffuse_str * colour`.
//! The lobe of [`Phong`] is normalised (Lafortune and Willems 1994, "Using the modified Phong reflectance
//! model for physically based rendering"): its peak is `specular (n + 2) / (2 pi)`, which times E is
//! `specular (n + 2) / 2 L`. It equals `specular_str * L` for `specular = 2 specular_str / (n + 2)`.

use glam::Vec3;

use super::keys::{MATERIAL, RGB, Values, find};
use super::tree::{Block, quote};
use crate::{Material, Phong, SceneError, Shading};

/// What VXCT's surfaces are where a scene says nothing.
const COLOR: Vec3 = Vec3::splat(0.85);
const SHININESS: f32 = 32.0;
const AMBIENT: f32 = 0.08;
const DIFFUSE: f32 = 1.0;
const SPECULAR: f32 = 0.5;

/// The material of a model's block, under the model's name.
pub(super) fn material(
    model: &Block<'_>,
    name: &str,
    values: &mut Values<'_>,
) -> Result<Material, SceneError> {
    let emits = emits(model, values)?;
    let none = Block { at: model.at, entries: Vec::new() };
    let block = match find(model, "material") {
        Some(entry) => values.block(entry, "color { r = 0.8 g = 0.8 b = 0.8 }")?,
        None => &none,
    };
    values.check(block, &MATERIAL);
    let color = at_least_0(values.vector(block, "color", &RGB, COLOR)?, block, values);
    let mut strength = |key: &str, default: f32| {
        let value = values.number(block, key, default)?;
        if value < 0.0 {
            values.warn(block.at, format!("\"{key}\" is {value} and became 0"));
        }
        Ok::<_, SceneError>(value.max(0.0))
    };
    let shininess = strength("shininess", SHININESS)?;
    let specular = strength("specular_str", SPECULAR)?;
    let diffuse = strength("diffuse_str", DIFFUSE)?;
    let ambient = strength("ambient_str", AMBIENT)?;

    let mut material =
        Material { name: name.to_owned(), double_sided: true, ..Material::default() };
    let black = Phong { diffuse: Vec3::ZERO, ..Phong::default() };
    if emits {
        // It shows its colour whatever the light: 1 is the screen's white, and a cd/m².
        material.emissive = color;
        material.shading = Shading::Phong(black);
        return Ok(material);
    }
    let lobe = 2.0 * specular / (shininess + 2.0);
    let albedo = color * diffuse;
    if albedo.max_element() > 1.0 {
        let text = "the surface reflects more light than it gets: its \"color\" times \"diffuse_str\" \
                    was limited to 1";
        values.warn(block.at, text);
    }
    if lobe > 1.0 {
        let text = "the surface reflects more light than it gets: its \"specular_str\" was limited to \
                    (shininess + 2) / 2";
        values.warn(block.at, text);
    }
    material.shading = Shading::Phong(Phong {
        diffuse: albedo.min(Vec3::ONE),
        specular: Vec3::splat(lobe.min(1.0)),
        shininess,
        // Times the albedo it is VXCT's, which multiplies the colour alone.
        ambient: if diffuse > 0.0 { (ambient / diffuse).min(f32::MAX) } else { ambient },
        ..black
    });
    Ok(material)
}

fn at_least_0(color: Vec3, block: &Block<'_>, values: &mut Values<'_>) -> Vec3 {
    if color.cmplt(Vec3::ZERO).any() {
        values.warn(block.at, "the colour is below 0 and became 0");
    }
    color.max(Vec3::ZERO)
}

/// Whether a model's shader shows its colour as light.
fn emits(model: &Block<'_>, values: &mut Values<'_>) -> Result<bool, SceneError> {
    let Some(word) = values.word(model, "shader", "COLOR")? else { return Ok(false) };
    match word.text {
        "EMIT" | "EMITRGBA" => return Ok(true),
        "COLOR" => {}
        "VOX" => values.warn(
            word.at,
            "the shader VOX, which shows a model by its voxels, is shown as COLOR; the view of voxels \
             shows all of them",
        ),
        _ => values.warn(
            word.at,
            format!(
                "there is no shader {}, COLOR stands in; there are: COLOR, EMIT, EMITRGBA, VOX",
                quote(&word)
            ),
        ),
    }
    Ok(false)
}
