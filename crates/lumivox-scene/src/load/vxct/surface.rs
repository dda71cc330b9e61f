//! A model's material: the file's strengths of Phong's model, and the closest physical material.

use glam::Vec3;

use super::keys::{MATERIAL, RGB, Values, find};
use super::tree::{Block, quote};
use crate::{Material, Phong, SceneError, Shading, Strengths};

/// The material of a model's block, with the model's name; `is_rounded` as in [`Strengths`].
pub(super) fn material(
    model: &Block<'_>,
    name: &str,
    is_rounded: bool,
    values: &mut Values<'_>,
) -> Result<Material, SceneError> {
    let emits = emits(model, values)?;
    let none = Block { at: model.at, entries: Vec::new() };
    let block = match find(model, "material") {
        Some(entry) => values.block(entry, "color { r = 0.8 g = 0.8 b = 0.8 }")?,
        None => &none,
    };
    values.check(block, &MATERIAL);
    let usual = Strengths::default();
    let strengths = Strengths {
        color: values.vector(block, "color", &RGB, usual.color)?,
        ambient: values.number(block, "ambient_str", usual.ambient)?,
        diffuse: values.number(block, "diffuse_str", usual.diffuse)?,
        specular: values.number(block, "specular_str", usual.specular)?,
        shininess: values.number(block, "shininess", usual.shininess)?,
        is_rounded,
    };
    let mut material = Material {
        name: name.to_owned(),
        double_sided: true,
        strengths: Some(strengths),
        ..Material::default()
    };
    if emits {
        // It shows its colour in any light: 1 is the screen's white, and 1 cd/m².
        material.emissive = strengths.color.max(Vec3::ZERO);
        material.shading = Shading::Phong(Phong { diffuse: Vec3::ZERO, ..Phong::default() });
    } else {
        material.shading = Shading::Phong(strengths.to_phong());
        for text in limits(&strengths) {
            values.warn(block.at, format!("{text}; only the look of VXCT shows it as it is"));
        }
    }
    Ok(material)
}

/// Descriptions of values that are physically impossible.
fn limits(strengths: &Strengths) -> impl Iterator<Item = &'static str> {
    let Strengths { color, ambient, diffuse, specular, shininess, .. } = *strengths;
    let least = [color.min_element(), ambient, diffuse, specular, shininess];
    let all = [
        (
            least.into_iter().any(|number| number < 0.0),
            "a number of the material is below 0 and became 0",
        ),
        (
            (color * diffuse).max_element() > 1.0,
            "the surface reflects more light than it gets: its \"color\" times \"diffuse_str\" was limited to 1",
        ),
        (
            2.0 * specular > shininess.max(0.0) + 2.0,
            "the surface reflects more light than it gets: its \"specular_str\" was limited to (shininess + 2) / 2",
        ),
    ];
    all.into_iter().filter_map(|(is_beyond, text)| is_beyond.then_some(text))
}

/// Whether a model's shader emits its colour.
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
                "there is no shader {}, COLOR is used instead; there are: COLOR, EMIT, EMITRGBA, VOX",
                quote(&word)
            ),
        ),
    }
    Ok(false)
}
