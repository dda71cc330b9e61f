//! The light that the command line adds to a scene, or that replaces the scene's.

use lumivox_console::SourceArgs;
use lumivox_scene::{EnvironmentMap, Note, Scene, SceneError, check_regular};
use serde_json::{Value, json};

use crate::args::light::Surroundings;
use crate::args::scene::stamp;
use crate::progress::ProgressDisplay;

/// The remedy for a picture with too little light, or too much.
pub const REMEDY: &str = "light it otherwise with --surroundings studio or sky, --sun or --environment, or set --exposure";

/// Checks that the panorama's file exists, which is cheap.
///
/// # Errors
/// [`SceneError::Read`].
pub fn check(args: &SourceArgs) -> Result<(), SceneError> {
    let Some(Surroundings::File(file)) = &args.environment else { return Ok(()) };
    match check_regular(file) {
        Ok(_) => Ok(()),
        Err(source) => Err(SceneError::Read { file: file.clone(), source }),
    }
}

/// Lights a scene as the command line says.
///
/// # Errors
/// When a panorama cannot be read.
pub fn add(
    scene: &mut Scene,
    args: &SourceArgs,
    progress: &ProgressDisplay,
) -> Result<(), SceneError> {
    progress.set("loading the surroundings", 0, 1);
    let panorama = args.panorama().map(EnvironmentMap::load).transpose()?;
    args.light(scene, panorama)
}

/// Logs the choices made for the user.
pub fn tell(notes: &[Note]) {
    for note in notes {
        tracing::info!("{}: {note}", note.about);
    }
}

/// All values that decide the light, for the index of a sequence.
pub fn settings(args: &SourceArgs) -> Value {
    let sun = args.sun.as_ref();
    let sun =
        sun.map(|sun| json!({ "towards_sun": (-sun.direction).to_array(), "lux": sun.intensity }));
    let environment = args.environment.as_ref().map(|surroundings| match surroundings {
        Surroundings::Uniform(radiance) => json!(radiance.to_array()),
        Surroundings::File(file) => {
            json!({ "name": file.display().to_string(), "file": stamp(file) })
        }
    });
    json!({
        "sun": sun,
        "environment": environment,
        "environment_rotation": args.environment_rotation,
        "environment_intensity": args.environment_intensity,
        "sky": args.sky.map(|towards| towards.to_array()),
        "turbidity": args.turbidity,
        "surroundings": args.staging().name(),
    })
}
