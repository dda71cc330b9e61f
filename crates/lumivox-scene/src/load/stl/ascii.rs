//! STL as text: `solid`, facets of one loop of vertices each, `endsolid`; in any case and with any
//! line breaks.

use std::io::BufRead;

use glam::{DVec3, Vec3};

use super::{MOST_SOLIDS, Reading, Solid};
use crate::SceneError;
use crate::load::polygon::Cutter;
use crate::load::text::{Lines, keyword, number, readable, words};

impl Reading<'_> {
    pub(super) fn ascii(&mut self, reader: impl BufRead) -> Result<Vec<Solid>, SceneError> {
        let mut lines = Lines::new(self.file, reader, 0);
        let mut solids: Vec<Solid> = Vec::new();
        let mut cutter = Cutter::default();
        let (mut facet, mut exact): (Vec<Vec3>, Vec<DVec3>) = Default::default();
        // Whether a facet or a solid is open.
        let (mut in_facet, mut in_solid) = (false, false);
        // A vertex, and the number of its coordinates, or a normal's, that are still missing.
        let (mut place, mut missing, mut in_normal) = ([0.0; 3], 0, 0);
        while lines.advance()? {
            let (first, rest) = keyword(lines.line());
            let mut text = lines.line();
            if first.eq_ignore_ascii_case(b"solid") {
                // The whole file may be one line.
                let (name, facets) = rest.split_at(first_facet(rest).unwrap_or(rest.len()));
                text = facets;
                in_solid = true;
                if solids.len() < MOST_SOLIDS {
                    let name = readable(name.trim_ascii());
                    solids.push(Solid { name, corners: Vec::new() });
                } else {
                    self.notes.warn(format!("solids after the {MOST_SOLIDS}th were joined"));
                }
            }
            let mut words = words(text);
            while let Some(word) = words.next() {
                if missing > 0 {
                    place[3 - missing] = number(word).ok_or_else(|| {
                        lines.malformed(format!("\"{}\" is not a number", readable(word)))
                    })?;
                    missing -= 1;
                    if missing == 0 {
                        exact.push(DVec3::from_array(place));
                    }
                    continue;
                }
                // Ignores the normal, which the winding gives.
                if in_normal > 0 && !word.eq_ignore_ascii_case(b"outer") {
                    in_normal -= 1;
                    continue;
                }
                in_normal = 0;
                // Some programs write "end facet" for "endfacet".
                let (ends, word) = match word.split_at_checked(3) {
                    Some((start, rest)) if start.eq_ignore_ascii_case(b"end") => (
                        true,
                        if rest.is_empty() { words.next().unwrap_or_default() } else { rest },
                    ),
                    _ => (false, word),
                };
                let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
                if is("facet") && !ends {
                    in_facet = true;
                    facet.clear();
                    exact.clear();
                } else if is("vertex") && !ends {
                    missing = 3;
                } else if is("facet") {
                    in_facet = false;
                    if exact.len() < 3 {
                        let reason = format!("a facet ends with {} vertices", exact.len());
                        return Err(lines.malformed(reason));
                    }
                    facet.extend(exact.iter().map(|place| (*place - exact[0]).as_vec3()));
                    let triangles = cutter.cut(&facet);
                    self.budget.spend(
                        || format!("the facet of line {}", lines.number()),
                        triangles.len(),
                        triangles.len(),
                        false,
                    )?;
                    if solids.is_empty() {
                        solids.push(Solid { name: String::new(), corners: Vec::new() });
                    }
                    let last = solids.len() - 1;
                    let places = triangles.iter().map(|&i| self.rest.place(exact[i as usize]));
                    solids[last].corners.extend(places);
                } else if is("solid") && ends {
                    in_solid = false;
                    break;
                } else if is("color") && !ends {
                    self.notes.warn("the colours of its facets were ignored".to_owned());
                    break;
                } else if is("normal") && !ends {
                    in_normal = 3;
                } else if !in_solid && !in_facet {
                    // A comment outside the solids.
                    break;
                } else if !(is("loop") || (is("outer") && !ends)) {
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

/// The first facet of a line, recognised by the numbers of its normal: a solid's name may contain
/// the words "facet normal", too.
fn first_facet(line: &[u8]) -> Option<usize> {
    const BEGIN: &[u8] = b"facet normal";
    let begins = line.windows(BEGIN.len()).enumerate();
    let mut begins = begins.filter(|(_, at)| at.eq_ignore_ascii_case(BEGIN)).map(|(at, _)| at);
    begins.find(|at| {
        let mut after = words(&line[at + BEGIN.len()..]);
        after.next().is_some_and(|word| number::<f64>(word).is_some())
            || after.nth(2).is_some_and(|word| word.eq_ignore_ascii_case(b"outer"))
    })
}
