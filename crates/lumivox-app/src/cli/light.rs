//! What shines, and how its light is found.

use clap::Args;
use glam::Vec3;
use lumivox::Injection;
use lumivox_render::ShadowMethod;
use lumivox_scene::{Light, Staging};

use crate::args::light::Surroundings;
use crate::args::{choices, light, number, size};

/// What shines.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Light")]
pub struct SourceArgs {
    /// Add a sun that stands in the direction X,Y,Z, with LUX lux [default: none; LUX: 100000]
    ///
    /// The vector points from the scene to the sun (y is up), at any length: 0,1,0 is noon. LUX is
    /// the illuminance of a surface that faces it, 0 to 1e10. It has the size of ours.
    #[arg(long, value_name = "X,Y,Z[,LUX]", value_parser = light::sun)]
    #[arg(allow_hyphen_values = true)]
    pub sun: Option<Light>,

    /// The surroundings: radiance in cd/m2, each from 0 to 1e10, or a panorama's file, .hdr or .exr
    /// [default: the scene's]
    ///
    /// It replaces the scene's own. A clear blue sky has about 2000,2600,3600. A panorama is
    /// equirectangular, twice as wide as high; its middle lies towards -z. One unit of it is 1 cd/m2
    /// unless it says otherwise, see --environment-intensity. PNG and JPEG are read, too.
    #[arg(long, value_name = "R,G,B|FILE", value_parser = light::environment)]
    #[arg(allow_hyphen_values = true, conflicts_with = "sky")]
    pub environment: Option<Surroundings>,

    /// Turn of the panorama about the vertical in degrees, -360 to 360, counter-clockwise seen from
    /// above [default: the scene's, mostly 0]
    #[arg(long, value_name = "DEGREES", value_parser = number::number(-360.0..=360.0))]
    #[arg(allow_negative_numbers = true, conflicts_with = "sky")]
    pub environment_rotation: Option<f32>,

    /// Number that the radiance of the surroundings is multiplied by, 0 to 1e10
    #[arg(long, value_name = "FACTOR", value_parser = number::number(0.0..=1e10))]
    #[arg(default_value = "1", allow_negative_numbers = true)]
    pub environment_intensity: f32,

    /// A clear sky and its sun, which stands towards X,Y,Z, or ELEVATION,AZIMUTH in degrees [default:
    /// none]
    ///
    /// It replaces the scene's surroundings, computed in cd/m2 and lux. The elevation is from -90 to
    /// 90 (below 0 is dusk), the azimuth from -360 to 360: 0 is towards -z, 90 towards +x.
    #[arg(long, value_name = "X,Y,Z|ELEVATION,AZIMUTH", value_parser = light::sky)]
    #[arg(allow_hyphen_values = true)]
    pub sky: Option<Vec3>,

    /// Haze of the sky, a number from 1 (the clearest) to 10
    ///
    /// Higher: paler, brighter round the sun, a weaker sun.
    #[arg(long, value_name = "NUMBER", value_parser = number::number(1.0..=10.0))]
    #[arg(default_value = "2", allow_negative_numbers = true, requires = "sky")]
    pub turbidity: f32,

    /// What is put around a scene of which the file sees to too little light [default: auto; none with
    /// --sun, --sky or --environment]
    ///
    /// auto measures what the scene's own light does where it is seen. Where that is not enough, lamps
    /// of 300 lux light a closed room, sun and sky an open place or a landscape, and a studio of 1536
    /// lux, turned to the camera, everything else. The note under the picture tells what was chosen.
    #[arg(long, value_name = "WHAT", value_parser = choices::staging())]
    pub surroundings: Option<Staging>,

    /// The same as --surroundings none
    #[arg(long, conflicts_with = "surroundings")]
    pub no_default_light: bool,
}

impl SourceArgs {
    /// The surroundings that the scene gets: none where the user lights it.
    pub fn staging(&self) -> Staging {
        let is_lit = self.sun.is_some() || self.sky.is_some() || self.environment.is_some();
        let is_left = self.no_default_light || is_lit;
        self.surroundings.unwrap_or(if is_left { Staging::None } else { Staging::Auto })
    }
}

/// Light, and how it is found.
#[derive(Args, Debug)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// What shines.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// Reflections of indirect light, 0 to 16 [default: 8; presets report and vxct: 1]
    ///
    /// 0 is direct light alone, 1 is light by way of one other surface. N leave out about the share
    /// a^N of the light in a room of albedo a. Each costs one more gather in the voxels, once.
    #[arg(long, value_name = "BOUNCES", value_parser = number::whole(0..=16))]
    #[arg(allow_negative_numbers = true)]
    pub bounces: Option<u32>,

    /// How shadows of lamps and sun are found
    #[arg(long, value_name = "HOW", value_parser = choices::shadows())]
    #[arg(default_value = "map")]
    pub shadows: ShadowMethod,

    /// Edge of a shadow map in texels, 16 to 32768 (or less, as the GPU allows)
    ///
    /// Higher: sharper shadows that begin nearer to their caster, and photons that scatter less. Four
    /// bytes a texel; a point light has six maps.
    #[arg(long, value_name = "TEXELS", value_parser = number::whole(16..=size::LONGEST_EDGE))]
    #[arg(default_value = "1024", allow_negative_numbers = true)]
    pub shadow_resolution: u32,

    /// How the light of lamps and sun comes into the voxels [default: direct; preset report: photons]
    ///
    /// Both give the same light in the mean. Photons scatter with the texels that a voxel is seen by, and
    /// follow shadows within a voxel. Lights without shadow maps are injected directly.
    #[arg(long, value_name = "HOW", value_parser = choices::injection())]
    pub injection: Option<Injection>,
}
