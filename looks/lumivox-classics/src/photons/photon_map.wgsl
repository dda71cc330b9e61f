// Shared by the two photon kernels: the light whose maps are inserted.
//
// A texel of a light's depth map is a bundle of photons (Crassin et al. 2011, "Interactive indirect
// illumination using voxel cone tracing", section 5). It carries irradiance across the beam times
// the bundle's cross-section: the texel's area for parallel light, its solid angle times the
// squared distance for the other lights.

import package::constants::PHOTON_LAYERS;

struct PhotonMap {
    // From each layer's clip space to the world.
    world_from_clip: array<mat4x4f, PHOTON_LAYERS>,
    // Index of the light.
    light: u32,
    first_layer: u32,
    layer_count: u32,
    // Integer counts per unit of flux, for a light with an intensity of one: per m2 for parallel
    // light, per steradian for other lights. As large as possible without overflow of a sum
    // (mod.rs).
    counts_per_flux: f32,
}

@group(1) @binding(0) var<uniform> photon_map: PhotonMap;

// The light that a face has received.
struct Taken {
    // The flux, in counts.
    flux: u32,
    // The flux times its distance in front of the face's middle, in counts times two voxels;
    // signed.
    lead: u32,
}
