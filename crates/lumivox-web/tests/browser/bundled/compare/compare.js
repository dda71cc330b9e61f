// The example's hall, closed and matte, by Lumivox and by three.js's VXGINode: times and pictures.

import * as THREE from "three/webgpu";
import { builtinGIContext, mrt, normalView, pass, vec4 } from "three/tsl";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import { vxgi } from "three/addons/lighting/vxgi/VXGINode.js";
import { createDevice, createGi } from "lumivox/three";
import { createHall } from "../example/hall.js";

const TIME = 1.5;
/** Numbers of frames: until light has settled, in the picture's mean, and timed. */
const [SETTLING, AVERAGED, TIMED] = [48, 16, 6];

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
const base64 = (bytes) => {
    let text = "";
    for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
    return btoa(text);
};

function hallOf(width, height) {
    const hall = createHall({ aspect: width / height, isClosed: true, isMatte: true });
    hall.lamp.clear();
    hall.animate(TIME);
    hall.scene.updateMatrixWorld();
    return hall;
}

/** The hall as a GLB file, and its camera as an option of the program. */
async function exported(width, height) {
    const { scene, camera } = hallOf(width, height);
    const glb = await new GLTFExporter().parseAsync(scene, { binary: true });
    const target = camera.getWorldDirection(new THREE.Vector3()).add(camera.position);
    return { glb: base64(new Uint8Array(glb)), camera: [...camera.position, ...target, camera.fov].join() };
}

async function lumivox(renderer, { scene, camera }, resolution) {
    const view = pass(scene, camera, { samples: 4 });
    const gi = await createGi(renderer, { scene, camera, resolution });
    view.contextNode = gi.context;
    return { output: view, memory: () => gi.memory, rebuild() {} };
}

function ofThree(bounces) {
    return async (renderer, { scene, camera }, resolution) => {
        const before = renderer.info.memory.total;
        const view = pass(scene, camera, { samples: 4 });
        const prepass = pass(scene, camera, { samples: 0 });
        prepass.transparent = false;
        prepass.setMRT(mrt({ output: vec4(normalView, 1) }));
        const node = vxgi(prepass.getTextureNode("depth"), prepass.getTextureNode(), scene, camera, resolution);
        node.bounces = bounces;
        view.contextNode = builtinGIContext(node.getAONode().r, node.getGINode().rgb);
        // Drawn first: passes cannot be nested.
        const output = prepass.getTextureNode().rgba.mul(0).add(view);
        return { output, memory: () => renderer.info.memory.total - before, rebuild: () => (node.needsUpdate = true) };
    };
}

const METHODS = { "Lumivox, `realtime`": lumivox, "`VXGINode`, 1 bounce": ofThree(1), "`VXGINode`, 2 bounces": ofThree(2) };

/** Measures a method: ms a frame while nothing, the lamp, or objects move; bytes; its picture in
 * linear light. */
async function measured(name, resolution, width, height) {
    const renderer = new THREE.WebGPURenderer({ canvas: document.createElement("canvas"), device: await createDevice() });
    await renderer.init();
    renderer.setSize(width, height, false);
    renderer.shadowMap.enabled = true;
    const hall = hallOf(width, height);
    const { output, memory, rebuild } = await METHODS[name](renderer, hall, resolution);
    const pipeline = new THREE.RenderPipeline(renderer, output);
    pipeline.outputColorTransform = false;
    const target = new THREE.RenderTarget(width, height, { type: THREE.FloatType });
    const frame = async () => {
        const begin = performance.now();
        renderer._nodes.nodeFrame.update();
        renderer.setRenderTarget(target);
        pipeline.render();
        renderer.setRenderTarget(null);
        await renderer.backend.device.queue.onSubmittedWorkDone();
        return performance.now() - begin;
    };
    const times = async (count, before) => {
        const all = [];
        for (let at = 0; at < count; at += 1) {
            before?.(at);
            all.push(await frame());
        }
        return all;
    };
    await times(SETTLING);
    const still = median(await times(TIMED));
    const mean = new Float32Array(4 * width * height);
    for (let at = 0; at < AVERAGED; at += 1) {
        await frame();
        const texels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height);
        texels.forEach((value, texel) => (mean[texel] += value / AVERAGED));
    }
    const place = hall.lamp.position.x;
    const lamp = median(await times(TIMED, (at) => (hall.lamp.position.x = place + 0.05 * (at + 1))));
    // The first frames, which separate moving from static objects, are not counted.
    const moving = await times(TIMED + 8, (at) => {
        hall.animate(TIME + 0.05 * at);
        rebuild();
    });
    const bytes = memory();
    renderer.dispose();
    return { name, still, lamp, moving: median(moving.slice(8)), memory: bytes, picture: base64(new Uint8Array(mean.buffer)) };
}

globalThis.compare = { methods: Object.keys(METHODS), exported, measured };
document.documentElement.dataset.state = "ready";
