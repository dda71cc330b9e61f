//! Updates the scene every frame: materials, geometry, volumes.

pub(crate) mod deform;
pub(crate) mod geometry;
pub(crate) mod instances;
pub(crate) mod material;
pub(crate) mod surfaces;
pub(crate) mod textures;

use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::mesh::RenderMesh;
use bevy::render::mesh::allocator::MeshAllocator;
use bevy::render::render_asset::RenderAssets;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::texture::GpuImage;

use crate::light::irradiance::Offers;
use crate::report::Reports;
use crate::scene::deform::{Deformer, ScenePoses};
use crate::scene::geometry::{SceneGeometry, Sources};
use crate::scene::instances::Instances;
use crate::scene::material::Surfaces;
use crate::scene::surfaces::{SurfaceSources, SurfaceTable};
use crate::scene::textures::{Prepared, TextureCopies};
use crate::screen::views::GiViews;
use crate::volumes::Volumes;

/// Frames for which textures are looked up again after images change: Bevy uploads only some per
/// frame.
const UNSETTLED_FRAMES: u32 = 4;

/// Images that may have changed.
#[derive(Resource, Default)]
pub(crate) struct ChangedImages {
    unsettled: u32,
    /// Images with new content, perhaps in the same texture.
    modified: HashSet<AssetId<Image>>,
    is_due: bool,
}

impl ChangedImages {
    /// The modified images if they are due. They are read twice, since Bevy uploads an image at
    /// once or some frames later.
    pub(crate) fn due(&self) -> Option<&HashSet<AssetId<Image>>> {
        self.is_due.then_some(&self.modified)
    }
}

pub(crate) fn extract_changed_images(
    mut changed: ResMut<ChangedImages>,
    mut events: Extract<MessageReader<AssetEvent<Image>>>,
) {
    if changed.unsettled == 0 {
        changed.modified.clear();
    }
    for event in events.read() {
        changed.unsettled = UNSETTLED_FRAMES;
        if let AssetEvent::Modified { id } = event {
            changed.modified.insert(*id);
        }
    }
    changed.is_due = changed.unsettled == UNSETTLED_FRAMES || changed.unsettled == 1;
}

/// Applies the extracted changes, after Bevy has uploaded meshes and images.
pub(crate) fn update_scene(
    mut scene: ResMut<SceneGeometry>,
    mut table: ResMut<SurfaceTable>,
    mut volumes: ResMut<Volumes>,
    mut instances: ResMut<Instances>,
    mut surfaces: ResMut<Surfaces>,
    mut changed_images: ResMut<ChangedImages>,
    mut copies: ResMut<TextureCopies>,
    (mut deformer, poses): (ResMut<Deformer>, Res<ScenePoses>),
    views: Res<GiViews>,
    (meshes, allocator, images): (
        Res<RenderAssets<RenderMesh>>,
        Res<MeshAllocator>,
        Res<RenderAssets<GpuImage>>,
    ),
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    (reports, offers): (Res<Reports>, Res<Offers>),
) {
    // Without a camera, changes wait.
    if views.views.is_empty() {
        instances.skip();
        volumes.follow(&[], &instances, (&device, &queue), &reports);
        if volumes.are_gone() {
            scene.clear(&mut deformer);
            offers.set(std::iter::empty());
        }
        return;
    }
    let pipelines = volumes.pipelines(&device);
    let sources = SurfaceSources {
        surfaces: &surfaces,
        images: &images,
        images_changed: changed_images.unsettled > 0,
        exposure: volumes.exposure(),
        unit: volumes.unit(),
        exposure_changed: volumes.take_exposure_changed(),
    };
    if let Some(modified) = changed_images.due() {
        copies.forget(modified);
    }
    let mut prepared = Prepared { pipelines: &pipelines, queue: &queue, copies: &mut copies };
    let mut are_displaced = table.update(&sources, &mut prepared);
    are_displaced |= allocator.meshes_displaced_by_slab_growth().next().is_some();
    are_displaced |= instances.is_unsettled();
    let sources = Sources {
        device: device.wgpu_device(),
        instances: &instances,
        meshes: &meshes,
        allocator: &allocator,
        reports: &reports,
    };
    scene.update(&sources, (&mut table, &mut deformer), are_displaced);
    if deformer.follow((device.wgpu_device(), &queue), &poses) {
        scene.geometry.invalidate();
    }
    volumes.follow(&views.views, &instances, (&device, &queue), &reports);
    offers.set(volumes.offers());
    instances.take_changes();
    surfaces.are_changed = false;
    changed_images.unsettled = changed_images.unsettled.saturating_sub(1);
}
