//! Tests that two complete renderings, with separate devices, voxels and shadow maps, are
//! bit-identical: values that many threads write at once are integer sums or bit sets, so the order
//! of threads does not matter.

#![allow(clippy::float_cmp)] // Equal to the bit is the claim.

use glam::UVec2;
use lumivox::{Directionality, TraceResolution, TraceSettings};
use lumivox_render::{Picture, RenderSettings, ShadowMethod};

use crate::common::{builtin, gpu, picture, renderer};

/// The bits of a rendering from scratch. Cornell's blocks are turned against the grid, so that many
/// triangles share a voxel. With an odd size, workgroups at the edges are half empty.
fn bits(settings: &RenderSettings) -> (Vec<[u32; 4]>, Vec<[u8; 4]>) {
    let settings = RenderSettings {
        size: UVec2::new(75, 45),
        resolution: 48,
        frames: 3,
        shadow_resolution: 256,
        ..settings.clone()
    };
    let mut renderer = renderer(&gpu(), &builtin("cornell"), settings);
    let Picture { hdr, ldr, .. } = picture(&mut renderer);
    assert!(hdr.iter().any(|pixel| pixel[0] > 0.1), "the picture is black");
    (hdr.into_iter().map(|pixel| pixel.map(f32::to_bits)).collect(), ldr)
}

fn assert_two_runs_agree(settings: &RenderSettings) {
    let (first, second) = (bits(settings), bits(settings));
    let differing = first.0.iter().zip(&second.0).filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "of {} pixels of the radiance", first.0.len());
    assert!(first.1 == second.1, "the same radiance is shown differently");
}

#[test]
#[ignore = "slow: over three seconds"]
fn isotropic_voxels_repeat_to_the_bit() {
    let directionality = Directionality::Isotropic;
    assert_two_runs_agree(&RenderSettings { directionality, ..RenderSettings::default() });
}

#[test]
#[ignore = "slow: over three seconds"]
fn half_resolution_and_cone_shadows_repeat_to_the_bit() {
    let trace = TraceSettings { resolution: TraceResolution::Half, ..TraceSettings::default() };
    let shadows = ShadowMethod::Cone;
    assert_two_runs_agree(&RenderSettings { trace, shadows, ..RenderSettings::default() });
}
