//! Drives a scene step by step, as the window does: changes, then one frame.

use std::time::Instant;

use lumivox::gpu::MadeResources;
use lumivox::internal::waits;
use lumivox_console::Failure;
use lumivox_explorer::{Explorer, PreparedScene};
use lumivox_render::compare::LinearPicture;
use lumivox_render::{Gpu, PresetChoice, RenderProgress, RenderSettings, View};
use lumivox_scene::{Camera, Scene, SightOptions};
use serde::Serialize;

use super::moves::{Pose, Start};
use super::sequences::Sequence;

/// Frames of a picture: more than any sequence holds still, so that it is never complete.
pub const FRAMES: u32 = 1024;

/// The pictures that a viewer sees at one step.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The picture, in cd/m².
    pub picture: LinearPicture,
    /// Irradiance by all light except direct light of lamps, in lux.
    pub full: LinearPicture,
}

/// The cost of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StepCost {
    /// Wall-clock time of the changes and the frame, with the wait at its end, ms.
    pub ms: f64,
    /// Volume samples of a pixel's cones; samples between voxels do not count.
    pub samples_per_pixel: f64,
    /// Number of times that the CPU waits for the GPU, including the wait at the frame's end.
    pub waits: u64,
    /// Bytes of GPU buffers and textures created in the step.
    pub allocated_bytes: u64,
}

/// A changing scene, and its renderer.
#[derive(Debug)]
pub struct Drive {
    explorer: Explorer,
    start: Start,
}

impl Drive {
    /// Opens a scene for a sequence; nothing is rendered yet.
    ///
    /// # Errors
    /// When a setting is out of range, or the scene has nothing that the sequence moves.
    pub fn new(
        gpu: &Gpu,
        sequence: &Sequence,
        (scene, camera): (&Scene, &Camera),
        settings: &RenderSettings,
    ) -> anyhow::Result<Self> {
        let mut scene = scene.clone();
        sequence.prepare(&mut scene)?;
        let settings = RenderSettings {
            frames: FRAMES,
            view: View::Final,
            beside: vec![View::Diffuse, View::Cost],
            ..settings.clone()
        };
        settings.validate(&gpu.device.limits())?;
        let aspect = settings.size.x as f32 / settings.size.y as f32;
        let mut explorer = Explorer::new(gpu.clone(), settings, PresetChoice::default());
        let sight =
            SightOptions { camera: Some(camera.clone()), aspect, ..SightOptions::default() };
        explorer.open(PreparedScene::new(scene, &sight, &mut |_| {})?);
        for name in sequence.moving {
            let object =
                explorer.object(name).map_err(|error| Failure::input(error.to_string()))?;
            explorer.set_static(object, false);
        }
        let start = Start {
            scene: explorer.scene().cloned().unwrap_or_default(),
            camera: explorer.camera().clone(),
            duration_s: explorer.playback().duration_s,
        };
        Ok(Self { explorer, start })
    }

    /// The scene before anything moved.
    pub fn start(&self) -> &Start {
        &self.start
    }

    /// The current scene and its camera.
    pub fn now(&self) -> (&Scene, &Camera) {
        (self.explorer.scene().unwrap_or(&self.start.scene), self.explorer.camera())
    }

    /// Applies a pose; changes only what differs.
    ///
    /// # Errors
    /// When the scene has no triangles left at a time of its animation.
    pub fn pose(&mut self, pose: &Pose) -> anyhow::Result<()> {
        let explorer = &mut self.explorer;
        if *explorer.camera() != pose.camera {
            explorer.set_camera(pose.camera.clone());
        }
        if explorer.scene().is_some_and(|scene| scene.lights != pose.lights) {
            explorer.edit_lights(|scene| scene.lights.clone_from(&pose.lights));
        }
        for (name, place) in &pose.places {
            let object =
                explorer.object(name).map_err(|error| Failure::input(error.to_string()))?;
            let Some(posed) = explorer.posed(object) else { continue };
            let local = posed.inverse() * *place;
            if explorer.local_edit(object) != Some(local) {
                explorer.set_local_edit(object, local);
            }
        }
        if let Some(time_s) = pose.time_s {
            let playback = explorer.playback();
            if !playback.is_moved || playback.time_s.to_bits() != time_s.to_bits() {
                explorer.seek(time_s)?;
            }
        }
        Ok(())
    }

    /// Applies a pose and renders one frame. The first step includes the time to prepare the scene.
    ///
    /// # Errors
    /// As [`Self::pose`], and when rendering fails.
    pub fn step(
        &mut self,
        pose: &Pose,
        tell: &mut dyn FnMut(RenderProgress),
    ) -> anyhow::Result<StepCost> {
        let (made, waited) = (MadeResources::now(), waits());
        let start = Instant::now();
        self.pose(pose)?;
        pollster::block_on(self.explorer.frame(tell))?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        Ok(StepCost {
            ms,
            waits: waits() - waited,
            allocated_bytes: MadeResources::now().bytes - made.bytes,
            samples_per_pixel: self.samples_per_pixel()?,
        })
    }

    /// The pictures on screen after the last step.
    ///
    /// # Errors
    /// When the device fails.
    pub fn shown(&mut self) -> anyhow::Result<Shown> {
        let renderer = self.explorer.renderer_mut();
        let renderer = renderer.ok_or_else(|| Failure::input("the scene is empty"))?;
        let picture = pollster::block_on(renderer.finish())?;
        let full = self.beside(View::Diffuse)?;
        // The view shows irradiance / pi.
        let rgb = full.iter().map(|&[r, g, b, _]| [r, g, b].map(|x| x * std::f32::consts::PI));
        let full = LinearPicture { size: picture.size, rgb: rgb.collect() };
        Ok(Shown { picture: LinearPicture::from(&picture), full })
    }

    fn samples_per_pixel(&self) -> anyhow::Result<f64> {
        let samples = self.beside(View::Cost)?;
        Ok(samples.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / samples.len() as f64)
    }

    fn beside(&self, view: View) -> anyhow::Result<Vec<[f32; 4]>> {
        let renderer = self.explorer.renderer();
        let renderer = renderer.ok_or_else(|| Failure::input("the scene is empty"))?;
        let pixels = pollster::block_on(renderer.read_beside(view))?;
        Ok(pixels.ok_or_else(|| Failure::input("no frame was rendered"))?)
    }
}
