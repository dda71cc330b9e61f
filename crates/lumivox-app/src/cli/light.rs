//! What shines, and how its light is found.

use clap::Args;
use glam::Vec3;
use lumivox_render::ShadowMethod;
use lumivox_scene::Light;

use crate::args::{choices, light, number, size};

/// Light.
#[derive(Args, Debug)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// Reflections of indirect light, 0 to 16
    ///
    /// 0 is direct light alone, 1 is light by way of one other surface. Each costs one more gather
    /// in the voxels, once.
    #[arg(long, value_name = "BOUNCES", value_parser = number::whole(0..=16))]
    #[arg(default_value = "4", allow_negative_numbers = true)]
    pub bounces: u32,

    /// Add a sun that stands in the direction X,Y,Z, with LUX lux [default: none; LUX: 100000]
    ///
    /// The vector points from the scene to the sun (y is up), at any length: 0,1,0 is noon. LUX is
    /// the illuminance of a surface that faces it, 0 to 1e10. It has the size of ours.
    #[arg(long, value_name = "X,Y,Z[,LUX]", value_parser = light::sun)]
    #[arg(allow_hyphen_values = true)]
    pub sun: Option<Light>,

    /// Radiance of the surroundings in cd/m2, each from 0 to 1e10 [default: the scene's]
    ///
    /// It replaces the scene's own. A clear blue sky has about 2000,2600,3600.
    #[arg(long, value_name = "R,G,B", value_parser = light::environment)]
    #[arg(allow_hyphen_values = true)]
    pub environment: Option<Vec3>,

    /// How shadows of lamps and sun are found
    #[arg(long, value_name = "HOW", value_parser = choices::shadows())]
    #[arg(default_value = "map")]
    pub shadows: ShadowMethod,

    /// Edge of a shadow map in texels, 16 to 32768 (or less, as the GPU allows)
    ///
    /// Higher: sharper shadows that begin nearer to their caster. Four bytes a texel; a point light
    /// has six maps.
    #[arg(long, value_name = "TEXELS", value_parser = number::whole(16..=size::LONGEST_EDGE))]
    #[arg(default_value = "1024", allow_negative_numbers = true)]
    pub shadow_resolution: u32,
}
