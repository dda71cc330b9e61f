//! Which scene the console and the window open, and how it is read.

use std::cell::OnceCell;

use lumivox_explorer::Opened;
use lumivox_scene::SightOptions;

use crate::args::camera::{CameraChoice, resolve_with};
use crate::args::scene::SceneSource;
use crate::cli::{ExploreArgs, LoadArgs, SourceArgs};
use crate::commands::light;
use crate::progress::{Progress, words};

/// Which scene, and how it is read and lit.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The scene.
    pub source: SceneSource,
    /// How its file is read.
    pub load: LoadArgs,
    /// What is added to its light.
    pub light: SourceArgs,
    /// Where it is seen from.
    pub camera: Option<CameraChoice>,
    /// Width by height of the picture that the camera is found for.
    pub aspect: f32,
}

/// A scene that was read, and how.
#[derive(Debug)]
pub struct Ready {
    /// How.
    pub opening: Opening,
    /// The scene.
    pub opened: Opened,
}

impl Opening {
    /// Of the scene that the command line names, if it names one.
    pub fn of_args(args: &ExploreArgs) -> Option<Self> {
        let source = args.scene.clone()?;
        Some(Self { camera: args.picture.camera.clone(), ..Self::of(args, source) })
    }

    /// Of another scene, read and lit as the command line asks for.
    pub fn of(args: &ExploreArgs, source: SceneSource) -> Self {
        Self {
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
    pub fn load(self, progress: &Progress) -> anyhow::Result<Ready> {
        self.source.check()?;
        light::check(&self.light)?;
        let mut scene = self.source.load(&self.load, progress)?;
        light::add(&mut scene, &self.light, progress)?;
        let (camera, framing) = (self.camera.as_ref(), OnceCell::new());
        let camera = camera.map(|_| resolve_with(camera, &scene, self.aspect, &framing));
        let camera = camera.transpose()?;
        let options = SightOptions { camera, aspect: self.aspect, staging: self.light.staging() };
        let opened = Opened::surveyed(scene, &options, &framing, &mut |step| {
            progress.set(words(step.stage), step.done, step.total);
        })?;
        light::tell(opened.notes());
        Ok(Ready { opening: self, opened })
    }
}
