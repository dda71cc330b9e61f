// lumivox/three: global illumination for a scene of three.js's WebGPURenderer.

import init, { SharedGi } from "./lumivox_three.js";
import { Gi } from "./gi.js";
import { failure } from "./failure.js";

/** @type {Promise<unknown> | undefined} */
let module;

/**
 * Loads the WebAssembly; `createGi` does so itself. `source` is only needed if a bundler does not
 * find the file.
 */
export function initialize(source) {
    module ??= init(source === undefined ? undefined : { module_or_path: source }).catch((error) => {
        // Allow another try, perhaps with another source.
        module = undefined;
        throw error;
    });
    return module;
}

/**
 * A device with the highest limits of the GPU, for `new WebGPURenderer({ device })`: with it a
 * buffer may exceed 128 MiB.
 */
export async function createDevice(options = {}) {
    const adapter = await navigator.gpu?.requestAdapter(options);
    if (!adapter) throw failure("no-webgpu", "this browser has no WebGPU, or no GPU for it; Chrome and Edge 113, Safari 26 and Firefox 145 have it");
    const requiredLimits = {};
    for (const name of ["maxBufferSize", "maxStorageBufferBindingSize", "maxTextureDimension3D"]) requiredLimits[name] = adapter.limits[name];
    const wanted = ["timestamp-query", "float32-filterable", "texture-compression-bc", "texture-compression-etc2", "texture-compression-astc"];
    return adapter.requestDevice({ requiredLimits, requiredFeatures: wanted.filter((name) => adapter.features.has(name)) });
}

/** Global illumination for what a camera sees of a scene. The declarations (`index.d.ts`) have all
 * options. */
export async function createGi(renderer, options) {
    const { scene, camera } = options ?? {};
    if (!scene?.isScene || !camera?.isCamera) {
        throw failure("value", "createGi needs a scene and a camera: createGi(renderer, { scene, camera })");
    }
    if (renderer?.isRenderer !== true) throw failure("value", "createGi needs a WebGPURenderer of three.js");
    await renderer.init();
    if (renderer.backend.isWebGPUBackend !== true) {
        throw failure("no-webgpu", "the renderer draws with WebGL here; Lumivox needs WebGPU: Chrome and Edge 113, Safari 26, Firefox 145 or newer");
    }
    if (renderer.backend.compatibilityMode === true) {
        throw failure("no-webgpu", "the renderer's device is one of WebGPU's compatibility mode; make it by createDevice() and give it to the renderer");
    }
    if (renderer.logarithmicDepthBuffer) {
        throw failure("value", "a logarithmic depth buffer cannot be read; use reversedDepthBuffer: true instead");
    }
    await initialize();
    return Gi.create(SharedGi, renderer, options);
}
