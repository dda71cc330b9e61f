#![doc = include_str!("../README.md")]

mod light;
mod report;
mod scene;
mod screen;
mod settings;
mod volumes;

use std::marker::PhantomData;

use bevy::camera::visibility::VisibilitySystems;
use bevy::core_pipeline::core_3d::{main_opaque_pass_3d, main_transparent_pass_3d};
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::ecs::message::MessageUpdateSystems;
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::pbr::deferred::deferred_lighting;
use bevy::prelude::*;
use bevy::render::mesh::allocator::MeshAllocatorSettings;
use bevy::render::render_resource::BufferUsages;
use bevy::render::renderer::RenderDevice;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderSystems};

pub use lumivox;
pub use report::LumivoxEvent;
pub use scene::material::{GiSurface, GiTexture, LumivoxMaterial};
pub use settings::{GiQuality, GiVolume, LumivoxGi, NotInGi};

use report::Reports;

/// Plugin for global illumination on cameras with [`LumivoxGi`].
///
/// Add it after `DefaultPlugins`. It makes deferred rendering the default for opaque materials
/// ([`DefaultOpaqueRendererMethod::deferred`]), except with [`Self::forward`].
///
/// ```no_run
/// use bevy::prelude::*;
/// use bevy_lumivox::{LumivoxGi, LumivoxPlugin};
///
/// App::new()
///     .add_plugins((DefaultPlugins, LumivoxPlugin::default()))
///     .add_systems(Startup, |mut commands: Commands| {
///         commands.spawn((Camera3d::default(), LumivoxGi::default()));
///     })
///     .run();
/// ```
#[derive(Debug, Default)]
pub struct LumivoxPlugin {
    is_forward: bool,
}

impl LumivoxPlugin {
    /// For apps that render forward, because they use multisampling or many custom materials. All
    /// indirect light then comes from probes, one per four voxels along each axis, which otherwise
    /// light only transparent objects. It is softer and cheaper than cones per pixel, and diffuse
    /// only. Glossy surfaces reflect the camera's environment map, as they do without this plugin.
    pub fn forward() -> Self {
        Self { is_forward: true }
    }
}

/// Adds a material type to the voxels. [`LumivoxPlugin`] already adds [`StandardMaterial`].
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_lumivox::{LumivoxMaterial, LumivoxMaterialPlugin};
/// # fn add<Rock: LumivoxMaterial>(app: &mut App) {
/// app.add_plugins(LumivoxMaterialPlugin::<Rock>::default());
/// # }
/// ```
#[derive(Debug)]
pub struct LumivoxMaterialPlugin<M: LumivoxMaterial>(PhantomData<M>);

impl<M: LumivoxMaterial> Default for LumivoxMaterialPlugin<M> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

/// The systems of one frame's extraction.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
enum Extraction {
    Begin,
    Read,
}

impl Plugin for LumivoxPlugin {
    fn build(&self, app: &mut App) {
        let (reports, offers) = (Reports::default(), light::irradiance::Offers::default());
        if !self.is_forward {
            app.insert_resource(DefaultOpaqueRendererMethod::deferred())
                .add_observer(settings::draw_deferred)
                .add_observer(settings::draw_gbuffer);
        }
        app.insert_resource(reports.clone())
            .insert_resource(offers.clone())
            .add_message::<LumivoxEvent>()
            .register_type::<LumivoxGi>()
            .register_type::<NotInGi>()
            .add_systems(First, report::deliver.after(MessageUpdateSystems))
            .add_systems(
                First,
                (light::irradiance::follow_offers, light::irradiance::choose_keys).chain(),
            )
            .add_systems(
                PostUpdate,
                light::irradiance::choose_volumes.after(VisibilitySystems::CheckVisibility),
            );
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .insert_resource(reports)
            .insert_resource(offers)
            .insert_resource(screen::views::Method { is_forward: self.is_forward })
            .init_resource::<light::irradiance::ShownVolumes>()
            .init_resource::<screen::views::GiViews>()
            .init_resource::<light::lights::SceneLights>()
            .init_resource::<scene::instances::Instances>()
            .init_resource::<scene::material::Surfaces>()
            .init_resource::<scene::surfaces::SurfaceTable>()
            .init_resource::<scene::textures::TextureCopies>()
            .init_resource::<scene::geometry::SceneGeometry>()
            .init_resource::<scene::deform::Deformer>()
            .init_resource::<scene::deform::ScenePoses>()
            .init_resource::<scene::ChangedImages>()
            .init_resource::<volumes::Volumes>()
            .configure_sets(ExtractSchedule, (Extraction::Begin, Extraction::Read).chain())
            .add_systems(
                ExtractSchedule,
                (
                    scene::instances::begin_instances.in_set(Extraction::Begin),
                    screen::views::extract_views.in_set(Extraction::Read),
                    light::lights::extract_scene_lights.in_set(Extraction::Read),
                    light::irradiance::extract_volumes.in_set(Extraction::Read),
                    scene::deform::extract_poses.in_set(Extraction::Read),
                    scene::extract_changed_images.in_set(Extraction::Read),
                ),
            )
            .add_systems(
                Render,
                (
                    // Before Bevy chooses pipelines from the views' components.
                    (screen::views::take_ambient_over, light::surroundings::take_maps_over)
                        .after(RenderSystems::ExtractCommands)
                        .before(RenderSystems::PrepareAssets),
                    scene::update_scene.in_set(RenderSystems::PrepareResources),
                    screen::prepare_screens.in_set(RenderSystems::PrepareBindGroups),
                ),
            )
            .add_systems(
                Core3d,
                (
                    light::irradiance::fill_volume
                        .after(deferred_lighting)
                        .before(main_opaque_pass_3d),
                    (volumes::record_volume, screen::light_screen)
                        .chain()
                        .after(main_opaque_pass_3d)
                        .before(main_transparent_pass_3d),
                    light::irradiance::empty_volume.after(main_transparent_pass_3d),
                )
                    .in_set(Core3dSystems::MainPass),
            );
        app.add_plugins(LumivoxMaterialPlugin::<StandardMaterial>::default());
    }

    fn finish(&self, app: &mut App) {
        let reports = app.world().resource::<Reports>().clone();
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            let missing = "there is no renderer: add `RenderPlugin` with a backend".to_owned();
            reports.once(LumivoxEvent::Unsupported { missing });
            return;
        };
        // Voxelization reads meshes in place. It binds whole slabs, so these must fit a binding.
        let limits = render_app.world().get_resource::<RenderDevice>().map(RenderDevice::limits);
        if let Some(mut settings) =
            render_app.world_mut().get_resource_mut::<MeshAllocatorSettings>()
        {
            settings.extra_buffer_usages |= BufferUsages::STORAGE;
            if let Some(limits) = limits {
                let most = limits.max_storage_buffer_binding_size;
                let settings = &mut settings.slab_allocator_settings;
                settings.max_slab_size = settings.max_slab_size.min(most);
                settings.min_slab_size = settings.min_slab_size.min(most);
            }
        }
    }
}

impl<M: LumivoxMaterial> Plugin for LumivoxMaterialPlugin<M> {
    fn build(&self, app: &mut App) {
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app.add_systems(
                ExtractSchedule,
                (scene::instances::extract_instances::<M>, scene::material::extract_surfaces::<M>)
                    .in_set(Extraction::Read),
            );
        }
    }
}
