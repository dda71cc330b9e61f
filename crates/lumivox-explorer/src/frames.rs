//! Rendering frame by frame, and the times of frames.

use std::collections::VecDeque;
use std::time::Duration;

use lumivox_render::{Picture, RenderError, RenderProgress};
use web_time::Instant;

use crate::{Explorer, ExplorerError};

/// The number of frames whose times are kept.
const KEPT: usize = 4096;

/// The times of the last frames.
#[derive(Clone, Debug, Default)]
pub struct FrameTimes {
    times: VecDeque<Duration>,
}

impl FrameTimes {
    /// Forgets all times.
    pub fn clear(&mut self) {
        self.times.clear();
    }

    /// Times of the last `count` frames, 4096 at most, the newest last.
    pub fn last(&self, count: usize) -> impl Iterator<Item = Duration> + '_ {
        self.times.iter().skip(self.times.len().saturating_sub(count)).copied()
    }

    /// The number of kept times.
    pub fn count(&self) -> usize {
        self.times.len()
    }

    fn add(&mut self, time: Duration) {
        if self.times.len() == KEPT {
            self.times.pop_front();
        }
        self.times.push_back(time);
    }
}

impl Explorer {
    /// Brings the renderer up to date and renders one more frame. Returns `false` if the picture
    /// already has all requested frames, or if there is nothing to render.
    ///
    /// # Errors
    /// As [`Explorer::update`], and when the device fails.
    pub async fn frame(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<bool, ExplorerError> {
        self.catch_up();
        self.update(progress).await?;
        let frames = self.settings.frames;
        let Some(renderer) = &mut self.renderer else { return Ok(false) };
        let is_complete = renderer.is_complete();
        let lacks_overlay =
            renderer.settings().overlay.is_on() && renderer.overlay_frame_count() < frames;
        if is_complete && !lacks_overlay {
            return Ok(false);
        }
        let start = Instant::now();
        if !self.waits_for_gpu {
            self.gpu.finished("rendering a frame").await?;
        }
        // A later overlay is drawn over the finished picture.
        if is_complete {
            renderer.render_overlay_frame().await?;
        } else if let Err(error) = renderer.render_frame().await {
            if matches!(error, RenderError::Gi(_)) {
                // As after a refused change: the next renderer is made from the present scene.
                self.renderer = None;
            }
            return Err(error.into());
        }
        if self.waits_for_gpu {
            self.gpu.finished("rendering a frame").await?;
        }
        self.times.add(start.elapsed());
        Ok(true)
    }

    /// Renders a frame only for its time: the picture does not change.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn rehearse(&mut self) -> Result<(), ExplorerError> {
        let Some(renderer) = &mut self.renderer else { return Ok(()) };
        let start = Instant::now();
        if !self.waits_for_gpu {
            self.gpu.finished("rendering a frame").await?;
        }
        renderer.rehearse_frame().await?;
        if self.waits_for_gpu {
            self.gpu.finished("rendering a frame").await?;
        }
        self.times.add(start.elapsed());
        Ok(())
    }

    /// Renders all missing frames and returns the finished picture; `None` if there is nothing to
    /// show.
    ///
    /// # Errors
    /// As [`Self::frame`].
    pub async fn picture(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Option<Picture>, ExplorerError> {
        while self.frame(progress).await? {
            if let Some(renderer) = &self.renderer {
                let done = renderer.frame_count();
                progress(RenderProgress { stage: "render", done, total: self.settings.frames });
            }
        }
        let Some(renderer) = &mut self.renderer else { return Ok(None) };
        renderer.complete_overlay().await?;
        Ok(Some(renderer.finish().await?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_frame_times_are_kept() {
        let mut times = FrameTimes::default();
        let most = KEPT as u64;
        for millis in 0..most + 2 {
            times.add(Duration::from_millis(millis));
        }
        let last = |count| times.last(count).map(|time| time.as_millis()).collect::<Vec<_>>();
        let newest = u128::from(most) + 1;
        assert_eq!(last(2), [newest - 1, newest]);
        assert_eq!(last(usize::MAX), (2..=newest).collect::<Vec<_>>());
        assert_eq!(times.count(), KEPT);
        times.clear();
        assert_eq!(times.count(), 0);
    }
}
