//! The schedule of a rendering: poses of the scene and positions of the camera over time.

use std::cell::OnceCell;

use glam::{Mat4, Vec3};
use lumivox_console::Failure;
use lumivox_scene::{AnimationChoice, Bounds, Camera, Framing, Scene};

use super::path::CameraPath;
use super::{Moments, ORBIT_S, PathFile, TimeChoice};
use crate::args::Refused;
use crate::args::camera::{self, CameraChoice};

/// An animation on the command line.
#[derive(Clone, Debug, PartialEq)]
pub enum AnimationName {
    /// By its name, or else by its index from 0.
    Named(String),
    /// All animations at once.
    All,
    /// No animation: the scene stays as in its file.
    None,
}

/// Parses `NAME`, `NUMBER`, `all` or `none`.
pub fn animation(text: &str) -> Result<AnimationName, Refused> {
    match text {
        "" => Err(Refused::Malformed("expected a name, a number, all or none".to_owned())),
        "all" => Ok(AnimationName::All),
        "none" => Ok(AnimationName::None),
        name => Ok(AnimationName::Named(name.to_owned())),
    }
}

/// The options of the command line that concern motion.
#[derive(Clone, Copy, Debug)]
pub struct ScheduleOptions<'a> {
    pub time: Option<TimeChoice>,
    pub fps: f64,
    pub animation: Option<&'a AnimationName>,
    pub orbit_deg: Option<f32>,
    pub path: Option<&'a PathFile>,
    pub camera: Option<&'a CameraChoice>,
    /// `true` if the output can hold many pictures.
    pub is_sequence: bool,
    /// Width over height of the pictures.
    pub aspect: f32,
}

/// The times of the pictures.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureTimes {
    /// One picture of the scene as in its file.
    Rest,
    /// One picture at this time in seconds.
    At(f64),
    /// A sequence of pictures.
    Sequence(Moments),
}

/// The motion of the camera.
#[derive(Clone, Debug)]
enum CameraMotion {
    /// A camera of the scene, which may move.
    Scene(usize),
    /// A camera that does not move.
    Still(Camera),
    /// An orbit about the vertical line through a point.
    Orbit { start: Camera, pivot: Vec3, angle_rad: f64 },
    /// A path.
    Path(Box<CameraPath>),
}

/// The schedule of a rendering.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The times of the pictures.
    pub times: PictureTimes,
    /// The animation; `None` if the scene does not move.
    pub animation: Option<AnimationChoice>,
    eye: CameraMotion,
}

impl Schedule {
    /// Determines the schedule. `framing` caches the scene's survey, computed if needed.
    ///
    /// # Errors
    /// A [`Failure`] of input that names the contradictory options, or what the scene does not
    /// have.
    pub fn new(
        asked: &ScheduleOptions<'_>,
        scene: &Scene,
        framing: &OnceCell<Framing>,
    ) -> anyhow::Result<Self> {
        let known = scene.animations();
        let choice = choose(asked.animation, scene)?;
        let duration_s = match choice {
            Some(AnimationChoice::One(index)) => known.get(index).map(|a| a.duration_s),
            Some(AnimationChoice::All) => known.iter().map(|a| a.duration_s).reduce(f32::max),
            None => None,
        };
        let duration_s = duration_s.map(f64::from);
        let path_end_s = asked.path.map(PathFile::end_s);
        let end_s = path_end_s.into_iter().chain(duration_s).reduce(f64::max);
        let whole = |start: f64| match end_s {
            Some(end) => Ok(start..end),
            None if asked.orbit_deg.is_some() => Ok(start..start + ORBIT_S),
            None => Err(Failure::input(format!(
                "nothing moves in the scene \"{}\": it has no animation; add --orbit or \
                 --camera-path, or give one picture's file and no --time",
                scene.name
            ))),
        };
        let times = match asked.time {
            Some(TimeChoice::At(time_s)) => {
                if asked.orbit_deg.is_some() {
                    return Err(Failure::input(
                        "an orbit is a sequence; give --time START..END instead of one time",
                    )
                    .into());
                }
                // If the motion has no end, fail as a range does.
                if end_s.is_none() {
                    whole(0.0)?;
                }
                PictureTimes::At(time_s)
            }
            Some(TimeChoice::Range(start, Some(end))) => {
                whole(start)?;
                PictureTimes::Sequence(Moments::new(start..end, asked.fps)?)
            }
            Some(TimeChoice::Range(start, None)) => {
                PictureTimes::Sequence(Moments::new(whole(start)?, asked.fps)?)
            }
            None => match asked.path {
                Some(path) => {
                    PictureTimes::Sequence(Moments::new(path.start_s()..path.end_s(), asked.fps)?)
                }
                None if asked.orbit_deg.is_some() || asked.is_sequence => {
                    PictureTimes::Sequence(Moments::new(whole(0.0)?, asked.fps)?)
                }
                None if asked.animation.is_some() => PictureTimes::At(0.0),
                None => PictureTimes::Rest,
            },
        };
        let animation = if times == PictureTimes::Rest { None } else { choice };
        Ok(Self { times, animation, eye: eye(asked, scene, framing)? })
    }

    /// The time of the first picture, s.
    pub fn start_s(&self) -> f64 {
        match &self.times {
            PictureTimes::Rest => 0.0,
            PictureTimes::At(time_s) => *time_s,
            PictureTimes::Sequence(moments) => moments.time_s(0),
        }
    }

    /// Poses the scene for a time, if it moves.
    ///
    /// # Errors
    /// As [`Scene::pose`].
    pub fn pose(&self, scene: &mut Scene, time_s: f64) -> anyhow::Result<()> {
        if let Some(animation) = self.animation {
            scene.pose(animation, time_s as f32)?;
        }
        Ok(())
    }

    /// The box around all poses of the scene, for a grid that neither clips the motion nor moves,
    /// which would flicker. Leaves the scene in the last pose.
    ///
    /// # Errors
    /// As [`Scene::pose`].
    pub fn bounds(
        &self,
        scene: &mut Scene,
        tell: &mut dyn FnMut(u32, u32),
    ) -> anyhow::Result<Bounds> {
        let (PictureTimes::Sequence(moments), Some(_)) = (&self.times, self.animation) else {
            return Ok(scene.bounds());
        };
        let mut bounds = Bounds::EMPTY;
        for number in 0..moments.count {
            tell(number, moments.count);
            self.pose(scene, moments.time_s(number))?;
            bounds = bounds.union(scene.bounds());
        }
        Ok(bounds)
    }

    /// The camera at a time, when `share` of the sequence has passed. `scene` is posed for that
    /// time.
    pub fn camera(&self, scene: &Scene, time_s: f64, share: f64) -> Camera {
        match &self.eye {
            CameraMotion::Scene(index) => scene.cameras.get(*index).cloned().unwrap_or_default(),
            CameraMotion::Still(camera) => camera.clone(),
            CameraMotion::Orbit { start, pivot, angle_rad } => {
                orbit(start, *pivot, angle_rad * share)
            }
            CameraMotion::Path(path) => path.at(time_s),
        }
    }
}

/// The requested animation; by default the first, if any.
///
/// # Errors
/// A [`Failure`] of input that lists the animations.
pub fn choose(
    asked: Option<&AnimationName>,
    scene: &Scene,
) -> anyhow::Result<Option<AnimationChoice>> {
    let known = scene.animations();
    let unknown = |what: String| {
        let names: Vec<String> =
            known.iter().enumerate().map(|(i, a)| format!("{i} \"{}\"", a.name)).collect();
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Failure::input(format!("the scene \"{}\" has no {what}; there are: {names}", scene.name))
    };
    match asked {
        None if known.is_empty() => Ok(None),
        None => Ok(Some(AnimationChoice::One(0))),
        Some(AnimationName::None) => Ok(None),
        Some(AnimationName::All) if known.is_empty() => Err(unknown("animation".to_owned()).into()),
        Some(AnimationName::All) => Ok(Some(AnimationChoice::All)),
        Some(AnimationName::Named(name)) => {
            let by_number = || name.parse().ok().filter(|index| *index < known.len());
            let found = known.iter().position(|a| a.name == *name).or_else(by_number);
            let found = found.ok_or_else(|| unknown(format!("animation \"{name}\"")))?;
            Ok(Some(AnimationChoice::One(found)))
        }
    }
}

fn eye(
    asked: &ScheduleOptions<'_>,
    scene: &Scene,
    framing: &OnceCell<Framing>,
) -> anyhow::Result<CameraMotion> {
    if let Some(path) = asked.path {
        return Ok(CameraMotion::Path(Box::new(path.resolve(scene, asked.aspect)?)));
    }
    let start = camera::resolve_with(asked.camera, scene, asked.aspect, framing)?;
    if let Some(degrees) = asked.orbit_deg {
        let pivot = scene.bounds().center();
        let angle_rad = f64::from(degrees).to_radians();
        return Ok(CameraMotion::Orbit { start, pivot, angle_rad });
    }
    // Use the scene's camera by index: an animation may move it.
    let place = match asked.camera {
        Some(CameraChoice::LookAt { .. }) => None,
        _ => scene.cameras.iter().position(|camera| *camera == start),
    };
    Ok(place.map_or(CameraMotion::Still(start), CameraMotion::Scene))
}

/// The camera, rotated as a whole about the vertical line through `pivot`, counter-clockwise seen
/// from above.
fn orbit(start: &Camera, pivot: Vec3, angle_rad: f64) -> Camera {
    let turn = Mat4::from_rotation_y(angle_rad as f32);
    let arm = turn.transform_vector3(start.position - pivot);
    // Avoid rounding errors in a rotation of zero.
    let position = if angle_rad == 0.0 { start.position } else { pivot + arm };
    Camera {
        name: format!("orbit of {}", start.name),
        position,
        forward: turn.transform_vector3(start.forward),
        up: turn.transform_vector3(start.up),
        ..start.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(time: Option<TimeChoice>) -> ScheduleOptions<'static> {
        ScheduleOptions {
            time,
            fps: 10.0,
            animation: None,
            orbit_deg: None,
            path: None,
            camera: None,
            is_sequence: false,
            aspect: 1.5,
        }
    }

    fn scene() -> Scene {
        lumivox_scene::builtin::scene("cornell").unwrap()
    }

    #[test]
    fn an_orbit_circles_the_centre_of_the_scene() {
        let mut scene = scene();
        // A rolled camera stays rolled.
        scene.cameras[0].up = Vec3::new(0.6, 0.8, 0.0);
        let schedule = Schedule::new(
            &ScheduleOptions { orbit_deg: Some(360.0), ..asked(None) },
            &scene,
            &OnceCell::new(),
        )
        .unwrap();
        let PictureTimes::Sequence(moments) = &schedule.times else { panic!("a sequence") };
        assert_eq!(moments.count, 40);
        let start = &scene.cameras[0];
        let first = schedule.camera(&scene, 0.0, 0.0);
        assert_eq!((first.position, first.forward), (start.position, start.forward));
        let half = schedule.camera(&scene, 2.0, moments.share(20));
        let center = scene.bounds().center();
        let mirrored = 2.0 * center - start.position;
        assert!((half.position - mirrored.with_y(start.position.y)).length() < 1e-4);
        assert!(half.up.abs_diff_eq(Vec3::new(-0.6, 0.8, 0.0), 1e-6), "{}", half.up);
        let quarter = schedule.camera(&scene, 1.0, moments.share(10));
        let distance = |camera: &Camera| (camera.position - center).with_y(0.0).length();
        assert!((distance(&quarter) - distance(&first)).abs() < 1e-5);
        assert!((quarter.forward.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn conflicting_schedule_options_are_refused() {
        let scene = scene();
        let error = |asked: &ScheduleOptions<'_>| {
            Schedule::new(asked, &scene, &OnceCell::new()).unwrap_err().to_string()
        };
        let still = error(&asked(Some(TimeChoice::At(1.0))));
        assert!(still.contains("nothing moves") && still.contains("--orbit"), "{still}");
        let range = error(&asked(Some(TimeChoice::Range(0.0, Some(1.0)))));
        assert!(range.contains("nothing moves"), "{range}");
        let pattern = error(&ScheduleOptions { is_sequence: true, ..asked(None) });
        assert!(pattern.contains("nothing moves"), "{pattern}");
        let orbit = ScheduleOptions { orbit_deg: Some(90.0), ..asked(Some(TimeChoice::At(1.0))) };
        assert!(error(&orbit).contains("START..END"));
        let name = AnimationName::Named("walk".to_owned());
        let unknown = error(&ScheduleOptions { animation: Some(&name), ..asked(None) });
        assert!(unknown.contains("\"walk\"") && unknown.contains("none"), "{unknown}");
        let all = error(&ScheduleOptions { animation: Some(&AnimationName::All), ..asked(None) });
        assert!(all.contains("no animation"), "{all}");
    }

    #[test]
    fn without_options_one_picture_at_rest_is_scheduled() {
        let scene = scene();
        let schedule = Schedule::new(&asked(None), &scene, &OnceCell::new()).unwrap();
        assert_eq!(schedule.times, PictureTimes::Rest);
        assert!(schedule.animation.is_none());
        assert_eq!(schedule.camera(&scene, 0.0, 0.0), scene.cameras[0]);
    }
}
