//! Pictures that are kept, and how far another processor's may be from them.

/// The largest mean FLIP error that counts as the same picture, whatever processor and software
/// driver rendered it.
///
/// The processor and driver that made the references repeat them to the bit: 0. Others round
/// differently and weigh neighbouring voxels with fewer bits, at least 8. Shifting the grid by a
/// hundredth of a voxel, more than twice the step of such weights, makes 0.0004 to 0.0044,
/// depending on the scene; the same llvmpipe on a processor with other vector instructions (AVX2,
/// AVX-512) makes up to 0.0046. What must be seen lies above: noise of one 8-bit code makes 0.012
/// to 0.014, 1 % more light mostly 0.010 to 0.030, one bounce more 0.017 to 0.077. (Set on llvmpipe
/// of Mesa 22.3.6, 160 x 90 pixels.)
///
/// Two things in a picture are not continuous, and may change by much when a last bit changes:
///
/// - Transparency: whether a surface is drawn in a frame compares a number with its coverage, and
///   the number is a hash of, among others, its distance to within a 256th (`screen_door.wgsl`).
///   Another last bit may give another hash, and then all frames of that pixel draw otherwise. The
///   error falls with the number of frames: where *every* surface draws otherwise (another constant
///   in the hash), the materials have 0.0108 with 16 frames, 0.0086 with 32 and 0.0068 with 64.
/// - Automatic exposure: a single pixel decides it, the one that a fifth of the surfaces exceed.
///   When its rank moves, every pixel of the picture gets brighter or darker: 0.003 stops put 39 %
///   of the pixels one 8-bit code off, and add 0.01 to the error above.
///
/// So a picture with drawn transparency has 64 frames and an exposure of its own in its settings,
/// and needs no other tolerance.
pub const MAX_MEAN_FLIP: f32 = 0.008;

/// The bound on the mean absolute difference of a channel, of 255, where pictures are compared by
/// codes: half of the codes may be one off. Noise of one code, which must be seen, makes 1.
#[allow(dead_code)] // The tests of `lumivox-vxct` compare so.
pub const MAX_MEAN_CODES: f64 = 0.5;
