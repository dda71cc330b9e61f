// One cone, marched through the volume: the module package::cones::trace_method for a caller's own
// model. Lengths here are in the finest voxels.
//
// The step size is the size of the cells that the cone reads: at distance t, about v = max(1,
// growth * t). Levels are powers of two, so the level is chosen at random: each cone rounds log2(v)
// up or down by a number that it draws once. The mean over cones and frames then equals
// interpolation between levels, with half the look-ups. Steps are as long as the cells, so the
// filter's weights along the cone, and with them a wall's coverage, add up to one at every level.
//
// A cone changes to a coarser level only where both levels are empty nearby. From level to level a
// wall moves by half a cell, since it is in the middle of its cell. A change of level within the
// wall's reach would count parts of it twice or not at all, and the missing parts leak (12 % of the
// light of a closed box with a growth of 0.2, against 1.7 % with this rule). On the coarser level
// walls beside the cone count, too: its cells could reach past them, to the end of the wall at the
// cone's end.
//
// A cell of edge c that covers the share a of its cross-section absorbs da = min(a * step / c, T)
// of the remaining transmittance T and adds its radiance times da. The sum is additive, like the
// pyramid: coverage comes from clipping, so the pieces of a wall add up to one.
//
// The pieces add up exactly only for walls along the grid. An oblique wall climbs the grid in
// steps, and a ray that crosses it near a step meets it twice or misses parts: its coverage
// scatters about one (standard deviation 0.15, mean 1.00 in a rotated furnace). If the sum were
// capped at one, the surplus of some rays would be lost and the deficit of others would leak: 5 %
// of the light of a closed room. So at an oblique wall T may fall to -SURPLUS. Light from farther
// away, past a gap or from outside, pays the surplus back: it counts negative until T is zero
// again. In the mean over cones that cancels the leaks.

import package::cascades::{finest_level, level_count, outer_high, outer_low};
import package::cones::cone::{Cone, ConeSettings, MIN_GROWTH, OUTSIDE, Traced};
import package::cones::model::{shown_share, start_of_cones};
import package::constants::{LEAST_SURPLUS, SURPLUS};
import package::grid::grid_from_world;
import package::volume::patch::NOTHING;
import package::volume::{is_clear, is_empty, is_oblique, probe_volume, sample_probe, Probe};

// Within this distance of a cascade's border, in its voxels, a cone changes to the next cascade at
// the first empty place; each cone draws a factor of 1 to 2.
const CASCADE_BORDER: f32 = 3.0;

// Whether the remaining transmittance is negligible. The threshold is smaller for a surplus, which
// pays for light that other cones let through: if it were dropped as early, rotated rooms would get
// more light from outside.
fn is_spent(transmittance: f32, settings: ConeSettings) -> bool {
    return transmittance <= settings.min_transmittance
        && transmittance >= -min(settings.min_transmittance, LEAST_SURPLUS);
}

// The start of a surface's cones, in the grid's coordinates; `level` is the level of the surface's
// voxels.
fn cone_start(position_in_world: vec3f, normal: vec3f, level: u32, settings: ConeSettings) -> vec3f {
    let offset = settings.normal_offset * exp2(f32(level));
    let above = grid_from_world(position_in_world) + normal * offset;
    return start_of_cones(above, normal, level, settings.model_values);
}

// The growth of a cone by its half angle and its cosine to the surface's normal: cells are
// `voxel_per_diameter` of the diameter, but do not reach the plane that the cone starts from.
fn cone_growth(tan_half_angle: f32, cos_normal: f32, settings: ConeSettings) -> f32 {
    var growth = 2.0 * tan_half_angle * settings.voxel_per_diameter;
    if settings.clearance > 0.0 {
        growth = min(growth, settings.clearance * cos_normal);
    }
    return max(growth, MIN_GROWTH);
}

// The transmittance that a sample absorbs; negative while a surplus is paid back.
fn taken_by(covered: f32, transmittance: f32, may_exceed: bool, pays_back: bool) -> f32 {
    if pays_back {
        return -min(covered, -transmittance);
    }
    return min(covered, transmittance + select(0.0, SURPLUS, may_exceed));
}

fn trace_cone(cone: Cone, settings: ConeSettings) -> Traced {
    let low = outer_low();
    let high = outer_high();
    let extent = high - low;
    let side = max(extent.x, max(extent.y, extent.z));
    let levels = level_count();
    let smallest_cell = exp2(f32(cone.level));
    let largest_cell = exp2(f32(levels - 1u));
    // Nothing is farther away than the grid's diagonal (less than 1.74 sides) and the coarsest
    // cells around it.
    let reach = min(cone.reach, 1.75 * side + 2.0 * largest_cell);

    var traced = Traced(vec3f(0.0), 1.0, -1.0, 0u, 0.0, vec3f(0.0), vec3f(0.0), NOTHING);
    var distance = 0.0;
    var level = cone.level;
    var length = 0.0;
    var cell = smallest_cell;
    var is_inside = reach > 0.0;
    // `may_exceed`: the sampled surface is oblique. `pays_back`: it is not the surface that made
    // the surplus.
    var may_exceed = false;
    var pays_back = false;
    loop {
        // Skip empty space, probe by probe. On wide machines, lanes leave this inner loop one by
        // one and then sample together, instead of waiting for each other at every step.
        var probe: Probe;
        loop {
            let near = clamp(cone.growth * distance, smallest_cell, largest_cell);
            let wanted =
                clamp(cone.growth * (distance + 0.5 * near), smallest_cell, largest_cell);
            let next = cone.origin_in_grid
                + cone.direction * (distance + 0.5 * settings.step_per_voxel * exp2(f32(level)));
            // Change cascades at a cascade's end in any case.
            level = finest_level(next, level, 0.5);
            let wanted_level = max(
                min(u32(log2(wanted) + cone.level_offset), levels - 1u),
                // Before the cascade's end, change only in empty space, each cone at another
                // distance.
                finest_level(next, level, CASCADE_BORDER * (1.0 + cone.level_offset)),
            );
            cell = exp2(f32(level));
            length = settings.step_per_voxel * cell;
            let middle = distance + 0.5 * length;
            let position = cone.origin_in_grid + cone.direction * middle;
            // Outside the grid the cells at its border still count for half a cell.
            let margin = min(cell, 0.5 * side);
            is_inside = is_inside && distance < reach
                && all(position >= low - margin) && all(position <= high + margin);
            if middle > settings.occlusion_distance && traced.openness < 0.0 {
                traced.openness = traced.transmittance;
            }
            probe = probe_volume(position, level, cone.direction);
            distance += length;
            if wanted_level > level && is_empty(probe) {
                level += u32(is_clear(position, level + 1u));
            }
            traced.samples += u32(is_inside);
            // A gap ends a surface.
            pays_back = pays_back || is_empty(probe);
            let is_closed = is_spent(traced.transmittance, settings);
            is_inside = is_inside && !(is_closed && is_empty(probe));
            continuing {
                break if !(is_inside && is_empty(probe));
            }
        }
        if is_inside {
            let seen = sample_probe(probe, cone.direction);
            if seen.a > 0.0 {
                // The part of the last step beyond the cone's end does not count.
                let counted = min(length, reach - (distance - length));
                may_exceed = is_oblique(probe);
                pays_back = traced.transmittance < 0.0 && (pays_back || !may_exceed);
                let taken = taken_by(
                    seen.a * counted / cell, traced.transmittance, may_exceed, pays_back);
                let diameter = cone.growth / settings.voxel_per_diameter * (distance - 0.5 * length);
                let shown = shown_share(
                    taken, traced.transmittance, level, diameter / side, settings.model_values);
                traced.radiance += seen.rgb * (shown / seen.a);
                traced.transmittance -= taken;
                traced.distance += taken * (distance - 0.5 * length);
                pays_back = pays_back || traced.transmittance <= -SURPLUS;
            }
        }
        continuing {
            let is_over = is_spent(traced.transmittance, settings)
                && (pays_back || !may_exceed);
            break if !is_inside || is_over;
        }
    }
    if is_spent(traced.transmittance, settings) {
        traced.radiance /= 1.0 - traced.transmittance;
        traced.distance /= 1.0 - traced.transmittance;
        traced.transmittance = 0.0;
    }
    if traced.openness < 0.0 {
        traced.openness = traced.transmittance;
    }
    traced.distance = max(traced.distance, 0.0) + max(traced.transmittance, 0.0) * OUTSIDE * side;
    return traced;
}

// Shadow cones are narrow, so cells of half their diameter are fine enough. They start 1.5 voxels
// off the surface; otherwise cones to a light at a grazing angle would meet the receiver's own
// neighbourhood.
fn shadow_cone_settings() -> ConeSettings {
    var settings = ConeSettings();
    settings.voxel_per_diameter = 0.5;
    settings.normal_offset = 1.5;
    settings.step_per_voxel = 1.0;
    settings.min_transmittance = 0.004;
    settings.occlusion_distance = 3e38;
    return settings;
}

// The visible share of a source: one cone as wide as the source.
fn seen_share(
    position_in_world: vec3f,
    normal: vec3f,
    direction: vec3f,
    tan_half_angle: f32,
    reach: f32,
    level: u32,
) -> f32 {
    let settings = shadow_cone_settings();
    let voxel = exp2(f32(level));
    let origin = grid_from_world(position_in_world) + normal * (voxel * settings.normal_offset);
    let growth = cone_growth(tan_half_angle, 1.0, settings);
    // Stop before the surface that carries the source.
    let cone = Cone(origin, direction, growth, reach - 2.0 * voxel, 0.5, level);
    return max(trace_cone(cone, settings).transmittance, 0.0);
}
