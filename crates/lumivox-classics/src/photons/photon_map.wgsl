// What the two photon kernels share: the light whose maps are inserted.
//
// A texel of a light's depth map is a bundle of photons (Crassin et al. 2011, "Interactive indirect illumination
// using voxel cone tracing", section 5). It carries irradiance across the beam times the bundle's cross-section:
// the texel's area for parallel light, its solid angle times the squared distance for the other lights.

// Layers of a point light.
const MAX_LAYERS: u32 = 6u;

struct PhotonMap {
    // From each layer's clip space to the world.
    world_from_clip: array<mat4x4f, MAX_LAYERS>,
    // Index of the light.
    light: u32,
    first_layer: u32,
    layer_count: u32,
    // What a flux of one is as an integer, where the light's intensity is one: per m2 for parallel light, per
    // steradian for the others. So large that no sum can overflow (mod.rs).
    counts_per_flux: f32,
}

@group(1) @binding(0) var<uniform> photon_map: PhotonMap;

// What a face has taken up.
struct Taken {
    // The flux, in counts.
    flux: u32,
    // The flux times how far in front of the face's middle it arrived, in counts times two voxels: a signed number.
    lead: u32,
}
