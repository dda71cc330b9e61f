//! Scenes for the console and the window: requests from the command line, and their loading.

use lumivox_console::{OpenedScene, SceneRequest, SceneSource};

use crate::args::scene;
use crate::cli::ExploreArgs;
use crate::light;
use crate::progress::{ProgressDisplay, words};

/// The request for the scene that the command line names, if any.
pub fn of_args(args: &ExploreArgs) -> Option<SceneRequest> {
    let source = args.scene.clone()?;
    Some(SceneRequest { camera: args.picture.camera.clone(), ..of(args, source) })
}

/// The request for the scene `source`, with the options of the command line.
pub fn of(args: &ExploreArgs, source: SceneSource) -> SceneRequest {
    SceneRequest {
        source,
        load: args.load.clone(),
        light: args.light.sources.clone(),
        camera: None,
        aspect: args.picture.aspect(),
    }
}

/// Reads and lights the scene, and finds its camera.
///
/// # Errors
/// When the scene or a panorama cannot be read, or there is no such camera.
pub fn load(request: SceneRequest, progress: &ProgressDisplay) -> anyhow::Result<OpenedScene> {
    scene::check(&request.source)?;
    light::check(&request.light)?;
    let mut scene = scene::load(&request.source, &request.load, progress)?;
    light::add(&mut scene, &request.light, progress)?;
    let mut tell = |step: lumivox_render::RenderProgress| {
        progress.set(words(step.stage), step.done, step.total);
    };
    let scene = request.prepare(scene, &mut tell)?;
    light::tell(scene.prepared.notes());
    Ok(scene)
}
