//! `setmat`: VXCT's names for what a Phong material is made of.

use glam::Vec3;
use lumivox_scene::{Phong, Shading};

use super::MATERIALS;
use super::table::{MOST_AMBIENT, phong};
use crate::console::arguments::{choice, number_of, vector};
use crate::console::command::{Command, MANY, Takes};
use crate::console::{Console, Reply, nothing_to_show};
use crate::exit::Failure;

/// Its place in the table.
pub const SETMAT: Command = Command {
    name: "setmat",
    usage: "NAME PROPERTY VALUE...",
    count: (3, MANY),
    takes: &[
        Takes::Object,
        Takes::Word(&["shininess", "specular_str", "diffuse_str", "ambient_str", "color"]),
    ],
    summary: "Change a property of an object's Phong material by VXCT's names",
    details: "shininess (1 to 1000000), specular_str, diffuse_str, ambient_str (0 to 1), color R G B (0 to 1). NAME is \
              an object or else a material; all objects of the material change. diffuse_str is the share of the colour \
              that the material had when it was opened. Other materials become Phong's by `material NAME shading phong`.",
    example: "setmat Floor color 0.2 0.4 0.8",
    vxct: Some(
        "no more than its name is known of VXCT's; the properties are those of its scene files",
    ),
    run: setmat,
    ..MATERIALS
};

/// What `setmat` has set of a material: a colour without a diffuse part is still there once it has one again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strengths {
    color: Vec3,
    diffuse: f32,
    ambient: f32,
}

impl Strengths {
    /// Those of a material: what was set before, unless it was changed otherwise since.
    fn of(phong: &Phong, before: Option<&Self>) -> Self {
        let fits = |before: &&Self| before.diffuse_color() == phong.diffuse;
        let Some(before) = before.filter(fits) else {
            return Self { color: phong.diffuse, diffuse: 1.0, ambient: phong.ambient };
        };
        // To the bit: it was computed so, and has not changed since.
        if before.ambient_share().to_bits() == phong.ambient.to_bits() {
            return *before;
        }
        let share = if before.diffuse > 0.0 { before.diffuse } else { 1.0 };
        Self { ambient: phong.ambient * share, ..*before }
    }

    fn diffuse_color(&self) -> Vec3 {
        self.color * self.diffuse
    }

    /// As the loader of VXCT's files has it: ambient light is a share of the diffuse part.
    fn ambient_share(&self) -> f32 {
        if self.diffuse > 0.0 { self.ambient / self.diffuse } else { self.ambient }
    }
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
    let Some(mut changed) = phong(material).copied() else {
        return Err(Failure::input(format!(
            "the material of \"{name}\" is no Phong material; `material '{called}' roughness 0.5` and the like change it, \
             `material '{called}' shading phong` makes it one"
        ))
        .into());
    };
    let mut strengths = Strengths::of(&changed, console.strengths.get(&number));
    // As the loader of VXCT's files has it: the lobe is normalized.
    let peak = |shininess: f32| 0.5 * (shininess + 2.0);
    let one = |what: &str| number_of(value, what, 0.0..=1.0);
    let properties = ["shininess", "specular_str", "diffuse_str", "ambient_str", "color"];
    match choice(property, "the property", &properties)? {
        "shininess" => {
            let shininess = number_of(value, property, 1.0..=1e6)?;
            let strength = changed.specular * peak(changed.shininess);
            changed.specular = (strength / peak(shininess)).min(Vec3::ONE);
            changed.shininess = shininess;
        }
        "specular_str" => {
            changed.specular = Vec3::splat((one(property)? / peak(changed.shininess)).min(1.0));
        }
        "diffuse_str" => strengths.diffuse = one(property)?,
        "ambient_str" => strengths.ambient = one(property)?,
        _ => strengths.color = vector(value, property, 0.0..=1.0)?,
    }
    if !matches!(property, "shininess" | "specular_str") {
        changed.diffuse = strengths.diffuse_color();
        changed.ambient = strengths.ambient_share();
        if changed.ambient > MOST_AMBIENT {
            return Err(Failure::input(format!(
                "{property}: the ambient part would be more than {MOST_AMBIENT} times the diffuse one; `setmat {} ambient_str 0` \
                 leaves it out",
                crate::console::line::quote(name)
            ))
            .into());
        }
    }
    console.strengths.insert(number, strengths);
    console.explorer.edit_material(number, |material| material.shading = Shading::Phong(changed));
    Ok(Reply::default())
}
