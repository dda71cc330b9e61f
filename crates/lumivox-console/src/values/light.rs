//! Light added on the command line.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use lumivox_scene::{Light, LightKind};

use super::Refused;
use super::number::{in_range, list, some};

/// The greatest radiance or illuminance: far above the sun (100 000 lux, 1.6e9 cd/m²), and far
/// below where squares overflow.
const BRIGHTEST: f32 = 1e10;

const SUN_FORM: &str = "X,Y,Z or X,Y,Z,LUX, such as 0.3,1,0.5,50000";

/// A sun: `X,Y,Z[,LUX]`, where the vector points from the scene towards the sun.
pub fn sun(text: &str) -> Result<Light, Refused> {
    let numbers = some(text, SUN_FORM)?;
    let (&[x, y, z], rest) =
        numbers.split_first_chunk().filter(|(_, rest)| rest.len() <= 1).ok_or_else(|| {
            let count = numbers.len();
            Refused::Malformed(format!("expected {SUN_FORM}; got {count} numbers"))
        })?;
    let mut sun = Light::typical(LightKind::Directional);
    if let [lux, ..] = rest {
        sun.intensity = in_range(*lux, &(0.0..=BRIGHTEST), "the illuminance in lux")?;
    }
    // In f64, squares of f32 neither overflow nor underflow.
    let towards_sun = Vec3::new(x, y, z).as_dvec3();
    if towards_sun == DVec3::ZERO {
        return Err(Refused::OutOfRange("the direction must not be 0,0,0".to_owned()));
    }
    Ok(Light {
        name: "sun of the command line".to_owned(),
        direction: -towards_sun.normalize().as_vec3(),
        ..sun
    })
}

/// The surroundings of the scene as the command line names them.
#[derive(Clone, Debug, PartialEq)]
pub enum Surroundings {
    /// A constant radiance from all directions, cd/m².
    Uniform(Vec3),
    /// A panorama.
    File(PathBuf),
}

/// `R,G,B` in cd/m², or a file.
pub fn environment(text: &str) -> Result<Surroundings, Refused> {
    const FORM: &str = "R,G,B in cd/m2, such as 800,1000,1300, or a panorama's file, .hdr or .exr";
    const PICTURES: [&str; 6] = ["hdr", "pic", "exr", "png", "jpg", "jpeg"];
    let extension = Path::new(text).extension().unwrap_or_default().to_ascii_lowercase();
    if PICTURES.iter().any(|known| *known == extension) || Path::new(text).exists() {
        return Ok(Surroundings::File(text.into()));
    }
    let radiance = list::<3>(text, FORM)?;
    for (value, name) in radiance.into_iter().zip(["red", "green", "blue"]) {
        in_range(value, &(0.0..=BRIGHTEST), name)?;
    }
    Ok(Surroundings::Uniform(radiance.into()))
}

/// The direction to the sun of a sky: `X,Y,Z`, or `ELEVATION,AZIMUTH` in degrees.
pub fn sky(text: &str) -> Result<Vec3, Refused> {
    const FORM: &str = "X,Y,Z or ELEVATION,AZIMUTH in degrees, such as 30,120";
    let numbers = some(text, FORM)?;
    match numbers[..] {
        [elevation, azimuth] => {
            let elevation = in_range(elevation, &(-90.0..=90.0), "the elevation in degrees")?;
            let azimuth = in_range(azimuth, &(-360.0..=360.0), "the azimuth in degrees")?;
            let (elevation, azimuth) =
                (f64::from(elevation).to_radians(), f64::from(azimuth).to_radians());
            let towards = DVec3::new(
                azimuth.sin() * elevation.cos(),
                elevation.sin(),
                -azimuth.cos() * elevation.cos(),
            );
            Ok(towards.as_vec3())
        }
        [x, y, z] => {
            let towards = Vec3::new(x, y, z).as_dvec3();
            if towards == DVec3::ZERO {
                return Err(Refused::OutOfRange("the direction must not be 0,0,0".to_owned()));
            }
            Ok(towards.normalize().as_vec3())
        }
        _ => {
            let count = numbers.len();
            Err(Refused::Malformed(format!("expected {FORM}; got {count} numbers")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sun_takes_the_direction_towards_the_sun() {
        let light = sun("0,2,0").unwrap();
        assert_eq!(light.direction, Vec3::NEG_Y);
        assert_eq!((light.kind, light.intensity), (LightKind::Directional, 100_000.0));
        let light = sun("1e-30,0,0,5").unwrap();
        assert_eq!(light.direction, Vec3::NEG_X);
        assert_eq!(light.intensity, 5.0);
        let mut scene = lumivox_scene::builtin::scene("cornell").unwrap();
        scene.lights.push(sun("3e38,3e38,-3e38,1e10").unwrap());
        scene.validate().unwrap();
    }

    #[test]
    fn invalid_sun_and_environment_values_are_refused() {
        for text in ["0,0,0", "0,1,0,-5", "0,1,0,1e11", "nan,1,0", "0,inf,0"] {
            assert!(matches!(sun(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "1,2", "1,2,3,4,5", "up"] {
            assert!(matches!(sun(text), Err(Refused::Malformed(_))), "{text}");
        }
        let uniform = Surroundings::Uniform(Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(environment("1,2,3"), Ok(uniform));
        for text in ["-1,0,0", "0,0,nan", "0,1e11,0"] {
            assert!(matches!(environment(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "1", "1,2", "1,2,3,4"] {
            assert!(matches!(environment(text), Err(Refused::Malformed(_))), "{text}");
        }
    }

    #[test]
    fn environment_accepts_panorama_files() {
        for name in ["a.hdr", "b/c.EXR", "d.jpg"] {
            assert_eq!(environment(name), Ok(Surroundings::File(name.into())));
        }
        let error = environment("no-such-thing").unwrap_err().to_string();
        assert!(error.contains(".hdr"), "{error}");
    }

    #[test]
    fn sky_takes_the_sun_as_vector_or_angles() {
        assert_eq!(sky("0,5,0"), Ok(Vec3::Y));
        assert!(sky("90,77").unwrap().distance(Vec3::Y) < 1e-6);
        assert!(sky("0,0").unwrap().distance(Vec3::NEG_Z) < 1e-6);
        assert!(sky("0,90").unwrap().distance(Vec3::X) < 1e-6);
        let low = sky("-10,180").unwrap();
        assert!(low.y < 0.0 && low.z > 0.9);
        for text in ["91,0", "0,361", "0,0,0", "nan,0"] {
            assert!(matches!(sky(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "1", "1,2,3,4", "noon"] {
            assert!(matches!(sky(text), Err(Refused::Malformed(_))), "{text}");
        }
    }
}
