//! Commands for lights.

use lumivox_scene::{LIGHT_FIELDS, Light, LightField, LightKind, LightValue};

use crate::arguments::{choice, short, wrong};
use crate::command::Run::Now;
use crate::command::{Command, Edits, Group, MANY, PLAIN, Takes};
use crate::properties::{self, Property, first, names};
use crate::report::Table;
use crate::{Console, Failure, Reply, nothing_to_show};

const LIGHT: Command = Command { group: Group::Light, takes: &[Takes::Light], ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "lights",
        summary: "List the lights: kind, strength, colour, position, direction",
        example: "lights",
        run: Now(list),
        ..LIGHT
    },
    Command {
        name: "light",
        usage: "NAME [PROPERTY VALUE...]...",
        count: (1, MANY),
        takes: &[Takes::Light, Takes::Word(&NAMES)],
        summary: "Change properties of a light, or print them",
        more: properties_in_words,
        example: "light lamp strength 200 color 1 0.8 0.6",
        sets: Some(3),
        edits: Edits::Look,
        run: Now(light),
        ..LIGHT
    },
    Command {
        name: "add_light",
        usage: "KIND [NAME] [PROPERTY VALUE...]...",
        count: (1, MANY),
        takes: &[Takes::Word(&KINDS), Takes::Word(&NAMES)],
        summary: "Add a light",
        details: "Defaults of its properties (see `light`): at the camera, in its direction, 100 cd; a sun shines from \
                  above with 100000 lux. Prints the light's name.",
        more: kinds_in_words,
        example: "add_light point lamp position 0 1.5 0 strength 50",
        edits: Edits::Look,
        run: Now(add),
        ..LIGHT
    },
    Command {
        name: "remove_light",
        usage: "NAME|all",
        count: (1, 1),
        summary: "Remove a light, or all of them",
        example: "remove_light lamp",
        edits: Edits::Look,
        run: Now(remove),
        ..LIGHT
    },
];

const KINDS: [&str; LightKind::ALL.len()] = {
    let mut words = [""; LightKind::ALL.len()];
    let mut index = 0;
    while index < words.len() {
        words[index] = LightKind::ALL[index].word();
        index += 1;
    }
    words
};

const NAMES: [&str; LIGHT_FIELDS.len()] = names(&PROPERTIES);

/// The fields of lights, read and written in words.
pub const PROPERTIES: [Property<Light>; LIGHT_FIELDS.len()] = {
    const EMPTY: Property<Light> = Property {
        name: "",
        aliases: &[],
        count: 0,
        is: "",
        get: |own, light| Some(field(own, light)?.value(light).to_string()),
        set: |own, light, words| {
            let Some(field) = field(own, light) else { return Ok(()) };
            if words.is_empty() {
                let is = field.expected(light);
                return Err(Failure::input(format!("{} is {is}; got nothing", own.name)));
            }
            let parts = words.iter().flat_map(|word| word.split(','));
            let numbers: Option<Vec<f64>> = parts.map(|part| part.trim().parse().ok()).collect();
            let value = match numbers.as_deref() {
                Some(&[number]) => Ok(LightValue::Number(number)),
                Some(&[x, y, z]) => Ok(LightValue::Vector([x, y, z])),
                _ if words == ["none"] => Ok(LightValue::None),
                _ => Err(field.expected(light)),
            };
            value
                .and_then(|value| field.set_value(light, &value))
                .map_err(|expected| wrong(own.name, &expected, &words.join(" ")))
        },
    };
    let mut table = [EMPTY; LIGHT_FIELDS.len()];
    let mut index = 0;
    while index < table.len() {
        let field = LIGHT_FIELDS[index];
        table[index] = Property { name: field.name, aliases: field.aliases, ..EMPTY };
        table[index].count = if field.form.parts().is_some() { 3 } else { 1 };
        index += 1;
    }
    table
};

/// The field of a property if the light has it.
fn field(property: &Property<Light>, light: &Light) -> Option<&'static LightField> {
    light.kind.fields().find(|field| field.name == property.name)
}

fn properties_in_words() -> String {
    let fields = LIGHT_FIELDS.iter().map(|field| {
        format!(
            "{} ({}: {})",
            field.name,
            field.summary,
            field.expected(&Light::typical(field.kinds[0]))
        )
    });
    format!("Properties: {}.", fields.collect::<Vec<_>>().join("; "))
}

fn kinds_in_words() -> String {
    let kinds = LightKind::ALL.map(|kind| format!("{} ({})", kind.word(), kind.summary()));
    format!("Kinds: {}.", kinds.join(", "))
}

fn list(console: &mut Console, _: &[&str]) -> anyhow::Result<Reply> {
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    if scene.lights.is_empty() {
        return Ok(Reply::say("the scene has no lights; `add_light` adds one"));
    }
    let mut table = Table::left(&["light", "kind", "strength", "colour", "position", "direction"]);
    for (name, light) in console.explorer.light_names().into_iter().zip(&scene.lights) {
        let kind = light.kind;
        let of = |field, value| if kind.has(field) { short(value) } else { "-".to_owned() };
        table.row([
            name,
            kind.word().to_owned(),
            format!("{} {}", light.intensity, kind.unit()),
            short(light.color),
            of("position", light.position),
            of("direction", light.direction),
        ]);
    }
    Ok(Reply::say(table.text().trim_end()))
}

fn light(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some((name, words)) = arguments.split_first() else { return Ok(Reply::default()) };
    let number = console.explorer.light(name).map_err(|error| Failure::input(error.to_string()))?;
    let light = console.explorer.scene().and_then(|scene| scene.lights.get(number));
    let light = light.ok_or_else(nothing_to_show)?;
    if words.is_empty() {
        let list = properties::list(&PROPERTIES, light);
        return Ok(Reply::say(format!("{name}, {}:\n{list}", light.kind.word())));
    }
    let changed = properties::set(&PROPERTIES, &format!("the light \"{name}\""), light, words)?;
    console.explorer.edit_lights(|scene| {
        if let Some(light) = scene.lights.get_mut(number) {
            *light = changed;
        }
    });
    Ok(Reply::default())
}

/// A new light of a kind: at the camera, in its direction. A sun shines from above.
pub fn new_light(kind: LightKind, camera: &lumivox_scene::Camera) -> Light {
    let light = Light::typical(kind);
    if kind.is_parallel() {
        return light;
    }
    let direction = if kind.has("direction") { camera.forward } else { light.direction };
    Light { position: camera.position, direction, ..light }
}

fn add(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some((word, words)) = arguments.split_first() else { return Ok(Reply::default()) };
    let word = choice(word, "the kind", &KINDS)?;
    let kind = LightKind::ALL.into_iter().find(|kind| kind.word() == word).unwrap_or_default();
    if console.explorer.scene().is_none() {
        return Err(nothing_to_show().into());
    }
    let (name, words) = match words {
        [name, rest @ ..]
            if !PROPERTIES.iter().any(|p| p.name == *name || p.aliases.contains(name)) =>
        {
            (*name, rest)
        }
        _ => (word, words),
    };
    let names = console.explorer.light_names();
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let free = [name.to_owned()].into_iter().chain(numbered).find(|name| !names.contains(name));
    let name = free.unwrap_or_default();
    let light = new_light(kind, console.explorer.camera());
    let light = properties::set(&PROPERTIES, &format!("the light \"{name}\""), &light, words)?;
    console.explorer.edit_lights(|scene| scene.lights.push(Light { name: name.clone(), ..light }));
    Ok(Reply::say(format!("added the light \"{name}\"")))
}

fn remove(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let name = first(arguments);
    if name == "all" && console.explorer.light(name).is_err() {
        console.explorer.edit_lights(|scene| scene.lights.clear());
        return Ok(Reply::default());
    }
    let number = console.explorer.light(name).map_err(|error| Failure::input(error.to_string()))?;
    console.explorer.edit_lights(|scene| {
        scene.lights.remove(number);
    });
    Ok(Reply::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_words_restore_every_light_field() {
        for kind in LightKind::ALL {
            let mut light = Light::typical(kind);
            light.attenuation = Some(lumivox_scene::Attenuation::default());
            light.range_m = kind.has("range").then_some(0.1);
            let plain = Light { kind, ..Light::default() };
            let words = properties::difference(&PROPERTIES, &light, &plain).join(" ");
            let words: Vec<&str> = words.split(' ').collect();
            assert_eq!(properties::set(&PROPERTIES, "it", &plain, &words).unwrap(), light);
            let shown = properties::list(&PROPERTIES, &light);
            assert!(kind.fields().all(|field| shown.contains(field.name)), "{shown}");
        }
    }
}
