//! Statements of MTL that name an image: options, then the file. Some programs write options after
//! the file, or nonstandard options.

use glam::{Affine2, Vec2};

use crate::load::text::{keyword, number, readable};
use crate::{Texture, TextureRef, Wrap};

/// An image and its use.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The file, in any encoding.
    pub(super) file: Vec<u8>,
    /// `-s`: factor of texture coordinates. Default: one.
    pub(super) scale: Vec2,
    /// `-o`: offset, added after the scale. Default: zero.
    pub(super) offset: Vec2,
    /// `-bm`: the strength of bumps. Default: 1.
    pub(super) bump: f32,
    /// `-clamp`: `true` if the image does not repeat. Default: no.
    pub(super) clamp: bool,
    /// `-imfchan`: the channel of the image that is used if one number is needed.
    pub(super) channel: Channel,
}

/// The channel from which a single number is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Channel {
    /// Not given: luminance; for opacities, alpha if the image has any.
    #[default]
    Unsaid,
    Red,
    Green,
    Blue,
    Alpha,
    Luminance,
}

impl Map {
    /// Reads the line after the keyword; also returns the ignored options. `None` if no file is
    /// named. If several names are possible, the longest one for which `exists` is true is used.
    pub(super) fn parse(
        rest: &[u8],
        exists: &dyn Fn(&[u8]) -> bool,
    ) -> Option<(Self, Vec<String>)> {
        let mut map = Self {
            file: Vec::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            bump: 1.0,
            clamp: false,
            channel: Channel::Unsaid,
        };
        let mut ignored = Vec::new();
        let rest = map.options(rest, &mut ignored);
        let (before, name, behind) = name_in(rest, exists);
        map.file = name.to_vec();
        // Each part gets a dummy name at its end; otherwise a last number would count as the name.
        for others in [before, behind] {
            let line = [others, b" ."].concat();
            let mut left = map.options(&line, &mut ignored);
            while !left.is_empty() && left != b"." {
                let (word, after) = keyword(left);
                if word.starts_with(b"-") {
                    ignored.push(readable(word));
                }
                left = map.options(after, &mut ignored);
            }
        }
        let finite = map.scale.is_finite() && map.offset.is_finite() && map.bump.is_finite();
        if !finite {
            (map.scale, map.offset, map.bump) = (Vec2::ONE, Vec2::ZERO, 1.0);
            ignored.push("a number that is not finite".to_owned());
        }
        (!map.file.is_empty()).then_some((map, ignored))
    }

    /// Reads the options at the start of a line, and returns the rest.
    fn options<'t>(&mut self, mut rest: &'t [u8], ignored: &mut Vec<String>) -> &'t [u8] {
        while rest.starts_with(b"-") {
            let (option, mut after) = keyword(rest);
            match option {
                b"-s" => self.scale = vector(&mut after, 1.0),
                b"-o" => self.offset = vector(&mut after, 0.0),
                b"-bm" => self.bump = values(&mut after, 1).first().copied().unwrap_or(1.0),
                b"-clamp" => self.clamp = word(&mut after).eq_ignore_ascii_case(b"on"),
                b"-imfchan" => {
                    self.channel = match word(&mut after) {
                        b"r" => Channel::Red,
                        b"g" => Channel::Green,
                        b"b" => Channel::Blue,
                        b"m" => Channel::Alpha,
                        b"l" => Channel::Luminance,
                        _ => Channel::Unsaid,
                    };
                }
                b"-t" | b"-mm" | b"-boost" | b"-texres" => {
                    let most = if option == b"-t" { 3 } else { 2 };
                    let changes = values(&mut after, most);
                    // Exporters also write defaults, which need no warning.
                    let neutral = match option {
                        b"-t" => changes.iter().all(|&value| value == 0.0),
                        b"-mm" => changes == [0.0, 1.0],
                        _ => false,
                    };
                    if !neutral {
                        ignored.push(readable(option));
                    }
                }
                b"-blendu" | b"-blendv" | b"-cc" | b"-type" => {
                    let value = word(&mut after);
                    let neutral = match option {
                        b"-cc" => value == b"off",
                        b"-type" => false,
                        _ => value == b"on",
                    };
                    if !neutral {
                        ignored.push(readable(option));
                    }
                }
                // A name that begins with a hyphen.
                _ => break,
            }
            rest = after;
        }
        rest
    }

    /// The texture with this statement's options.
    pub(super) fn reference(&self, texture: usize) -> TextureRef {
        // OBJ's v grows upwards: v' = 1 - (s (1 - v) + o).
        let (s, o) = (self.scale, self.offset);
        let transform = Affine2::from_cols(
            Vec2::new(s.x, 0.0),
            Vec2::new(0.0, s.y),
            Vec2::new(o.x, 1.0 - s.y - o.y),
        );
        TextureRef { transform, ..TextureRef::new(texture) }
    }

    /// Whether both have the same coordinates on a surface, so that one image can contain both.
    pub(super) fn lies_like(&self, other: &Self) -> bool {
        (self.scale, self.offset, self.clamp) == (other.scale, other.offset, other.clamp)
    }

    pub(super) fn set_sampler(&self, texture: &mut Texture) {
        if self.clamp {
            texture.sampler.wrap_u = Wrap::ClampToEdge;
            texture.sampler.wrap_v = Wrap::ClampToEdge;
        }
    }
}

/// The most positions that are tried as the start of a name, and as the end.
const MOST_TRIED: usize = 8;

/// Splits the rest of a line around the file's name: the longest that exists, else everything up to
/// the next option.
fn name_in<'t>(rest: &'t [u8], exists: &dyn Fn(&[u8]) -> bool) -> (&'t [u8], &'t [u8], &'t [u8]) {
    let begins = |at: usize| at == 0 || rest[at - 1].is_ascii_whitespace();
    let words: Vec<usize> =
        (0..rest.len()).filter(|&at| begins(at) && !rest[at].is_ascii_whitespace()).collect();
    // Values of an unknown option come before the name.
    let starts = if rest.starts_with(b"-") { MOST_TRIED } else { 1 };
    let begins_option = |at: usize| {
        at > 0 && rest[at] == b'-' && rest.get(at + 1).is_some_and(u8::is_ascii_alphabetic)
    };
    let options = words.iter().copied().filter(|&at| begins_option(at));
    let ends: Vec<usize> = options.take(MOST_TRIED).chain([rest.len()]).collect();
    let name =
        |start: usize, end: usize| (&rest[..start], rest[start..end].trim_ascii(), &rest[end..]);
    if starts > 1 || ends.len() > 1 {
        for &start in words.iter().take(starts) {
            for &end in ends.iter().rev().filter(|&&end| end > start) {
                if exists(rest[start..end].trim_ascii()) {
                    return name(start, end);
                }
            }
        }
    }
    name(0, ends[0])
}

/// Takes the next word.
fn word<'t>(rest: &mut &'t [u8]) -> &'t [u8] {
    let (word, after) = keyword(rest);
    *rest = after;
    word
}

/// Takes up to `most` numbers.
fn values(rest: &mut &[u8], most: usize) -> Vec<f32> {
    let mut values = Vec::new();
    while values.len() < most {
        let (word, after) = keyword(rest);
        // A file's name can be a number: the last word is always the name.
        let Some(value) = number(word).filter(|_| !after.is_empty()) else { break };
        values.push(value);
        *rest = after;
    }
    values
}

/// Takes `u [v [w]]`; w is for solid textures.
fn vector(rest: &mut &[u8], default: f32) -> Vec2 {
    let values = values(rest, 3);
    let at = |i: usize| values.get(i).copied().unwrap_or(default);
    Vec2::new(at(0), at(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parses a statement whose file does not exist.
    fn parse(rest: &[u8]) -> Option<(Map, Vec<String>)> {
        Map::parse(rest, &|_| false)
    }

    #[test]
    fn existing_files_disambiguate_names_from_options() {
        let exists = |name: &[u8]| [&b"my wood - dark.png"[..], b"a.png", b"7"].contains(&name);
        let parse = |rest| Map::parse(rest, &exists).unwrap();
        for (line, file, ignored) in [
            (&b"a.png -s 2 2 1"[..], &b"a.png"[..], &[] as &[&str]),
            (b"-clamp on a.png -s 2 2 -bm 0.5", b"a.png", &[]),
            (b"my wood - dark.png", b"my wood - dark.png", &[]),
            (b"my wood - dark.png -s 2 2", b"my wood - dark.png", &[]),
            (b"-rotate 90 -s 2 2 1 a.png", b"a.png", &["-rotate"]),
            (b"-rotate 90 a.png -s 2 2 -flip", b"a.png", &["-rotate", "-flip"]),
            (b"gone.png -s 2 2 1", b"gone.png", &[]),
            (b"a.png -s 2 2 -clamp", b"a.png", &[]),
            (b"a.png -s 2 2 -imfchan", b"a.png", &[]),
            (b"a.png -s 2 2 -bm", b"a.png", &[]),
            (b"7 -s 2 2", b"7", &[]),
        ] {
            let (map, others) = parse(line);
            assert_eq!(map.file, file);
            assert_eq!(others, ignored);
            let scaled = line.windows(2).any(|pair| pair == b"-s");
            assert_eq!(map.scale, if scaled { Vec2::splat(2.0) } else { Vec2::ONE });
        }
    }

    #[test]
    fn options_and_names_with_spaces() {
        let (map, ignored) =
            parse(b"-s 2 3 1 -o 0.5 0.25 -bm 0.3 -clamp on -imfchan g my wood.png").unwrap();
        assert_eq!(map.file, b"my wood.png");
        assert_eq!((map.scale, map.offset), (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.25)));
        assert_eq!((map.bump, map.clamp, map.channel), (0.3, true, Channel::Green));
        assert!(ignored.is_empty());

        let (map, ignored) = parse(b"-s 2 -t 0 0 0 -mm 0 1 -boost 3 -blendu off 7").unwrap();
        assert_eq!((map.file.as_slice(), map.scale), (&b"7"[..], Vec2::new(2.0, 1.0)));
        assert_eq!(ignored, ["-boost", "-blendu"]);

        assert_eq!(parse(b"-odd.png").unwrap().0.file, b"-odd.png");
        assert!(parse(b"").is_none());
        assert!(parse(b"-clamp on").is_none());
        assert_eq!(parse(b"-s nan 1 a.png").unwrap().0.scale, Vec2::ONE);
    }

    #[test]
    fn scale_and_offset_are_those_of_the_images_lower_left_corner() {
        let (map, _) = parse(b"-s 2 4 -o 0.25 0.125 a.png").unwrap();
        let transform = map.reference(3).transform;
        // In OBJ (0.5, 0.5) becomes (1.25, 2.125); here v is inverted.
        let moved = transform.transform_point2(Vec2::new(0.5, 1.0 - 0.5));
        assert!((moved - Vec2::new(1.25, 1.0 - 2.125)).length() < 1e-6, "{moved}");
        assert_eq!(parse(b"a.png").unwrap().0.reference(3), TextureRef::new(3));
    }
}
