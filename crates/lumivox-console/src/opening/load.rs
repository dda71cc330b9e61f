//! Options for reading a scene's file.

use clap::Args;
use glam::Vec3;
use lumivox_scene::{LoadOptions, MemoryBudget, Scene, UpAxis};

use crate::values::{choices, load, number};
use crate::{Failure, SceneSource};

const RADIANS_PER_DEGREE: f32 = std::f32::consts::PI / 180.0;

/// Options for reading a scene's file.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "File")]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct LoadArgs {
    /// The scene to show of a file with several (glTF, VXCT), by name or number [default: the one
    /// that the file marks, else the first]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists them.
    #[arg(long, value_name = "NAME|NUMBER")]
    pub scene_in_file: Option<String>,

    /// Axis of the file that points up
    ///
    /// Use z if a CAD model or a scan lies on its back.
    #[arg(long, value_name = "AXIS", value_parser = choices::up(), default_value = "y")]
    pub up: UpAxis,

    /// The file's unit of length: mm, cm, m, km, in, ft, or a number of metres, 1e-9 to 1e9
    ///
    /// Lengths are multiplied by it, strengths of lights are not. STL and OBJ files do not name
    /// their unit.
    #[arg(long, value_name = "UNIT", value_parser = load::unit, default_value = "m")]
    #[arg(allow_negative_numbers = true)]
    pub unit: f32,

    /// Angle in degrees, 0 to 180, above which an edge of a surface without normals stays sharp
    /// (OBJ, PLY, STL) [default: depends on the format]
    ///
    /// 0 keeps all edges sharp, 180 none. By default PLY is smooth, STL is flat, and OBJ is flat
    /// outside its smoothing groups.
    #[arg(long, value_name = "DEGREES", value_parser = number::number(0.0..=180.0))]
    #[arg(allow_negative_numbers = true)]
    pub crease: Option<f32>,

    /// Rotate the scene about the centre of its bounds: degrees about x, y and z, each -360 to 360
    ///
    /// About z first, then y, then x. Lights and cameras of the scene rotate with it, so their
    /// pictures stay the same; the surroundings and everything that other options place do not.
    /// Errors of voxels depend on how walls lie in the grid; measurements try several angles.
    #[arg(long, value_name = "X,Y,Z", value_parser = number::angles, help_heading = "Scene")]
    #[arg(default_value = "0,0,0", allow_hyphen_values = true)]
    pub rotate: Vec3,

    /// Let light pass single-sided surfaces from behind [default: off]
    ///
    /// Otherwise they block it there, too, and are black: a wall of one side is a wall. Cones and the path tracer follow the same
    /// rule.
    #[arg(long, help_heading = "Scene")]
    pub open_backs: bool,

    /// Let the scene's file refer to files outside its own folder [default: off]
    ///
    /// Only for files that you trust: they may then read any file that you may read.
    #[arg(long)]
    pub allow_outside: bool,

    /// Show a glTF file as well as possible even if it requires extensions that are not supported
    /// [default: off]
    ///
    /// The picture may then be wrong in any way; a warning names the extensions. Extensions that
    /// only refine the picture, such as variants of materials, do not need this option.
    #[arg(long)]
    pub ignore_required: bool,

    /// Memory for all textures with their finest levels, as a number with MiB, GiB, MB or GB
    ///
    /// Textures that need more are halved until they fit, with a warning. 1 KiB and up.
    #[arg(long, value_name = "SIZE", value_parser = load::bytes, default_value = "4GiB")]
    #[arg(allow_hyphen_values = true)]
    pub texture_memory: u64,

    /// Memory for all vertices and indices, as a number with MiB, GiB, MB or GB
    ///
    /// A scene that needs more is refused before memory is allocated. 1 KiB and up.
    #[arg(long, value_name = "SIZE", value_parser = load::bytes, default_value = "8GiB")]
    #[arg(allow_hyphen_values = true)]
    pub geometry_memory: u64,

    /// Whether second texture coordinates are read even if no texture uses them; not an option.
    #[arg(skip)]
    pub second_uvs: bool,
}

impl LoadArgs {
    /// Converts the options to those of the scene crate.
    pub fn options(&self) -> LoadOptions<'static> {
        LoadOptions {
            allow_outside: self.allow_outside,
            ignore_required: self.ignore_required,
            scene: self.scene_in_file.clone(),
            up: self.up,
            unit_m: self.unit,
            crease_rad: self.crease.map(f32::to_radians),
            budget: MemoryBudget {
                texture_bytes: self.texture_memory,
                geometry_bytes: self.geometry_memory,
            },
            second_uvs: self.second_uvs,
            progress: None,
            ..LoadOptions::default()
        }
    }

    /// Checks that the options fit the scene.
    ///
    /// # Errors
    /// When an option for files is given with a built-in scene.
    pub fn check(&self, source: &SceneSource) -> Result<(), Failure> {
        if let SceneSource::Builtin(_) = source
            && let Some(option) = self.option_of_files()
        {
            return Err(Failure::input(format!(
                "{source}: {option} is for scenes from files; leave it out"
            )));
        }
        Ok(())
    }

    /// Applies `open_backs` and `rotate` to a scene.
    pub fn turn(&self, scene: &mut Scene) {
        if self.open_backs {
            for material in &mut scene.materials {
                material.open_behind = true;
            }
        }
        if self.rotate != Vec3::ZERO {
            scene.rotate(self.rotate * RADIANS_PER_DEGREE);
        }
    }

    /// A given option that only applies to files.
    fn option_of_files(&self) -> Option<&'static str> {
        let given = [
            (self.scene_in_file.is_some(), "--scene-in-file"),
            (self.allow_outside, "--allow-outside"),
            (self.ignore_required, "--ignore-required"),
            (self.up != UpAxis::Y, "--up"),
            (self.unit.to_bits() != 1.0_f32.to_bits(), "--unit"),
            (self.crease.is_some(), "--crease"),
        ];
        given.iter().find(|(is_given, _)| *is_given).map(|(_, option)| *option)
    }
}
