//! The scene of a command.

use std::ffi::OsString;

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use lumivox_console::{LoadArgs, SceneSource};
use lumivox_scene::Scene;

use crate::args::scene;
use crate::progress::ProgressDisplay;

/// The scene of a command.
#[derive(Args, Debug)]
pub struct SceneArg {
    /// The scene: a glTF, OBJ, PLY, STL or VXCT file (.gltf, .glb, .obj, .ply, .stl, .scene, .vxct, .txt),
    /// or builtin:NAME
    ///
    /// `lumivox scenes` lists the built-in ones.
    #[arg(value_name = "SCENE", value_parser = scene_source())]
    pub scene: SceneSource,

    /// How its file is read.
    #[command(flatten)]
    pub load: LoadArgs,
}

impl SceneArg {
    /// Makes or reads the scene.
    ///
    /// # Errors
    /// When the scene cannot be read, and when options for files are given with a built-in scene.
    pub fn load(&self, progress: &ProgressDisplay) -> anyhow::Result<Scene> {
        scene::load(&self.scene, &self.load, progress)
    }
}

/// A parser of scenes' names.
pub fn scene_source() -> impl TypedValueParser<Value = SceneSource> {
    OsStringValueParser::new().map(|text: OsString| scene::source(text))
}
