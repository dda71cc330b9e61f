// Skinned meshes: a compute shader moves their vertices with the bones, for the voxels.

import { floats } from "./geometries.js";

const SHADER = `
struct Binding {
    bind: mat4x4f,
    bind_inverse: mat4x4f,
    vertices: u32,
}

@group(0) @binding(0) var<uniform> binding: Binding;
@group(0) @binding(1) var<storage, read> rest: array<f32>;
// Four bones, two per number; their weights.
@group(0) @binding(2) var<storage, read> joints: array<vec2u>;
@group(0) @binding(3) var<storage, read> weights: array<vec4f>;
@group(0) @binding(4) var<storage, read> bones: array<mat4x4f>;
@group(0) @binding(5) var<storage, read_write> positions: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let vertex = invocation.x;
    if vertex >= binding.vertices {
        return;
    }
    let at = 3u * vertex;
    let bound = binding.bind * vec4f(rest[at], rest[at + 1u], rest[at + 2u], 1.0);
    let joint = joints[vertex];
    let numbers = vec4u(joint.x & 0xffffu, joint.x >> 16u, joint.y & 0xffffu, joint.y >> 16u);
    let weight = weights[vertex];
    var moved = vec4f(0.0);
    for (var i = 0u; i < 4u; i++) {
        moved += weight[i] * (bones[numbers[i]] * bound);
    }
    let position = (binding.bind_inverse * moved).xyz;
    positions[at] = position.x;
    positions[at + 1u] = position.y;
    positions[at + 2u] = position.z;
}`;
/** Bytes of `Binding`. */
const BINDING = 144;

export class Skins {
    #device;
    #pipeline = null;

    constructor(device) {
        this.#device = device;
    }

    /** Makes the buffers that a skinned geometry needs besides its positions. */
    make(geometry, positions, vertices) {
        const device = this.#device;
        this.#pipeline ??= device.createComputePipeline({
            label: "lumivox: skins",
            layout: "auto",
            compute: { module: device.createShaderModule({ label: "lumivox: skins", code: SHADER }), entryPoint: "main" },
        });
        const { STORAGE, UNIFORM, COPY_DST } = GPUBufferUsage;
        const buffer = (size, usage) => device.createBuffer({ label: "lumivox: skin", size: Math.max(16, size), usage: usage | COPY_DST });
        const skin = {
            vertices, positions, group: null, boneCount: 0,
            rest: buffer(12 * vertices, STORAGE),
            joints: buffer(8 * vertices, STORAGE),
            weights: buffer(16 * vertices, STORAGE),
            binding: buffer(BINDING, UNIFORM),
            bones: null,
            dispose() {
                for (const each of [this.rest, this.joints, this.weights, this.binding, this.bones]) each?.destroy();
            },
        };
        device.queue.writeBuffer(skin.joints, 0, Uint16Array.from(floats(geometry.attributes.skinIndex, 4)));
        device.queue.writeBuffer(skin.weights, 0, floats(geometry.attributes.skinWeight, 4));
        return skin;
    }

    /** Moves a mesh's vertices with its bones. */
    run(encoder, { skin }, object) {
        const device = this.#device;
        const { skeleton, bindMatrix, bindMatrixInverse } = object;
        skeleton.update();
        const { boneMatrices } = skeleton;
        if (skin.boneCount !== boneMatrices.length) {
            skin.bones?.destroy();
            skin.boneCount = boneMatrices.length;
            skin.bones = device.createBuffer({ label: "lumivox: bones", size: boneMatrices.byteLength, usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST });
            const entries = [skin.binding, skin.rest, skin.joints, skin.weights, skin.bones, skin.positions];
            skin.group = device.createBindGroup({
                layout: this.#pipeline.getBindGroupLayout(0),
                entries: entries.map((buffer, binding) => ({ binding, resource: { buffer } })),
            });
        }
        device.queue.writeBuffer(skin.bones, 0, boneMatrices);
        const binding = new Float32Array(BINDING / 4);
        bindMatrix.toArray(binding, 0);
        bindMatrixInverse.toArray(binding, 16);
        new Uint32Array(binding.buffer)[32] = skin.vertices;
        device.queue.writeBuffer(skin.binding, 0, binding);
        const pass = encoder.beginComputePass({ label: "lumivox: skins" });
        pass.setPipeline(this.#pipeline);
        pass.setBindGroup(0, skin.group);
        pass.dispatchWorkgroups(Math.ceil(skin.vertices / 64));
        pass.end();
    }
}
