//! Shared by the tests: an app with a scene, a camera, and a picture.

use std::sync::{Mutex, MutexGuard, PoisonError};

use bevy::camera::{Exposure, RenderTarget};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::light::{DirectionalLightShadowMap, GlobalAmbientLight, PointLightShadowMap};
use bevy::prelude::*;
use bevy::render::settings::WgpuLimits;
use bevy_lumivox::{GiQuality, GiVolume, LumivoxEvent, LumivoxGi, LumivoxPlugin};
use lumivox_scene::Scene;

use crate::common::{headless, scene};

/// An app without ambient light, whose camera has no global illumination yet.
pub struct Stage {
    pub app: App,
    pub camera: Entity,
    pub image: Handle<Image>,
    spawned: scene::Spawned,
    view: (Transform, Projection),
}

/// Runs tests one at a time: they count live GPU resources, and each uses all cores.
pub fn alone() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Quick, deterministic settings.
pub fn quick() -> LumivoxGi {
    LumivoxGi {
        quality: GiQuality::Realtime,
        volume: GiVolume::Scene { resolution: 32 },
        faces_per_frame: 0,
        ..LumivoxGi::default()
    }
}

impl Stage {
    pub fn of(given: &Scene, size: UVec2) -> Self {
        Self::with(LumivoxPlugin::default(), None, given, size)
    }

    /// A stage on a device with at most these limits.
    pub fn on(limits: Option<WgpuLimits>, given: &Scene, size: UVec2) -> Self {
        Self::with(LumivoxPlugin::default(), limits, given, size)
    }

    /// A stage drawn forward.
    pub fn forward(given: &Scene, size: UVec2) -> Self {
        Self::with(LumivoxPlugin::forward(), None, given, size)
    }

    fn with(plugin: LumivoxPlugin, limits: Option<WgpuLimits>, given: &Scene, size: UVec2) -> Self {
        let mut app = App::new();
        app.add_plugins((headless::plugins(limits), plugin));
        app.insert_resource(ClearColor(Color::BLACK));
        app.insert_resource(GlobalAmbientLight::NONE);
        headless::start(&mut app);
        let spawned = scene::spawn(app.world_mut(), given);
        let (image, target) = headless::target(&mut app, size);
        let (camera, view) = (Entity::PLACEHOLDER, scene::camera(given));
        let mut stage = Self { app, camera, image, spawned, view };
        stage.camera = stage.add_camera(target);
        stage
    }

    /// Another camera at the scene's view, without global illumination.
    pub fn add_camera(&mut self, target: RenderTarget) -> Entity {
        let look = (Tonemapping::None, DebandDither::Disabled, Exposure { ev100: 4.0 });
        let parts = (Camera3d::default(), target, self.view.clone(), look);
        self.app.world_mut().spawn(parts).id()
    }

    /// The Cornell box with global illumination, ready.
    pub fn cornell() -> Self {
        Self::ready(&scene::builtin("cornell"))
    }

    /// A scene with global illumination, ready.
    pub fn ready(given: &Scene) -> Self {
        let mut stage = Self::of(given, UVec2::new(48, 36));
        stage.use_small_shadow_maps();
        stage.app.world_mut().entity_mut(stage.camera).insert(quick());
        headless::wait_until_ready(&mut stage.app);
        stage
    }

    /// The software GPU clears and fills shadow maps in each frame.
    pub fn use_small_shadow_maps(&mut self) {
        self.app.insert_resource(PointLightShadowMap { size: 256 });
        self.app.insert_resource(DirectionalLightShadowMap { size: 256 });
    }

    /// The entity of an instance of the Cornell box, by its name.
    pub fn instance(&self, name: &str) -> Entity {
        let given = scene::builtin("cornell");
        let index = given.instances.iter().position(|instance| instance.name == name);
        self.spawned.instances[index.expect("an instance of that name")]
    }

    pub fn add<A: Asset>(&mut self, asset: A) -> Handle<A> {
        self.app.world_mut().resource_mut::<Assets<A>>().add(asset)
    }

    pub fn camera(&mut self) -> EntityWorldMut<'_> {
        self.app.world_mut().entity_mut(self.camera)
    }

    /// The settings of the camera's global illumination.
    pub fn gi(&mut self) -> Mut<'_, LumivoxGi> {
        self.app.world_mut().get_mut(self.camera).expect("global illumination")
    }

    pub fn place(&mut self, entity: Entity, at: Vec3) {
        let mut transform = self.app.world_mut().get_mut::<Transform>(entity);
        transform.as_mut().expect("a transform").translation = at;
    }

    pub fn frames(&mut self, count: u32) {
        for _ in 0..count {
            self.app.update();
        }
    }

    /// The picture of another frame.
    pub fn next(&mut self) -> headless::Shot {
        self.app.update();
        headless::shot(&self.app, &self.image)
    }

    /// The mean of frames once light has settled.
    pub fn settled(&mut self) -> headless::Shot {
        self.settled_over(8)
    }

    /// The mean of some frames once light has settled.
    pub fn settled_over(&mut self, frames: u32) -> headless::Shot {
        self.frames(16);
        headless::mean_shot(&mut self.app, &self.image.clone(), frames)
    }

    /// Pictures of the frames until another volume is lit and shown.
    pub fn until_ready(&mut self) -> Vec<headless::Shot> {
        let mut shots = Vec::new();
        while !self.events().contains(&LumivoxEvent::Ready) {
            assert!(shots.len() < 400, "no global illumination after 400 frames");
            shots.push(self.next());
        }
        shots.extend((0..8).map(|_| self.next()));
        shots
    }

    /// The events of the last frame.
    pub fn events(&self) -> Vec<LumivoxEvent> {
        let messages = self.app.world().resource::<Messages<LumivoxEvent>>();
        messages.iter_current_update_messages().cloned().collect()
    }

    /// Runs frames until an event matches.
    pub fn wait_for(&mut self, is_it: impl Fn(&LumivoxEvent) -> bool) -> LumivoxEvent {
        for _ in 0..300 {
            self.app.update();
            if let Some(event) = self.events().into_iter().find(&is_it) {
                return event;
            }
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        panic!("it was not told within 300 frames");
    }
}

/// Root mean square of the difference of two pictures, as a share of the mean of the second.
pub fn difference(one: &headless::Shot, other: &headless::Shot) -> f32 {
    assert_eq!(one.size, other.size);
    let pixels = one.rgb.iter().zip(&other.rgb);
    let squares: f32 = pixels.map(|(one, other)| headless::luminance(*one - *other).powi(2)).sum();
    (squares / one.rgb.len() as f32).sqrt() / other.mean_luminance()
}

/// Clamps the lamp, the only very bright thing: its edges depend on the samples.
pub fn without_lamp(shot: &headless::Shot) -> headless::Shot {
    let rgb = shot.rgb.iter().map(|rgb| rgb.min(Vec3::splat(0.3))).collect();
    headless::Shot { size: shot.size, rgb }
}
