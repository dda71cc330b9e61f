//! Sums of an unfinished reference, saved in a file.
//!
//! Little-endian: a magic number, the fingerprint of the traced scene, width, height, samples and
//! batches, all sums ([`super::film`]), and a checksum of everything before.

use glam::UVec2;

use super::film::{Film, Sums};

const MARK: &[u8; 8] = b"LUMIREF3";
const HEADER_BYTES: usize = 8 + 8 + 4 * 4;

/// The reason why tracing cannot continue from a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes are not a complete checkpoint.
    #[error("it is not a checkpoint of a reference, or it is damaged; delete it and start again")]
    Damaged,
    /// The picture of the checkpoint has another size.
    #[error(
        "it holds {} x {} pixels, but {} x {} were asked for; ask for that size, or start again",
        found.x, found.y, wanted.x, wanted.y
    )]
    Size {
        /// The checkpoint's size in pixels.
        found: UVec2,
        /// The size of the current picture.
        wanted: UVec2,
    },
    /// The scene, the camera, the seed or the limit of bounces has changed.
    #[error(
        "it is of another scene, camera, seed or number of bounces; trace the same again, or delete the file and start again"
    )]
    Other,
}

pub(super) fn write(film: &Film, fingerprint: u64) -> Vec<u8> {
    let mut bytes = MARK.to_vec();
    bytes.extend(fingerprint.to_le_bytes());
    for number in [film.size.x, film.size.y, film.samples, film.batches] {
        bytes.extend(number.to_le_bytes());
    }
    write_sums(&mut bytes, film);
    let checksum = fingerprint_of([&bytes[..]]);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

pub(super) fn read(bytes: &[u8], size: UVec2, fingerprint: u64) -> Result<Film, CheckpointError> {
    let (bytes, checksum) = bytes.split_last_chunk::<8>().ok_or(CheckpointError::Damaged)?;
    if bytes.len() < HEADER_BYTES
        || &bytes[..8] != MARK
        || fingerprint_of([bytes]) != u64::from_le_bytes(*checksum)
    {
        return Err(CheckpointError::Damaged);
    }
    let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[16 + 4 * at + i]));
    let found = UVec2::new(word(0), word(1));
    if found != size {
        return Err(CheckpointError::Size { found, wanted: size });
    }
    if bytes[8..16] != fingerprint.to_le_bytes() {
        return Err(CheckpointError::Other);
    }
    let mut film = read_sums(&bytes[HEADER_BYTES..], size).ok_or(CheckpointError::Damaged)?;
    (film.samples, film.batches) = (word(2), word(3));
    Ok(film)
}

/// Appends all sums of a film.
pub(super) fn write_sums(bytes: &mut Vec<u8>, film: &Film) {
    bytes.reserve(size_of_val(film.sums.as_slice()));
    for sum in bytemuck::cast_slice::<Sums, i128>(&film.sums) {
        bytes.extend(sum.to_le_bytes());
    }
}

/// The film of a size with these sums; `None` if their number does not match.
pub(super) fn read_sums(bytes: &[u8], size: UVec2) -> Option<Film> {
    // Check before allocating for a size that a damaged file claims.
    let expected = u128::from(size.x) * u128::from(size.y) * size_of::<Sums>() as u128;
    if bytes.len() as u128 != expected {
        return None;
    }
    let mut film = Film::new(size);
    let sums = bytemuck::cast_slice_mut::<Sums, i128>(&mut film.sums).iter_mut();
    for (sum, bytes) in sums.zip(bytes.chunks_exact(16)) {
        *sum = i128::from_le_bytes(std::array::from_fn(|i| bytes[i]));
    }
    Some(film)
}

/// FNV-1a (Fowler, Noll and Vo 1991) over 8 bytes at a time: it detects accidental differences, not
/// deliberate ones.
pub(super) fn fingerprint_of<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut mix =
        |word: u64| hash = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
    for part in parts {
        mix(part.len() as u64);
        for chunk in part.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            mix(u64::from_le_bytes(word));
        }
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checkpoints_round_trip_and_damaged_ones_are_refused() {
        let size = UVec2::new(3, 2);
        let mut film = Film::new(size);
        film.samples = 12;
        film.batches = 3;
        film.sums[4].full = [15, -20, i128::MAX];
        let bytes = write(&film, 77);
        assert_eq!(read(&bytes, size, 77), Ok(film));
        assert_eq!(read(&bytes, size, 78), Err(CheckpointError::Other));
        let wanted = UVec2::new(2, 3);
        assert_eq!(read(&bytes, wanted, 77), Err(CheckpointError::Size { found: size, wanted }));
        for cut in [0, 5, 20, bytes.len() - 1] {
            assert_eq!(read(&bytes[..cut], size, 77), Err(CheckpointError::Damaged));
        }
        for at in [0, 9, 17, 40, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 4;
            assert_eq!(read(&damaged, size, 77), Err(CheckpointError::Damaged), "{at}");
        }
    }
}
