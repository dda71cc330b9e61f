//! The surroundings of a scene.

use glam::Vec3;
use lumivox_scene::Environment;
use serde::{Deserialize, Serialize};
use tsify::Tsify;

use crate::error::WebError;

/// The greatest radiance, cd/m2, as on the command line.
const BRIGHTEST: f32 = 1e10;

/// The surroundings of a scene: a panorama, or uniform light.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct EnvironmentInfo {
    /// Linear red, green and blue in cd/m2; with a panorama, the factor of its texels.
    #[tsify(type = "[number, number, number]")]
    pub radiance: Vec3,
    /// The panorama's name, if there is one.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub panorama: Option<String>,
    /// The panorama's rotation about the vertical, in degrees, counter-clockwise seen from above.
    pub rotation_deg: f32,
}

impl From<&Environment> for EnvironmentInfo {
    fn from(environment: &Environment) -> Self {
        Self {
            radiance: environment.radiance,
            panorama: environment.map.as_ref().map(|map| map.name.clone()),
            rotation_deg: environment.rotation_rad.to_degrees(),
        }
    }
}

/// A change of a scene's surroundings; properties that are left out keep their values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(default, deny_unknown_fields)]
pub struct EnvironmentChange {
    /// Linear red, green and blue in cd/m2, from 0 to 1e10; with a panorama, the factor of its
    /// texels.
    #[tsify(optional, type = "[number, number, number]")]
    pub radiance: Option<Vec3>,
    /// `null` removes the panorama; `loadPanorama` sets another.
    #[serde(deserialize_with = "given")]
    #[tsify(optional, type = "string | null")]
    pub panorama: Option<Option<String>>,
    /// The panorama's rotation about the vertical, from -360 to 360 degrees.
    #[tsify(optional)]
    pub rotation_deg: Option<f32>,
}

/// Distinguishes null from a missing property.
#[allow(clippy::option_option, reason = "null removes the panorama, undefined leaves it")]
fn given<'a, D: serde::Deserializer<'a>>(value: D) -> Result<Option<Option<String>>, D::Error> {
    Deserialize::deserialize(value).map(Some)
}

impl EnvironmentChange {
    /// The surroundings after this change.
    ///
    /// # Errors
    /// When a number is out of range, or another panorama is named.
    pub fn of(&self, present: &Environment) -> Result<Environment, WebError> {
        let mut environment = present.clone();
        if let Some(radiance) = self.radiance {
            if !radiance.to_array().iter().all(|channel| (0.0..=BRIGHTEST).contains(channel)) {
                return Err(WebError::value(format!(
                    "radiance of the surroundings is {radiance}, but must be from 0 to 1e10 cd/m2"
                )));
            }
            environment.radiance = radiance;
        }
        if let Some(degrees) = self.rotation_deg {
            if !(-360.0..=360.0).contains(&degrees) {
                return Err(WebError::value(format!(
                    "rotation_deg of the surroundings is {degrees}, but must be from -360 to 360"
                )));
            }
            environment.rotation_rad = degrees.to_radians();
        }
        match &self.panorama {
            None => {}
            Some(None) => environment.map = None,
            Some(Some(name)) if present.map.as_ref().is_some_and(|map| map.name == *name) => {}
            Some(Some(name)) => {
                return Err(WebError::value(format!(
                    "the panorama \"{name}\" is not the present one; open another with loadPanorama"
                )));
            }
        }
        Ok(environment)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn changed(text: &str) -> Result<Environment, WebError> {
        let map = lumivox_scene::EnvironmentMap { name: "hall".to_owned(), ..Default::default() };
        let change: EnvironmentChange = serde_json::from_str(text).unwrap();
        change.of(&Arc::new(map).into())
    }

    #[test]
    fn omitted_environment_fields_stay_unchanged() {
        assert_eq!(
            EnvironmentInfo::from(&changed("{}").unwrap()).panorama.as_deref(),
            Some("hall")
        );
        let turned = changed(r#"{ "rotation_deg": 90, "panorama": "hall" }"#).unwrap();
        assert_eq!((turned.rotation_rad, turned.radiance), (90_f32.to_radians(), Vec3::ONE));
        assert!(turned.map.is_some());
        let plain = changed(r#"{ "panorama": null, "radiance": [1, 2, 3] }"#).unwrap();
        assert_eq!((plain.map, plain.radiance), (None, Vec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn invalid_environments_are_refused() {
        let message = |text| changed(text).unwrap_err().message;
        assert!(message(r#"{ "radiance": [1, -1, 0] }"#).contains("from 0 to 1e10"));
        assert!(message(r#"{ "rotation_deg": 400 }"#).contains("from -360 to 360"));
        assert!(message(r#"{ "panorama": "wood" }"#).contains("loadPanorama"));
        assert!(serde_json::from_str::<EnvironmentChange>(r#"{ "turn": 3 }"#).is_err());
    }
}
