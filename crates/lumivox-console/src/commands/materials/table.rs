//! The properties of a material that can be read and set by name.

use glam::{Vec3, Vec4};
use lumivox_scene::{Material, MetallicRoughness, Phong, Shading, Strengths, Unlit};

use crate::Failure;
use crate::arguments::{
    choice, color, number, number_of, on_or_off, spaces, switch, vector, wrong,
};
use crate::properties::{Property, first, names};

/// The greatest radiance, cd/m2, as on the command line.
const BRIGHTEST: f32 = 1e10;

type P = Property<Material>;

/// The names of the properties.
pub const NAMES: [&str; PROPERTIES.len()] = names(PROPERTIES);

fn metallic(material: &Material) -> Option<&MetallicRoughness> {
    if let Shading::MetallicRoughness(m) = &material.shading { Some(m) } else { None }
}

pub fn phong(material: &Material) -> Option<&Phong> {
    if let Shading::Phong(p) = &material.shading { Some(p) } else { None }
}

fn unlit(material: &Material) -> Option<&Unlit> {
    if let Shading::Unlit(u) = &material.shading { Some(u) } else { None }
}

fn four(v: Vec4) -> String {
    format!("{} {}", spaces(v.truncate()), v.w)
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

/// The properties of a material. Shading comes first, because the others depend on it.
pub const PROPERTIES: &[P] = &[
    P {
        name: "shading",
        aliases: &[],
        count: 1,
        is: "metallic_roughness, phong or unlit",
        get: |_, m| Some(shading_name(m).to_owned()),
        set: |_, m, words| set_shading(m, first(words)),
    },
    P {
        name: "base_color",
        aliases: &["albedo"],
        count: 4,
        is: "three or four numbers R G B [A] from 0 to 1",
        get: |_, m| metallic(m).map(|m| four(m.base_color)),
        set: |_, m, words| {
            let alpha = metallic(m).map_or(1.0, |m| m.base_color.w);
            set!(MetallicRoughness, m, base_color = color(words, "base_color", alpha)?)
        },
    },
    P {
        name: "metallic",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| metallic(m).map(|m| m.metallic.to_string()),
        set: |_, m, words| set!(MetallicRoughness, m, metallic = share(words, "metallic")?),
    },
    P {
        name: "roughness",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| metallic(m).map(|m| m.roughness.to_string()),
        set: |_, m, words| set!(MetallicRoughness, m, roughness = share(words, "roughness")?),
    },
    P {
        name: "specular_color",
        aliases: &[],
        count: 3,
        is: "three numbers R G B from 0 to 100",
        get: |_, m| metallic(m).map(|m| spaces(m.specular_color)),
        set: |_, m, words| {
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
        get: |_, m| metallic(m).map(|m| m.ior.to_string()),
        set: |_, m, words| {
            let range = if first(words) == "0" { 0.0..=0.0 } else { 1.0..=100.0 };
            set!(MetallicRoughness, m, ior = number(first(words), "ior", range)?)
        },
    },
    P {
        name: "diffuse",
        aliases: &[],
        count: 3,
        is: "three numbers R G B from 0 to 1",
        get: |_, m| phong(m).map(|p| spaces(p.diffuse)),
        set: |_, m, words| set!(Phong, m, diffuse = vector(words, "diffuse", 0.0..=1.0)?),
    },
    P {
        name: "opacity",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| phong(m).map(|p| p.opacity.to_string()),
        set: |_, m, words| set!(Phong, m, opacity = share(words, "opacity")?),
    },
    P {
        name: "specular",
        aliases: &[],
        count: 3,
        is: "a number from 0 to 1; of a Phong material three, R G B",
        get: |_, m| match &m.shading {
            Shading::MetallicRoughness(m) => Some(m.specular.to_string()),
            Shading::Phong(p) => Some(spaces(p.specular)),
            Shading::Unlit(_) => None,
        },
        set: |_, m, words| match &mut m.shading {
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
        get: |_, m| phong(m).map(|p| p.shininess.to_string()),
        set: |_, m, words| {
            set!(Phong, m, shininess = number(first(words), "shininess", 0.0..=1e6)?)
        },
    },
    P {
        name: "color",
        aliases: &[],
        count: 4,
        is: "three or four numbers R G B [A] from 0 to 1",
        get: |_, m| unlit(m).map(|u| four(u.color)),
        set: |_, m, words| {
            let alpha = unlit(m).map_or(1.0, |u| u.color.w);
            set!(Unlit, m, color = color(words, "color", alpha)?)
        },
    },
    P {
        name: "emission",
        aliases: &["emissive"],
        count: 3,
        is: "three numbers R G B in cd/m2, from 0 to 1e10",
        get: |_, m| Some(spaces(m.emissive)),
        set: |_, m, words| {
            m.emissive = vector(words, "emission (cd/m2)", 0.0..=BRIGHTEST)?;
            Ok(())
        },
    },
    P {
        name: "double_sided",
        aliases: &[],
        count: 1,
        is: "on or off",
        get: |_, m| Some(on_or_off(m.double_sided).to_owned()),
        set: |_, m, words| {
            m.double_sided = switch(first(words), "double_sided")?;
            Ok(())
        },
    },
    P {
        name: "normal_scale",
        aliases: &[],
        count: 1,
        is: "a number from -100 to 100",
        get: |_, m| m.normal_texture.map(|_| m.normal_scale.to_string()),
        set: |_, m, words| {
            m.normal_scale = number(first(words), "normal_scale", -100.0..=100.0)?;
            Ok(())
        },
    },
    P {
        name: "clearcoat",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| Some(m.clearcoat.strength.to_string()),
        set: |_, m, words| {
            m.clearcoat.strength = share(words, "clearcoat")?;
            Ok(())
        },
    },
    P {
        name: "clearcoat_roughness",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| Some(m.clearcoat.roughness.to_string()),
        set: |_, m, words| {
            m.clearcoat.roughness = share(words, "clearcoat_roughness")?;
            Ok(())
        },
    },
    P {
        name: "sheen",
        aliases: &[],
        count: 3,
        is: "three numbers R G B from 0 to 1",
        get: |_, m| Some(spaces(m.sheen.color)),
        set: |_, m, words| {
            m.sheen.color = vector(words, "sheen", 0.0..=1.0)?;
            Ok(())
        },
    },
    P {
        name: "sheen_roughness",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| Some(m.sheen.roughness.to_string()),
        set: |_, m, words| {
            m.sheen.roughness = share(words, "sheen_roughness")?;
            Ok(())
        },
    },
    P {
        name: "transmission",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1",
        get: |_, m| Some(m.transmission.factor.to_string()),
        set: |_, m, words| {
            m.transmission.factor = share(words, "transmission")?;
            Ok(())
        },
    },
    P {
        name: "strengths",
        aliases: &[],
        count: 7,
        is: "seven numbers, VXCT's color R G B, ambient_str, diffuse_str, specular_str and shininess, or none",
        get: |_, m| {
            Some(m.strengths.map_or("none".to_owned(), |s| {
                format!(
                    "{} {} {} {} {}",
                    spaces(s.color),
                    s.ambient,
                    s.diffuse,
                    s.specular,
                    s.shininess
                )
            }))
        },
        set: |_, m, words| set_strengths(m, words),
    },
];

/// Sets the strengths, which describe the surface only in VXCT's look. The command `material`
/// removes them when the physical surface changes.
fn set_strengths(material: &mut Material, words: &[&str]) -> Result<(), Failure> {
    if words == ["none"] {
        material.strengths = None;
        return Ok(());
    }
    let parts: Vec<&str> = words.iter().flat_map(|word| word.split(',')).collect();
    let &[r, g, b, ambient, diffuse, specular, shininess] = parts.as_slice() else {
        return Err(wrong("strengths", "seven numbers, or none", &words.join(" ")));
    };
    let any = |word: &str| number(word, "a strength", -1e12..=1e12);
    material.strengths = Some(Strengths {
        color: Vec3::new(any(r)?, any(g)?, any(b)?),
        ambient: any(ambient)?,
        diffuse: any(diffuse)?,
        specular: any(specular)?,
        shininess: any(shininess)?,
        is_rounded: material.strengths.is_some_and(|strengths| strengths.is_rounded),
    });
    Ok(())
}

pub fn shading_name(material: &Material) -> &'static str {
    match material.shading {
        Shading::MetallicRoughness(_) => "metallic_roughness",
        Shading::Phong(_) => "phong",
        Shading::Unlit(_) => "unlit",
    }
}

/// The main colour of a material.
pub fn main_color(material: &Material) -> Vec4 {
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
