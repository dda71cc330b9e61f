//! Parts of a reference that several machines trace, and their sum.
//!
//! A part consists of numbered batches of samples. Since batches are added exactly (`film.rs`),
//! parts add up to the same bits as on one machine, in any order. A part that was traced twice
//! counts once. The file is little-endian: a magic number, the length of the maker's name and that
//! name, the fingerprint of the scene, the seed, the unit of radiance, width, height, the first
//! batch, samples, batches, all sums, and a checksum of everything before.

use std::ops::Range;

use glam::UVec2;

use super::checkpoint::{fingerprint_of, read_sums, write_sums};
use super::film::Film;
use super::{BATCH, MOST_EDGE, MOST_SAMPLES, PathTracer, ReferenceLayers};
use crate::describe;

const MARK: &[u8; 8] = b"LUMIPRT1";
/// The longest name of a maker, bytes.
const LONGEST_MAKER: usize = 1 << 12;

/// The reason why parts cannot be added up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// The bytes are not a complete part.
    #[error("it is not a part of a reference, or it is damaged; trace it again")]
    Damaged,
    /// The part ends within a batch.
    #[error("it has {samples} samples, which are no whole batches of {BATCH}; trace it to its end")]
    Unfinished {
        /// The samples of the part.
        samples: u32,
    },
    /// A part is of another scene, camera, size, seed or limit of bounces.
    #[error("it is of another scene, camera, size, seed or number of bounces than the first part")]
    Other,
    /// A part was made by another program, GPU or driver, which may round differently.
    #[error(
        "it was made by {found}, the first part by {first}; parts of a mix do not have the bits of one machine, but can \
         be added (--allow-mixed)"
    )]
    Mixed {
        /// The maker of the part.
        found: String,
        /// The maker of the first part.
        first: String,
    },
    /// Some of the part's batches are in another part.
    #[error(
        "its batches {found:?} are in part those of another part, {other:?}; leave one of the two out"
    )]
    Overlap {
        /// The batches of the part.
        found: Range<u32>,
        /// The batches of the other part.
        other: Range<u32>,
    },
    /// Two parts have the same batches, but different sums.
    #[error(
        "its batches {batches:?} are there already, with other sums; trace them again on the same machine"
    )]
    Differs {
        /// The batches of both parts.
        batches: Range<u32>,
    },
    /// Batches are missing between the added ones.
    #[error("the batches {batches:?} are missing; trace them with --batches {}..{}", batches.start, batches.end)]
    Missing {
        /// The missing batches.
        batches: Range<u32>,
    },
}

/// Some batches of a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferencePart {
    maker: String,
    fingerprint: u64,
    seed: u32,
    radiance_unit: f32,
    first_batch: u32,
    film: Film,
}

impl ReferencePart {
    pub(super) fn new(tracer: &PathTracer) -> Self {
        let gpu = describe(&tracer.gpu.adapter_info);
        let maker = format!("lumivox {} on {gpu}", env!("CARGO_PKG_VERSION"));
        Self {
            maker: maker.chars().take(LONGEST_MAKER / 4).collect(),
            fingerprint: tracer.uploaded.fingerprint,
            seed: tracer.settings.seed,
            radiance_unit: tracer.uploaded.radiance_unit,
            first_batch: tracer.settings.first_batch,
            film: tracer.film.clone(),
        }
    }

    /// The program, GPU and driver that made the part.
    pub fn maker(&self) -> &str {
        &self.maker
    }

    /// The numbers of the part's batches.
    pub fn batches(&self) -> Range<u32> {
        self.first_batch..self.first_batch + self.film.batches
    }

    /// The bytes of the part's file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MARK.to_vec();
        bytes.extend((self.maker.len() as u32).to_le_bytes());
        bytes.extend(self.maker.as_bytes());
        bytes.extend(self.fingerprint.to_le_bytes());
        let Film { size, samples, batches, .. } = self.film;
        let unit = self.radiance_unit.to_bits();
        for number in [self.seed, unit, size.x, size.y, self.first_batch, samples, batches] {
            bytes.extend(number.to_le_bytes());
        }
        write_sums(&mut bytes, &self.film);
        let checksum = fingerprint_of([&bytes[..]]);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// Parses the bytes of a part's file.
    ///
    /// # Errors
    /// [`PartError::Damaged`], and [`PartError::Unfinished`] for a part that ends within a batch.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PartError> {
        let part = Self::parse(bytes).ok_or(PartError::Damaged)?;
        let Film { samples, batches, .. } = part.film;
        let last = u64::from(part.first_batch) + u64::from(batches);
        if batches == 0 || last > u64::from(MOST_SAMPLES / BATCH) {
            return Err(PartError::Damaged);
        }
        if samples == batches * BATCH { Ok(part) } else { Err(PartError::Unfinished { samples }) }
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let (bytes, checksum) = bytes.split_last_chunk::<8>()?;
        if fingerprint_of([bytes]) != u64::from_le_bytes(*checksum) {
            return None;
        }
        let rest = bytes.strip_prefix(MARK)?;
        let (length, rest) = rest.split_first_chunk::<4>()?;
        let (maker, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let (fingerprint, mut rest) = rest.split_first_chunk::<8>()?;
        let mut word = || {
            let (word, after) = rest.split_first_chunk::<4>()?;
            rest = after;
            Some(u32::from_le_bytes(*word))
        };
        let (seed, unit) = (word()?, f32::from_bits(word()?));
        let size = UVec2::new(word()?, word()?);
        let (first_batch, samples, batches) = (word()?, word()?, word()?);
        if maker.len() > LONGEST_MAKER || size.min_element() == 0 || size.max_element() > MOST_EDGE
        {
            return None;
        }
        let mut film = read_sums(rest, size)?;
        (film.samples, film.batches) = (samples, batches);
        Some(Self {
            maker: String::from_utf8(maker.to_vec()).ok()?,
            fingerprint: u64::from_le_bytes(*fingerprint),
            seed,
            radiance_unit: unit,
            first_batch,
            film,
        })
    }
}

/// The sum of parts, which are added one by one, in any order.
#[derive(Clone, Debug, Default)]
pub struct ReferenceMerge {
    allows_mixed: bool,
    sum: Option<ReferencePart>,
    /// The batches of each part, with the checksum of its sums, sorted.
    added: Vec<(Range<u32>, u64)>,
}

impl ReferenceMerge {
    /// An empty sum. `allows_mixed` accepts parts of different programs, GPUs and drivers.
    pub fn new(allows_mixed: bool) -> Self {
        Self { allows_mixed, ..Self::default() }
    }

    /// Adds a part. A part that is already in the sum, with the same sums, counts once.
    ///
    /// # Errors
    /// [`PartError`] when it does not fit the others; the sum is then unchanged.
    pub fn add(&mut self, part: ReferencePart) -> Result<(), PartError> {
        let batches = part.batches();
        let sums = fingerprint_of([bytemuck::cast_slice(&part.film.sums)]);
        if let Some(first) = &self.sum {
            let of = |part: &ReferencePart| {
                let unit = part.radiance_unit.to_bits();
                (part.fingerprint, part.seed, unit, part.film.size)
            };
            if of(first) != of(&part) {
                return Err(PartError::Other);
            }
            if first.maker != part.maker && !self.allows_mixed {
                return Err(PartError::Mixed { found: part.maker, first: first.maker.clone() });
            }
        }
        for (other, other_sums) in &self.added {
            if *other == batches {
                let is_same = *other_sums == sums || self.allows_mixed;
                return if is_same { Ok(()) } else { Err(PartError::Differs { batches }) };
            }
            if other.start < batches.end && batches.start < other.end {
                return Err(PartError::Overlap { found: batches, other: other.clone() });
            }
        }
        match &mut self.sum {
            Some(sum) => sum.film.merge(&part.film),
            None => self.sum = Some(part),
        }
        self.added.push((batches, sums));
        self.added.sort_by_key(|(batches, _)| batches.start);
        Ok(())
    }

    /// The layers of all parts; `None` if there are none.
    ///
    /// # Errors
    /// [`PartError::Missing`] for the first missing batches, counted from batch 0.
    pub fn layers(&self) -> Result<Option<ReferenceLayers>, PartError> {
        let mut end = 0;
        for (batches, _) in &self.added {
            if batches.start > end {
                return Err(PartError::Missing { batches: end..batches.start });
            }
            end = batches.end;
        }
        let layers = |sum: &ReferencePart| {
            ReferenceLayers::new(&sum.film, sum.radiance_unit, sum.fingerprint)
        };
        Ok(self.sum.as_ref().map(layers))
    }

    /// The number of distinct parts.
    pub fn count(&self) -> usize {
        self.added.len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::records::PixelRecord;
    use super::*;

    fn part(batches: Range<u32>) -> ReferencePart {
        let mut film = Film::new(UVec2::new(2, 1));
        for batch in batches.clone() {
            let value = 1.0 / (batch + 3) as f32;
            let pixel = PixelRecord { picture: [value; 3], ..PixelRecord::default() };
            film.add(BATCH, &[(0, vec![pixel; 2])]);
        }
        ReferencePart {
            maker: "a test".to_owned(),
            fingerprint: 5,
            seed: 1,
            radiance_unit: 2.0,
            first_batch: batches.start,
            film,
        }
    }

    fn merged(parts: &[ReferencePart]) -> Result<ReferenceLayers, PartError> {
        let mut merge = ReferenceMerge::default();
        for part in parts {
            merge.add(part.clone())?;
        }
        merge.layers().map(|layers| layers.expect("parts"))
    }

    #[test]
    fn parts_merge_in_any_order_and_duplicates_count_once() {
        let whole = merged(&[part(0..9)]).expect("whole");
        assert_eq!(whole.samples, 144);
        let [a, b, c] = [part(0..2), part(2..3), part(3..9)];
        assert!(whole == merged(&[a.clone(), b.clone(), c.clone()]).expect("in order"));
        assert!(
            whole == merged(&[c.clone(), a.clone(), b.clone(), a.clone(), c]).expect("retried")
        );
    }

    #[test]
    fn gaps_overlaps_and_foreign_parts_are_refused() {
        let a = part(0..2);
        let refused = |other: ReferencePart| merged(&[a.clone(), other]).expect_err("refused");
        assert_eq!(refused(part(3..4)), PartError::Missing { batches: 2..3 });
        assert_eq!(merged(&[part(1..2)]), Err(PartError::Missing { batches: 0..1 }));
        assert_eq!(refused(part(1..4)), PartError::Overlap { found: 1..4, other: 0..2 });
        assert_eq!(refused(ReferencePart { seed: 2, ..part(2..3) }), PartError::Other);
        assert_eq!(refused(ReferencePart { fingerprint: 6, ..part(2..3) }), PartError::Other);
        let other = ReferencePart { maker: "another".to_owned(), ..part(2..3) };
        let text = refused(other.clone()).to_string();
        assert!(text.contains("another") && text.contains("--allow-mixed"), "{text}");
        let mut merge = ReferenceMerge::new(true);
        merge.add(a.clone()).and_then(|()| merge.add(other)).expect("a mix that is allowed");
        let mut changed = part(0..2);
        changed.film.sums[1].picture[0] += 1;
        assert_eq!(refused(changed), PartError::Differs { batches: 0..2 });
    }

    #[test]
    fn part_files_round_trip_and_damaged_ones_are_refused() {
        let part = part(4..6);
        let bytes = part.to_bytes();
        assert_eq!(ReferencePart::from_bytes(&bytes), Ok(part.clone()));
        for at in [0, 9, 20, 40, bytes.len() / 2, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 4;
            assert_eq!(ReferencePart::from_bytes(&damaged), Err(PartError::Damaged), "{at}");
            assert_eq!(ReferencePart::from_bytes(&bytes[..at]), Err(PartError::Damaged), "{at}");
        }
        let mut stopped = part;
        stopped.film.samples -= 3;
        let read = ReferencePart::from_bytes(&stopped.to_bytes());
        assert_eq!(read, Err(PartError::Unfinished { samples: 29 }));
    }
}
