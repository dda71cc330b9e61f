//! Light in the voxels: direct light and emission, and bounces.
//!
//! Everything here runs over the faces of the voxel list alone. A face sends out `Le + reflectance / pi * E`;
//! `E` is the irradiance from the analytic lights (`direct.wgsl`) and, for each bounce, what cones gather from
//! the volume (`bounce.wgsl`). The light of emissive surfaces and of the environment arrives through gathers.
//! A caller's own [`Injection`] takes the place of the direct evaluation.

mod injection;
mod lights;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};

use crate::cones::{ConeSettings, TraceSettings};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer, uniform_buffer,
};
use crate::volume::Volume;
use crate::volume::changes::Changes;
use crate::voxels::VoxelList;
use crate::{GiConfig, GiError};

pub use injection::{FaceLight, Injection, InjectionParts, Injector};
pub(crate) use lights::{
    LIGHT_DIRECTIONAL, LIGHT_ENVIRONMENT, LIGHT_POINT, LIGHT_SPOT, SHADOW_CONE, SHADOW_MAP,
    SHADOW_NONE, lights_layout,
};
pub use lights::{
    Light, LightSource, Lights, MappedLight, Shadow, ShadowLayer, ShadowMaps, ShadowSource,
};
#[cfg(test)]
pub(crate) use lights::{LightGlobals, LightRecord, ShadowLayerRecord};

/// The shader modules of this folder.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("light::lights", include_str!("lights.wgsl")),
    ("light::reflected", include_str!("reflected.wgsl")),
    ("light::shadow_map", include_str!("shadow_map.wgsl")),
    ("light::visibility", include_str!("visibility.wgsl")),
    ("light::direct", include_str!("direct.wgsl")),
    ("light::bounce", include_str!("bounce.wgsl")),
    ("light::cover", include_str!("cover.wgsl")),
];

/// `BounceSettings` of `bounce.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct BounceSettings {
    pub(crate) cones: ConeSettings,
    pub(crate) cone_count: u32,
    pub(crate) padding: [u32; 3],
}

/// Lights the faces of a voxel list.
#[derive(Debug)]
pub(crate) struct Lighting {
    direct: Direct,
    bounce: Kernel,
    cover: Kernel,
    /// The grid alone.
    grid: BindGroup,
    direct_layout: wgpu::BindGroupLayout,
    bounce_layout: wgpu::BindGroupLayout,
    cover_layout: wgpu::BindGroupLayout,
    settings: Buffer,
    faces: Option<Faces>,
}

/// How the light of lamps comes in.
#[derive(Debug)]
enum Direct {
    /// Each face asks each light (`direct.wgsl`).
    Faces(Kernel),
    /// The caller's way.
    Own(Box<dyn Injector>),
}

/// What belongs to a voxel list.
#[derive(Debug)]
pub(crate) struct Faces {
    count: u64,
    /// Radiance without bounces (`array<vec4f>`).
    direct: Buffer,
    /// Radiance with the bounces so far (`array<vec4f>`).
    radiance: Buffer,
    /// What the volume shows of it (`cover.wgsl`).
    shown: Buffer,
    direct_group: BindGroup,
    bounce_group: BindGroup,
    cover_group: BindGroup,
}

impl Faces {
    /// The buffer that will hold what the volume stores of the faces' radiance.
    pub(crate) fn shown(&self) -> &Buffer {
        &self.shown
    }
}

impl Lighting {
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        config: &GiConfig,
        globals: &wgpu::BindGroupLayout,
        lights: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let direct_layout = LayoutBuilder::compute()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "direct light");
        let bounce_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage()
            .storage()
            .storage_mut()
            .build(device, "bounce");
        let cover_layout = (0..6)
            .fold(LayoutBuilder::compute(), |layout, _| layout.storage())
            .storage_mut()
            .build(device, "cover");
        // Without the volume, whose buffers would be too many beside its own.
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let grid = BindGroupBuilder::new(&grid_layout)
            .buffer(&config.grid.uniform(device))
            .build(device, "grid");
        let kernel = |module, layout| {
            Kernel::new(device, shaders, module, "main", &[globals, layout, lights])
        };
        let direct = match &config.injection {
            None => Direct::Faces(kernel("light::direct", &direct_layout)?),
            Some(injection) => {
                let grid = &config.grid;
                let parts = InjectionParts { device, shaders, grid, globals, lights };
                Direct::Own(injection.make(&parts)?)
            }
        };
        Ok(Self {
            direct,
            bounce: kernel("light::bounce", &bounce_layout)?,
            cover: Kernel::new(
                device,
                shaders,
                "light::cover",
                "main",
                &[&grid_layout, &cover_layout],
            )?,
            grid,
            direct_layout,
            bounce_layout,
            cover_layout,
            settings: uniform_buffer(device, "bounce settings", &BounceSettings::zeroed()),
            faces: None,
        })
    }

    /// What lighting a new voxel list takes; [`Self::take`] makes it the current one.
    pub(crate) fn prepare(&self, device: &wgpu::Device, voxels: &VoxelList) -> Faces {
        let count = u64::from(voxels.face_count);
        let direct = storage_buffer(device, "direct radiance", count * 16);
        let radiance = storage_buffer(device, "radiance", count * 16);
        let shown = storage_buffer(device, "shown radiance", count * 16);
        let direct_group = BindGroupBuilder::new(&self.direct_layout)
            .buffer(&voxels.faces)
            .buffer(&direct)
            .buffer(&radiance)
            .build(device, "direct light");
        let bounce_group = BindGroupBuilder::new(&self.bounce_layout)
            .buffer(&self.settings)
            .buffer(&voxels.faces)
            .buffer(&voxels.nodes)
            .buffer(&direct)
            .buffer(&radiance)
            .build(device, "bounce");
        let cover_group = BindGroupBuilder::new(&self.cover_layout)
            .buffer(&voxels.faces)
            .buffer(&voxels.nodes)
            .buffer(&voxels.first_faces)
            .buffer(&voxels.occupancy)
            .buffer(&voxels.ranks)
            .buffer(&radiance)
            .buffer(&shown)
            .build(device, "cover");
        Faces { count, direct, radiance, shown, direct_group, bounce_group, cover_group }
    }

    /// Lights this list from now on.
    pub(crate) fn take(&mut self, device: &Pipelines, voxels: &VoxelList, faces: Faces) {
        if let Direct::Own(injector) = &mut self.direct {
            injector.take(device, voxels);
        }
        self.faces = Some(faces);
    }

    /// Direct light, then `gathers` bounces, each stored and filtered into the volume.
    ///
    /// Without bounces what did not change is not stored again. With them nearly everything changes, in every
    /// gather, and looking for what does not would cost more than it saves.
    pub(crate) fn run(
        &self,
        recorder: &mut Recorder,
        (volume, changes): (&mut Volume, &mut Changes),
        lights: &Lights,
        gathers: u32,
        (settings, model_values): (&TraceSettings, [f32; 4]),
    ) {
        let Some(faces) = &self.faces else {
            return;
        };
        let bounce_settings = BounceSettings {
            // Occlusion is not read, so its distance needs no unit.
            cones: settings.cones(1.0, model_values),
            cone_count: settings.diffuse_cones,
            padding: [0; 3],
        };
        let bytes = bytemuck::bytes_of(&bounce_settings);
        recorder.queue().write_buffer(&self.settings, 0, bytes);
        recorder.stage("light");
        let is_direct = gathers == 0;
        // With cone shadows the light needs the volume's opacities, which come with any radiance.
        if lights.has_cone_shadows {
            recorder.stage("filter");
            if let Some(changed) = changes.surfaces(recorder) {
                volume.update(recorder, changed);
            }
            recorder.stage("light");
        }
        let globals = volume.globals();
        match &self.direct {
            Direct::Faces(kernel) => {
                let groups = [globals, &faces.direct_group, &lights.group];
                kernel.run_linear(recorder, &groups, faces.count);
            }
            Direct::Own(injector) => {
                let Faces { direct, radiance, .. } = faces;
                injector.run(recorder, FaceLight { globals, lights, direct, radiance });
            }
        }
        let cover = |recorder: &mut Recorder| {
            self.cover.run_linear(recorder, &[&self.grid, &faces.cover_group], faces.count);
        };
        cover(recorder);
        recorder.stage("filter");
        let changed = if is_direct { changes.find(recorder) } else { changes.all(recorder) };
        let Some(changed) = changed else { return };
        volume.update(recorder, changed);
        for _ in 0..gathers {
            recorder.stage("bounce");
            let groups = [volume.globals(), &faces.bounce_group, &lights.group];
            self.bounce.run_linear(recorder, &groups, faces.count);
            cover(recorder);
            recorder.stage("filter");
            volume.update(recorder, changed);
        }
    }

    /// Bytes on the GPU, by what they hold.
    pub(crate) fn memory(&self) -> Vec<(&'static str, u64)> {
        let size = |buffer: fn(&Faces) -> &Buffer| {
            self.faces.as_ref().map_or(0, |faces| buffer(faces).size())
        };
        let mut memory = vec![
            ("light: direct radiance of the faces", size(|faces| &faces.direct)),
            ("light: radiance of the faces", size(|faces| &faces.radiance)),
            ("light: shown radiance of the faces", size(|faces| &faces.shown)),
        ];
        memory.extend(self.injector().into_iter().flat_map(Injector::memory));
        memory
    }

    /// The caller's way for the direct light, if it is one.
    pub(crate) fn injector(&self) -> Option<&dyn Injector> {
        match &self.direct {
            Direct::Faces(_) => None,
            Direct::Own(injector) => Some(injector.as_ref()),
        }
    }

    /// The radiance of each face (`array<vec4f>`), for tests and views.
    pub(crate) fn radiance(&self) -> Option<&Buffer> {
        self.faces.as_ref().map(|faces| &faces.radiance)
    }
}
