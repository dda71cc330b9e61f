// The powers of the emitters, added up: one workgroup, so that the order of the sums is always the same.

import package::emitters::emitter::EmitterList;

struct EmitterCount {
    count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(0) var<uniform> emitter_count: EmitterCount;
@group(0) @binding(1) var<storage, read_write> list: EmitterList;

const THREADS = 256u;

// First the power of each thread's emitters, then that of all before them.
var<workgroup> powers: array<f32, THREADS>;

@compute @workgroup_size(THREADS)
fn main(@builtin(local_invocation_index) local: u32) {
    let count = emitter_count.count;
    let each = (count + THREADS - 1u) / THREADS;
    let first = min(local * each, count);
    let end = min(first + each, count);
    var power = 0.0;
    for (var i = first; i < end; i++) {
        power += list.emitters[i].power_so_far;
        list.emitters[i].power_so_far = power;
    }
    powers[local] = power;
    workgroupBarrier();
    if local == 0u {
        var all = 0.0;
        for (var i = 0u; i < THREADS; i++) {
            let own = powers[i];
            powers[i] = all;
            all += own;
        }
        list.count = count;
        list.power = all;
    }
    workgroupBarrier();
    let before = powers[local];
    for (var i = first; i < end; i++) {
        list.emitters[i].power_so_far += before;
    }
}
