//! The choice of a camera.

use std::cell::OnceCell;
use std::fmt;

use anyhow::bail;
use glam::DVec3;
use lumivox_scene::{Camera, Framing, Scene};

use super::Refused;
use super::number::{in_range, some};
use crate::Failure;

/// The name of the view that every scene has: see [`Scene::default_camera`].
pub const FRAMING: &str = "framing";
/// The name of that view from outside.
pub const OUTSIDE: &str = "outside";
/// The name of that view from inside.
pub const INSIDE: &str = "inside";

const FORM: &str = "six or seven numbers, PX,PY,PZ,TX,TY,TZ[,FOV]";
/// Vertical field of view of cameras that have none, degrees.
pub const DEFAULT_FOV_DEG: f32 = 45.0;

/// A camera as the command line names it.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraChoice {
    /// A camera of the scene, by its name.
    Name(String),
    /// A camera of the scene, by its index.
    Index(usize),
    /// A camera given by two points.
    LookAt {
        /// The eye, m, in the coordinates of the scene's file.
        position: DVec3,
        /// A point in the middle of the picture, m.
        target: DVec3,
        /// The angle between the bottom and the top of the picture.
        vertical_fov_rad: f32,
    },
}

impl fmt::Display for CameraChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::Index(index) => index.fmt(f),
            Self::LookAt { position: p, target: t, vertical_fov_rad } => {
                let fov_deg = vertical_fov_rad.to_degrees();
                write!(f, "{},{},{},{},{},{},{fov_deg}", p.x, p.y, p.z, t.x, t.y, t.z)
            }
        }
    }
}

/// A name, an index, or `PX,PY,PZ,TX,TY,TZ[,FOV_DEG]`.
pub fn camera(text: &str) -> Result<CameraChoice, Refused> {
    let text = text.trim();
    if text.is_empty() {
        return Err(Refused::Malformed("expected a name, an index or a position".to_owned()));
    }
    if let Ok(index) = text.parse() {
        return Ok(CameraChoice::Index(index));
    }
    let first = text.split(',').next().unwrap_or_default();
    if !text.contains(',') || first.trim().parse::<f32>().is_err() {
        return Ok(CameraChoice::Name(text.to_owned()));
    }
    let numbers = some(text, FORM)?;
    // Map coordinates need f64.
    let exact: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    let (Some(&[px, py, pz, tx, ty, tz]), Some(rest)) = (exact.first_chunk(), numbers.get(6..))
    else {
        let count = numbers.len();
        return Err(Refused::Malformed(format!("expected {FORM}; got {count} numbers")));
    };
    let fov_deg = match rest {
        [] => DEFAULT_FOV_DEG,
        [fov_deg] => in_range(*fov_deg, &(1.0..=170.0), "the field of view in degrees")?,
        _ => {
            let count = numbers.len();
            return Err(Refused::Malformed(format!("expected {FORM}; got {count} numbers")));
        }
    };
    let (position, target) = (DVec3::new(px, py, pz), DVec3::new(tx, ty, tz));
    // This also refuses distances too small or too large for f32.
    if (target - position).as_vec3().try_normalize().is_none() {
        return Err(Refused::OutOfRange(
            "the position and the target must be different points, and not too far apart"
                .to_owned(),
        ));
    }
    Ok(CameraChoice::LookAt { position, target, vertical_fov_rad: fov_deg.to_radians() })
}

/// The chosen camera. Without a choice it is the scene's first or, if there is none, the best view
/// for a picture of this aspect (width over height).
///
/// # Errors
/// When the scene has no such camera; the message lists its cameras.
pub fn resolve(
    choice: Option<&CameraChoice>,
    scene: &Scene,
    aspect: f32,
) -> anyhow::Result<Camera> {
    resolve_with(choice, scene, aspect, &OnceCell::new())
}

/// As [`resolve`], with a cell for the scene's survey, which is filled if needed.
///
/// # Errors
/// As [`resolve`].
pub fn resolve_with(
    choice: Option<&CameraChoice>,
    scene: &Scene,
    aspect: f32,
    framing: &OnceCell<Framing>,
) -> anyhow::Result<Camera> {
    let survey = || framing.get_or_init(|| Framing::of(scene));
    let framing = || survey().camera(aspect);
    let found = match choice {
        None => return Ok(scene.cameras.first().cloned().unwrap_or_else(framing)),
        Some(CameraChoice::LookAt { position, target, vertical_fov_rad }) => {
            let [position, target] = [*position, *target].map(|place| scene.from_file(place));
            let mut camera = Camera::look_at(position, target, *vertical_fov_rad);
            "command line".clone_into(&mut camera.name);
            fit_near(&mut camera, scene.bounds().radius_m());
            return Ok(camera);
        }
        Some(CameraChoice::Index(index)) => scene.cameras.get(*index).cloned(),
        Some(CameraChoice::Name(name)) => {
            let called = |name: &str| scene.cameras.iter().find(|camera| camera.name == name);
            let known = called(name).or_else(|| called(scene.name_on(name))).cloned();
            match (known, name.as_str()) {
                (Some(known), _) => Some(known),
                (None, FRAMING) => Some(framing()),
                (None, OUTSIDE) => Some(survey().outside(aspect)),
                (None, INSIDE) => return survey().inside(aspect).ok_or_else(|| no_inside(scene)),
                (None, _) => None,
            }
        }
    };
    if let Some(camera) = found {
        return Ok(camera);
    }
    let wanted = match choice {
        Some(CameraChoice::Index(index)) => format!("camera number {index}"),
        Some(CameraChoice::Name(name)) => format!("camera called \"{name}\""),
        _ => "such camera".to_owned(),
    };
    let known: Vec<String> = scene
        .cameras
        .iter()
        .enumerate()
        .map(|(index, camera)| format!("{index} \"{}\"", camera.name))
        .chain([format!("\"{FRAMING}\" (the view that shows the scene best)")])
        .chain([OUTSIDE, INSIDE].map(|name| format!("\"{name}\"")))
        .collect();
    bail!(Failure::input(format!(
        "the scene \"{}\" has no {wanted}; there are: {}; or use PX,PY,PZ,TX,TY,TZ",
        scene.name,
        known.join(", ")
    )))
}

fn no_inside(scene: &Scene) -> anyhow::Error {
    let name = &scene.name;
    let reason = format!("the scene \"{name}\" has no room inside for a camera");
    Failure::input(format!("{reason}; look at it from outside, or use PX,PY,PZ,TX,TY,TZ")).into()
}

/// Lowers the near plane for small scenes, so that they are not cut off.
pub fn fit_near(camera: &mut Camera, scene_radius_m: f32) {
    camera.near_m = camera.near_m.min(scene_radius_m * 1e-3).max(1e-6);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_names_indices_and_positions_are_distinguished() {
        assert_eq!(camera("front"), Ok(CameraChoice::Name("front".to_owned())));
        assert_eq!(camera("left, upper"), Ok(CameraChoice::Name("left, upper".to_owned())));
        assert_eq!(camera("2"), Ok(CameraChoice::Index(2)));
        let Ok(CameraChoice::LookAt { position, target, vertical_fov_rad }) =
            camera("1,2,3,-4,5e-1,6,90")
        else {
            panic!("seven numbers are a view")
        };
        assert_eq!(position, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(target, DVec3::new(-4.0, 0.5, 6.0));
        assert!((vertical_fov_rad - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!(matches!(camera("-1,2,3,4,5,6"), Ok(CameraChoice::LookAt { .. })));
    }

    #[test]
    fn impossible_views_are_refused() {
        for text in ["1,2,3,4,5,6,0", "1,2,3,4,5,6,180", "1,2,3,1,2,3", "nan,0,0,1,1,1"] {
            assert!(matches!(camera(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        assert!(matches!(camera("3e38,0,0,-3e38,0,0"), Err(Refused::OutOfRange(_))));
        for text in ["", " ", "1,2,3", "1,2,3,4,5", "1,2,3,4,5,6,7,8", "1,2,3,4,5,x"] {
            assert!(matches!(camera(text), Err(Refused::Malformed(_))), "{text}");
        }
    }

    #[test]
    fn the_first_camera_is_the_default() {
        let scene = lumivox_scene::builtin::scene("cornell").unwrap();
        assert_eq!(resolve(None, &scene, 1.5).unwrap(), scene.cameras[0]);
        let bare = Scene { cameras: Vec::new(), ..scene.clone() };
        assert_eq!(resolve(None, &bare, 1.5).unwrap().name, FRAMING);
        let framing = CameraChoice::Name(FRAMING.to_owned());
        assert_eq!(resolve(Some(&framing), &scene, 1.5).unwrap().name, FRAMING);
    }

    #[test]
    fn a_camera_is_found_by_its_node() {
        let mut scene = lumivox_scene::builtin::scene("two-rooms").unwrap();
        let last = scene.cameras.last().unwrap().clone();
        scene.notes.nodes.insert("stand".to_owned(), last.name.clone());
        let named = |name: &str| resolve(Some(&CameraChoice::Name(name.to_owned())), &scene, 1.5);
        assert_eq!(named("stand").unwrap(), last);
        assert!(named("gone").is_err());
    }

    #[test]
    fn inside_and_outside_cameras_are_placed_accordingly() {
        let named = |name: &str, scene: &Scene| {
            resolve(Some(&CameraChoice::Name(name.to_owned())), scene, 1.5)
        };
        let hall = lumivox_scene::builtin::scene("atrium").unwrap();
        assert!(hall.bounds().contains(named(INSIDE, &hall).unwrap().position));
        assert!(!hall.bounds().contains(named(OUTSIDE, &hall).unwrap().position));
        // A camera of the file takes precedence.
        let mut own = hall.clone();
        INSIDE.clone_into(&mut own.cameras[0].name);
        assert_eq!(named(INSIDE, &own).unwrap(), own.cameras[0]);
        let mut panel = lumivox_scene::builtin::scene("panel").unwrap();
        panel.instances.truncate(1);
        let error = named(INSIDE, &panel).unwrap_err().to_string();
        assert!(error.contains("no room inside") && error.contains("outside"), "{error}");
    }

    #[test]
    fn unknown_cameras_list_the_known_ones() {
        let scene = lumivox_scene::builtin::scene("cornell").unwrap();
        for choice in [CameraChoice::Index(99), CameraChoice::Name("nowhere".to_owned())] {
            let error = resolve(Some(&choice), &scene, 1.5).unwrap_err().to_string();
            assert!(error.contains(&scene.cameras[0].name), "{error}");
            assert!(error.contains("cornell"), "{error}");
        }
    }
}
