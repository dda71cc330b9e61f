//! `setmat`: VXCT's names for the properties of a Phong material.

use glam::Vec3;
use lumivox_scene::{Material, Phong, Shading, Strengths};

use super::MATERIALS;
use super::table::phong;
use crate::arguments::{choice, number_of, vector};
use crate::command::Run::Now;
use crate::command::{Command, Edits, MANY, Takes};
use crate::{Console, Failure, Reply, nothing_to_show};

const PROPERTIES: [&str; 5] = ["shininess", "specular_str", "diffuse_str", "ambient_str", "color"];

/// The range of values. VXCT has no limits; this one keeps sums finite.
const ANY: std::ops::RangeInclusive<f32> = -1e12..=1e12;

/// The command.
pub const SETMAT: Command = Command {
    name: "setmat",
    usage: "NAME PROPERTY VALUE...",
    count: (3, MANY),
    takes: &[Takes::Object, Takes::Word(&PROPERTIES)],
    summary: "Change a property of an object's Phong material by VXCT's names",
    details: "shininess, specular_str, diffuse_str, ambient_str, color R G B: any numbers. NAME is an object or a \
              material; all objects of the material change. The physical look shows the closest surface. Other \
              materials become Phong materials by `material NAME shading phong`.",
    example: "setmat Floor color 0.2 0.4 0.8",
    edits: Edits::Look,
    run: Now(setmat),
    ..MATERIALS
};

/// The strengths of a material: its own, or those that match its surface.
fn strengths_of(material: &Material) -> Option<Strengths> {
    let of_phong = |phong: &Phong| Strengths {
        color: phong.diffuse,
        specular: 0.5 * (phong.shininess + 2.0) * phong.specular.max_element(),
        shininess: phong.shininess,
        ..Strengths::default()
    };
    material.strengths.or_else(|| phong(material).map(of_phong))
}

fn setmat(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let &[name, property, ref value @ ..] = arguments else { return Ok(Reply::default()) };
    let number = match console.explorer.object(name) {
        Ok(object) => {
            console.explorer.scene().and_then(|scene| Some(scene.instances.get(object)?.material))
        }
        Err(error) => match console.explorer.material(name) {
            Ok(material) => Some(material),
            Err(_) => return Err(Failure::input(error.to_string()).into()),
        },
    };
    let number = number.unwrap_or_default();
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    let material = scene.materials.get(number).ok_or_else(nothing_to_show)?;
    let called = console.explorer.material_names().into_iter().nth(number).unwrap_or_default();
    let Some(mut strengths) = strengths_of(material) else {
        return Err(Failure::input(format!(
            "the material of \"{name}\" is not a Phong material; `material '{called}' roughness 0.5` and the like change it, \
             `material '{called}' shading phong` makes it one"
        ))
        .into());
    };
    match choice(property, "the property", &PROPERTIES)? {
        "shininess" => strengths.shininess = number_of(value, property, ANY)?,
        "specular_str" => strengths.specular = number_of(value, property, ANY)?,
        "diffuse_str" => strengths.diffuse = number_of(value, property, ANY)?,
        "ambient_str" => strengths.ambient = number_of(value, property, ANY)?,
        _ => strengths.color = vector(value, property, ANY)?,
    }
    console.explorer.edit_material(number, |material| {
        set_strengths(material, strengths);
    });
    Ok(Reply::default())
}

/// Sets a material's strengths, and from them its physical surface or, if it emits, its emission.
pub fn set_strengths(material: &mut Material, strengths: Strengths) {
    material.strengths = Some(strengths);
    if material.emissive == Vec3::ZERO {
        let textures = phong(material).map(|p| (p.diffuse_texture, p.specular_texture, p.opacity));
        let (diffuse_texture, specular_texture, opacity) = textures.unwrap_or((None, None, 1.0));
        material.shading = Shading::Phong(Phong {
            diffuse_texture,
            specular_texture,
            opacity,
            ..strengths.to_phong()
        });
    } else {
        material.emissive = strengths.color.max(Vec3::ZERO);
    }
}
