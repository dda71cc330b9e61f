//! The cameras with global illumination, as the render world knows them.

use bevy::camera::Exposure;
use bevy::color::LinearRgba;
use bevy::light::{
    AmbientLight, EnvironmentMapLight, GeneratedEnvironmentMapLight, GlobalAmbientLight,
};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;

use crate::irradiance::LitFrom;
use crate::settings::LumivoxGi;
use crate::surroundings::Surroundings;
use crate::volumes::{VolumeKey, Volumes};

/// A camera of this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GiView {
    /// In the render world.
    pub(crate) entity: Entity,
    pub(crate) gi: LumivoxGi,
    /// The volume that lights it.
    pub(crate) key: VolumeKey,
    /// The one that it asks for: another one while that is in the making.
    pub(crate) wanted: VolumeKey,
    pub(crate) position: Vec3,
    pub(crate) exposure: f32,
    /// Bevy's ambient light there, cd/m².
    pub(crate) ambient: Vec3,
    pub(crate) surroundings: Option<Surroundings>,
    /// It is the camera's own.
    has_own_ambient: bool,
    /// Its turn among cameras, and itself in the app's world.
    order: (isize, Entity),
}

/// How opaque things are drawn.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct Method {
    pub(crate) is_forward: bool,
}

/// The cameras of this frame.
#[derive(Resource, Default)]
pub(crate) struct GiViews {
    pub(crate) views: Vec<GiView>,
}

/// On a view whose ambient light is taken over.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct TakenOver {
    /// The camera's own ambient light is extracted in each frame, so that it comes back by itself.
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
    // The first one sets the unit of light: it stays the first when others come.
    gi_views.views.sort_by_key(|view| view.order);
    volumes.follow_exposure(&gi_views.views);
}

/// Keeps Bevy from adding ambient light to views whose voxels are ready: these let in what finds a way.
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
