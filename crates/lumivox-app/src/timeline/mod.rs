//! Motion between the pictures of a sequence: time, the camera, the scene.

mod history;
mod moments;
mod path;
mod schedule;
mod spline;

pub use history::{History, history};
pub use moments::{MOST_PICTURES, Moments, TimeChoice, time};
pub use path::PathFile;
pub use schedule::{AnimationName, PictureTimes, Schedule, ScheduleOptions, animation, choose};

/// The latest time before or after 0, s: nearly three hours. Scenes are posed at `f32` times, which
/// still resolve milliseconds there.
pub const LATEST_S: f64 = 1e4;

/// The duration of an orbit in a scene without an animation, s.
pub const ORBIT_S: f64 = 4.0;
