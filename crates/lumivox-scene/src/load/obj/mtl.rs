//! The statements of MTL files.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::map::Map;
use crate::SceneError;
use crate::load::color::rgb_from_xyz;
use crate::load::files::Reach;
use crate::load::find::{bare, find};
use crate::load::text::{Lines, keyword, number, numbers, readable, words};
use crate::load::{LoadOptions, Notes, stream};

/// The most words of a line that is split into several names.
const MOST_WORDS: usize = 32;

/// The materials of all libraries of a scene.
#[derive(Default)]
pub(super) struct Library {
    materials: HashMap<Vec<u8>, Mtl>,
    /// The first spelling of a material's name, by its [`plain`] form.
    plain_names: HashMap<Vec<u8>, Vec<u8>>,
}

/// A material as in its file; `None` means not given.
#[derive(Clone, Debug, Default)]
pub(super) struct Mtl {
    /// The file that contains it.
    pub(super) file: PathBuf,
    pub(super) ambient: Option<Vec3>,
    pub(super) diffuse: Option<Vec3>,
    pub(super) specular: Option<Vec3>,
    pub(super) emission: Option<Vec3>,
    pub(super) scalars: BTreeMap<Scalar, f32>,
    pub(super) maps: BTreeMap<Slot, Map>,
}

/// Statements with one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Scalar {
    Shininess,
    Ior,
    Opacity,
    Transparency,
    Illumination,
    Roughness,
    Metallic,
    Sheen,
    Clearcoat,
    ClearcoatRoughness,
}

/// Statements with an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Slot {
    Diffuse,
    Specular,
    Emission,
    Opacity,
    Bump,
    Normal,
    Roughness,
    Metallic,
    Sheen,
}

impl Library {
    /// Reads the libraries that the scene `file` names; missing ones cause a warning.
    pub(super) fn load(
        file: &Path,
        reach: Reach<'_>,
        names: &[Vec<u8>],
        notes: &mut Notes,
    ) -> Self {
        let mut library = Self::default();
        for name in names {
            let found = split(name, &|name| find(&[file], name, reach));
            for path in found {
                match path {
                    Ok(path) => library.read_or_tell(&path, file, reach, notes),
                    Err(reason) => {
                        let beside = file.with_extension("mtl");
                        let is_there = reach.is_file(&beside) && reach.admit(&beside).is_ok();
                        let instead = if is_there {
                            library.read_or_tell(&beside, file, reach, notes);
                            "; the one of the scene's own name was read instead"
                        } else {
                            ""
                        };
                        notes.warn(format!("the material library {reason}{instead}"));
                    }
                }
            }
        }
        library
    }

    /// Reads a library; if it cannot be read, warns and continues without it.
    fn read_or_tell(&mut self, file: &Path, scene: &Path, reach: Reach<'_>, notes: &mut Notes) {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        match self.read(file, scene, reach, notes) {
            Ok(0) => notes.warn(format!(
                "the material library \"{name}\" has no materials (no line begins with newmtl); \
                 export it again"
            )),
            Ok(_) => {}
            Err(SceneError::OtherKind { kind, .. }) => {
                notes.warn(format!("the material library \"{name}\" was ignored: {kind}"));
            }
            Err(error) => notes.warn(format!("a material library was ignored: {error}")),
        }
    }

    /// The material of this name, or one whose name only differs in case, quotation marks or a
    /// comment.
    pub(super) fn get(&self, name: &[u8]) -> Option<&Mtl> {
        let same = || self.materials.get(self.plain_names.get(&plain(name))?);
        self.materials.get(name).or_else(same)
    }

    /// Reads a library, and returns the number of its materials.
    fn read(
        &mut self,
        file: &Path,
        scene: &Path,
        reach: Reach<'_>,
        notes: &mut Notes,
    ) -> Result<usize, SceneError> {
        let exists = |name: &[u8]| find(&[file, scene], name, reach).is_ok();
        let mut options = LoadOptions { files: reach.source, ..LoadOptions::default() };
        let (reader, _) = stream::open(file, &mut options)?;
        let mut lines = Lines::new(file, reader, 0);
        let mut current: Option<(Vec<u8>, Mtl)> = None;
        let mut names: HashSet<Vec<u8>> = HashSet::new();
        let file_name = file.file_name().unwrap_or_default().to_string_lossy();
        while lines.advance_joined()? {
            let (first, rest) = keyword(lines.line());
            if first.is_empty() || first.starts_with(b"#") {
                continue;
            }
            if first.eq_ignore_ascii_case(b"newmtl") {
                if !names.insert(rest.to_vec()) {
                    notes.warn(format!(
                        "{file_name}: the material \"{}\" is defined more than once; the first \
                         counts",
                        readable(rest)
                    ));
                }
                let mtl = Mtl { file: file.to_owned(), ..Mtl::default() };
                let done = current.replace((rest.to_vec(), mtl));
                self.insert(done);
                continue;
            }
            let said = match &mut current {
                Some((_, mtl)) => mtl.statement(first, rest, &exists),
                None => Err("it comes before the first \"newmtl\"".to_owned()),
            };
            let said = match said {
                Ok(None) => continue,
                Ok(Some(limit)) => limit,
                Err(reason) => format!("was ignored: {reason}"),
            };
            let word = readable(first);
            notes.warn(format!("{file_name}, line {}: \"{word}\" {said}", lines.number()));
        }
        self.insert(current);
        Ok(names.len())
    }

    /// Stores a material unless its name exists.
    fn insert(&mut self, named: Option<(Vec<u8>, Mtl)>) {
        if let Some((name, mtl)) = named {
            self.plain_names.entry(plain(&name)).or_insert_with(|| name.clone());
            self.materials.entry(name).or_insert(mtl);
        }
    }
}

impl Mtl {
    pub(super) fn scalar(&self, scalar: Scalar) -> Option<f32> {
        self.scalars.get(&scalar).copied()
    }

    pub(super) fn map(&self, slot: Slot) -> Option<&Map> {
        self.maps.get(&slot)
    }

    /// Reads a statement, and returns its ignored part. The error is a sentence with the reason why
    /// the whole statement is ignored.
    fn statement(
        &mut self,
        first: &[u8],
        rest: &[u8],
        exists: &dyn Fn(&[u8]) -> bool,
    ) -> Result<Option<String>, String> {
        let first = first.to_ascii_lowercase();
        match first.as_slice() {
            b"ka" => self.ambient = color(rest).ok(),
            b"kd" => self.diffuse = Some(color(rest)?),
            b"ks" => self.specular = Some(color(rest)?),
            b"ke" => self.emission = Some(color(rest)?),
            b"ns" => self.number(Scalar::Shininess, rest)?,
            b"ni" => self.number(Scalar::Ior, rest)?,
            b"illum" => self.number(Scalar::Illumination, rest)?,
            b"pr" => self.number(Scalar::Roughness, rest)?,
            b"pm" => self.number(Scalar::Metallic, rest)?,
            b"ps" => self.number(Scalar::Sheen, rest)?,
            b"pc" => self.number(Scalar::Clearcoat, rest)?,
            b"pcr" => self.number(Scalar::ClearcoatRoughness, rest)?,
            b"tr" => self.number(Scalar::Transparency, rest)?,
            b"d" => match keyword(rest) {
                (b"-halo", rest) => {
                    self.number(Scalar::Opacity, rest)?;
                    let limit = "is the same for all angles: -halo is not supported";
                    return Ok(Some(limit.to_owned()));
                }
                _ => self.number(Scalar::Opacity, rest)?,
            },
            b"map_kd" => return self.map_statement(Slot::Diffuse, rest, exists),
            b"map_ks" => return self.map_statement(Slot::Specular, rest, exists),
            b"map_ke" | b"map_emissive" => return self.map_statement(Slot::Emission, rest, exists),
            b"map_d" | b"map_opacity" => return self.map_statement(Slot::Opacity, rest, exists),
            b"map_bump" | b"bump" => return self.map_statement(Slot::Bump, rest, exists),
            b"norm" | b"map_kn" | b"map_norm" => {
                return self.map_statement(Slot::Normal, rest, exists);
            }
            b"map_pr" => return self.map_statement(Slot::Roughness, rest, exists),
            b"map_pm" => return self.map_statement(Slot::Metallic, rest, exists),
            b"map_ps" => return self.map_statement(Slot::Sheen, rest, exists),
            // Renderers compute ambient light, and every exporter writes both keys. The sharpness
            // of reflections and anti-aliasing are not properties of surfaces.
            b"map_ka" | b"sharpness" | b"map_aat" => {}
            b"tf" if color(rest) == Ok(Vec3::ONE) => {}
            b"aniso" | b"anisor" if number(rest) == Some(0.0) => {}
            b"tf" => return Err("filters of transmitted light are not supported".to_owned()),
            b"map_ns" => return Err("Phong's exponent has no image".to_owned()),
            b"map_tr" => return Err("use map_d".to_owned()),
            b"refl" | b"map_refl" => {
                return Err("reflections are computed, not read from an image".to_owned());
            }
            b"disp" | b"map_disp" | b"decal" | b"aniso" | b"anisor" | b"map_pc" | b"map_pcr"
            | b"map_rma" | b"map_orm" => return Err("it is not supported".to_owned()),
            _ => return Err("it is unknown".to_owned()),
        }
        Ok(None)
    }

    fn number(&mut self, scalar: Scalar, rest: &[u8]) -> Result<(), String> {
        let [value] = numbers::<1, f32>(&mut words(rest))?;
        if !value.is_finite() {
            return Err("its number is not finite".to_owned());
        }
        self.scalars.insert(scalar, value);
        Ok(())
    }

    fn map_statement(
        &mut self,
        slot: Slot,
        rest: &[u8],
        exists: &dyn Fn(&[u8]) -> bool,
    ) -> Result<Option<String>, String> {
        let (map, ignored) = Map::parse(rest, exists).ok_or("it names no file")?;
        self.maps.insert(slot, map);
        let is_whole = ignored.is_empty();
        Ok((!is_whole).then(|| {
            format!("is used without its options {}, which are not supported", ignored.join(", "))
        }))
    }
}

/// Splits a line into names of libraries, which may contain blanks: the longest names that are
/// found, else up to the next `.mtl`.
fn split<T>(names: &[u8], find: &dyn Fn(&[u8]) -> Result<T, String>) -> Vec<Result<T, String>> {
    let ends: Vec<usize> = (1..=names.len())
        .filter(|&at| !names[at - 1].is_ascii_whitespace())
        .filter(|&at| names.get(at).is_none_or(u8::is_ascii_whitespace))
        .collect();
    // A line with more words is not a list of names.
    if ends.len() > MOST_WORDS {
        return vec![find(names)];
    }
    let mut found = Vec::new();
    let mut rest = 0;
    while rest < names.len() {
        let name = |end: usize| names[rest..end].trim_ascii();
        let longer = ends.iter().copied().filter(|&end| end > rest);
        let (end, path) = longer
            .clone()
            .rev()
            .find_map(|end| Some((end, Ok(find(name(end)).ok()?))))
            .unwrap_or_else(|| {
                let is_library = |&end: &usize| name(end).to_ascii_lowercase().ends_with(b".mtl");
                let end = longer.clone().find(is_library).unwrap_or(names.len());
                (end, find(name(end)))
            });
        found.push(path);
        rest = end;
    }
    found
}

/// The form of a name for comparisons, without case, spacing, quotation marks and comments.
fn plain(name: &[u8]) -> Vec<u8> {
    let words: Vec<_> = words(bare(name)).collect();
    words.join(&b' ').to_ascii_lowercase()
}

/// `r [g b]`, or `xyz x [y z]`; missing numbers equal the first.
fn color(rest: &[u8]) -> Result<Vec3, String> {
    let (first, after) = keyword(rest);
    let (xyz, rest) = match first {
        b"spectral" => return Err("spectral curves are not supported".to_owned()),
        b"xyz" => (true, after),
        _ => (false, rest),
    };
    let mut words = words(rest);
    let [x] = numbers::<1, f32>(&mut words)?;
    let mut next = || words.next().map_or(Some(x), number).ok_or("its numbers are malformed");
    let color = Vec3::new(x, next()?, next()?);
    if !color.is_finite() {
        return Err("its numbers are not finite".to_owned());
    }
    Ok(if xyz { rgb_from_xyz(color) } else { color })
}
