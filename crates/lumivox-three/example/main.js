import * as THREE from "three/webgpu";
import { pass } from "three/tsl";
import { createDevice, createGi } from "lumivox/three";
import { createHall } from "./hall.js";

const say = (text) => (document.querySelector("p").textContent = text);

try {
    const renderer = new THREE.WebGPURenderer({ device: await createDevice() });
    await renderer.init();
    renderer.shadowMap.enabled = true;
    renderer.toneMapping = THREE.AgXToneMapping;
    renderer.toneMappingExposure = 0.5;
    document.body.append(renderer.domElement);
    const { scene, camera, animate } = createHall();

    const resize = () => {
        renderer.setPixelRatio(Math.min(devicePixelRatio, 1.5));
        renderer.setSize(innerWidth, innerHeight);
        camera.aspect = innerWidth / innerHeight;
        camera.updateProjectionMatrix();
    };
    addEventListener("resize", resize);
    resize();

    const onProgress = (done, total) => say(`compiling: ${done} of ${total}`);
    const gi = await createGi(renderer, { scene, camera, resolution: 96, onProgress });
    const view = pass(scene, camera);
    view.contextNode = gi.context;
    const pipeline = new THREE.RenderPipeline(renderer, view);
    const begin = performance.now();
    let last = begin;
    let mean = 0;
    renderer.setAnimationLoop((now) => {
        animate((now - begin) / 1000);
        pipeline.render();
        mean += 0.05 * (now - last - mean);
        last = now;
        say(`${mean.toFixed(0)} ms a frame; ${gi.stats.voxels} voxels, ${(gi.memory / 2 ** 20).toFixed(0)} MiB`);
    });
} catch (error) {
    say(error.message);
    throw error;
}
