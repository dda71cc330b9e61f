//! The statements of an OBJ file.

use std::collections::{BTreeMap, HashMap};
use std::io::BufRead;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::corners::{Corner, Corners, Normal};
use super::fault::Fault;
use crate::SceneError;
use crate::load::geometry::GeometryBudget;
use crate::load::origin::Rest;
use crate::load::polygon::Cutter;
use crate::load::text::{Lines, keyword, number, numbers, readable, words};
use crate::load::{Notes, normals};

/// Beyond this number of submeshes, all groups of a material share one: a file could name millions.
const MOST_SUBMESHES: usize = 1 << 16;
/// The most material libraries that are searched.
const MOST_LIBRARIES: usize = 64;

/// The content of an OBJ file.
#[derive(Default)]
pub(super) struct Model {
    pub(super) positions: Vec<Vec3>,
    /// The rounding errors of `positions`.
    pub(super) rest: Rest,
    /// Colours as in the file, NaN for vertices without a colour; may be shorter than `positions`.
    pub(super) colors: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Corners,
    pub(super) submeshes: Vec<Submesh>,
    /// The names that `usemtl` gives, in any encoding.
    pub(super) materials: Vec<Vec<u8>>,
    /// The files that `mtllib` names.
    pub(super) libraries: Vec<Vec<u8>>,
}

/// The triangles of one object and group with one material.
#[derive(Debug)]
pub(super) struct Submesh {
    pub(super) name: String,
    /// Index into [`Model::materials`].
    pub(super) material: Option<usize>,
    /// Indices of corners, three per triangle.
    pub(super) indices: Vec<u32>,
}

/// Reads a file.
pub(super) fn read(
    file: &Path,
    reader: impl BufRead,
    notes: &mut Notes,
    budget: &GeometryBudget<'_>,
) -> Result<Model, SceneError> {
    let mut lines = Lines::new(file, reader, 0);
    let mut state = State::default();
    while lines.advance_joined()? {
        let (first, rest) = keyword(lines.line());
        // The longest keywords have eight letters.
        let mut lower = [0; 8];
        let first = match lower.get_mut(..first.len()) {
            Some(lower) => {
                lower.copy_from_slice(first);
                lower.make_ascii_lowercase();
                lower
            }
            None => first,
        };
        state
            .statement(first, rest, lines.number())
            .map_err(|fault| fault.of_line(file, lines.number()))?;
        if lines.number().is_multiple_of(65_536) {
            budget.check(|| format!("line {}", lines.number()), state.bytes())?;
        }
    }
    budget.check(|| "its last line".to_owned(), state.bytes())?;
    for late in std::mem::take(&mut state.late) {
        (state.submesh, state.smoothing) = (Some(late.submesh), late.smoothing);
        state.counts_before = Some(late.counts);
        state.face(&late.rest, late.line).map_err(|fault| fault.of_line(file, late.line))?;
    }
    budget.check(|| "its last faces".to_owned(), state.bytes())?;
    state.warn(notes);
    Ok(state.model)
}

/// A face that refers to something later in the file, with the state at its line.
struct Late {
    line: u64,
    rest: Vec<u8>,
    submesh: usize,
    smoothing: Option<Normal>,
    /// The numbers of positions, texture coordinates and normals before the face, for negative
    /// indices.
    counts: [usize; 3],
}

/// Object, group and material.
type SubmeshKey = (Vec<u8>, Vec<u8>, Option<usize>);

/// The state of reading.
#[derive(Default)]
struct State {
    model: Model,
    object: Vec<u8>,
    group: Vec<u8>,
    /// The normal of corners without a given one: the face's, or the smoothing group's.
    smoothing: Option<Normal>,
    groups: HashMap<Vec<u8>, u32>,
    material: Option<usize>,
    material_numbers: HashMap<Vec<u8>, usize>,
    /// The submesh of each object, group and material.
    submesh_numbers: HashMap<SubmeshKey, usize>,
    /// The submesh of the next faces; `None` after the object, group or material has changed.
    submesh: Option<usize>,
    triangles: u64,
    cutter: Cutter,
    face: Vec<u32>,
    points: Vec<Vec3>,
    /// Faces that are read at the end of the file.
    late: Vec<Late>,
    /// Bytes of `late`.
    late_bytes: usize,
    /// [`Late::counts`] of the face in `late` that is being read; `None` before the end of the
    /// file.
    counts_before: Option<[usize; 3]>,
    /// The number of colours in `ZBrush`'s comments so far.
    painted: usize,
    skipped: Skipped,
}

/// The numbers of skipped things.
#[derive(Default)]
struct Skipped {
    lines_and_points: u64,
    free_form: u64,
    short_faces: u64,
    lost_uvs: u64,
    lost_normals: u64,
    joined_submeshes: u64,
    libraries: u64,
    others: BTreeMap<String, u64>,
}

impl State {
    fn statement(&mut self, first: &[u8], rest: &[u8], line: u64) -> Result<(), Fault> {
        match first {
            b"v" => self.vertex(rest)?,
            b"vt" => self.texture_coordinate(rest)?,
            b"vn" => {
                // Normals of length zero are repaired later.
                let normal = numbers(&mut words(rest))?;
                self.model.normals.push(Vec3::from_array(normal));
            }
            b"f" | b"fo" => self.face(rest, line)?,
            b"o" => {
                self.object = rest.to_vec();
                self.group.clear();
                self.submesh = None;
            }
            b"g" => {
                self.group = rest.to_vec();
                self.submesh = None;
            }
            b"s" => self.smoothing_group(rest),
            b"usemtl" => {
                let count = self.material_numbers.len();
                let number = *self.material_numbers.entry(rest.to_vec()).or_insert(count);
                if number == count {
                    self.model.materials.push(rest.to_vec());
                }
                self.material = Some(number);
                self.submesh = None;
            }
            b"mtllib" => {
                let libraries = &mut self.model.libraries;
                if !libraries.iter().any(|known| known == rest) {
                    if libraries.len() < MOST_LIBRARIES {
                        libraries.push(rest.to_vec());
                    } else {
                        self.skipped.libraries += 1;
                    }
                }
            }
            b"l" | b"p" => self.skipped.lines_and_points += 1,
            b"curv" | b"curv2" | b"surf" => self.skipped.free_form += 1,
            // Statements for free-form shapes, and ignored display attributes.
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole"
            | b"scrv" | b"sp" | b"end" | b"con" | b"mg" | b"ctech" | b"stech" | b"bevel"
            | b"c_interp" | b"d_interp" | b"lod" | b"bsp" | b"bzp" | b"cdc" | b"cdp" | b"res"
            | b"" => {}
            b"#mrgb" => self.polypaint(rest),
            _ if first.starts_with(b"#") => {}
            other => {
                let others = &mut self.skipped.others;
                if others.len() < Notes::MOST {
                    *others.entry(readable(other)).or_default() += 1;
                }
            }
        }
        Ok(())
    }

    /// `x y z [w]`, or `x y z r g b [a]`. The weight w is for free-form shapes.
    fn vertex(&mut self, rest: &[u8]) -> Result<(), Fault> {
        let mut words = words(rest);
        let place = DVec3::from_array(numbers(&mut words)?);
        if self.model.positions.len() >= Corner::NONE as usize {
            return Err("it is vertex 4294967296, more than indices can number".to_owned().into());
        }
        let position = self.model.rest.place(place);
        self.model.positions.push(position);
        let Some(red) = words.next() else { return Ok(()) };
        if let (Some(green), Some(blue)) = (words.next(), words.next())
            && let (Some(r), Some(g), Some(b)) = (number(red), number(green), number(blue))
        {
            let colors = &mut self.model.colors;
            colors.resize(self.model.positions.len() - 1, Vec3::NAN);
            colors.push(Vec3::new(r, g, b));
        }
        Ok(())
    }

    fn texture_coordinate(&mut self, rest: &[u8]) -> Result<(), Fault> {
        let mut words = words(rest);
        let [u] = numbers(&mut words)?;
        // Texture coordinates of lines have no v.
        let v = match words.next() {
            Some(word) => {
                number(word).ok_or_else(|| format!("\"{}\" is not a number", readable(word)))?
            }
            None => 0.0,
        };
        // OBJ's v grows upwards.
        self.model.uvs.push(Vec2::new(u, 1.0 - v));
        Ok(())
    }

    fn smoothing_group(&mut self, rest: &[u8]) {
        let word = words(rest).next().unwrap_or(b"off").to_ascii_lowercase();
        // The format requires numbers; some programs write names. Blender's older exporters write
        // "on" for the first group.
        let group = match std::str::from_utf8(&word).ok().and_then(|text| text.parse::<f64>().ok())
        {
            Some(number) => number.to_string().into_bytes(),
            None if word == b"on" => b"1".to_vec(),
            None => word,
        };
        let is_off = [&b"off"[..], b"0", b"-0", b"null", b"none", b"false"].contains(&&group[..]);
        self.smoothing = (!is_off).then(|| {
            let count = self.groups.len() as u32;
            Normal::group(*self.groups.entry(group).or_insert(count))
        });
    }

    /// Reads the colours of the next vertices from a comment of `ZBrush`: two hexadecimal digits
    /// each for a mask, red, green and blue.
    fn polypaint(&mut self, rest: &[u8]) {
        let Model { positions, colors, .. } = &mut self.model;
        for block in rest.chunks_exact(8) {
            let number = std::str::from_utf8(block).ok().map(|text| u32::from_str_radix(text, 16));
            let Some(Ok(number)) = number.filter(|_| self.painted < positions.len()) else {
                return;
            };
            let [_, r, g, b] = number.to_be_bytes().map(f32::from);
            colors.resize(colors.len().max(self.painted + 1), Vec3::NAN);
            colors[self.painted] = Vec3::new(r, g, b) / 255.0;
            self.painted += 1;
        }
    }

    fn face(&mut self, rest: &[u8], line: u64) -> Result<(), Fault> {
        self.face.clear();
        for word in words(rest) {
            let corner = match self.corner(word) {
                Err(Fault::Later) => {
                    let submesh = self.submesh.unwrap_or_else(|| self.start_submesh());
                    let (rest, smoothing) = (rest.to_vec(), self.smoothing);
                    let counts = self.counts();
                    self.late_bytes += size_of::<Late>() + rest.len();
                    self.late.push(Late { line, rest, submesh, smoothing, counts });
                    return Ok(());
                }
                corner => corner?,
            };
            self.face.push(self.model.corners.number(corner));
        }
        if self.model.corners.len() >= Corner::NONE as usize {
            return Err("there are too many different corners, split it".to_owned().into());
        }
        let submesh = match self.submesh {
            Some(submesh) => submesh,
            None => self.start_submesh(),
        };
        let indices = &mut self.model.submeshes[submesh].indices;
        match self.face.as_slice() {
            [] | [_] | [_, _] => self.skipped.short_faces += 1,
            [a, b, c] => indices.extend([*a, *b, *c]),
            face => {
                self.points.clear();
                let model = &self.model;
                let position = |i: u32| model.corners.get(i).position as usize;
                {
                    let near = model.rest.relative_to(position(face[0]), &model.positions);
                    self.points.extend(face.iter().map(|&i| near(position(i))));
                }
                let triangles = self.cutter.cut(&self.points);
                let indices = &mut self.model.submeshes[submesh].indices;
                indices.extend(triangles.iter().map(|&i| face[i as usize]));
            }
        }
        self.triangles += self.face.len().saturating_sub(2) as u64;
        Ok(())
    }

    /// Parses `position[/[uv][/normal]]`: indices from 1, or backwards from -1.
    fn corner(&mut self, word: &[u8]) -> Result<Corner, Fault> {
        let mut parts = word.split(|&byte| byte == b'/');
        let bad = || Fault::Text(format!("\"{}\" is not a corner of a face", readable(word)));
        let index = integer(parts.next().unwrap_or_default()).ok_or_else(bad)?;
        let counts = self.counts();
        let before = self.counts_before.unwrap_or(counts);
        let may_come = |index: i64, count: usize| {
            self.counts_before.is_none() && usize::try_from(index).is_ok_and(|index| index > count)
        };
        let count = counts[0];
        if may_come(index, count) {
            return Err(Fault::Later);
        }
        let position = resolve(index, count, before[0]).ok_or(match index {
            0 => Fault::Text("it uses vertex 0, but vertices are counted from 1".to_owned()),
            ..0 => Fault::Text(format!(
                "it uses vertex {index}, counted back from the last one, but only {} come before it",
                before[0]
            )),
            _ => Fault::Index {
                index: usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX),
                count,
            },
        })?;
        // Invalid indices of texture coordinates and normals are ignored: a picture without them is
        // better than none.
        let mut other = |list: usize| match parts.next() {
            None | Some([]) => Ok((None, 0)),
            Some(part) => {
                let index = integer(part).ok_or_else(bad)?;
                if may_come(index, counts[list]) {
                    return Err(Fault::Later);
                }
                let found = resolve(index, counts[list], before[list]);
                Ok((found, u64::from(found.is_none())))
            }
        };
        let ((uv, lost_uv), (normal, lost_normal)) = (other(1)?, other(2)?);
        self.skipped.lost_uvs += lost_uv;
        self.skipped.lost_normals += lost_normal;
        Ok(Corner {
            position,
            uv: uv.unwrap_or(Corner::NONE),
            normal: normal.map_or(self.smoothing.unwrap_or(Normal::FLAT), Normal::given),
        })
    }

    /// The numbers of positions, texture coordinates and normals so far.
    fn counts(&self) -> [usize; 3] {
        [self.model.positions.len(), self.model.uvs.len(), self.model.normals.len()]
    }

    /// The submesh for the current names.
    fn start_submesh(&mut self) -> usize {
        let submeshes = &mut self.model.submeshes;
        // Beyond the limit, faces are grouped only by their material.
        let crowded = submeshes.len() >= MOST_SUBMESHES;
        self.skipped.joined_submeshes += u64::from(crowded);
        let key = if crowded {
            (b"others".to_vec(), Vec::new(), self.material)
        } else {
            (self.object.clone(), self.group.clone(), self.material)
        };
        let submesh =
            *self.submesh_numbers.entry(key).or_insert_with_key(|(object, group, material)| {
                let name = match (object.as_slice(), group.as_slice()) {
                    ([], []) => "object".to_owned(),
                    (name, []) | ([], name) => readable(name),
                    (object, group) if object == group => readable(object),
                    (object, group) => format!("{}/{}", readable(object), readable(group)),
                };
                submeshes.push(Submesh { name, material: *material, indices: Vec::new() });
                submeshes.len() - 1
            });
        self.submesh = Some(submesh);
        submesh
    }

    /// The memory in use in bytes, except for names.
    fn bytes(&self) -> u64 {
        let model = &self.model;
        let lists = (model.positions.len() + model.colors.len() + model.normals.len()) * 12
            + model.uvs.len() * 8
            + model.corners.len() * 16;
        (lists + self.late_bytes) as u64 + self.triangles * 12
    }

    fn warn(&self, notes: &mut Notes) {
        let skipped = &self.skipped;
        for (count, what) in [
            (skipped.lines_and_points, "lines and points are not shown and were skipped"),
            (
                skipped.free_form,
                "free-form curves and surfaces are not supported and were skipped; export polygons",
            ),
            (skipped.short_faces, "faces of fewer than three corners were skipped"),
            (skipped.lost_uvs, "corners name texture coordinates that do not exist"),
            (skipped.lost_normals, "corners name normals that do not exist, theirs were computed"),
            (skipped.libraries, "more material libraries were not read"),
        ] {
            if count > 0 {
                notes.warn(format!("{count} {what}"));
            }
        }
        if skipped.joined_submeshes > 0 {
            notes.warn(format!(
                "groups after the {MOST_SUBMESHES}th were joined by their materials"
            ));
        }
        for (word, count) in &skipped.others {
            notes.warn(format!("{count} statements \"{word}\" are unknown and were ignored"));
        }
    }
}

impl Model {
    /// The normals of the corners in smoothing groups, by corner; empty without groups. Frees the
    /// memory that was only needed for reading.
    pub(super) fn group_normals(&mut self) -> Vec<Vec3> {
        let count = self.corners.len() as u32;
        let mut sums = Vec::new();
        if (0..count).any(|number| self.corners.get(number).normal.is_group()) {
            // Corners that only differ in texture coordinates share the first one's normal.
            let first = |number: u32| {
                let corner = self.corners.get(number);
                let fits = |other: &Corner| other.normal == corner.normal;
                self.corners.find(corner.position, fits).unwrap_or(number)
            };
            sums = vec![Vec3::ZERO; count as usize];
            for triangle in
                self.submeshes.iter().flat_map(|submesh| submesh.indices.chunks_exact(3))
            {
                let triangle = [triangle[0], triangle[1], triangle[2]];
                let corners = triangle.map(|number| self.corners.get(number));
                let places = corners.map(|corner| self.positions[corner.position as usize]);
                let weighted = normals::corner_normals(places);
                for ((number, corner), normal) in triangle.into_iter().zip(corners).zip(weighted) {
                    if corner.normal.is_group() {
                        sums[first(number) as usize] += normal;
                    }
                }
            }
            for number in 0..count {
                if self.corners.get(number).normal.is_group() {
                    let sum = sums[first(number) as usize];
                    sums[number as usize] = sum.normalize_or(Vec3::Y);
                }
            }
        }
        self.corners.close();
        sums
    }
}

/// A whole number; numbers that do not fit saturate.
fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0_i64;
    for digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
    }
    Some(if negative { -value } else { value })
}

/// Converts an index that counts from 1, or backwards from -1, which is the last of the first
/// `before` entries.
fn resolve(index: i64, count: usize, before: usize) -> Option<u32> {
    let count = count as i64;
    let from_zero = if index < 0 { before as i64 + index } else { index - 1 };
    (0..count).contains(&from_zero).then(|| u32::try_from(from_zero).ok())?
}
