//! Tests the passes and the status of `Gi::frame`.

use super::*;
use crate::Frame;

/// The number of passes of a frame, and its status once it has run.
fn passes(stage: &mut Stage, frame: Frame<'_>) -> (usize, FrameStatus) {
    let mut recorder = Recorder::with_timing(&stage.device, &stage.queue, Timing::SubmitAndWait);
    stage.gi.frame(&mut recorder, frame).expect("it fits");
    let passes = pollster::block_on(recorder.finish()).expect("the device works").len();
    wait_until_read(&stage.device, &stage.gi);
    (passes, stage.gi.status())
}

/// Frames with the same inputs become ready, with the bits of a new object, and then record
/// nothing until geometry or lights change.
#[test]
#[ignore = "slow: over three seconds"]
fn unchanged_frames_record_nothing() {
    for volume in volumes() {
        let mut stage = Stage::with(volume, Vec3::new(1.0, 0.7, 0.9), 16);
        let mut geometry = moved(&room_with_a_box().build(&stage.device), at(0.3, 0.4, 0.6));
        let mut lights = stage.lamp(Vec3::new(0.2, 0.4, 0.7), Vec3::ONE);
        let settings = TraceSettings::default();
        let settle = |stage: &mut Stage, geometry: &Geometry, lights: &Lights, what: &str| {
            let (first, status) = passes(stage, Frame::new(geometry, lights, &settings));
            assert!(first > 0 && !status.is_ready(), "{what}: {status:?}");
            for _ in 0..80 {
                passes(stage, Frame::new(geometry, lights, &settings));
            }
            let (last, status) = passes(stage, Frame::new(geometry, lights, &settings));
            assert!(last == 0 && status.is_ready(), "{what}: {last} passes, {status:?}");
        };
        settle(&mut stage, &geometry, &lights, "from nothing");
        geometry.batches[0].draws.iter_mut().for_each(|draw| {
            if !draw.is_static {
                draw.world_from_local = at(0.5, 0.3, 0.4);
            }
        });
        settle(&mut stage, &geometry, &lights, "a move");
        geometry.invalidate();
        settle(&mut stage, &geometry, &lights, "other vertices");
        lights.invalidate();
        settle(&mut stage, &geometry, &lights, "other shadow maps");
        stage.assert_fresh(&geometry, "in the end");
    }
}

/// Refused geometry is reported once; later frames show the previous voxels until the geometry
/// changes.
#[test]
fn a_refused_geometry_is_reported_once() {
    let mut stage = Stage::new(Vec3::new(1.0, 0.7, 0.9), 16);
    let geometry = moved(&room_with_a_box().build(&stage.device), at(0.3, 0.4, 0.6));
    stage.catch_up(&geometry);
    let lights = stage.lamp(Vec3::new(0.2, 0.4, 0.7), Vec3::ONE);
    let settings = TraceSettings::default();
    let mut broken = geometry.clone();
    broken.batches[0].draws[0].material = 1000;
    let mut frame = |geometry: &Geometry| {
        let mut recorder = Recorder::new(&stage.device, &stage.queue);
        let status = stage.gi.frame(&mut recorder, Frame::new(geometry, &lights, &settings));
        recorder.submit();
        status
    };
    assert!(matches!(frame(&broken), Err(crate::GiError::Geometry { .. })));
    let status = frame(&broken).expect("it was reported");
    assert!(status.is_refused && !status.is_ready() && status.voxels > 0, "{status:?}");
    assert!(!frame(&geometry).expect("it fits").is_refused);
    stage.assert_fresh(&geometry, "mended");
}
