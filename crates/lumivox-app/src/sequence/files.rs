//! The names of a sequence's files.

use std::ops::Range;
use std::path::{Path, PathBuf};

use lumivox_console::Failure;
use lumivox_render::ImageFormat;

use crate::args::output;
use crate::lock::Lock;

/// Minimum digits of the file numbers in a folder.
const LEAST_DIGITS: usize = 4;

/// The files of a sequence: `prefix`, a number and `suffix`, all in one folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameFiles {
    folder: PathBuf,
    prefix: String,
    suffix: String,
    digits: usize,
    /// `true` if the user named a folder, which may be created.
    is_folder: bool,
    /// The requested pictures; `None` for all.
    range: Option<Range<u32>>,
}

impl FrameFiles {
    /// Whether `output` is a file name with a `#`. If nothing moves, it names a single picture.
    pub fn is_pattern(output: &Path) -> bool {
        let name = output.file_name().unwrap_or_default().to_string_lossy();
        name.contains('#') && !ends_as_folder(output) && !output.is_dir()
    }

    /// Whether `output` names a sequence: a name with a `#`, or a folder. `is_asked`: `true` if
    /// other options request a sequence; then a name without an extension is a folder, too.
    pub fn is_meant(output: &Path, is_asked: bool) -> bool {
        let is_picture = ImageFormat::from_path(output).is_ok();
        let is_bare = output.extension().is_none();
        Self::is_pattern(output)
            || ends_as_folder(output)
            || (output.is_dir() && (is_asked || !is_picture))
            || (is_bare && is_asked)
    }

    /// Parses `output`: a folder, or a file with a run of `#` for the number.
    ///
    /// # Errors
    /// A [`Failure`] of input when it is neither, and
    /// [`lumivox_render::RenderError::UnknownFormat`].
    pub fn new(output: &Path) -> anyhow::Result<Self> {
        let name = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some(first) = name.find('#').filter(|_| Self::is_pattern(output)) else {
            if !Self::is_meant(output, true) {
                ImageFormat::from_path(output)?;
                let stem = output.with_extension("");
                let extension = output.extension().unwrap_or_default().display();
                return Err(Failure::input(format!(
                    "{}: a sequence is many pictures; give a folder, or a name with # for the \
                     digits of the number, such as {}_####.{extension}",
                    output.display(),
                    stem.display()
                ))
                .into());
            }
            return Ok(Self {
                folder: output.to_owned(),
                prefix: String::new(),
                suffix: ".png".to_owned(),
                digits: LEAST_DIGITS,
                is_folder: true,
                range: None,
            });
        };
        let digits = name[first..].chars().take_while(|c| *c == '#').count();
        let (prefix, suffix) = (&name[..first], &name[first + digits..]);
        if suffix.contains('#') {
            return Err(Failure::input(format!(
                "{}: the # for the digits of the number must stand together, once",
                output.display()
            ))
            .into());
        }
        ImageFormat::from_path(output)?;
        Ok(Self {
            folder: output.parent().map(Path::to_owned).unwrap_or_default(),
            prefix: prefix.to_owned(),
            suffix: suffix.to_owned(),
            digits,
            is_folder: false,
            range: None,
        })
    }

    /// Restricts the sequence to a range of pictures, which has its own index.
    #[must_use]
    pub fn of_range(self, range: Option<Range<u32>>) -> Self {
        Self { range, ..self }
    }

    /// The numbers of the requested pictures, of `count` in the sequence.
    ///
    /// # Errors
    /// A [`Failure`] of input when the range starts after the last picture.
    pub fn numbers(&self, count: u32) -> anyhow::Result<Range<u32>> {
        let Some(Range { start, end }) = self.range else { return Ok(0..count) };
        if start < count {
            return Ok(start..end.min(count));
        }
        Err(Failure::input(format!(
            "--pictures {start}..{end}: the sequence has {count} pictures, numbered from 0"
        ))
        .into())
    }

    /// Widens the numbers in a folder to fit `count` files; checks that a name with `#` has enough
    /// of them.
    ///
    /// # Errors
    /// A [`Failure`] of input when the name has too few `#`.
    pub fn fit(&mut self, count: u32) -> anyhow::Result<()> {
        let needed = count.saturating_sub(1).to_string().len();
        if self.is_folder {
            self.digits = self.digits.max(needed);
        } else if self.digits < needed {
            return Err(Failure::input(format!(
                "{count} pictures need numbers of {needed} digits, but the name \
                 \"{}\" has room for {}; write {} in it",
                self.pattern().display(),
                self.digits,
                "#".repeat(needed)
            ))
            .into());
        }
        Ok(())
    }

    /// Checks that files can be written in the folder. If it is missing, it is made with the first
    /// picture.
    ///
    /// # Errors
    /// A [`Failure`] of output that names the obstacle.
    pub fn check(&self) -> anyhow::Result<()> {
        if self.is_folder && !self.folder.exists() {
            return output::check_folder(&self.folder, &output::folder_of(&self.folder));
        }
        let pattern = self.pattern();
        output::check_folder(&pattern, &output::folder_of(&pattern))
    }

    /// Creates the folder if the user named one and it is missing.
    ///
    /// # Errors
    /// A [`Failure`] of output.
    pub fn make_folder(&self) -> anyhow::Result<()> {
        if self.is_folder && !self.folder.exists() {
            std::fs::create_dir(&self.folder).map_err(|error| {
                let folder = self.folder.display();
                Failure::output(format!("{folder}: cannot make the folder: {error}"))
            })?;
        }
        Ok(())
    }

    /// The name of a picture's file, without the folder.
    pub fn name(&self, number: u32) -> String {
        format!("{}{number:0width$}{}", self.prefix, self.suffix, width = self.digits)
    }

    /// The path of a picture's file.
    pub fn path(&self, number: u32) -> PathBuf {
        self.folder.join(self.name(number))
    }

    /// Whether the exposure affects the files; `OpenEXR` files store radiance.
    pub fn are_exposed(&self) -> bool {
        matches!(ImageFormat::from_path(&self.path(0)), Ok(ImageFormat::Png))
    }

    /// The path of the index.
    pub fn index(&self) -> PathBuf {
        let of_range = self.range.as_ref().map(|range| format!("_{}-{}", range.start, range.end));
        let stem = format!("{}index{}", self.prefix, of_range.unwrap_or_default());
        self.folder.join(Path::new(&stem).with_extension("json"))
    }

    /// Locks the sequence for this process.
    ///
    /// # Errors
    /// A [`Failure`] of output when another process renders it.
    pub fn lock(&self) -> Result<Lock, Failure> {
        Lock::take(&self.index(), "renders this sequence")
    }

    /// The pattern of all pictures' files, with # for the digits.
    pub fn pattern(&self) -> PathBuf {
        self.folder.join(format!("{}{}{}", self.prefix, "#".repeat(self.digits), self.suffix))
    }
}

/// Whether `output` ends in a slash, and so names a folder; `Path` ignores the slash.
fn ends_as_folder(output: &Path) -> bool {
    output.to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_patterns_are_distinguished_from_single_pictures() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["walk/", "a_##.png", "#.exr"] {
            assert!(FrameFiles::is_meant(Path::new(name), false), "{name}");
        }
        assert!(FrameFiles::is_meant(folder.path(), false));
        for name in ["a.png", "b/a.exr", "a.jpg"] {
            assert!(!FrameFiles::is_meant(Path::new(name), true), "{name}");
        }
        assert!(FrameFiles::is_pattern(Path::new("a_##.png")));
        let numbered = folder.path().join("take#2");
        std::fs::create_dir(&numbered).unwrap();
        for name in [Path::new("take#1/"), &numbered] {
            assert!(!FrameFiles::is_pattern(name) && FrameFiles::is_meant(name, false));
            assert_eq!(FrameFiles::new(name).unwrap().index(), name.join("index.json"));
        }
        // A bare name could be a picture's name without its extension.
        assert!(!FrameFiles::is_meant(Path::new("walk"), false));
        assert!(FrameFiles::is_meant(Path::new("walk"), true));
    }

    #[test]
    fn frame_numbers_get_as_many_digits_as_needed() {
        let mut files = FrameFiles::new(Path::new("out/walk")).unwrap();
        assert_eq!(files.path(7), Path::new("out/walk/0007.png"));
        assert_eq!(files.index(), Path::new("out/walk/index.json"));
        files.fit(20_000).unwrap();
        assert_eq!(files.name(7), "00007.png");
        let mut files = FrameFiles::new(Path::new("b/a_##_x.exr")).unwrap();
        assert_eq!(files.path(3), Path::new("b/a_03_x.exr"));
        assert_eq!(files.index(), Path::new("b/a_index.json"));
        assert_eq!(files.pattern(), Path::new("b/a_##_x.exr"));
        files.fit(100).unwrap();
        let error = files.fit(101).unwrap_err().to_string();
        assert!(error.contains("a_##_x.exr") && error.contains("write ###"), "{error}");
        assert_eq!(FrameFiles::new(Path::new("#.png")).unwrap().index(), Path::new("index.json"));
    }

    #[test]
    fn each_range_of_pictures_has_its_own_index() {
        let files = FrameFiles::new(Path::new("b/a_##.exr")).unwrap();
        assert_eq!(files.numbers(9).unwrap(), 0..9);
        let part = files.of_range(Some(6..12));
        assert_eq!(part.index(), Path::new("b/a_index_6-12.json"));
        assert_eq!(part.numbers(20).unwrap(), 6..12);
        assert_eq!(part.numbers(9).unwrap(), 6..9, "the last part may be shorter");
        let error = part.numbers(6).unwrap_err().to_string();
        assert!(error.contains("6..12") && error.contains("has 6 pictures"), "{error}");
    }

    #[test]
    fn file_names_without_a_valid_number_pattern_are_refused() {
        for (name, needle) in [
            ("a.png", "a_####.png"),
            ("a_#_#.png", "together"),
            ("a_##.jpg", ".exr"),
            ("a.jpg", ".exr"),
        ] {
            let error = FrameFiles::new(Path::new(name)).unwrap_err().to_string();
            assert!(error.contains(needle), "{name}: {error}");
        }
    }
}
