// Uses of `lumivox/three` that must compile, and some that must not.

import { PerspectiveCamera, RenderPipeline, Scene, WebGPURenderer } from "three/webgpu";
import { pass } from "three/tsl";
import { LumivoxGi, type LumivoxGiProps } from "lumivox/react";
import { createDevice, createGi, type Gi, type LumivoxError } from "lumivox/three";

const renderer = new WebGPURenderer({ device: await createDevice({ powerPreference: "high-performance" }) });
const scene = new Scene();
const camera = new PerspectiveCamera();
const gi: Gi = await createGi(renderer, { scene, camera, resolution: 64, preset: "fast", cones: 12, onProgress: (done, total) => console.log(done / total) });
const view = pass(scene, camera);
view.contextNode = gi.context;
const pipeline = new RenderPipeline(renderer, view.add(gi.reflection));
pipeline.render();
gi.set("normal_offset", 1);
console.log(gi.notes.join(), gi.stats.voxels, gi.memory);
gi.dispose();
createGi(renderer, { scene, camera }).catch((error: LumivoxError) => console.log(error.code));

// @ts-expect-error: there is no such preset
createGi(renderer, { scene, camera, preset: "best" });
// @ts-expect-error: a camera is missing
createGi(renderer, { scene });
// @ts-expect-error: its textures are made once
gi.set("temporal", true);

const props: LumivoxGiProps = { resolution: 64, cones: 12, passOptions: { samples: 4 }, onReady: (gi) => gi.cut(), onError: ({ code }) => console.log(code) };
LumivoxGi(props);
// @ts-expect-error: the canvas has the scene
LumivoxGi({ scene });
