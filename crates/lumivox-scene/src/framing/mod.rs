//! Where to look from, and what shines, in scenes that bring no camera or no light.
//!
//! Both follow from one [survey](survey) of the scene by rays: a place (a room, a hall) is looked at
//! from inside, a thing (a helmet, a terrain) from outside; sun and sky light what they reach, lamps
//! what is closed. Everything happens in a [unit space](soup), so that it makes no difference whether
//! a scene is modelled in millimetres or in kilometres; the one exception is the height of the eye in
//! places of a building's size, which is a person's.
//!
//! It takes about 200 000 rays, and the same scene always gives the same answer.
//!
//! | file | has |
//! | --- | --- |
//! | `soup.rs` | all triangles in unit space, simplified where there are more than a million |
//! | `rays.rs` | what lies in a direction |
//! | `survey.rs` | a place or a thing? |
//! | `inside.rs`, `outside.rs` | the view of a place and of a thing |
//! | `shines.rs` | whether anything shines |
//! | `sun.rs`, `lamps.rs` | default lights |

mod directions;
mod inside;
mod lamps;
mod outside;
mod rays;
mod shines;
mod soup;
mod sun;
mod survey;

use std::sync::Arc;

use glam::Vec3;

use crate::{Camera, Environment, EnvironmentMap, Light, Scene};
use inside::Inside;
use outside::View;
use rays::Rays;
use soup::{Soup, Unit};
use survey::Survey;

/// Below this mean share of gaps around the points of a place it counts as closed: a window of a
/// tenth of one wall lets in more.
const CLOSED: f32 = 0.01;

/// What rays found out about a scene, for a default camera and default lights. It borrows nothing:
/// make it once where both are wanted.
///
/// For a million triangles it takes 1.3 s, 260 MB, and 130 MB afterwards; for ten million, which are
/// simplified first, 1.9 s and 100 MB (debug build, one core of a busy machine).
pub struct Framing {
    unit: Unit,
    soup: Soup,
    rays: Rays,
    survey: Survey,
}

impl std::fmt::Debug for Framing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Framing")
            .field("is_place", &self.is_place())
            .field("is_enclosed", &self.is_enclosed())
            .field("triangles", &self.soup.triangles.len())
            .finish_non_exhaustive()
    }
}

impl Framing {
    /// Surveys a scene. A scene without triangles, which has not been validated, is no place.
    pub fn of(scene: &Scene) -> Self {
        let unit = Unit::of(scene.bounds());
        let soup = Soup::of(scene, unit);
        let rays = Rays::new(&soup);
        let survey = Survey::new(&rays, unit.half);
        Self { unit, soup, rays, survey }
    }

    /// Whether the scene is a place to stand in, such as a room or a hall (maybe with windows or an
    /// open roof), rather than a thing to look at from outside.
    pub fn is_place(&self) -> bool {
        self.survey.is_place
    }

    /// Whether it is a place with hardly a gap to the outside: no more than a small window.
    pub fn is_enclosed(&self) -> bool {
        self.is_place() && self.survey.sky() < CLOSED
    }

    /// The view that shows the scene best in a picture of that aspect, its width over its height: a
    /// place from inside, a thing from outside. Where a place lacks a wall, the view from there may
    /// show more of it; then that is taken.
    pub fn camera(&self, aspect: f32) -> Camera {
        let aspect = sane(aspect);
        let outside = outside::view(&self.rays, &self.soup, self.unit.half, aspect);
        let Some(inside) = self.best_inside(aspect) else { return self.place(&outside) };
        let share = inside::share(&self.rays, &self.survey.patches, &outside, aspect);
        self.place(if share > inside.share { &outside } else { &inside.view })
    }

    /// A three-quarter view of the whole from outside, with a vertical field of view of 45 degrees,
    /// as large as it fits into a picture of that aspect. It looks from where most fronts are seen.
    pub fn outside(&self, aspect: f32) -> Camera {
        self.place(&outside::view(&self.rays, &self.soup, self.unit.half, sane(aspect)))
    }

    /// A view along a place, from a free spot that shows the most of it; `None` where the scene is no
    /// place.
    ///
    /// The eye is 1.6 m above the floor where the place has the size of a building, elsewhere at half
    /// of the free height or width, whichever is less.
    pub fn inside(&self, aspect: f32) -> Option<Camera> {
        Some(self.place(&self.best_inside(sane(aspect))?.view))
    }

    fn best_inside(&self, aspect: f32) -> Option<Inside> {
        inside::view(&self.rays, &self.survey, self.unit.scale_m, aspect)
    }

    /// Lights for the scene as if nothing shone in it, to suit a view by `camera`.
    pub fn light(&self, camera: &Camera) -> DefaultLight {
        let lamps = if self.is_enclosed() { self.lamps() } else { Vec::new() };
        if !lamps.is_empty() {
            return DefaultLight::Lamps(lamps);
        }
        let eye = self.unit.unit_from_world(camera.position);
        let towards_sun = sun::direction(&self.rays, &self.survey.patches, eye, camera.forward);
        sun::day(towards_sun)
    }

    fn lamps(&self) -> Vec<Light> {
        lamps::lamps(&self.rays, &self.survey.interior)
            .into_iter()
            .map(|lamp| lamp.light(self.unit))
            .collect()
    }

    fn place(&self, view: &View) -> Camera {
        Camera {
            name: "framing".to_owned(),
            near_m: (view.near * self.unit.scale_m).max(f32::MIN_POSITIVE),
            ..Camera::look_at(
                self.unit.world_from_unit(view.position),
                self.unit.world_from_unit(view.position + view.forward),
                view.vertical_fov_rad,
            )
        }
    }
}

/// An aspect that a picture can have.
fn sane(aspect: f32) -> f32 {
    if aspect.is_finite() { aspect.clamp(0.05, 20.0) } else { 1.0 }
}

/// Light for a scene in which nothing shines; physical values in all cases.
#[derive(Clone, Debug, PartialEq)]
pub enum DefaultLight {
    /// The sun and the [sky](crate::sky) of a clear day. In a place the sun stands where it lights
    /// most of what is inside, otherwise to the left of the camera, 50 degrees high.
    SunAndSky {
        /// The sun.
        sun: Light,
        /// The sky, in cd/m².
        sky: Arc<EnvironmentMap>,
    },
    /// A lamp below the ceiling of each closed room, eight at most: each gives the surfaces that it
    /// reaches 300 lux in the mean, whatever the room's size.
    Lamps(Vec<Light>),
}

impl std::fmt::Display for DefaultLight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::SunAndSky { .. } => write!(f, "the sun and the sky of a clear day"),
            Self::Lamps(lamps) if lamps.len() == 1 => write!(f, "a lamp of 300 lux"),
            Self::Lamps(lamps) => write!(f, "{} lamps of 300 lux", lamps.len()),
        }
    }
}

impl Scene {
    /// A camera for a scene that brings none: see [`Framing::camera`].
    pub fn default_camera(&self, aspect: f32) -> Camera {
        Framing::of(self).camera(aspect)
    }

    /// Whether the scene is a closed room, maybe with a small window: see [`Framing::is_enclosed`].
    pub fn is_enclosed(&self) -> bool {
        Framing::of(self).is_enclosed()
    }

    /// Whether there is any light: a lamp, an environment, or a surface in use that emits or takes no
    /// light (all of them, in the last case).
    pub fn shines(&self) -> bool {
        shines::shines(self)
    }

    /// Lights a scene in which nothing [shines](Scene::shines), and says how: under the open sky by
    /// the sun and sky of a clear day, in closed rooms by lamps of 300 lux. `None`, and no change, where
    /// something shines.
    ///
    /// `camera` is the one that the scene will be seen by; `None` stands for the scene's first, or the
    /// default one.
    pub fn add_default_light(&mut self, camera: Option<&Camera>) -> Option<DefaultLight> {
        if self.shines() {
            return None;
        }
        let framing = Framing::of(self);
        let camera = camera.or(self.cameras.first()).cloned();
        let light = framing.light(&camera.unwrap_or_else(|| framing.camera(1.0)));
        tracing::warn!(
            "nothing shines in the scene \"{}\": it is lit by {light}; add a light, an environment or \
             an emissive material",
            self.name
        );
        match &light {
            DefaultLight::SunAndSky { sun, sky } => {
                // Behind those that are there but dark: a rig knows its own by their places.
                self.lights.push(sun.clone());
                self.environment =
                    Environment { radiance: Vec3::ONE, map: Some(sky.clone()), rotation_rad: 0.0 };
            }
            DefaultLight::Lamps(lamps) => self.lights.extend(lamps.iter().cloned()),
        }
        Some(light)
    }
}

#[cfg(test)]
mod tests;
