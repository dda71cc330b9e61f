// Lists the emitters of a run of triangles: one thread for each.
//
// A textured triangle is quartered repeatedly into pieces of equal area, each with the mean of the
// texture over it: sampling an emitter then reads no textures, whose number is unlimited.

import package::constants::{DOUBLE_SIDED, LINEAR_WORKGROUP_SIZE};
import package::emitters::emitter::{strength, Emitter};
import package::gpu::dispatch::linear_index;
import package::voxelize::items::run;
import package::voxelize::surface::{surface_of, triangle_map, PIERCED};
import package::voxelize::triangles::{draws, load_triangle, SMALLEST_COVERAGE};

struct RunEmitters {
    first_emitter: u32,
    // Number of times that a triangle is quartered.
    levels: u32,
    // The largest emission of all materials.
    emission_scale: f32,
    padding: u32,
}

@group(2) @binding(0) var<uniform> params: RunEmitters;
@group(2) @binding(1) var<storage, read_write> listed: array<Emitter>;

// The corners of a piece in barycentric coordinates. Each two bits of its number choose a quarter
// of the remaining triangle, so pieces with close numbers are close to each other, and well
// distributed numbers give well distributed places.
fn corners_of(piece: u32) -> array<vec2f, 3> {
    var a = vec2f(0.0);
    var b = vec2f(1.0, 0.0);
    var c = vec2f(0.0, 1.0);
    for (var level = params.levels; level > 0u; level--) {
        let quarter = extractBits(piece, 2u * (level - 1u), 2u);
        let ab = 0.5 * (a + b);
        let bc = 0.5 * (b + c);
        let ca = 0.5 * (c + a);
        switch quarter {
            case 0u: {
                b = ab;
                c = ca;
            }
            case 1u: {
                a = ab;
                c = bc;
            }
            case 2u: {
                a = ca;
                b = bc;
            }
            default: {
                a = ab;
                b = bc;
                c = ca;
            }
        }
    }
    return array(a, b, c);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    let pieces = 1u << (2u * params.levels);
    if index >= (run.end_triangle - run.first_triangle) * pieces {
        return;
    }
    let triangle =
        load_triangle(run.first_triangle + index / pieces, run.first_draw, run.end_draw);
    let ab = triangle.b - triangle.a;
    let ac = triangle.c - triangle.a;
    let corners = corners_of(index % pieces);
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let map = triangle_map(triangle.vertices, triangle.draw, 2.0 * f32(pieces));
    let surface = surface_of(triangle.draw, map, middle, PIERCED);

    let to_b = corners[1] - corners[0];
    let to_c = corners[2] - corners[0];
    var emitter: Emitter;
    emitter.corner = triangle.a + corners[0].x * ab + corners[0].y * ac;
    emitter.along_ab = to_b.x * ab + to_b.y * ac;
    emitter.along_ac = to_c.x * ab + to_c.y * ac;
    emitter.is_double_sided = u32((draws[triangle.draw].flags & DOUBLE_SIDED) != 0u);
    if surface.coverage >= SMALLEST_COVERAGE {
        emitter.radiance = surface.emission * surface.coverage * params.emission_scale;
    }
    let area = 0.5 * length(cross(emitter.along_ab, emitter.along_ac));
    let power = strength(emitter.radiance) * area * f32(1u + emitter.is_double_sided);
    // Triangles that are not finite do not emit, since they are not voxelized either.
    emitter.power = select(0.0, power, power > 0.0 && power < 1e30);
    listed[params.first_emitter + index] = emitter;
}
