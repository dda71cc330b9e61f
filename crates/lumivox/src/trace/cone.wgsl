// One cone through the volume. Lengths here are in voxels.
//
// The cone is marched with samples of the size of the cells that it reads: at distance t, cells of edge
// v = max(1, growth * t), one cell apart. A cell that covers the share a of its cross-section takes
// da = min(a * step / v, T) of the transmittance T that is left and adds its radiance for it. The sum is
// additive, like the pyramid: coverage comes from clipping, so that the pieces of a wall add up to one.

import package::grid::grid;
import package::volume::sample_volume;

// How cones are marched; the shader's side of TraceSettings.
struct ConeSettings {
    // Edge of the cells that are read, over the cone's diameter.
    voxel_per_diameter: f32,
    // Bound of the growth by the cosine against the own plane; 0: none.
    clearance: f32,
    normal_offset: f32,
    step_per_voxel: f32,
    min_transmittance: f32,
    // Voxels; where openness is read off.
    occlusion_distance: f32,
    padding_0: f32,
    padding_1: f32,
}

struct Cone {
    origin_in_grid: vec3f,
    direction: vec3f,
    // Edge of the cells that are read, per distance.
    growth: f32,
    // Where the cone ends, in voxels.
    reach: f32,
}

struct Traced {
    radiance: vec3f,
    // The share of the cone that met nothing.
    transmittance: f32,
    // The same at the occlusion distance.
    openness: f32,
    samples: u32,
}

// The least growth: a cone of a perfect mirror still reads coarser cells far away, which bounds its samples.
const MIN_GROWTH: f32 = 0.02;

// The growth of a cone with a half angle, leaving a surface at a cosine against its normal: cells stay
// `voxel_per_diameter` of the diameter, and clear of the plane that they come from.
fn cone_growth(tan_half_angle: f32, cos_normal: f32, settings: ConeSettings) -> f32 {
    var growth = 2.0 * tan_half_angle * settings.voxel_per_diameter;
    if settings.clearance > 0.0 {
        growth = min(growth, settings.clearance * cos_normal);
    }
    return max(growth, MIN_GROWTH);
}

fn trace_cone(cone: Cone, settings: ConeSettings) -> Traced {
    let extent = vec3f(grid.dimensions);
    let side = max(extent.x, max(extent.y, extent.z));
    let largest_cell = exp2(f32(grid.levels - 1u));
    // Nothing is farther than the grid's diagonal (less than 1.74 sides) and the coarsest cells around it.
    let reach = min(cone.reach, 1.75 * side + 2.0 * largest_cell);

    var traced = Traced(vec3f(0.0), 1.0, 1.0, 0u);
    var distance = 0.0;
    var openness_is_read = false;
    loop {
        if distance >= reach {
            break;
        }
        let step = settings.step_per_voxel
            * clamp(cone.growth * distance, 1.0, largest_cell);
        let middle = distance + 0.5 * step;
        let cell = clamp(cone.growth * middle, 1.0, largest_cell);
        let position = cone.origin_in_grid + cone.direction * middle;
        // Outside the grid the cells at its border are still felt for half a cell.
        let margin = min(cell, 0.5 * side);
        if any(position < vec3f(-margin)) || any(position > extent + margin) {
            break;
        }
        if !openness_is_read && middle > settings.occlusion_distance {
            traced.openness = traced.transmittance;
            openness_is_read = true;
        }
        let seen = sample_volume(position, log2(cell), cone.direction);
        traced.samples++;
        if seen.a > 0.0 {
            // What the cone's end cuts off of the last step does not count.
            let length = min(step, reach - distance);
            let taken = min(seen.a * length / cell, traced.transmittance);
            traced.radiance += seen.rgb * (taken / seen.a);
            traced.transmittance -= taken;
            if traced.transmittance < settings.min_transmittance {
                traced.transmittance = 0.0;
                break;
            }
        }
        distance += step;
    }
    if !openness_is_read {
        traced.openness = traced.transmittance;
    }
    return traced;
}
