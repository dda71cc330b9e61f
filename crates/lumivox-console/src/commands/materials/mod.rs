//! Commands for materials.
//!
//! | file | is |
//! | --- | --- |
//! | `table.rs` | the properties that can be read and set by name |
//! | `setmat.rs` | the command `setmat`, with VXCT's names of properties |

mod setmat;
mod table;

use glam::Vec3;
use lumivox_scene::{Material, Shading};

use crate::arguments::spaces;
use crate::command::Run::Now;
use crate::command::{Command, Edits, Group, MANY, PLAIN, Takes};
use crate::report::Table;
use crate::{Console, Failure, Reply, nothing_to_show, properties};
pub use table::PROPERTIES;
use table::{NAMES, main_color, shading_name};

const MATERIALS: Command = Command { group: Group::Objects, takes: &[Takes::Material], ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "materials",
        summary: "List the materials: shading, colour, emission, number of objects",
        example: "materials",
        run: Now(list),
        ..MATERIALS
    },
    Command {
        name: "material",
        usage: "NAME [PROPERTY VALUE...]...",
        count: (1, MANY),
        takes: &[Takes::Material, Takes::Word(&NAMES)],
        summary: "Change properties of a material, or print them",
        details: "Of all: emission R G B (cd/m2), double_sided, normal_scale, clearcoat, clearcoat_roughness, sheen R G B, \
                  sheen_roughness, transmission, strengths (seven numbers for the look vxct; any other change of the surface removes them), \
                  shading (metallic_roughness, phong or unlit, which keeps the colour). \
                  Metallic-roughness: base_color or albedo R G B [A], metallic, roughness, specular, specular_color R G B, \
                  ior. Phong: diffuse R G B, opacity, specular R G B, shininess. Unlit: color R G B [A]. Colours \
                  are linear, 0 to 1, and multiply textures.",
        example: "material 'red wall' albedo 0.1 0.1 0.6 roughness 0.5",
        sets: Some(3),
        edits: Edits::Look,
        run: Now(material),
        ..MATERIALS
    },
    setmat::SETMAT,
];

fn list(console: &mut Console, _: &[&str]) -> anyhow::Result<Reply> {
    let explorer = &console.explorer;
    let scene = explorer.scene().ok_or_else(nothing_to_show)?;
    let mut table = Table::left(&["material", "shading", "colour", "emission (cd/m2)", "objects"]);
    for (index, (name, material)) in
        explorer.material_names().into_iter().zip(&scene.materials).enumerate()
    {
        let count = scene.instances.iter().filter(|instance| instance.material == index).count();
        let color = main_color(material).truncate();
        let emission = if material.emissive == Vec3::ZERO {
            "-".to_owned()
        } else {
            spaces(material.emissive)
        };
        let short = crate::arguments::short(color);
        table.row([name, shading_name(material).to_owned(), short, emission, count.to_string()]);
    }
    Ok(Reply::say(table.text().trim_end()))
}

/// Restores the file's textures that a change of shading dropped, if the material has its original
/// kind of shading again.
fn bring_textures_back(material: &mut Material, original: &Material) {
    match (&mut material.shading, &original.shading) {
        (Shading::MetallicRoughness(now), Shading::MetallicRoughness(was)) => {
            now.metallic_roughness_texture = was.metallic_roughness_texture;
            now.specular_texture = was.specular_texture;
        }
        (Shading::Phong(now), Shading::Phong(was)) => now.specular_texture = was.specular_texture,
        _ => {}
    }
}

fn material(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some((name, words)) = arguments.split_first() else { return Ok(Reply::default()) };
    let number =
        console.explorer.material(name).map_err(|error| Failure::input(error.to_string()))?;
    let material = console.explorer.scene().and_then(|scene| scene.materials.get(number));
    let material = material.ok_or_else(nothing_to_show)?;
    if words.is_empty() {
        return Ok(Reply::say(format!("{name}:\n{}", properties::list(PROPERTIES, material))));
    }
    let mut changed =
        properties::set(PROPERTIES, &format!("the material \"{name}\""), material, words)?;
    let opened = console.explorer.opened();
    if let Some(original) = opened.and_then(|opened| opened.original().materials.get(number)) {
        bring_textures_back(&mut changed, original);
    }
    // VXCT's look uses strengths if there are any, so strengths of the old surface are removed.
    let is_other = changed.shading != material.shading || changed.emissive != material.emissive;
    if is_other && changed.strengths == material.strengths {
        changed.strengths = None;
    }
    console.explorer.edit_material(number, |material| *material = changed);
    Ok(Reply::default())
}
