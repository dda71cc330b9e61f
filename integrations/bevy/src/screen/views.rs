//! The cameras with global illumination, in the render world.

use bevy::camera::Exposure;
use bevy::color::LinearRgba;
use bevy::light::{
    AmbientLight, EnvironmentMapLight, GeneratedEnvironmentMapLight, GlobalAmbientLight,
};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;

use crate::light::irradiance::LitFrom;
use crate::light::surroundings::Surroundings;
use crate::settings::LumivoxGi;
use crate::volumes::{VolumeKey, Volumes};

/// A camera of this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GiView {
    /// The camera's entity in the render world.
    pub(crate) entity: Entity,
    pub(crate) gi: LumivoxGi,
    /// The volume that lights it.
    pub(crate) key: VolumeKey,
    /// The volume that it asks for; differs from `key` while that volume is being made.
    pub(crate) wanted: VolumeKey,
    pub(crate) position: Vec3,
    pub(crate) exposure: f32,
    /// Bevy's ambient light for this camera, cd/m².
    pub(crate) ambient: Vec3,
    pub(crate) surroundings: Option<Surroundings>,
    /// Whether the ambient light is the camera's own component.
    has_own_ambient: bool,
    /// The camera's `order`, and its entity in the main world.
    order: (isize, Entity),
}

/// How opaque objects are drawn.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct Method {
    pub(crate) is_forward: bool,
}

/// The cameras of this frame.
#[derive(Resource, Default)]
pub(crate) struct GiViews {
    pub(crate) views: Vec<GiView>,
}

/// Marks a view whose ambient light is disabled.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct TakenOver {
    /// `true` if the ambient light is the camera's own: Bevy extracts it every frame, so it returns
    /// by itself.
    comes_back: bool,
}

pub(crate) fn extract_views(
    mut gi_views: ResMut<GiViews>,
    mut volumes: ResMut<Volumes>,
    cameras: Extract<
        Query<(
            Entity,
            RenderEntity,
            &Camera,
            (&LumivoxGi, Option<&LitFrom>),
            &GlobalTransform,
            Option<&Exposure>,
            Option<&AmbientLight>,
            Option<&EnvironmentMapLight>,
            Option<&GeneratedEnvironmentMapLight>,
        )>,
    >,
    everywhere: Extract<Option<Res<GlobalAmbientLight>>>,
) {
    gi_views.views.clear();
    for (
        camera_entity,
        entity,
        camera,
        (gi, lit_from),
        transform,
        exposure,
        ambient,
        map,
        generated,
    ) in &cameras
    {
        let has_picture =
            camera.physical_viewport_size().is_some_and(|size| size.min_element() > 0);
        if !camera.is_active || !has_picture {
            continue;
        }
        let color = |color: Color, brightness: f32| LinearRgba::from(color).to_vec3() * brightness;
        let everywhere = everywhere.as_ref().map(|light| color(light.color, light.brightness));
        let own = ambient.map(|light| color(light.color, light.brightness));
        gi_views.views.push(GiView {
            entity,
            gi: *gi,
            key: LitFrom::key(lit_from, gi, camera_entity),
            wanted: VolumeKey::new(&gi.volume, camera_entity),
            position: transform.translation(),
            exposure: exposure.copied().unwrap_or_default().exposure(),
            ambient: own.or(everywhere).unwrap_or_default().max(Vec3::ZERO),
            surroundings: map.and_then(|map| Surroundings::new(map, generated)),
            has_own_ambient: own.is_some(),
            order: (camera.order, camera_entity),
        });
    }
    // The first camera sets the unit of light, and must stay the first when others are added.
    gi_views.views.sort_by_key(|view| view.order);
    volumes.follow_exposure(&gi_views.views);
}

/// Disables Bevy's ambient light in views whose voxels are ready: the cones gather it instead.
pub(crate) fn take_ambient_over(
    mut commands: Commands,
    gi_views: Res<GiViews>,
    volumes: Res<Volumes>,
    mut views: Query<(Entity, Option<&mut AmbientLight>, Option<&TakenOver>)>,
    taken: Query<(Entity, &TakenOver)>,
) {
    let is_ready = |view: &&GiView| volumes.shown(&view.key).is_some();
    for view in gi_views.views.iter().filter(is_ready) {
        let Ok((entity, ambient, taken)) = views.get_mut(view.entity) else { continue };
        match ambient {
            Some(mut ambient) => ambient.brightness = 0.0,
            None => {
                let none = AmbientLight { brightness: 0.0, ..AmbientLight::default() };
                commands.entity(entity).insert(none);
            }
        }
        if taken.is_none() {
            commands.entity(entity).insert(TakenOver { comes_back: view.has_own_ambient });
        }
    }
    for (entity, over) in &taken {
        if gi_views.views.iter().filter(is_ready).any(|view| view.entity == entity) {
            continue;
        }
        commands.entity(entity).remove::<TakenOver>();
        if !over.comes_back {
            commands.entity(entity).remove::<AmbientLight>();
        }
    }
}
