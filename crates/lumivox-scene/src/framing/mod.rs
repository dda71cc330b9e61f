//! The first view of a scene: a camera and light for files that have none, or not enough.
//!
//! Everything is derived from one [survey](survey) of the scene by rays: a place (a room, a hall)
//! is viewed from inside, or through its opening if a wall is missing; a thing (a helmet, a
//! terrain) from outside, from the side that shows most of it. The scene's own light is measured
//! where the view's rays hit; if it is not enough, lamps light a closed place, sun and sky an open
//! one, and a studio everything else. All computation is in a [unit space](rays), so a scene in
//! millimetres gives the same result as one in kilometres.
//!
//! It takes about 300 000 rays and is deterministic.
//!
//! | file | has |
//! | --- | --- |
//! | `sight.rs` | the decision: [`Sight`], which every front end uses |
//! | `rays.rs` | all triangles in unit space, and the first surface in a direction |
//! | `survey.rs` | a place or a thing? |
//! | `inside.rs`, `outside.rs` | the view of a place and of a thing |
//! | `light.rs` | the scene's own light on what is seen |
//! | `lights.rs`, `stage.rs` | default lights, and the ground of a studio |

mod directions;
mod fineness;
mod inside;
mod light;
mod lights;
mod outside;
mod rays;
mod sight;
mod stage;
mod survey;

use crate::{Camera, Scene};
use light::Standpoint;
use outside::Subject;
use rays::Rays;
use survey::Survey;

pub use fineness::{Fineness, Shade, ShadowMapFineness};
pub use sight::{Note, Sight, SightOptions, Staging};
pub use stage::{DefaultLight, Ground};

/// A place with a smaller mean share of gaps around its points counts as closed: a window in a
/// tenth of one wall is a larger gap.
const CLOSED: f32 = 0.01;
/// If this share of a place is visible from outside, a wall is missing, and the view is from
/// outside.
const OPEN_FRONT: f32 = 0.6;
/// If this share of a place is visible through an opening, a camera that must be outside looks
/// through it.
const OPENING: f32 = 0.3;
/// A camera with surfaces in this share of all directions is inside. In front of something flat the
/// share is less than half.
const AROUND: f32 = 0.55;
/// The number of directions that are tested for `AROUND`.
const LOOKS: usize = 96;

/// The result of the survey of a scene, for a default camera and default lights. It borrows
/// nothing: make it once and use it for both.
///
/// For a million triangles it takes 1.3 s, 260 MB, and 130 MB afterwards; for ten million, which
/// are simplified first, 1.9 s and 100 MB (debug build, one core of a busy machine).
pub struct Framing {
    rays: Rays,
    survey: Survey,
}

impl std::fmt::Debug for Framing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Framing")
            .field("is_place", &self.is_place())
            .field("is_enclosed", &self.is_enclosed())
            .field("triangles", &self.rays.triangles.len())
            .finish_non_exhaustive()
    }
}

impl Framing {
    /// Surveys a scene. A scene without triangles, which is invalid, counts as a thing.
    pub fn of(scene: &Scene) -> Self {
        let rays = Rays::of(scene);
        let survey = Survey::of(&rays);
        Self { rays, survey }
    }

    /// Whether the scene is a place to stand in, such as a room or a hall (possibly with windows or
    /// an open roof), rather than a thing to look at from outside.
    pub fn is_place(&self) -> bool {
        self.survey.is_place()
    }

    /// Whether it is a place with hardly any gap to the outside: at most a small window.
    pub fn is_enclosed(&self) -> bool {
        self.is_place() && self.survey.sky < CLOSED
    }

    /// The best view of the scene for a picture of that aspect (width over height): a place from
    /// inside, a thing from outside. If a wall of the place is missing, the view is through the
    /// open side.
    pub fn camera(&self, aspect: f32) -> Camera {
        self.chosen(aspect).0
    }

    /// The default camera, with the reason for its choice and the option that overrides it.
    fn chosen(&self, aspect: f32) -> (Camera, (&'static str, &'static str)) {
        let aspect = sane(aspect);
        let subject = Subject::of(&self.rays, self.is_place());
        if !self.is_place() {
            let text = if subject.is_part {
                "from outside, fitted to what stands on the ground"
            } else {
                "from outside, where most of it is seen"
            };
            return (self.place(&subject.view(&self.rays, aspect)), (text, "--camera inside"));
        }
        let patches = &self.survey.patches;
        let through = subject.view_into(&self.rays, patches, aspect);
        let share = outside::share(&self.rays, patches, through.position);
        match inside::view(&self.rays, &self.survey.interior, patches, aspect) {
            Some((view, within)) if share < OPEN_FRONT && share <= within => {
                let text = "from inside, where most of the place is seen";
                (self.place(&view), (text, "--camera outside"))
            }
            _ => {
                let text = "from outside, through the side that is open";
                (self.place(&through), (text, "--camera inside"))
            }
        }
    }

    /// A view of the whole scene from outside, with a vertical field of view of 45 degrees, as
    /// large as it fits into a picture of that aspect. It shows as much of the surface as possible,
    /// and a place through its opening.
    pub fn outside(&self, aspect: f32) -> Camera {
        let (rays, patches, aspect) = (&self.rays, &self.survey.patches, sane(aspect));
        let subject = Subject::of(rays, self.is_place());
        let through = subject.view_into(rays, patches, aspect);
        if outside::share(rays, patches, through.position) >= OPENING {
            return self.place(&through);
        }
        self.place(&subject.view(rays, aspect))
    }

    /// A view along a place, from the free spot that shows the most of it; for a hollow thing, such
    /// a view of its inside. `None` if there is no space for a camera.
    ///
    /// The height of the eye over the floor follows from the free height and width: 1.6 m in a
    /// living room of 3 m, about a third of a hall.
    pub fn inside(&self, aspect: f32) -> Option<Camera> {
        let (points, patches) = self.survey.within(&self.rays);
        let (view, _) = inside::view(&self.rays, &points, &patches, sane(aspect))?;
        Some(self.place(&view))
    }

    /// Whether a camera has surfaces nearly all around.
    fn surrounds(&self, camera: &Camera) -> bool {
        let eye = self.rays.unit.unit_from_world(camera.position);
        let around = directions::sphere(LOOKS).filter(|&way| self.rays.cast(eye, way).is_some());
        around.count() as f32 >= AROUND * LOOKS as f32
    }

    /// The standpoint of a camera.
    fn standpoint(&self, camera: &Camera) -> Standpoint {
        if !self.is_place() {
            return Standpoint::Outside;
        }
        let is_inside = self.surrounds(camera);
        // Walls that are only modelled for the inside are transparent from outside, so the room is
        // visible.
        if self.is_enclosed() && (is_inside || self.survey.is_made_for_inside) {
            Standpoint::ClosedRoom
        } else {
            Standpoint::OpenPlace
        }
    }

    /// A view in unit space as a camera in the world.
    fn place(&self, view: &Camera) -> Camera {
        let unit = self.rays.unit;
        Camera {
            name: "framing".to_owned(),
            near_m: (view.near_m * unit.scale_m).max(f32::MIN_POSITIVE),
            ..Camera::look_at(
                unit.world_from_unit(view.position),
                unit.world_from_unit(view.position + view.forward),
                view.vertical_fov_rad,
            )
        }
    }
}

/// Limits the aspect to that of possible pictures.
fn sane(aspect: f32) -> f32 {
    if aspect.is_finite() { aspect.clamp(0.05, 20.0) } else { 1.0 }
}

impl Scene {
    /// A camera for a scene without one: see [`Framing::camera`].
    pub fn default_camera(&self, aspect: f32) -> Camera {
        Framing::of(self).camera(aspect)
    }
}

#[cfg(test)]
mod tests;
