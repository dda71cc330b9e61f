//! Tone maps radiance from other sources like rendered pictures.

use glam::UVec2;
use lumivox::gpu::Recorder;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, VolumeKind};

use crate::gpu::readback::read_texture;
use crate::gpu::textures::{ScreenTextures, extent};
use crate::picture::tone_map::{Encoding, ToneMapPass};
use crate::{Exposure, Gpu, Picture, RenderError, ToneMap};

impl Picture {
    /// A picture of radiances in cd/m² (a is 1 where there is a surface), row by row from the top,
    /// with its tone-mapped pixels for a screen.
    ///
    /// # Errors
    /// [`RenderError::Setting`] when the number of pixels does not match the size, and when the
    /// device fails.
    pub async fn develop(
        gpu: &Gpu,
        size: UVec2,
        hdr: Vec<[f32; 4]>,
        exposure: Exposure,
        curve: ToneMap,
    ) -> Result<Self, RenderError> {
        if hdr.is_empty() || hdr.len() as u64 != u64::from(size.x) * u64::from(size.y) {
            return Err(RenderError::Setting {
                name: "the picture",
                value: format!("of {} pixels", hdr.len()),
                expected: format!("of {} x {}", size.x, size.y),
            });
        }
        let volume = library_with_volume(VolumeKind::default(), Directionality::default());
        let shaders = crate::shaders::library(&volume);
        let mut textures = ScreenTextures::new(&gpu.device, size);
        let pass = ToneMapPass::new(&gpu.pipelines, &shaders, &mut textures, size)?;
        let format = wgpu::TextureFormat::Rgba32Float;
        let texture = textures.create("picture", format, wgpu::TextureUsages::COPY_DST);
        gpu.queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(&hdr),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(size.x * size_of::<[f32; 4]>() as u32),
                rows_per_image: None,
            },
            extent(size),
        );
        let scale = exposure.stops(&hdr).exp2();
        let mut recorder = Recorder::new(&gpu.device, &gpu.queue);
        pass.record(&mut recorder, &texture, Encoding::Color { scale, curve });
        recorder.submit();
        let ldr = read_texture(gpu, pass.screen()).await?;
        gpu.check("bringing a picture to the screen")?;
        Ok(Self { size, hdr, ldr })
    }
}
