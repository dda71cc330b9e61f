//! After surface has moved, only rays that may meet it are traced again.

use super::*;
use crate::light::HIT_WORDS;

/// The word of a face that is not a result of its rays: the step of its last gather.
const STEP_WORD: usize = HIT_WORDS as usize - 1;

/// A closed room with a panel below its ceiling and a box that moves.
fn room() -> SceneBuilder {
    let half = Vec3::splat(0.06);
    let (corner, across, along) =
        (Vec3::new(0.35, 0.68, 0.35), Vec3::new(0.3, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.2));
    SceneBuilder::default()
        .room(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), &lambert(0.5, 0.0))
        .quad(corner, across, along, lambert(0.2, 3.0))
        .fixed()
        .room(-half, half, &lambert(0.6, 0.0))
}

/// The hits of the faces' rays, their adjacent faces, and their irradiance from the panel.
fn rays(stage: &Stage) -> Vec<u32> {
    let count = stage.gi.voxels().expect("there is a list").face_count as usize;
    let hits = stage.gi.face_hits().expect("there is light");
    let mut words: Vec<u32> = read(&stage.device, &stage.queue, hits, count * HIT_WORDS as usize);
    words.iter_mut().skip(STEP_WORD).step_by(HIT_WORDS as usize).for_each(|word| *word = 0);
    words
}

/// A box crosses the room, with frames in which it rests, and frames that voxelize twice. A lamp
/// changes meanwhile. In the end all rays are those of a new object.
#[test]
#[ignore = "slow: over three seconds"]
fn rays_past_moved_surface_keep_correct_hits() {
    for volume in volumes() {
        let new = || Stage::without_cells(volume, Vec3::new(1.0, 0.7, 0.9), 32);
        let mut stage = new();
        let geometry = room().build(&stage.device);
        let place = |step: u8| {
            let turn = 0.7 * f32::from(step);
            at(0.5 + 0.3 * turn.sin(), 0.3 + 0.02 * f32::from(step), 0.45 + 0.25 * turn.cos())
        };
        let lamp = |stage: &Stage, x| stage.lamp(Vec3::new(x, 0.4, 0.4), Vec3::ONE);
        stage.catch_up(&moved(&geometry, place(0)));
        let lights = lamp(&stage, 0.2);
        stage.light(&lights, 3);
        for step in 1..14_u8 {
            let lights = lamp(&stage, 0.2 + 0.03 * f32::from(step / 3));
            if step % 4 != 3 {
                stage.catch_up(&moved(&geometry, place(step)));
            }
            stage.step(&lights, None);
        }
        let last = moved(&geometry, place(13));
        for _ in 0..4 {
            stage.step(&lights, None);
        }
        let mut fresh = new();
        fresh.catch_up(&last);
        let lights = lamp(&fresh, 0.2);
        fresh.light(&lights, 3);
        let (own, expected) = (rays(&stage), rays(&fresh));
        let differ = own.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert_eq!(own.len(), expected.len());
        assert!(differ == 0, "{volume:?}: {differ} of {} words differ", own.len());
        assert!(expected.iter().any(|word| *word != 0));
    }
}
