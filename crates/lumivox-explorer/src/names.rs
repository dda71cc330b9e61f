//! Names by which objects, materials and lights are found.

use std::collections::{HashMap, HashSet};

use lumivox_scene::Scene;

use crate::{Explorer, suggest};

/// The error that nothing has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {kind} \"{name}\"{remedy}")]
pub struct NotFound {
    /// The kind of the thing, such as `object`.
    pub kind: &'static str,
    /// The name that was asked for.
    pub name: String,
    /// The names that exist.
    pub known: Vec<String>,
    remedy: String,
}

impl NotFound {
    /// The place of a name among the known ones.
    ///
    /// # Errors
    /// When it is not among them.
    pub fn or_place(kind: &'static str, name: &str, known: &[String]) -> Result<usize, Self> {
        if let Some(place) = known.iter().position(|other| other == name) {
            return Ok(place);
        }
        let remedy = if known.is_empty() {
            format!(": the scene has no {kind}s")
        } else {
            suggest::remedy(name, known.iter().map(String::as_str), &format!("{kind}s"))
        };
        Err(Self { kind, name: name.to_owned(), known: known.to_vec(), remedy })
    }
}

/// Unique names of things of one kind: an unnamed thing is called by its number, and a repeated
/// name gets a number. Line feeds and the like become blanks, because a name is a word of a line.
fn unique<'a>(kind: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut used = HashSet::new();
    // The next number for each name: many things may share one.
    let mut next = HashMap::new();
    let name = |(index, name): (usize, &str)| {
        let mut name = name.replace(char::is_control, " ");
        if name.is_empty() {
            name = format!("{kind} {}", index + 1);
        }
        let mut free = name.clone();
        while used.contains(&free) {
            let number = next.entry(name.clone()).or_insert(1_usize);
            *number += 1;
            free = format!("{name} ({number})");
        }
        used.insert(free.clone());
        free
    };
    names.enumerate().map(name).collect()
}

/// The objects' names in the order of the instances.
pub(crate) fn names_of_objects(scene: &Scene) -> Vec<String> {
    unique("object", scene.instances.iter().map(|instance| instance.name.as_str()))
}

impl Explorer {
    /// The materials' names, in the order of the scene's materials, each once.
    pub fn material_names(&self) -> Vec<String> {
        let materials = self.scene().into_iter().flat_map(|scene| &scene.materials);
        unique("material", materials.map(|material| material.name.as_str()))
    }

    /// The number of the material of this name.
    ///
    /// # Errors
    /// [`NotFound`], with similar names.
    pub fn material(&self, name: &str) -> Result<usize, NotFound> {
        NotFound::or_place("material", name, &self.material_names())
    }

    /// The lights' names, in the order of the scene's lights, each once.
    pub fn light_names(&self) -> Vec<String> {
        let lights = self.scene().into_iter().flat_map(|scene| &scene.lights);
        unique("light", lights.map(|light| light.name.as_str()))
    }

    /// The number of the light of this name, or on the node of this name.
    ///
    /// # Errors
    /// [`NotFound`], with similar names.
    pub fn light(&self, name: &str) -> Result<usize, NotFound> {
        let (known, scene) = (self.light_names(), self.scene());
        NotFound::or_place("light", name, &known).or_else(|unknown| {
            let name = scene.map_or(name, |scene| scene.name_on(name));
            NotFound::or_place("light", name, &known).map_err(|_| unknown)
        })
    }
}
