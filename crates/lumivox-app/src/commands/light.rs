//! The light that the command line adds to a scene or puts in the place of the scene's.

use std::cell::OnceCell;
use std::sync::Arc;

use glam::Vec3;
use lumivox_scene::sky::{SkySettings, sky};
use lumivox_scene::{
    Camera, Environment, EnvironmentMap, Framing, Light, LightKind, Note, Scene, SceneError, Sight,
    SightOptions, Staging, check_regular,
};
use serde_json::{Value, json};

use crate::args::light::Surroundings;
use crate::args::scene::stamp;
use crate::cli::SourceArgs;
use crate::progress::Progress;

/// The name of the light that is the sun of a computed sky.
pub const SUN_OF_SKY: &str = "sun of the sky";

/// The remedy for a picture with too little light, or too much.
pub const REMEDY: &str = "light it otherwise with --surroundings studio or sky, --sun or --environment, or set --exposure";

/// Checks what is cheap to check: that there is such a panorama at all.
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
pub fn add(scene: &mut Scene, args: &SourceArgs, progress: &Progress) -> Result<(), SceneError> {
    scene.lights.extend(args.sun.clone());
    match &args.environment {
        Some(Surroundings::Uniform(radiance)) => {
            scene.environment = Environment { radiance: *radiance, ..Environment::default() };
        }
        Some(Surroundings::File(file)) => {
            progress.set("loading the surroundings", 0, 1);
            let map = EnvironmentMap::load(file)?;
            let map = Some(Arc::new(map));
            scene.environment = Environment { radiance: Vec3::ONE, map, rotation_rad: 0.0 };
        }
        None => {}
    }
    if let Some(sun_direction) = args.sky {
        progress.set("computing the sky", 0, 1);
        let settings =
            SkySettings { sun_direction, turbidity: args.turbidity, ..SkySettings::default() };
        let sky = sky(&settings)?;
        let map = Some(Arc::new(sky.map));
        scene.environment = Environment { radiance: Vec3::ONE, map, rotation_rad: 0.0 };
        scene.lights.extend(sky.sun.map(|sun| Light { name: SUN_OF_SKY.to_owned(), ..sun }));
    }
    scene.environment.radiance *= args.environment_intensity;
    if let Some(degrees) = args.environment_rotation {
        scene.environment.rotation_rad = degrees.to_radians();
    }
    Ok(())
}

/// Decides how a scene is seen, adds the light that it needs, and tells the user what was chosen. For commands
/// whose reports do not.
pub fn stage(
    scene: &mut Scene,
    camera: Camera,
    (staging, aspect): (Staging, f32),
    framing: &OnceCell<Framing>,
    progress: &Progress,
) {
    progress.set("looking at the scene", 0, 1);
    let options = SightOptions { camera: Some(camera), aspect, staging };
    let sight = Sight::of(scene, &options, framing);
    scene.light_up(&sight);
    if sight.light.is_some() {
        tell(&sight.notes);
    }
}

/// Tells what was chosen for the user.
pub fn tell(notes: &[Note]) {
    for note in notes {
        tracing::info!("{}: {note}", note.about);
    }
}

/// What decides the light, for the index of a sequence.
pub fn settings(args: &SourceArgs) -> Value {
    let sun = args.sun.as_ref().map(|sun| {
        let lux = match sun.kind {
            LightKind::Directional { illuminance_lux, .. } => Some(illuminance_lux),
            LightKind::Point { .. } | LightKind::Spot { .. } => None,
        };
        json!({ "towards_sun": (-sun.direction).to_array(), "lux": lux })
    });
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
