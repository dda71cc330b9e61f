//! Comparison of two picture files.

use std::path::Path;

use anyhow::Context as _;
use lumivox_console::{Comparison, Failure};
use lumivox_render::compare::{ErrorFigures, PictureFile};

use crate::cli::CompareArgs;
use crate::host::Host;
use crate::quality::{Row, strip, write_strip};

/// Compares two files, and reports.
///
/// # Errors
/// When a picture cannot be read, the two cannot be compared, or the strip cannot be written.
pub fn run(reference: &Path, ours: &Path, args: &CompareArgs, host: &Host) -> anyhow::Result<()> {
    let names = [reference, ours].map(|file| file.display().to_string());
    let read = |file| PictureFile::read(file, args.layer.as_deref());
    let (reference, ours) = (read(reference)?, read(ours)?);
    if args.layer.is_some() && reference.layer.is_none() && ours.layer.is_none() {
        let reason = format!("neither {} nor {} names its layers", names[0], names[1]);
        return Err(Failure::input(format!("{reason}; leave --layer out")).into());
    }
    let (reference, ours) = (&reference.picture, &ours.picture);
    let [reference_name, our_name] = names;
    let title = format!("{our_name} against {reference_name}");
    let failure = || format!("{title}: the two cannot be compared");
    let figures = ErrorFigures::new(reference, None, ours).with_context(failure)?;
    if let Some(file) = &args.output {
        let row = Row { label: "final", reference, ours, figures: &figures };
        write_strip(file, &strip(&title, &[row])?)?;
    }
    let comparison = Comparison {
        reference: Some(reference_name),
        ours: Some(our_name),
        size: reference.size.to_array(),
        final_picture: Some(figures),
        ..Comparison::default()
    };
    if args.json {
        return host.print_json(&comparison);
    }
    let [width, height] = comparison.size;
    let mut text = format!("{title}, {width}x{height}\n\n{}", comparison.table());
    if let Some(file) = &args.output {
        text += &format!("\n{}: reference, ours, error\n", file.display());
    }
    host.print(&text)
}
