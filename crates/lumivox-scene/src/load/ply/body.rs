//! The elements of a PLY file, converted to a mesh.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::header::{Element, Encoding, Header, Property, Scalar};
use super::source::Source;
use crate::load::geometry::GeometryBudget;
use crate::load::origin::{self, Rest};
use crate::load::polygon::Cutter;
use crate::load::{Notes, color, repair};
use crate::{Mesh, SceneError};

/// The meaning of a vertex's property.
#[derive(Clone, Copy)]
enum Use {
    Position(usize),
    Normal(usize),
    Uv(usize),
    Color(usize),
    /// All channels packed into one number; `true` with alpha.
    Packed(bool),
    Nothing,
}

/// Makes triangles from `corners`, for the entry with this index.
type Add<'f> = fn(&mut Body<'f>, usize) -> Result<(), SceneError>;

/// The state of reading the body.
pub(super) struct Body<'f> {
    file: &'f Path,
    header: &'f Header,
    budget: GeometryBudget<'f>,
    /// Upper bound of the bytes left in the file.
    length: u64,
    notes: Notes,
    mesh: Mesh,
    /// The rounding errors of the mesh's positions.
    rest: Rest,
    cutter: Cutter,
    corners: Vec<u32>,
    points: Vec<Vec3>,
    short_polygons: u64,
    /// Corners of faces that come before the vertices: lists, each preceded by its length.
    early: Vec<(Add<'f>, Vec<u32>)>,
}

/// A file that was read.
pub(super) struct Done<'f> {
    /// The mesh, without derived data.
    pub(super) mesh: Mesh,
    /// The origin that was subtracted from the mesh's positions.
    pub(super) origin: DVec3,
    pub(super) budget: GeometryBudget<'f>,
    pub(super) notes: Notes,
}

impl<'f> Body<'f> {
    pub(super) fn new(
        file: &'f Path,
        header: &'f Header,
        budget: GeometryBudget<'f>,
        length: u64,
    ) -> Self {
        let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        Self {
            file,
            header,
            budget,
            length,
            notes: Notes::default(),
            mesh: Mesh { name: name.unwrap_or_default(), ..Mesh::default() },
            rest: Rest::default(),
            cutter: Cutter::default(),
            corners: Vec::new(),
            points: Vec::new(),
            short_polygons: 0,
            early: Vec::new(),
        }
    }

    pub(super) fn read(&mut self, source: &mut impl Source) -> Result<(), SceneError> {
        let header = self.header;
        for element in &header.elements {
            self.check_room(element)?;
            match element.name.as_str() {
                "vertex" if self.mesh.positions.is_empty() => self.vertices(element, source)?,
                "face" => self.faces(element, source, Self::polygon)?,
                "tristrips" => self.faces(element, source, Self::strip)?,
                _ => skip(element, source)?,
            }
        }
        if let Some(rest) = source.rest()? {
            self.notes.warn(format!(
                "{rest} behind all that its header declares were ignored; if something is missing, the \
                 header counts too little"
            ));
        }
        for (add, lists) in std::mem::take(&mut self.early) {
            let (mut rest, mut face) = (lists.as_slice(), 0);
            while let [length, after @ ..] = rest {
                let (corners, after) = after.split_at(*length as usize);
                self.corners.clear();
                self.corners.extend_from_slice(corners);
                add(self, face)?;
                (rest, face) = (after, face + 1);
            }
        }
        Ok(())
    }

    /// The mesh, without derived data.
    pub(super) fn finish(mut self) -> Result<Done<'f>, SceneError> {
        let mesh = &mut self.mesh;
        if mesh.indices.is_empty() {
            let reason = match mesh.positions.len() {
                0 => "it has no vertices".to_owned(),
                count => format!(
                    "it is a cloud of {count} points without faces; reconstruct its surface first, \
                     for example with MeshLab"
                ),
            };
            return Err(SceneError::NoTriangles { file: self.file.to_owned(), reason });
        }
        mesh.uvs.resize(mesh.positions.len(), Vec2::ZERO);
        // Numbers above 1 are bytes, or wider integers.
        let largest =
            mesh.colors.iter().fold(0.0, |most: f32, color| most.max(color.max_element()));
        if largest > 2.0 {
            let most = [255, 65_535, u32::MAX]
                .into_iter()
                .find(|most| f64::from(largest) <= f64::from(*most));
            let byte = color::Decoder::integers(most.unwrap_or(u32::MAX));
            for color in &mut mesh.colors {
                let [r, g, b, a] = color.to_array().map(f64::from);
                let alpha = if a > 1.0 { byte.linear(a) } else { a as f32 };
                *color = Vec4::new(byte.color(r), byte.color(g), byte.color(b), alpha);
            }
        }
        repair::attributes(mesh, &mut self.notes);
        let short = self.short_polygons;
        if short > 0 {
            self.notes.warn(format!("{short} faces of fewer than three vertices were skipped"));
        }
        let origin = self.rest.take_origin([mesh.positions.as_mut_slice()]);
        let mut elements = self.header.elements.iter();
        let vertex = elements.find(|element| element.name == "vertex");
        let is_f32 = self.header.encoding != Encoding::Ascii
            && vertex.is_some_and(|vertex| {
                let stores = |property: &Property| property.scalar == Scalar::F32;
                vertex.properties.iter().any(|property| property.name == "x" && stores(property))
            });
        if is_f32 {
            origin::tell_lost(&mut self.notes, origin);
        }
        Ok(Done { mesh: self.mesh, origin, budget: self.budget, notes: self.notes })
    }

    /// Checks that the elements declared in the header fit into the file.
    fn check_room(&self, element: &Element) -> Result<(), SceneError> {
        let least = element.least_bytes(self.header.encoding);
        // The last line may have no line break.
        if element.count.saturating_mul(least) <= self.length.saturating_add(1) {
            return Ok(());
        }
        Err(self.malformed(
            &format!("element \"{}\"", element.name),
            format!(
                "its {} entries take at least {least} bytes each, but the file has {} after its \
                 header, so it was cut off",
                element.count, self.length
            ),
        ))
    }

    fn vertices(&mut self, element: &Element, source: &mut impl Source) -> Result<(), SceneError> {
        let uses: Vec<Use> = element.properties.iter().map(vertex_use).collect();
        let has = |wanted: fn(&Use) -> Option<usize>, count: usize| {
            (0..count).all(|i| uses.iter().any(|u| wanted(u) == Some(i)))
        };
        if !has(|u| if let Use::Position(i) = u { Some(*i) } else { None }, 3) {
            return Err(self.malformed("element \"vertex\"", "it lacks x, y or z".to_owned()));
        }
        let normals = has(|u| if let Use::Normal(i) = u { Some(*i) } else { None }, 3);
        let uvs = has(|u| if let Use::Uv(i) = u { Some(*i) } else { None }, 2);
        let colors = has(|u| if let Use::Color(i) = u { Some(*i) } else { None }, 3)
            || uses.iter().any(|used| matches!(used, Use::Packed(_)));
        let count = usize::try_from(element.count).unwrap_or(usize::MAX);
        self.budget.spend(|| format!("its {count} vertices"), count, 0, colors)?;

        // The file is large enough for `count` vertices, see `check_room`.
        let mesh = &mut self.mesh;
        mesh.positions.reserve_exact(count);
        if normals {
            mesh.normals.reserve_exact(count);
        }
        if uvs {
            mesh.uvs.reserve_exact(count);
        }
        if colors {
            mesh.colors.reserve_exact(count);
        }
        let decoders = element.properties.iter().zip(uses).map(|(property, used)| {
            // Wider integers may hold bytes: their range is only known after reading all.
            let bytes = property.scalar.largest().filter(|&largest| largest == 255);
            (used, bytes.map_or(color::Decoder::Float, color::Decoder::integers))
        });
        let decoders: Vec<(Use, color::Decoder)> = decoders.collect();
        let byte = color::Decoder::integers(255);
        let is_text = self.header.encoding == Encoding::Ascii;
        for _ in 0..count {
            source.begin()?;
            let (mut position, mut normal, mut uv) = (DVec3::ZERO, Vec3::ZERO, Vec2::ZERO);
            let mut color = Vec4::ONE;
            for (property, (used, decoder)) in element.properties.iter().zip(&decoders) {
                if let Some(list_count) = property.list_count {
                    let count = source.value(list_count)?;
                    skip_items(count, property, source)?;
                    continue;
                }
                // A packed colour is read as bits, since as a float it may be NaN.
                let is_packed = matches!(used, Use::Packed(_)) && !is_text;
                let scalar = if is_packed { Scalar::U32 } else { property.scalar };
                let value = source.value(scalar)?;
                match *used {
                    Use::Position(i) => position[i] = value,
                    Use::Normal(i) => normal[i] = value as f32,
                    Use::Uv(i) => uv[i] = value as f32,
                    Use::Color(3) => color[3] = decoder.linear(value),
                    Use::Color(i) => color[i] = decoder.color(value),
                    Use::Packed(has_alpha) => {
                        // In text, some programs write the bits of a float as an integer.
                        let is_float = is_text
                            && property.scalar == Scalar::F32
                            && !(1.0..=f64::from(u32::MAX)).contains(&value);
                        let bits =
                            if is_float { (value as f32).to_bits() } else { value as i64 as u32 };
                        let [a, r, g, b] = bits.to_be_bytes().map(f64::from);
                        let alpha = if has_alpha { byte.linear(a) } else { 1.0 };
                        color = Vec4::new(byte.color(r), byte.color(g), byte.color(b), alpha);
                    }
                    Use::Nothing => {}
                }
            }
            mesh.positions.push(self.rest.place(position));
            if normals {
                mesh.normals.push(normal);
            }
            if uvs {
                // PLY's v grows upwards.
                mesh.uvs.push(Vec2::new(uv.x, 1.0 - uv.y));
            }
            if colors {
                mesh.colors.push(color);
            }
        }
        Ok(())
    }

    fn faces<S: Source>(
        &mut self,
        element: &Element,
        source: &mut S,
        add: Add<'f>,
    ) -> Result<(), SceneError> {
        let find = |fits: fn(&Property) -> bool| element.properties.iter().position(fits);
        let usual = find(|property| {
            property.list_count.is_some()
                && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
        });
        let other = || find(|p| p.list_count.is_some() && p.scalar.largest().is_some());
        let Some(corners) = usual.or_else(other) else {
            self.notes.warn(format!("its \"{}\" name no vertices and were skipped", element.name));
            return skip(element, source);
        };
        if usual.is_none() {
            self.notes.warn(format!(
                "the list \"{}\" of its \"{}\" counts as vertex_indices",
                element.properties[corners].name, element.name
            ));
        }
        let is_early = self.mesh.positions.is_empty();
        if is_early {
            self.early.push((add, Vec::new()));
        }
        self.warn_of_face_properties(element);
        let count = usize::try_from(element.count).unwrap_or(usize::MAX);
        // Reserves three corners per face, at most what the file could hold.
        let property = &element.properties[corners];
        let item =
            if self.header.encoding == Encoding::Ascii { 2 } else { property.scalar.bytes() };
        let room = usize::try_from(self.length).unwrap_or(usize::MAX) / item;
        self.budget.check(|| format!("its {count} faces"), count.min(room / 3) as u64 * 12)?;
        self.mesh.indices.reserve(count.min(room / 3) * 3);

        for face in 0..count {
            source.begin()?;
            for (i, property) in element.properties.iter().enumerate() {
                let Some(list_count) = property.list_count else {
                    source.value(property.scalar)?;
                    continue;
                };
                let length = source.value(list_count)?;
                if i != corners {
                    skip_items(length, property, source)?;
                    continue;
                }
                self.corners.clear();
                for _ in 0..whole(length) {
                    let index = source.value(property.scalar)?;
                    // The index is checked later; the cast saturates, and -1 ends strips.
                    let index = if index < 0.0 { u32::MAX } else { index as u32 };
                    self.corners.push(index);
                }
                match self.early.last_mut().filter(|_| is_early) {
                    Some((_, lists)) => {
                        lists.push(self.corners.len() as u32);
                        lists.append(&mut self.corners);
                        let bytes = lists.len() as u64 * 4;
                        self.budget.check(|| format!("face {face}"), bytes)?;
                    }
                    None => add(self, face)?,
                }
            }
        }
        Ok(())
    }

    fn polygon(&mut self, face: usize) -> Result<(), SceneError> {
        self.check_corners("face", face, |_| true)?;
        let before = self.mesh.indices.len();
        match self.corners.len() {
            0..3 => self.short_polygons += 1,
            3 => self.mesh.indices.extend_from_slice(&self.corners),
            _ => {
                self.points.clear();
                let corners = self.corners.iter();
                let first = self.corners[0] as usize;
                let near = self.rest.relative_to(first, &self.mesh.positions);
                self.points.extend(corners.map(|&i| near(i as usize)));
                let triangles = self.cutter.cut(&self.points);
                self.mesh.indices.extend(triangles.iter().map(|&i| self.corners[i as usize]));
            }
        }
        let more = self.mesh.indices.len() - before;
        self.budget.spend(|| format!("face {face}"), 0, more, false)
    }

    /// Reads strips one after another, each ended by a negative number.
    fn strip(&mut self, element: usize) -> Result<(), SceneError> {
        self.check_corners("strip", element, |i| i != u32::MAX)?;
        let before = self.mesh.indices.len();
        for strip in self.corners.split(|&i| i == u32::MAX) {
            for (i, t) in strip.windows(3).enumerate() {
                // Every second triangle of a strip has the opposite winding.
                let turned = if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] };
                self.mesh.indices.extend(turned);
            }
        }
        let more = self.mesh.indices.len() - before;
        self.budget.spend(|| format!("strip {element}"), 0, more, false)
    }

    fn check_corners(
        &self,
        what: &str,
        number: usize,
        is_corner: fn(u32) -> bool,
    ) -> Result<(), SceneError> {
        let count = self.mesh.positions.len();
        match self.corners.iter().find(|&&i| is_corner(i) && i as usize >= count) {
            None => Ok(()),
            Some(_) if count == 0 => Err(self.malformed(
                &format!("{what} {number}"),
                "it uses vertices, but the file has none".to_owned(),
            )),
            Some(&u32::MAX) => Err(self.malformed(
                &format!("{what} {number}"),
                "it uses a vertex of a negative or far too large number".to_owned(),
            )),
            Some(&index) => Err(SceneError::IndexOutOfRange {
                file: self.file.to_owned(),
                part: format!("a corner of {what} {number}"),
                index: index as usize,
                count,
                target: "vertices",
            }),
        }
    }

    fn warn_of_face_properties(&mut self, element: &Element) {
        for property in &element.properties {
            match property.name.as_str() {
                "texcoord" => self.notes.warn(
                    "texture coordinates of faces are not supported and were ignored; save them \
                     with the vertices"
                        .to_owned(),
                ),
                "red" => self.notes.warn(
                    "colours of faces are not supported and were ignored; save them with the \
                     vertices"
                        .to_owned(),
                ),
                _ => {}
            }
        }
    }

    fn malformed(&self, part: &str, reason: String) -> SceneError {
        SceneError::Malformed { file: self.file.to_owned(), part: part.to_owned(), reason }
    }
}

fn skip(element: &Element, source: &mut impl Source) -> Result<(), SceneError> {
    // Entries without properties take no bytes.
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        source.begin()?;
        for property in &element.properties {
            let count = match property.list_count {
                Some(list_count) => source.value(list_count)?,
                None => 1.0,
            };
            skip_items(count, property, source)?;
        }
    }
    Ok(())
}

fn skip_items(count: f64, property: &Property, source: &mut impl Source) -> Result<(), SceneError> {
    (0..whole(count)).try_for_each(|_| source.value(property.scalar).map(drop))
}

/// The length of a list: a negative value or NaN counts as zero.
fn whole(count: f64) -> u64 {
    count as u64
}

fn vertex_use(property: &Property) -> Use {
    if property.list_count.is_some() {
        return Use::Nothing;
    }
    match property.name.as_str() {
        "x" => Use::Position(0),
        "y" => Use::Position(1),
        "z" => Use::Position(2),
        "nx" | "normal_x" => Use::Normal(0),
        "ny" | "normal_y" => Use::Normal(1),
        "nz" | "normal_z" => Use::Normal(2),
        "u" | "s" | "texture_u" | "texcoord_u" => Use::Uv(0),
        "v" | "t" | "texture_v" | "texcoord_v" => Use::Uv(1),
        "red" | "r" | "diffuse_red" => Use::Color(0),
        "green" | "g" | "diffuse_green" => Use::Color(1),
        "blue" | "b" | "diffuse_blue" => Use::Color(2),
        "alpha" | "a" | "diffuse_alpha" => Use::Color(3),
        "rgb" | "rgba" if property.scalar.bytes() == 4 => Use::Packed(property.name == "rgba"),
        _ => Use::Nothing,
    }
}
