//! Scenes that the console and the window open: how the command line asks for them, and how they are read.

use lumivox_console::{Opening, Ready, SceneSource};

use crate::args::scene;
use crate::cli::ExploreArgs;
use crate::commands::light;
use crate::progress::{Progress, words};

/// The opening of the scene that the command line names, if it names one.
pub fn of_args(args: &ExploreArgs) -> Option<Opening> {
    let source = args.scene.clone()?;
    Some(Opening { camera: args.picture.camera.clone(), ..of(args, source) })
}

/// The opening of another scene, read and lit as the command line asks for.
pub fn of(args: &ExploreArgs, source: SceneSource) -> Opening {
    Opening {
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
pub fn load(opening: Opening, progress: &Progress) -> anyhow::Result<Ready> {
    scene::check(&opening.source)?;
    light::check(&opening.light)?;
    let mut scene = scene::load(&opening.source, &opening.load, progress)?;
    light::add(&mut scene, &opening.light, progress)?;
    let mut tell = |step: lumivox_render::Progress| {
        progress.set(words(step.stage), step.done, step.total);
    };
    let ready = opening.ready(scene, &mut tell)?;
    light::tell(ready.opened.notes());
    Ok(ready)
}
