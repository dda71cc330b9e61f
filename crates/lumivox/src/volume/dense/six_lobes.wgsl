// The dense volume with six lobes, as the tracer sees it: the module package::volume (group 0, binding 1 up).
//
// Lobe f of a cell holds its opacity a along its axis, its radiance premultiplied by a, and the two components
// of its vector area N across the axis (the one along it is a). Seen along d it covers max(0, -d . N).

import package::grid::grid;
import package::volume::masks::{lobes_near, LOBES, TILTED_SHIFT};

@group(0) @binding(3) var lobe_positive_x: texture_3d<f32>;
@group(0) @binding(4) var lobe_negative_x: texture_3d<f32>;
@group(0) @binding(5) var lobe_positive_y: texture_3d<f32>;
@group(0) @binding(6) var lobe_negative_y: texture_3d<f32>;
@group(0) @binding(7) var lobe_positive_z: texture_3d<f32>;
@group(0) @binding(8) var lobe_negative_z: texture_3d<f32>;
// Vector areas across the axis: xy of the positive lobe, zw of the negative; the next axes in cyclic order.
@group(0) @binding(9) var tilt_x: texture_3d<f32>;
@group(0) @binding(10) var tilt_y: texture_3d<f32>;
@group(0) @binding(11) var tilt_z: texture_3d<f32>;
@group(0) @binding(12) var volume_sampler: sampler;

// Where and how a sample is taken. Outside the grid everything is zero; textures clamp to their edge instead,
// so near the border each of the two levels is weighted by what the trilinear filter has inside.
struct Footprint {
    uvw: vec3f,
    level: f32,
    is_near_border: bool,
    fine_weight: f32,
    coarse_weight: f32,
}

fn border_weight(position_in_grid: vec3f, level: f32) -> f32 {
    let scale = exp2(-level);
    let texel = position_in_grid * scale;
    let inside = vec3f(grid.dimensions) * scale - texel;
    let weight = saturate(texel + 0.5) * saturate(inside + 0.5);
    return weight.x * weight.y * weight.z;
}

fn footprint_at(position_in_grid: vec3f, level: f32) -> Footprint {
    let fine = floor(level);
    let coarse = min(fine + 1.0, f32(grid.levels - 1u));
    let fraction = level - fine;
    let extent = vec3f(grid.dimensions);
    let reach = 0.5 * exp2(coarse);
    let is_near_border =
        any(position_in_grid < vec3f(reach)) || any(position_in_grid > extent - reach);
    var fine_weight = 1.0 - fraction;
    var coarse_weight = fraction;
    if is_near_border {
        fine_weight *= border_weight(position_in_grid, fine);
        coarse_weight *= border_weight(position_in_grid, coarse);
    }
    return Footprint(position_in_grid / extent, level, is_near_border, fine_weight, coarse_weight);
}

fn fetch(volume: texture_3d<f32>, at: Footprint) -> vec4f {
    if at.is_near_border {
        let fine = floor(at.level);
        return at.fine_weight * textureSampleLevel(volume, volume_sampler, at.uvw, fine)
            + at.coarse_weight * textureSampleLevel(volume, volume_sampler, at.uvw, fine + 1.0);
    }
    return textureSampleLevel(volume, volume_sampler, at.uvw, at.level);
}

// Radiance times coverage, and coverage, of a lobe seen along a direction: `along` and `across` are the
// direction's components in the frame of the lobe, the first counted outwards.
fn seen(lobe: vec4f, tilt: vec2f, along: f32, across: vec2f) -> vec4f {
    let coverage = max(0.0, -(along * lobe.a + dot(across, tilt)));
    if coverage <= 0.0 || lobe.a <= 0.0 {
        return vec4f(0.0);
    }
    return vec4f(lobe.rgb * (coverage / lobe.a), coverage);
}

// Whether the two lobes of an axis (bits 0 and 1) are worth a look: they are there, and they face against the
// direction or are tilted so far that they may.
fn visible_lobes(lobes: u32, axis: u32, along: f32, across: vec2f) -> u32 {
    let present = (lobes >> (2u * axis)) & 3u;
    let tilted = (lobes >> (TILTED_SHIFT + 2u * axis)) & 3u;
    let facing = select(2u, 1u, along < 0.0);
    // A lobe's axis is the longest component of each of its normals, so it shows its front from behind its
    // axis only where the direction leans more across than along.
    let may_lean = abs(along) < abs(across.x) + abs(across.y);
    return present & (facing | select(0u, tilted, may_lean));
}

// Radiance that leaves the surfaces around a point against `direction`, times their coverage, and the coverage.
fn sample_volume(position_in_grid: vec3f, level: f32, direction: vec3f) -> vec4f {
    let lobes = lobes_near(position_in_grid, level);
    if (lobes & LOBES) == 0u {
        return vec4f(0.0);
    }
    let at = footprint_at(position_in_grid, level);
    var sum = vec4f(0.0);

    let show_x = visible_lobes(lobes, 0u, direction.x, direction.yz);
    if show_x != 0u {
        var tilt = vec4f(0.0);
        if ((lobes >> TILTED_SHIFT) & 3u) != 0u {
            tilt = fetch(tilt_x, at);
        }
        if (show_x & 1u) != 0u {
            sum += seen(fetch(lobe_positive_x, at), tilt.xy, direction.x, direction.yz);
        }
        if (show_x & 2u) != 0u {
            sum += seen(fetch(lobe_negative_x, at), tilt.zw, -direction.x, direction.yz);
        }
    }
    let show_y = visible_lobes(lobes, 1u, direction.y, direction.zx);
    if show_y != 0u {
        var tilt = vec4f(0.0);
        if ((lobes >> (TILTED_SHIFT + 2u)) & 3u) != 0u {
            tilt = fetch(tilt_y, at);
        }
        if (show_y & 1u) != 0u {
            sum += seen(fetch(lobe_positive_y, at), tilt.xy, direction.y, direction.zx);
        }
        if (show_y & 2u) != 0u {
            sum += seen(fetch(lobe_negative_y, at), tilt.zw, -direction.y, direction.zx);
        }
    }
    let show_z = visible_lobes(lobes, 2u, direction.z, direction.xy);
    if show_z != 0u {
        var tilt = vec4f(0.0);
        if ((lobes >> (TILTED_SHIFT + 4u)) & 3u) != 0u {
            tilt = fetch(tilt_z, at);
        }
        if (show_z & 1u) != 0u {
            sum += seen(fetch(lobe_positive_z, at), tilt.xy, direction.z, direction.xy);
        }
        if (show_z & 2u) != 0u {
            sum += seen(fetch(lobe_negative_z, at), tilt.zw, -direction.z, direction.xy);
        }
    }
    return sum;
}

// The same for one cell of a level, unfiltered.
fn load_cell(cell: vec3u, level: u32, direction: vec3f) -> vec4f {
    let x = textureLoad(tilt_x, cell, level);
    let y = textureLoad(tilt_y, cell, level);
    let z = textureLoad(tilt_z, cell, level);
    return seen(textureLoad(lobe_positive_x, cell, level), x.xy, direction.x, direction.yz)
        + seen(textureLoad(lobe_negative_x, cell, level), x.zw, -direction.x, direction.yz)
        + seen(textureLoad(lobe_positive_y, cell, level), y.xy, direction.y, direction.zx)
        + seen(textureLoad(lobe_negative_y, cell, level), y.zw, -direction.y, direction.zx)
        + seen(textureLoad(lobe_positive_z, cell, level), z.xy, direction.z, direction.xy)
        + seen(textureLoad(lobe_negative_z, cell, level), z.zw, -direction.z, direction.xy);
}
