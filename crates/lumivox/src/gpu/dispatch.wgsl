// The index of an invocation in a list whose workgroups are distributed over x and y
// (Kernel::dispatch_linear).

import package::constants::LINEAR_WORKGROUP_SIZE;

fn linear_index(invocation: vec3u, workgroups: vec3u) -> u32 {
    return invocation.y * (workgroups.x * LINEAR_WORKGROUP_SIZE) + invocation.x;
}
