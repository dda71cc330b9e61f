//! Options that add light to a scene.

use std::path::Path;
use std::sync::Arc;

use clap::Args;
use glam::Vec3;
use lumivox_scene::sky::{SkySettings, sky};
use lumivox_scene::{Environment, EnvironmentMap, Light, Scene, SceneError, Staging};

use crate::commands::surroundings::tell_replaced;
use crate::values::light::{self, Surroundings};
use crate::values::{choices, number};

/// Options that add light.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Light")]
pub struct SourceArgs {
    /// Add a sun in the direction X,Y,Z, with LUX lux [default: none; LUX: 100000]
    ///
    /// The vector points from the scene to the sun (y is up) and may have any length: 0,1,0 is
    /// noon. LUX is the illuminance of a surface that faces it, 0 to 1e10. It is as large as our
    /// sun.
    #[arg(long, value_name = "X,Y,Z[,LUX]", value_parser = light::sun)]
    #[arg(allow_hyphen_values = true)]
    pub sun: Option<Light>,

    /// The surroundings: radiance in cd/m2, each from 0 to 1e10, or a panorama's file, .hdr or .exr
    /// [default: the scene's]
    ///
    /// It replaces the scene's own. A clear blue sky has about 2000,2600,3600. A panorama is
    /// equirectangular, twice as wide as high, with -z at its centre. One unit of it is 1 cd/m2
    /// unless the file says otherwise; see --environment-intensity. PNG and JPEG are read, too.
    #[arg(long, value_name = "R,G,B|FILE", value_parser = light::environment)]
    #[arg(allow_hyphen_values = true, conflicts_with = "sky")]
    pub environment: Option<Surroundings>,

    /// Rotation of the panorama about the vertical in degrees, -360 to 360, counter-clockwise seen
    /// from above [default: the scene's, usually 0]
    #[arg(long, value_name = "DEGREES", value_parser = number::number(-360.0..=360.0))]
    #[arg(allow_negative_numbers = true, conflicts_with = "sky")]
    pub environment_rotation: Option<f32>,

    /// Factor of the radiance of the surroundings, 0 to 1e10
    #[arg(long, value_name = "FACTOR", value_parser = number::number(0.0..=1e10))]
    #[arg(default_value = "1", allow_negative_numbers = true)]
    pub environment_intensity: f32,

    /// A clear sky with its sun at X,Y,Z, or at ELEVATION,AZIMUTH in degrees [default: none]
    ///
    /// It replaces the scene's surroundings and directional lights, and is computed in cd/m2 and lux.
    /// The elevation is from -90 to 90 (below 0 is dusk), the azimuth from -360 to 360: 0 is towards
    /// -z, 90 towards +x.
    #[arg(long, value_name = "X,Y,Z|ELEVATION,AZIMUTH", value_parser = light::sky)]
    #[arg(allow_hyphen_values = true)]
    pub sky: Option<Vec3>,

    /// Haze of the sky, a number from 1 (the clearest) to 10
    ///
    /// Higher: the sky is paler and brighter around the sun, and the sun is weaker.
    #[arg(long, value_name = "NUMBER", value_parser = number::number(1.0..=10.0))]
    #[arg(default_value = "2", allow_negative_numbers = true, requires = "sky")]
    pub turbidity: f32,

    /// Surroundings for a scene that has too little light of its own [default: auto; none with
    /// --sun, --sky or --environment]
    ///
    /// auto measures the scene's own light where it is seen. If that is not enough, lamps of 300
    /// lux light a closed room, a sun and a sky an open place or a landscape, and a studio of 1536
    /// lux, turned to the camera, everything else. The note under the picture names the choice.
    #[arg(long, value_name = "WHAT", value_parser = choices::staging())]
    pub surroundings: Option<Staging>,

    /// The same as --surroundings none
    #[arg(long, conflicts_with = "surroundings")]
    pub no_default_light: bool,
}

impl SourceArgs {
    /// The surroundings to add; by default none if other options light the scene.
    pub fn staging(&self) -> Staging {
        let is_lit = self.sun.is_some() || self.sky.is_some() || self.environment.is_some();
        let is_left = self.no_default_light || is_lit;
        self.surroundings.unwrap_or(if is_left { Staging::None } else { Staging::Auto })
    }

    /// The file of the requested panorama.
    pub fn panorama(&self) -> Option<&Path> {
        match &self.environment {
            Some(Surroundings::File(file)) => Some(file),
            Some(Surroundings::Uniform(_)) | None => None,
        }
    }

    /// Adds the requested light to a scene; `panorama` is the content of the requested file.
    ///
    /// # Errors
    /// When the sky cannot be computed.
    pub fn light(
        &self,
        scene: &mut Scene,
        panorama: Option<EnvironmentMap>,
    ) -> Result<(), SceneError> {
        if let Some(Surroundings::Uniform(radiance)) = self.environment {
            scene.environment = Environment { radiance, ..Environment::default() };
        }
        if let Some(map) = panorama {
            scene.environment = Arc::new(map).into();
        }
        if let Some(sun_direction) = self.sky {
            let turbidity = self.turbidity;
            let settings = SkySettings { sun_direction, turbidity, ..SkySettings::default() };
            let replaced = sky(&settings)?.surround(&mut scene.environment, &mut scene.lights);
            tell_replaced(&replaced);
        }
        scene.lights.extend(self.sun.clone());
        scene.environment.radiance *= self.environment_intensity;
        if let Some(degrees) = self.environment_rotation {
            scene.environment.rotation_rad = degrees.to_radians();
        }
        Ok(())
    }
}
