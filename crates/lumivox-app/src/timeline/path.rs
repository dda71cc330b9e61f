//! A camera's path, as key frames in a JSON file.
//!
//! ```json
//! [
//!   { "time_s": 0, "position": [4, 1.7, 0], "target": [0, 1.5, 0], "fov_deg": 60 },
//!   { "time_s": 2.5, "camera": "balcony" },
//!   { "time_s": 4, "position": [-4, 1.7, 0], "target": [0, 1.5, 0] }
//! ]
//! ```
//!
//! Position and target are interpolated by a [`Spline`] each, so that the camera keeps looking at a
//! target that does not move; the field of view by a [`MonotoneCubic`], which stays within the
//! keys' values.

use std::io::Read as _;
use std::path::{Path as FilePath, PathBuf};

use glam::DVec3;
use lumivox_console::Failure;
use lumivox_scene::{Camera, Scene, check_regular};
use serde::{Deserialize, Serialize};

use super::spline::{MonotoneCubic, Spline};
use crate::args::camera::{CameraChoice, DEFAULT_FOV_DEG, fit_near, resolve};

/// The largest file, bytes: far above any real path, but fast to read.
const MOST_BYTES: u64 = 16 << 20;
const MOST_KEYS: usize = 10_000;
/// The least time between two keys, s.
const LEAST_STEP_S: f64 = 1e-6;
/// The farthest coordinate, m; its square does not overflow an f32.
const FARTHEST_M: f64 = 1e9;

/// The keys of a file, checked as far as possible without a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct PathFile {
    file: PathBuf,
    /// At least two keys, with increasing times.
    pub keys: Vec<Key>,
}

/// A key frame, as in the file.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// The time, s.
    pub time_s: f64,
    /// The eye in the world, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// A point at the centre of the picture, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<[f64; 3]>,
    /// A camera of the scene instead of position and target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<NameOrNumber>,
    /// Vertical field of view. Default: the camera's, else the previous key's, else 45.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov_deg: Option<f32>,
}

/// A camera's name or number in a file.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged)]
pub enum NameOrNumber {
    /// Its index, from 0.
    Number(usize),
    /// Its name.
    Name(String),
}

impl PathFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// A [`Failure`] of input that names the file, the key and a remedy.
    pub fn read(file: &FilePath) -> anyhow::Result<Self> {
        let fail = |what: String| Failure::input(format!("{}: {what}", file.display()));
        let unreadable = |error: std::io::Error| {
            fail(format!(
                "cannot read the camera path: {error}; check the path and its permissions"
            ))
        };
        check_regular(file).map_err(unreadable)?;
        let mut text = Vec::new();
        let opened = std::fs::File::open(file).map_err(unreadable)?;
        opened.take(MOST_BYTES + 1).read_to_end(&mut text).map_err(unreadable)?;
        if text.len() as u64 > MOST_BYTES {
            let most = MOST_BYTES >> 20;
            return Err(
                fail(format!("is above {most} MiB, which is too long for a camera path")).into()
            );
        }
        let keys = parse(&text).map_err(fail)?;
        Ok(Self { file: file.to_owned(), keys })
    }

    /// The time of the first key, s.
    pub fn start_s(&self) -> f64 {
        self.keys.first().map_or(0.0, |key| key.time_s)
    }

    /// The time of the last key, s.
    pub fn end_s(&self) -> f64 {
        self.keys.last().map_or(0.0, |key| key.time_s)
    }

    /// Resolves the path in a scene, whose cameras the keys may name.
    ///
    /// # Errors
    /// A [`Failure`] of input if there is no such camera.
    pub fn resolve(&self, scene: &Scene, aspect: f32) -> anyhow::Result<CameraPath> {
        let bounds = scene.bounds();
        let mut fov_deg = f64::from(DEFAULT_FOV_DEG);
        let (mut positions, mut targets) = (Vec::new(), Vec::new());
        let (mut ups, mut fovs) = (Vec::new(), Vec::new());
        for (number, key) in self.keys.iter().enumerate() {
            let camera = match (&key.camera, key.position, key.target) {
                (Some(named), ..) => {
                    let choice = match named {
                        NameOrNumber::Number(index) => CameraChoice::Index(*index),
                        NameOrNumber::Name(name) => CameraChoice::Name(name.clone()),
                    };
                    let camera = resolve(Some(&choice), scene, aspect).map_err(|error| {
                        let file = self.file.display();
                        Failure::input(format!("{file}: key {number}: {error}"))
                    })?;
                    fov_deg = f64::from(camera.vertical_fov_rad.to_degrees());
                    camera
                }
                (None, position, target) => {
                    let [position, target] = [position, target].map(Option::unwrap_or_default);
                    let [position, target] =
                        [position, target].map(|place| scene.from_file(DVec3::from_array(place)));
                    Camera::look_at(position, target, 1.0)
                }
            };
            fov_deg = key.fov_deg.map_or(fov_deg, f64::from);
            // A camera has no target: put it at the distance of the scene's radius.
            let target = match key.target {
                Some(target) if key.camera.is_none() => scene.from_file(DVec3::from_array(target)),
                _ => camera.position + camera.forward * bounds.radius_m(),
            };
            positions.push(camera.position.as_dvec3());
            targets.push(target.as_dvec3());
            ups.push(camera.up.as_dvec3());
            fovs.push(fov_deg);
        }
        let times: Vec<f64> = self.keys.iter().map(|key| key.time_s).collect();
        let spline = |points: &[DVec3]| Spline::new(&times, points);
        let (position, target, up) = (spline(&positions), spline(&targets), spline(&ups));
        let fov_deg = MonotoneCubic::new(&times, &fovs);
        Ok(CameraPath { position, target, up, fov_deg, radius_m: bounds.radius_m() })
    }
}

fn parse(text: &[u8]) -> Result<Vec<Key>, String> {
    const FORM: &str = "give a list of keys, such as \
        [{ \"time_s\": 0, \"position\": [4, 2, 0], \"target\": [0, 1, 0] }, ...]";
    // Some editors write a byte order mark, which JSON forbids.
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    if [b"\xff\xfe", b"\xfe\xff"].iter().any(|mark| text.starts_with(*mark)) {
        return Err("the camera path is text in UTF-16; save it as UTF-8".to_owned());
    }
    let values: Vec<serde_json::Value> = serde_json::from_slice(text).map_err(|error| {
        // JSON allows no slash outside strings, so this one starts a comment.
        let line = text.split(|&byte| byte == b'\n').nth(error.line().saturating_sub(1));
        let at = line.and_then(|line| line.get(error.column().saturating_sub(1)));
        if at == Some(&b'/') {
            let line = error.line();
            return format!(
                "line {line} of the camera path has a comment, which JSON forbids; remove all \
                 comments"
            );
        }
        format!("the camera path is malformed: {error}; {FORM}")
    })?;
    if values.len() < 2 || values.len() > MOST_KEYS {
        let count = values.len();
        return Err(format!("has {count} keys, but must have 2 to {MOST_KEYS}; {FORM}"));
    }
    let mut keys: Vec<Key> = Vec::with_capacity(values.len());
    for (number, value) in values.into_iter().enumerate() {
        let key: Key = serde_json::from_value(value)
            .map_err(|error| format!("key {number} is malformed: {error}; {FORM}"))?;
        check(&key).map_err(|reason| format!("key {number}: {reason}"))?;
        if let Some(before) = keys.last().filter(|before| before.time_s + LEAST_STEP_S > key.time_s)
        {
            return Err(format!(
                "key {number}: \"time_s\" is {}, but that of the key before is {}; put the keys \
                 in the order of time, each at a time of its own",
                key.time_s, before.time_s
            ));
        }
        keys.push(key);
    }
    Ok(keys)
}

fn check(key: &Key) -> Result<(), String> {
    if !key.time_s.is_finite() || key.time_s.abs() > super::LATEST_S {
        let (time_s, latest) = (key.time_s, super::LATEST_S);
        return Err(format!(
            "\"time_s\" is {time_s}, but must be from -{latest} to {latest} seconds"
        ));
    }
    if let Some(fov_deg) = key.fov_deg
        && !(1.0..=170.0).contains(&fov_deg)
    {
        return Err(format!("\"fov_deg\" is {fov_deg}, but must be from 1 to 170 degrees"));
    }
    for (name, point) in [("position", key.position), ("target", key.target)] {
        let near = |value: &f64| value.abs() <= FARTHEST_M;
        if point.is_some_and(|point| !point.iter().all(near)) {
            return Err(format!(
                "\"{name}\" is too far away; each of its numbers must be from -1e9 to 1e9 metres"
            ));
        }
    }
    match (&key.camera, key.position, key.target) {
        (Some(_), None, None) => Ok(()),
        (Some(_), ..) => Err("has a \"camera\" and a \"position\" or \"target\"; give either the \
                              camera or both of the others"
            .to_owned()),
        (None, Some(position), Some(target)) => {
            if (DVec3::from(target) - DVec3::from(position)).as_vec3().try_normalize().is_none() {
                return Err(
                    "\"position\" and \"target\" are the same point; move one of them".to_owned()
                );
            }
            Ok(())
        }
        (None, position, _) => {
            let missing = if position.is_none() { "position" } else { "target" };
            Err(format!(
                "\"{missing}\" is missing; give \"position\" and \"target\", or a \"camera\" of \
                 the scene"
            ))
        }
    }
}

/// A camera's path through a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    position: Spline,
    target: Spline,
    up: Spline,
    fov_deg: MonotoneCubic,
    /// The scene's radius.
    radius_m: f32,
}

impl CameraPath {
    /// The camera at a time; before the first key and after the last it does not move.
    pub fn at(&self, time_s: f64) -> Camera {
        let position = self.position.at(time_s).as_vec3();
        let target = self.target.at(time_s).as_vec3();
        let fov_rad = (self.fov_deg.at(time_s) as f32).to_radians();
        let mut camera = Camera::look_at(position, target, fov_rad);
        let up = self.up.at(time_s).as_vec3();
        // Position and target do not determine the roll; the up direction does.
        if let Some(up) = up.try_normalize().filter(|up| up.cross(camera.forward).length() > 1e-3) {
            camera.up = up;
        }
        "camera path".clone_into(&mut camera.name);
        fit_near(&mut camera, self.radius_m);
        camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn scene() -> Scene {
        lumivox_scene::builtin::scene("cornell").unwrap()
    }

    fn path(text: &str) -> Result<PathFile, String> {
        parse(text.as_bytes()).map(|keys| PathFile { file: "path.json".into(), keys })
    }

    #[test]
    fn the_path_passes_through_keys_at_their_times() {
        let text = r#"[
            { "time_s": -1, "position": [0, 0, 5], "target": [0, 0, 0], "fov_deg": 30 },
            { "time_s": 1, "camera": 0 },
            { "time_s": 2, "position": [0, 5, 0], "target": [0, 0, 0], "fov_deg": 90 }
        ]"#;
        let file = path(text).unwrap();
        assert_eq!((file.start_s(), file.end_s()), (-1.0, 2.0));
        let scene = scene();
        let path = file.resolve(&scene, 1.0).unwrap();
        let first = path.at(-7.0);
        assert!(first.position.distance(Vec3::new(0.0, 0.0, 5.0)) < 1e-5);
        assert!(first.forward.distance(Vec3::NEG_Z) < 1e-5);
        assert!((first.vertical_fov_rad.to_degrees() - 30.0).abs() < 1e-3);
        let known = &scene.cameras[0];
        let second = path.at(1.0);
        assert!(second.position.distance(known.position) < 1e-5);
        assert!(second.forward.distance(known.forward) < 1e-5);
        assert!((second.vertical_fov_rad - known.vertical_fov_rad).abs() < 1e-5);
        // Looking straight down, +y does not determine the roll.
        let last = path.at(2.0);
        assert!(last.forward.distance(Vec3::NEG_Y) < 1e-5);
        assert!(last.world_from_camera().is_finite());
        let between = path.at(1.5).vertical_fov_rad;
        assert!(between > known.vertical_fov_rad && between < last.vertical_fov_rad);
    }

    #[test]
    fn a_fixed_target_stays_centred_in_the_picture() {
        let text = r#"[
            { "time_s": 0, "position": [3, 1, 0], "target": [0, 1, 0] },
            { "time_s": 1, "position": [0, 2, 3], "target": [0, 1, 0] },
            { "time_s": 2, "position": [-3, 1, 0], "target": [0, 1, 0] }
        ]"#;
        let path = path(text).unwrap().resolve(&scene(), 1.0).unwrap();
        for step in 0..=20 {
            let camera = path.at(f64::from(step) * 0.1);
            let towards = (Vec3::Y - camera.position).normalize();
            assert!(camera.forward.distance(towards) < 1e-5);
        }
    }

    /// The target of a named camera is at the distance of the scene's radius, here the scene's
    /// centre.
    #[test]
    fn a_named_camera_has_a_target_in_the_scene() {
        let mut scene = scene();
        let (middle, radius_m) = (scene.bounds().center(), scene.bounds().radius_m());
        let aside = middle + Vec3::new(0.6, 0.0, 0.8) * radius_m;
        scene.cameras = vec![Camera::look_at(aside, middle, 0.8)];
        let [x, y, z] = middle.to_array();
        let text = format!(
            r#"[{{ "time_s": 0, "camera": 0 }},
                {{ "time_s": 1, "position": [-3, 1, 0], "target": [{x}, {y}, {z}] }}]"#
        );
        let path = path(&text).unwrap().resolve(&scene, 1.0).unwrap();
        for step in 0..=10 {
            let camera = path.at(f64::from(step) * 0.1);
            let towards = (middle - camera.position).normalize();
            assert!(camera.forward.distance(towards) < 1e-5, "{step}: {}", camera.forward);
        }
    }

    #[test]
    fn broken_files_name_the_key_and_the_remedy() {
        let good = r#"{ "time_s": 0, "position": [1, 0, 0], "target": [0, 0, 0] }"#;
        let with = |second: &str| format!("[{good}, {second}]");
        for (text, needles) in [
            (String::new(), ["malformed", "give a list"]),
            ("{}".to_owned(), ["malformed", "give a list"]),
            ("[1, 2".to_owned(), ["malformed", "give a list"]),
            (format!("[{good}]"), ["has 1 keys", "2 to 10000"]),
            (with("7"), ["key 1 is malformed", "give a list"]),
            (with(r#"{ "camera": 0 }"#), ["key 1 is malformed", "time_s"]),
            (with(r#"{ "time_s": 1, "camera": 0, "fov": 5 }"#), ["key 1", "unknown field `fov`"]),
            (with(r#"{ "time_s": 0, "camera": 0 }"#), ["key 1", "order of time"]),
            (with(r#"{ "time_s": -1, "camera": 0 }"#), ["key 1", "order of time"]),
            (with(r#"{ "time_s": 1e300, "camera": 0 }"#), ["key 1", "seconds"]),
            (with(r#"{ "time_s": 1 }"#), ["key 1", "\"position\" is missing"]),
            (with(r#"{ "time_s": 1, "position": [0, 0, 1] }"#), ["key 1", "\"target\" is missing"]),
            (
                with(r#"{ "time_s": 1, "position": [0, 0, 1], "camera": "a" }"#),
                ["key 1", "either the camera"],
            ),
            (
                with(r#"{ "time_s": 1, "position": [1, 1, 1], "target": [1, 1, 1] }"#),
                ["key 1", "same point"],
            ),
            (
                with(r#"{ "time_s": 1, "position": [1e30, 1, 1], "target": [1, 1, 1] }"#),
                ["key 1", "too far"],
            ),
            (with(r#"{ "time_s": 1, "camera": 0, "fov_deg": 180 }"#), ["key 1", "1 to 170"]),
            (with(r#"{ "time_s": 1, "camera": -1 }"#), ["key 1 is malformed", "give a list"]),
        ] {
            let error = path(&text).unwrap_err();
            assert!(needles.iter().all(|needle| error.contains(needle)), "{text}: {error}");
        }
        for text in [format!("// by hand\n[{good}]"), with("/* two */ 7")] {
            let error = path(&text).unwrap_err();
            assert!(error.contains("line 1 of the camera path has a comment"), "{error}");
        }
        let error = parse(b"\xff\xfe[\0]\0").unwrap_err();
        assert!(error.contains("UTF-16; save it as UTF-8"), "{error}");
        let text = with(r#"{ "time_s": 1, "camera": "nowhere" }"#);
        let error = path(&text).unwrap().resolve(&scene(), 1.0).unwrap_err().to_string();
        for needle in ["path.json", "key 1", "\"nowhere\"", "there are"] {
            assert!(error.contains(needle), "{error}");
        }
    }
}
