//! Options for motion, and for the pictures taken of it.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;

use crate::args::number;
use crate::timeline::{self, AnimationName, History, TimeChoice};

/// Motion of the scene and the camera. With it, a rendering can be a sequence of pictures.
#[derive(Args, Debug)]
#[command(next_help_heading = "Sequence")]
pub struct TimelineArgs {
    /// One time in seconds, or a sequence from START to just before END [default: the whole motion
    /// if the output is a sequence; else the scene as its file shows it]
    ///
    /// Times are from -10000 to 10000. END itself is left out, so that a motion that ends as it
    /// began can loop. START.. ends with the animation or the camera's path; an orbit without
    /// either takes 4 seconds.
    #[arg(long, value_name = "SECONDS|START..END", value_parser = timeline::time)]
    #[arg(allow_hyphen_values = true)]
    pub time: Option<TimeChoice>,

    /// Pictures per second, a number from 0.001 to 1000
    #[arg(long, value_name = "NUMBER", value_parser = number::number(0.001..=1000.0))]
    #[arg(default_value = "24", allow_negative_numbers = true)]
    pub fps: f32,

    /// The animation to show: its name or number, all at once, or none [default: the first]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists them. An animation starts at 0 s; before
    /// its first key and after its last the scene does not move.
    #[arg(long, value_name = "NAME|NUMBER|all|none", value_parser = timeline::animation)]
    pub animation: Option<AnimationName>,

    /// Render only these pictures of the sequence, from A to before B, numbers from 0 to 1000000
    /// [default: all]
    ///
    /// For many machines, of which each renders a range: exposure and grid are those of the whole
    /// sequence, so the pictures have the bits of one machine. A range has an index of its own.
    #[arg(long, value_name = "A..B", value_parser = number::range(timeline::MOST_PICTURES))]
    #[arg(allow_hyphen_values = true)]
    pub pictures: Option<Range<u32>>,

    /// Orbit the camera about the centre of the scene by this many degrees, -36000 to 36000
    /// [default: none]
    ///
    /// 360 is one full orbit, counter-clockwise seen from above; it starts at the camera of
    /// --camera.
    #[arg(long, value_name = "DEGREES", value_parser = number::number(-36_000.0..=36_000.0))]
    #[arg(allow_hyphen_values = true, conflicts_with = "camera_path")]
    pub orbit: Option<f32>,

    /// Move the camera along the key frames of a JSON file [default: none]
    ///
    /// A list of at least two keys in order of time, each with `time_s` in seconds, `position` and
    /// `target` in metres (or `camera`, a camera's name or number) and optionally `fov_deg`, the
    /// vertical field of view. Between them the camera moves smoothly.
    #[arg(long, value_name = "FILE", conflicts_with = "camera")]
    pub camera_path: Option<PathBuf>,

    /// Whether pictures of a sequence take over light of those before them, where the settings keep
    /// any (--temporal, --preset realtime)
    ///
    /// `kept` gives a film as the window shows it: one renderer, in which things and camera move,
    /// and --frames frames for each picture. A sequence that was stopped then begins again at its
    /// first picture to get there, and leaves the existing ones as they are. `none` gives pictures
    /// of --frames frames of their own. Without light of earlier frames there is no difference.
    #[arg(long, value_parser = timeline::history(), default_value = "kept")]
    pub history: History,

    /// Render all pictures of a sequence again [default: off, existing ones stay]
    ///
    /// Needed if a setting has changed since the others were rendered. The pictures that the index
    /// lists are removed first.
    #[arg(long)]
    pub restart: bool,
}
