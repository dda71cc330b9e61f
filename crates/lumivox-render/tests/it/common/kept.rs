//! Tolerances for comparisons with stored pictures on other processors.

/// The largest mean FLIP error that counts as the same picture, whatever processor and software
/// driver rendered it.
///
/// The processor and driver that made the references repeat them to the bit: 0. Others round
/// differently and weigh neighbouring voxels with fewer bits, at least 8. Shifting the grid by a
/// hundredth of a voxel, more than twice the step of such weights, makes 0.0004 to 0.0044,
/// depending on the scene; the same llvmpipe on a processor with other vector instructions (AVX2,
/// AVX-512) makes up to 0.0046. Changes that must fail are larger: noise of one 8-bit code makes
/// 0.012 to 0.014, 1 % more light mostly 0.010 to 0.030, another bounce 0.017 to 0.077. (Set on
/// llvmpipe of Mesa 22.3.6, 160 x 90 pixels.)
///
/// Two computations are discontinuous, so that a last bit may change much:
///
/// - Transparency: whether a surface is drawn in a frame compares its coverage with a hash of,
///   among others, its distance to within a 256th (`screen_door.wgsl`). Another last bit may give
///   another hash, which affects all frames of that pixel. The error falls with the number of
///   frames: if *every* surface has another hash, the materials have 0.0108 with 16 frames, 0.0086
///   with 32 and 0.0068 with 64.
/// - Automatic exposure: a single pixel determines it, the one that a fifth of the surface pixels
///   exceed. If another pixel gets this rank, the brightness of the whole picture changes: 0.003
///   stops put 39 % of the pixels one 8-bit code off, and add 0.01 to the error above.
///
/// So pictures with transparency have 64 frames and a fixed exposure, and need no larger tolerance.
pub const MAX_MEAN_FLIP: f32 = 0.008;

/// The largest mean absolute difference of a channel, of 255, if pictures are compared by codes:
/// half of the codes may be one off. Noise of one code, which must fail, makes 1.
#[allow(dead_code)] // The tests of `lumivox-vxct` compare so.
pub const MAX_MEAN_CODES: f64 = 0.5;
