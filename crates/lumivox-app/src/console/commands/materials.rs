//! Materials.

use glam::{Vec3, Vec4};
use lumivox_scene::{Material, MetallicRoughness, Phong, Shading, Unlit};

use crate::console::arguments::{choice, color, number, on_or_off, spaces, switch, vector};
use crate::console::command::{Command, Group, MANY, PLAIN, Takes};
use crate::console::properties::{self, Property};
use crate::console::{Console, Reply, nothing_to_show};
use crate::exit::Failure;
use crate::report::Table;

const MATERIALS: Command = Command { group: Group::Objects, takes: &[Takes::Material], ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "materials",
        summary: "List the materials: how they are shaded, colour, emission, how many objects have them",
        example: "materials",
        run: list,
        ..MATERIALS
    },
    Command {
        name: "material",
        usage: "NAME [PROPERTY VALUE...]...",
        count: (1, MANY),
        takes: &[Takes::Material, Takes::Word(&NAMES)],
        summary: "Change properties of a material, or print them",
        details: "Of all: emission R G B (cd/m2), double_sided, normal_scale, clearcoat, clearcoat_roughness, sheen R G B, \
                  sheen_roughness, transmission, shading (metallic_roughness, phong or unlit, which keeps the colour). \
                  Metallic-roughness: base_color or albedo R G B [A], metallic, roughness, specular, specular_color R G B, \
                  ior. Phong: diffuse R G B, opacity, specular R G B, shininess, ambient. Unlit: color R G B [A]. Colours \
                  are linear, 0 to 1, and multiply textures.",
        example: "material 'red wall' albedo 0.1 0.1 0.6 roughness 0.5",
        run: material,
        ..MATERIALS
    },
    Command {
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
    },
];

/// The most radiance, cd/m2: as of the command line.
const BRIGHTEST: f32 = 1e10;

/// The most ambient light, as a share of the diffuse colour.
const MOST_AMBIENT: f32 = 1e6;

type P = Property<Material>;

const NAMES: [&str; PROPERTIES.len()] = {
    let mut names = [""; PROPERTIES.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = PROPERTIES[index].name;
        index += 1;
    }
    names
};

fn metallic(material: &Material) -> Option<&MetallicRoughness> {
    if let Shading::MetallicRoughness(m) = &material.shading { Some(m) } else { None }
}

fn phong(material: &Material) -> Option<&Phong> {
    if let Shading::Phong(p) = &material.shading { Some(p) } else { None }
}

fn unlit(material: &Material) -> Option<&Unlit> {
    if let Shading::Unlit(u) = &material.shading { Some(u) } else { None }
}

fn four(v: Vec4) -> String {
    format!("{} {}", spaces(v.truncate()), v.w)
}

fn first<'a>(words: &[&'a str]) -> &'a str {
    words.first().copied().unwrap_or_default()
}

/// A number from 0 to 1.
fn share(words: &[&str], what: &str) -> Result<f32, Failure> {
    number(first(words), what, 0.0..=1.0)
}

macro_rules! set {
    ($variant:ident, $material:ident, $field:ident = $value:expr) => {{
        let value = $value;
        if let Shading::$variant(shading) = &mut $material.shading {
            shading.$field = value;
        }
        Ok(())
    }};
}

/// The table. The shading comes first, for the others belong to it.
pub const PROPERTIES: &[P] = &[
    P {
        name: "shading",
        aliases: &[],
        count: 1,
        is: "metallic_roughness, phong or unlit",
        get: |m| Some(shading_name(m).to_owned()),
        set: |m, words| set_shading(m, first(words)),
    },
    P {
        name: "base_color",
        aliases: &["albedo"],
        count: 4,
        is: "three or four numbers R G B [A] from 0 to 1",
        get: |m| metallic(m).map(|m| four(m.base_color)),
        set: |m, words| {
            let alpha = metallic(m).map_or(1.0, |m| m.base_color.w);
            set!(MetallicRoughness, m, base_color = color(words, "base_color", alpha)?)
        },
    },
    P {
        name: "metallic",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| metallic(m).map(|m| m.metallic.to_string()),
        set: |m, words| set!(MetallicRoughness, m, metallic = share(words, "metallic")?),
    },
    P {
        name: "roughness",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| metallic(m).map(|m| m.roughness.to_string()),
        set: |m, words| set!(MetallicRoughness, m, roughness = share(words, "roughness")?),
    },
    P {
        name: "specular_color",
        aliases: &[],
        count: 3,
        is: "three numbers R G B from 0 to 100",
        get: |m| metallic(m).map(|m| spaces(m.specular_color)),
        set: |m, words| {
            set!(
                MetallicRoughness,
                m,
                specular_color = vector(words, "specular_color", 0.0..=100.0)?
            )
        },
    },
    P {
        name: "ior",
        aliases: &[],
        count: 1,
        is: "a number from 1 to 100, or 0",
        get: |m| metallic(m).map(|m| m.ior.to_string()),
        set: |m, words| {
            let range = if first(words) == "0" { 0.0..=0.0 } else { 1.0..=100.0 };
            set!(MetallicRoughness, m, ior = number(first(words), "ior", range)?)
        },
    },
    P {
        name: "diffuse",
        aliases: &[],
        count: 3,
        is: "three numbers R G B from 0 to 1",
        get: |m| phong(m).map(|p| spaces(p.diffuse)),
        set: |m, words| set!(Phong, m, diffuse = vector(words, "diffuse", 0.0..=1.0)?),
    },
    P {
        name: "opacity",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| phong(m).map(|p| p.opacity.to_string()),
        set: |m, words| set!(Phong, m, opacity = share(words, "opacity")?),
    },
    P {
        name: "specular",
        aliases: &[],
        count: 3,
        is: "a number from 0 to 1; of a Phong material three, R G B",
        get: |m| match &m.shading {
            Shading::MetallicRoughness(m) => Some(m.specular.to_string()),
            Shading::Phong(p) => Some(spaces(p.specular)),
            Shading::Unlit(_) => None,
        },
        set: |m, words| match &mut m.shading {
            Shading::Phong(p) => {
                p.specular = vector(words, "specular", 0.0..=1.0)?;
                Ok(())
            }
            Shading::MetallicRoughness(m) => {
                m.specular = number_of(words, "specular", 0.0..=1.0)?;
                Ok(())
            }
            Shading::Unlit(_) => Ok(()),
        },
    },
    P {
        name: "shininess",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1000000",
        get: |m| phong(m).map(|p| p.shininess.to_string()),
        set: |m, words| set!(Phong, m, shininess = number(first(words), "shininess", 0.0..=1e6)?),
    },
    P {
        name: "ambient",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1000000",
        get: |m| phong(m).map(|p| p.ambient.to_string()),
        set: |m, words| {
            set!(Phong, m, ambient = number(first(words), "ambient", 0.0..=MOST_AMBIENT)?)
        },
    },
    P {
        name: "color",
        aliases: &[],
        count: 4,
        is: "three or four numbers R G B [A] from 0 to 1",
        get: |m| unlit(m).map(|u| four(u.color)),
        set: |m, words| {
            let alpha = unlit(m).map_or(1.0, |u| u.color.w);
            set!(Unlit, m, color = color(words, "color", alpha)?)
        },
    },
    P {
        name: "emission",
        aliases: &["emissive"],
        count: 3,
        is: "three numbers R G B in cd/m2, from 0 to 1e10",
        get: |m| Some(spaces(m.emissive)),
        set: |m, words| {
            m.emissive = vector(words, "emission (cd/m2)", 0.0..=BRIGHTEST)?;
            Ok(())
        },
    },
    P {
        name: "double_sided",
        aliases: &[],
        count: 1,
        is: "on or off",
        get: |m| Some(on_or_off(m.double_sided).to_owned()),
        set: |m, words| {
            m.double_sided = switch(first(words), "double_sided")?;
            Ok(())
        },
    },
    P {
        name: "normal_scale",
        aliases: &[],
        count: 1,
        is: "a number from -100 to 100",
        get: |m| m.normal_texture.map(|_| m.normal_scale.to_string()),
        set: |m, words| {
            m.normal_scale = number(first(words), "normal_scale", -100.0..=100.0)?;
            Ok(())
        },
    },
    P {
        name: "clearcoat",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| Some(m.clearcoat.strength.to_string()),
        set: |m, words| {
            m.clearcoat.strength = share(words, "clearcoat")?;
            Ok(())
        },
    },
    P {
        name: "clearcoat_roughness",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| Some(m.clearcoat.roughness.to_string()),
        set: |m, words| {
            m.clearcoat.roughness = share(words, "clearcoat_roughness")?;
            Ok(())
        },
    },
    P {
        name: "sheen",
        aliases: &[],
        count: 3,
        is: "three numbers R G B from 0 to 1",
        get: |m| Some(spaces(m.sheen.color)),
        set: |m, words| {
            m.sheen.color = vector(words, "sheen", 0.0..=1.0)?;
            Ok(())
        },
    },
    P {
        name: "sheen_roughness",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| Some(m.sheen.roughness.to_string()),
        set: |m, words| {
            m.sheen.roughness = share(words, "sheen_roughness")?;
            Ok(())
        },
    },
    P {
        name: "transmission",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |m| Some(m.transmission.factor.to_string()),
        set: |m, words| {
            m.transmission.factor = share(words, "transmission")?;
            Ok(())
        },
    },
];

fn shading_name(material: &Material) -> &'static str {
    match material.shading {
        Shading::MetallicRoughness(_) => "metallic_roughness",
        Shading::Phong(_) => "phong",
        Shading::Unlit(_) => "unlit",
    }
}

/// The colour that a material mainly has.
fn main_color(material: &Material) -> Vec4 {
    match &material.shading {
        Shading::MetallicRoughness(m) => m.base_color,
        Shading::Phong(p) => p.diffuse.extend(p.opacity),
        Shading::Unlit(u) => u.color,
    }
}

fn set_shading(material: &mut Material, name: &str) -> Result<(), Failure> {
    let name = choice(name, "shading", &["metallic_roughness", "phong", "unlit"])?;
    if name == shading_name(material) {
        return Ok(());
    }
    let color = main_color(material);
    let texture = match &material.shading {
        Shading::MetallicRoughness(m) => m.base_color_texture,
        Shading::Phong(p) => p.diffuse_texture,
        Shading::Unlit(u) => u.color_texture,
    };
    material.shading = match name {
        "phong" => Shading::Phong(Phong {
            diffuse: color.truncate(),
            opacity: color.w,
            diffuse_texture: texture,
            ..Phong::default()
        }),
        "unlit" => Shading::Unlit(Unlit { color, color_texture: texture }),
        _ => Shading::MetallicRoughness(MetallicRoughness {
            base_color: color,
            base_color_texture: texture,
            ..MetallicRoughness::default()
        }),
    };
    Ok(())
}

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
        let short = crate::console::arguments::short(color);
        table.row([name, shading_name(material).to_owned(), short, emission, count.to_string()]);
    }
    Ok(Reply::say(table.text().trim_end()))
}

/// Where a material is shaded again as its file has it: the textures that other ways of shading do not have.
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
    let original = console.explorer.original();
    if let Some(original) = original.and_then(|original| original.materials.get(number)) {
        bring_textures_back(&mut changed, original);
    }
    console.explorer.edit_material(number, |material| *material = changed);
    Ok(Reply::default())
}

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

fn number_of(
    words: &[&str],
    what: &str,
    range: std::ops::RangeInclusive<f32>,
) -> Result<f32, Failure> {
    match words {
        [word] => number(word, what, range),
        _ => Err(Failure::input(format!("{what} is one number; got {}", words.len()))),
    }
}
