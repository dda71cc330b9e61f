//! The light that the command line adds to a scene or puts in the place of the scene's.

use std::sync::Arc;

use glam::Vec3;
use lumivox_scene::sky::{SkySettings, sky};
use lumivox_scene::{
    Camera, DefaultLight, Environment, EnvironmentMap, Light, LightKind, Scene, SceneError,
};
use serde_json::{Value, json};

use crate::args::light::Surroundings;
use crate::args::scene::stamp;
use crate::cli::SourceArgs;
use crate::progress::Progress;

/// The name of the light that is the sun of a computed sky.
pub const SUN_OF_SKY: &str = "sun of the sky";

/// Checks what is cheap to check: that there is such a panorama at all.
///
/// # Errors
/// [`SceneError::Read`].
pub fn check(args: &SourceArgs) -> Result<(), SceneError> {
    let Some(Surroundings::File(file)) = &args.environment else { return Ok(()) };
    let read = std::fs::metadata(file).and_then(|metadata| {
        if metadata.is_file() { Ok(()) } else { Err(std::io::Error::other("not a regular file")) }
    });
    read.map_err(|source| SceneError::Read { file: file.clone(), source })
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

/// Lights a scene in which nothing shines, and says so.
pub fn add_default(scene: &mut Scene, camera: &Camera, progress: &Progress) {
    progress.set("looking for places of lamps", 0, 1);
    if let Some(light) = scene.add_default_light(Some(camera)) {
        tell_default(scene, &light);
    }
}

/// Says by what a scene is lit in which nothing shone.
pub fn tell_default(scene: &Scene, light: &DefaultLight) {
    tracing::warn!(
        "nothing shines in the scene \"{}\": it is lit by {light}; light it with --sun, --sky \
         or --environment, or leave it dark with --no-default-light",
        scene.name
    );
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
        "no_default_light": args.no_default_light,
    })
}
