//! STL as text: `solid`, facets of one loop of vertices each, `endsolid`; in any case and with any
//! line breaks.

use std::io::BufRead;

use glam::Vec3;

use super::{MOST_SOLIDS, Reading, Solid};
use crate::SceneError;
use crate::load::polygon::Cutter;
use crate::load::text::{Lines, keyword, numbers, readable, words};

impl Reading<'_> {
    pub(super) fn ascii(&mut self, reader: impl BufRead) -> Result<Vec<Solid>, SceneError> {
        let mut lines = Lines::new(self.file, reader, 0);
        let mut solids: Vec<Solid> = Vec::new();
        let mut cutter = Cutter::default();
        let mut facet: Vec<Vec3> = Vec::new();
        // Whether a facet, and a solid, have begun and not ended.
        let (mut in_facet, mut in_solid) = (false, false);
        while lines.advance()? {
            let (first, name) = keyword(lines.line());
            if first.eq_ignore_ascii_case(b"solid") {
                if solids.len() < MOST_SOLIDS {
                    solids.push(Solid { name: readable(name), corners: Vec::new() });
                } else {
                    self.notes.warn(format!("solids after the {MOST_SOLIDS}th were joined"));
                }
                in_solid = true;
                continue;
            }
            if first.eq_ignore_ascii_case(b"endsolid") {
                in_solid = false;
                continue;
            }
            let mut words = words(lines.line());
            while let Some(word) = words.next() {
                let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
                if is("facet") {
                    in_facet = true;
                    facet.clear();
                } else if is("vertex") {
                    let position =
                        numbers::<3>(&mut words).map_err(|reason| lines.malformed(reason))?;
                    let position = Vec3::from_array(position);
                    if !position.is_finite() {
                        let part = format!("line {}", lines.number());
                        return Err(SceneError::NotFinite { file: self.file.to_owned(), part });
                    }
                    facet.push(position);
                } else if is("endfacet") {
                    in_facet = false;
                    let Some(solid) = solids.last_mut() else {
                        return Err(lines.malformed("a facet comes before the first \"solid\""));
                    };
                    if facet.len() < 3 {
                        let reason = format!("a facet ends with {} vertices", facet.len());
                        return Err(lines.malformed(reason));
                    }
                    let triangles = cutter.cut(&facet);
                    self.budget.spend(
                        || format!("the facet of line {}", lines.number()),
                        triangles.len(),
                        triangles.len(),
                        false,
                    )?;
                    solid.corners.extend(triangles.iter().map(|&i| facet[i as usize]));
                } else if is("endsolid") {
                    in_solid = false;
                    break;
                } else if is("color") {
                    self.notes.warn("the colours of its facets were ignored".to_owned());
                    break;
                } else if is("normal") {
                    // The winding gives it, too.
                    for _ in 0..3 {
                        words.next();
                    }
                } else if !(is("outer") || is("loop") || is("endloop")) {
                    let reason = format!("\"{}\" is not a word of STL", readable(word));
                    return Err(lines.malformed(reason));
                }
            }
        }
        if in_facet {
            return Err(lines.malformed("the file ends in the middle of a facet, it was cut off"));
        }
        if in_solid {
            self.notes.warn("\"endsolid\" is missing at the end, maybe more is".to_owned());
        }
        Ok(solids)
    }
}
