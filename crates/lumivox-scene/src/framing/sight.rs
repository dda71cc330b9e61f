//! The first view of a scene, decided in one place for all front ends.

use std::cell::OnceCell;

use super::fineness::{self, Fineness};
use super::light::{self, Emission, OwnLight};
use super::outside::Subject;
use super::rays::Patch;
use super::{DefaultLight, Framing};
use crate::{Camera, Scene};

/// The surroundings of a scene: a studio, sun and sky, or nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Staging {
    /// The light that suits the scene, if its own is not enough: lamps in a closed room, sun and
    /// sky in other places and over landscapes, otherwise a studio.
    #[default]
    Auto,
    /// A [studio](crate::studio), whatever the scene's own light.
    Studio,
    /// The sun and the [sky](crate::sky) of a clear day, whatever the scene's own light.
    Sky,
    /// Nothing is added, even if the scene is dark.
    None,
}

impl Staging {
    /// All values.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Studio, Self::Sky, Self::None];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Studio => "studio",
            Self::Sky => "sky",
            Self::None => "none",
        }
    }
}

/// Options for the first view.
#[derive(Clone, Debug, PartialEq)]
pub struct SightOptions {
    /// The camera. Default: the scene's first camera, or else the view that shows it best.
    pub camera: Option<Camera>,
    /// Width over height of the picture for which the best view is found. Default: 16/9.
    pub aspect: f32,
    /// The surroundings. Default: what suits the scene.
    pub staging: Staging,
    /// The resolution of the voxels and shadow maps; notes then say if it is too coarse for what is
    /// visible. Default: unknown, no such notes.
    pub fineness: Fineness,
}

impl Default for SightOptions {
    fn default() -> Self {
        Self {
            camera: None,
            aspect: 16.0 / 9.0,
            staging: Staging::Auto,
            fineness: Fineness::default(),
        }
    }
}

/// A scene is thin if its thinnest side has fewer voxels than this.
const THIN: f32 = 24.0;
/// A scene with at least this many triangles is large.
const LARGE: usize = 50_000;

/// A choice made for the user, to be shown to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The subject: `camera`, `light`, `grid` or `shadows`.
    pub about: &'static str,
    /// The choice and its reason, without a full stop.
    pub text: String,
    /// The option that overrides it, as on the command line.
    pub option: &'static str,
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.text, self.option)
    }
}

/// The camera of a scene, and the light added to its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Sight {
    /// The camera.
    pub camera: Camera,
    /// The light to add; [`Scene::stage`] adds it.
    pub light: Option<DefaultLight>,
    /// The choices, with their reasons.
    pub notes: Vec<Note>,
}

impl Sight {
    /// Chooses camera and light without changing the scene. `framing` is computed only if it is
    /// needed, and can be reused as long as the scene's triangles stay the same.
    pub fn of(scene: &Scene, options: &SightOptions, framing: &OnceCell<Framing>) -> Self {
        let survey = || framing.get_or_init(|| Framing::of(scene));
        let mut notes = Vec::new();
        let known = options.camera.clone().or_else(|| scene.cameras.first().cloned());
        let camera = known.unwrap_or_else(|| {
            let (camera, (text, option)) = survey().chosen(options.aspect);
            notes.push(Note { about: "camera", text: text.to_owned(), option });
            camera
        });
        let light = match options.staging {
            Staging::None => None,
            Staging::Studio => {
                // The studio is dim enough for the scene's own emission to be visible.
                let emission = Emission::of(scene, &survey().rays);
                Some(survey().studio(&camera, &emission))
            }
            Staging::Sky => Some(survey().day(&camera)),
            Staging::Auto if scene.is_lit_by_design() => None,
            Staging::Auto => {
                let (light, note) = survey().light_where_needed(scene, &camera, options.aspect);
                notes.push(note);
                light
            }
        };
        // A survey of a large scene takes seconds, so only thin scenes are surveyed just for these
        // notes.
        let is_thin = options
            .fineness
            .voxel_m
            .is_some_and(|voxel_m| scene.bounds().size().min_element() < THIN * voxel_m);
        let may_survey = framing.get().is_some() || is_thin || scene.triangle_count() < LARGE;
        if options.fineness != Fineness::default() && may_survey {
            let rays = &survey().rays;
            let seen = light::seen(scene, rays, &camera, options.aspect);
            let seen = fineness::Seen { patches: &seen, rays };
            notes.extend(options.fineness.voxel_m.and_then(|voxel_m| seen.coarse_voxels(voxel_m)));
            let added = light.as_ref().map_or(&[][..], DefaultLight::lights);
            let lights = scene.lights.iter().chain(added);
            notes.extend(options.fineness.shadow_maps.and_then(|maps| {
                seen.coarse_shadows(lights, &maps, (scene.bounds(), camera.position))
            }));
        }
        Self { camera, light, notes }
    }
}

impl Framing {
    /// The light to add if the scene's own is not enough for a camera's view.
    fn light_where_needed(
        &self,
        scene: &Scene,
        camera: &Camera,
        aspect: f32,
    ) -> (Option<DefaultLight>, Note) {
        let standpoint = self.standpoint(camera);
        let emission = Emission::of(scene, &self.rays);
        let at = |points: &[Patch]| OwnLight::at(points, scene, &self.rays, &emission);
        let mut own = at(&light::seen(scene, &self.rays, camera, aspect));
        // Also measures the whole place, or the whole thing if the camera is the scene's own: the
        // dark view may then be intended.
        let whole = if self.is_place() {
            self.survey.patches.clone()
        } else if scene.cameras.contains(camera) {
            Subject::of(&self.rays, false).patches
        } else {
            Vec::new()
        };
        let whole = at(&whole);
        if !own.is_enough(standpoint) && whole.is_enough(standpoint) {
            own = whole;
        }
        let about = "light";
        if own.is_enough(standpoint) {
            let is_alone = scene.is_lit_by_emission_alone();
            let what = if is_alone { "its own emission alone" } else { "its own" };
            let text = format!("{what}, {} lux on what is seen", three_digits(own.lux(standpoint)));
            let option = "--surroundings studio or sky adds some";
            return (None, Note { about, text, option });
        }
        let light = self.light(camera, &emission);
        let option = match light {
            DefaultLight::SunAndSky { .. } => "--surroundings studio or none",
            DefaultLight::Studio { .. } => "--surroundings sky or none",
            DefaultLight::Lamps(_) => "--surroundings none",
        };
        let own = match own.lux(standpoint) {
            none if none <= 0.0 => "it has none of its own".to_owned(),
            some => {
                format!("its own gives what is seen {} lux, and not all of it", three_digits(some))
            }
        };
        let text = format!("{light}: {own}");
        (Some(light), Note { about, text, option })
    }
}

/// Formats a number with three digits.
pub(super) fn three_digits(value: f32) -> String {
    let digits = (2.0 - value.abs().max(1e-6).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

impl Scene {
    /// Chooses a camera, and adds light if the scene's own is not enough: see [`Sight`].
    pub fn stage(&mut self, options: &SightOptions) -> Sight {
        let sight = Sight::of(self, options, &OnceCell::new());
        self.light_up(&sight);
        sight
    }

    /// Adds the light of `sight`.
    pub fn light_up(&mut self, sight: &Sight) {
        if let Some(light) = &sight.light {
            tracing::info!("the scene \"{}\" is lit by {light}", self.name);
            light.light_up(self);
        }
    }

    /// Whether the author has lit the scene: it has surroundings, all its surfaces are unlit, or
    /// its lamps have a fall-off that is not physical.
    fn is_lit_by_design(&self) -> bool {
        let is_styled = self.lights.iter().any(|light| light.attenuation.is_some());
        is_styled || light::surroundings_shine(self) || light::is_unlit(self)
    }
}
