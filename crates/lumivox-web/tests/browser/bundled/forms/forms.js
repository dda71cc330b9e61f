// three.js scenes whose light has a closed form, as Lumivox renders them.

import * as THREE from "three/webgpu";
import { mrt, output, pass, vec4, velocity } from "three/tsl";
import { createGi } from "lumivox/three";

const SIZE = 16;

// The renderer creates its own device; the example uses ours.
const renderer = new THREE.WebGPURenderer();
await renderer.init();
renderer.setSize(SIZE, SIZE, false);
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(60, 1, 0.05, 20);
const bounds = new THREE.Box3(new THREE.Vector3(-1.2, -1.2, -1.2), new THREE.Vector3(1.2, 1.2, 1.2));
// Glass in a closed room, lit in its first frame.
const firsts = [furnaceRoom(), clear(0.3)];
firsts[1].scale.setScalar(0.6);
scene.add(...firsts);
const gi = await createGi(renderer, { scene, camera, bounds, resolution: 32, preset: "balanced" });
const view = pass(scene, camera, { samples: 0 });
view.contextNode = gi.context;
const pipeline = new THREE.RenderPipeline(renderer, view);
pipeline.outputColorTransform = false;
const target = new THREE.RenderTarget(SIZE, SIZE, { type: THREE.FloatType });
const first = (await picture(1))[0];
scene.remove(...firsts);

/** Mean red, green and blue of the picture, over the last half of the frames. */
async function picture(frames = 24, move = () => {}) {
    const sum = [0, 0, 0];
    for (let frame = 0; frame < frames; frame += 1) {
        move();
        renderer.setRenderTarget(target);
        // As the animation loop does.
        renderer._nodes.nodeFrame.update();
        pipeline.render();
        renderer.setRenderTarget(null);
        await renderer.backend.device.queue.onSubmittedWorkDone();
        if (frame < Math.floor(frames / 2)) continue;
        const texels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, SIZE, SIZE);
        for (let at = 0; at < texels.length; at += 1) if (at % 4 < 3) sum[at % 4] += texels[at] / (SIZE * SIZE * (frames - Math.floor(frames / 2)));
    }
    return sum;
}

function look(from, to) {
    camera.position.set(...from);
    camera.lookAt(...to);
}

/** Puts objects into the empty scene, measures, and takes them away. */
async function during(objects, measure) {
    for (const object of objects) scene.add(object);
    try {
        return await measure();
    } finally {
        for (const object of objects) scene.remove(object);
        scene.environment = null;
    }
}

function matte(options) {
    return new THREE.MeshLambertMaterial(options);
}

/** A closed room that reflects half and emits 1. */
function furnaceRoom() {
    return new THREE.Mesh(new THREE.BoxGeometry(2, 2, 2), matte({ color: new THREE.Color(0.5, 0.5, 0.5), emissive: 0xffffff, side: THREE.BackSide }));
}

/** A transparent wall outside the voxels that reflects half, seen from half a metre before it. */
function clear(turn) {
    const made = wall(turn, new THREE.Color(0.5, 0.5, 0.5));
    Object.assign(made.material, { transparent: true });
    made.userData.gi = false;
    const normal = new THREE.Vector3(0, 0, 1).applyAxisAngle(new THREE.Vector3(0, 1, 0), turn);
    look(normal.multiplyScalar(0.5).toArray(), [0, 0, 0]);
    return made;
}

/** A sky that is bright in the half towards +x. */
function halfSky(dark, bright) {
    const [width, height] = [32, 16];
    const data = new Float32Array(4 * width * height);
    for (let at = 0; at < width * height; at += 1) {
        // three.js maps the middle to +x.
        const isBright = Math.abs((at % width) + 0.5 - width / 2) < width / 4;
        data.fill(isBright ? bright : dark, 4 * at, 4 * at + 3);
        data[4 * at + 3] = 1;
    }
    const texture = new THREE.DataTexture(data, width, height, THREE.RGBAFormat, THREE.FloatType);
    texture.mapping = THREE.EquirectangularReflectionMapping;
    texture.needsUpdate = true;
    return texture;
}

async function withSky(sky) {
    scene.environment = sky;
    // It is read in the background.
    for (let tries = 0; tries < 20; tries += 1) {
        await picture(1);
        await new Promise((resolve) => setTimeout(resolve, 50));
    }
}

function wall(turn, color = 0xffffff) {
    const made = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), matte({ color }));
    made.rotation.y = turn;
    return made;
}

/** Radiance of a wall that faces +x (turn 90°) or -z (turn 180°), from a metre before it. */
async function wallIn(sky, turn, environmentTurn) {
    const made = wall(turn);
    const normal = new THREE.Vector3(0, 0, 1).applyAxisAngle(new THREE.Vector3(0, 1, 0), turn);
    look(normal.toArray(), [0, 0, 0]);
    scene.environmentRotation.y = environmentTurn;
    return during([made], async () => {
        await withSky(sky);
        return (await picture(8))[0];
    });
}

const forms = {
    /** A closed room that reflects half and emits 1: its radiance is 2 everywhere. */
    async furnace() {
        look([0.3, 0.2, 0.1], [-1, -0.4, -0.7]);
        return during([furnaceRoom()], () => picture());
    },
    /** The furnace's room, mirrored, with vertex colours that its material does not use. */
    async mirrored() {
        look([0.3, 0.2, 0.1], [-1, -0.4, -0.7]);
        const box = new THREE.BoxGeometry(2, 2, 2);
        box.setAttribute("color", new THREE.Float32BufferAttribute(new Float32Array(3 * box.attributes.position.count), 3));
        const room = new THREE.Mesh(box, matte({ color: new THREE.Color(0.5, 0.5, 0.5), emissive: 0xffffff, side: THREE.BackSide }));
        room.scale.x = -1;
        return during([room], () => picture());
    },
    /** A transparent blue sheet in front of a wall. */
    async sheet() {
        look([0, 0, 0.9], [0, 0, 0]);
        const sheet = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), new THREE.MeshBasicMaterial({ color: 0x0000ff, transparent: true }));
        return during([wall(0), sheet], () => picture(8)).finally(() => sheet.material.dispose());
    },
    /** Transparent walls outside the voxels, lit by probes: in the furnace, and under a sky
     * that is bright towards +x, facing +x, -z and -x. */
    async air() {
        const inside = clear(0.3);
        inside.scale.setScalar(0.6);
        const seen = { first, room: (await during([furnaceRoom(), inside], () => picture()))[0] };
        const sky = halfSky(0, 1);
        for (const [name, turn] of [["toX", Math.PI / 2], ["toZ", Math.PI], ["fromX", -Math.PI / 2]]) {
            const made = clear(turn);
            scene.environmentRotation.y = 0;
            seen[name] = await during([made], async () => {
                await withSky(sky);
                return (await picture(8))[0];
            });
        }
        return seen;
    },
    /** A metal wall with its own environment map, in a scene without one. */
    async ownMap() {
        look([0, 0, 0.5], [0, 0, 0]);
        const metal = new THREE.MeshStandardMaterial({ metalness: 1, roughness: 1, envMap: halfSky(1, 1) });
        return during([new THREE.Mesh(new THREE.PlaneGeometry(2, 2), metal)], () => picture(8));
    },
    /** The velocity of a moving wall in a pass of the page, which Lumivox must not change. */
    async velocity() {
        look([0, 0, 0.9], [0, 0, 0]);
        const moving = pass(scene, camera, { samples: 0 });
        moving.contextNode = gi.context;
        moving.setMRT(mrt({ output, velocity }));
        pipeline.outputNode = vec4(moving.getTextureNode("velocity").xy, 0, 1);
        pipeline.needsUpdate = true;
        const made = wall(0);
        const sum = await during([made], () => picture(4, () => (made.position.x += 0.05)));
        pipeline.outputNode = view;
        pipeline.needsUpdate = true;
        moving.dispose();
        return sum;
    },
    /** The last: a second `dispose` and a later `update` do nothing; glass that is new is then
     * drawn without light. */
    async free() {
        gi.dispose();
        gi.dispose();
        gi.update();
        const made = clear(0);
        made.material.alphaHash = true;
        return (await during([furnaceRoom(), made], () => picture(1)))[0];
    },
    /** A picture of size 0, NaN and infinity: none of them throws in frames. */
    async misuse() {
        renderer.setSize(0, 0, false);
        gi.update();
        renderer.setSize(SIZE, SIZE, false);
        const before = gi.notes;
        const made = wall(0);
        made.material.emissiveIntensity = Number.NaN;
        look([0, 0, 0.5], [0, 0, 0]);
        await during([made, new THREE.PointLight(0xffffff, 1, Infinity)], () => picture(2));
        return gi.notes.filter((note) => !before.includes(note));
    },
    /** A ball from within, which reflects half, with a lamp of pi candela in its middle: radiance
     * 0.5 (direct) + 0.5. */
    async ball() {
        look([0, 0, 0.02], [-1, 0.3, -0.7]);
        const ball = new THREE.Mesh(new THREE.SphereGeometry(1, 48, 32), matte({ color: new THREE.Color(0.5, 0.5, 0.5), side: THREE.BackSide }));
        return during([ball, new THREE.PointLight(0xffffff, Math.PI)], () => picture(48));
    },
    /** A white wall under a uniform sky of radiance 3: it has the same. */
    sky: () => wallIn(halfSky(3, 3), Math.PI / 2, 0),
    /** Walls that face +x and -z, under a sky that is bright towards +x, before and after it is
     * turned by 90° about y. */
    async turnedSky() {
        const sky = halfSky(0, 1);
        return { toX: await wallIn(sky, Math.PI / 2, 0), toZ: await wallIn(sky, Math.PI, 0), turnedToX: await wallIn(sky, Math.PI / 2, Math.PI / 2), turnedToZ: await wallIn(sky, Math.PI, Math.PI / 2) };
    },
    /** A sky that three.js draws, twice into the same texture. */
    async drawnSky() {
        const around = new THREE.Scene();
        const cube = new THREE.CubeRenderTarget(16, { type: THREE.HalfFloatType });
        const eye = new THREE.CubeCamera(0.1, 10, cube);
        const drawn = (radiance) => {
            around.background = new THREE.Color().setScalar(radiance);
            eye.update(renderer, around);
            return wallIn(cube.texture, Math.PI / 2, 0);
        };
        const seen = { before: await drawn(1), after: await drawn(3) };
        cube.dispose();
        return seen;
    },
    /** three.js's own picture of the turned sky towards -z: the sign of a turn. */
    async background() {
        look([0, 0, 0], [0, 0, -1]);
        const sky = halfSky(0, 1);
        scene.background = sky;
        scene.backgroundRotation.y = Math.PI / 2;
        const [red] = await during([], () => picture(2));
        scene.background = null;
        return red;
    },
    /** Light on a floor from a sheet, before and after a bone has moved the sheet closer. */
    async bone() {
        const floor = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), matte({ color: 0xffffff }));
        floor.rotation.x = -Math.PI / 2;
        floor.position.y = -1;
        const sheet = new THREE.PlaneGeometry(0.8, 0.8);
        sheet.rotateX(Math.PI / 2).translate(0, 0, 0.6);
        const { count } = sheet.attributes.position;
        sheet.setAttribute("skinIndex", new THREE.Uint16BufferAttribute(new Array(4 * count).fill(0), 4));
        sheet.setAttribute("skinWeight", new THREE.Float32BufferAttribute(Array.from({ length: 4 * count }, (_, at) => (at % 4 === 0 ? 1 : 0)), 4));
        const lamp = new THREE.SkinnedMesh(sheet, matte({ color: 0x000000, emissive: 0xffffff, emissiveIntensity: 4 }));
        const bone = new THREE.Bone();
        lamp.add(bone);
        lamp.bind(new THREE.Skeleton([bone]));
        lamp.frustumCulled = false;
        look([0.9, 0, -0.9], [0.5, -1, -0.5]);
        return during([floor, lamp], async () => {
            const [before] = await picture(16);
            bone.rotation.y = Math.PI;
            const [after] = await picture(16);
            return { before, after };
        });
    },
    /** Light on a white wall from an emissive image that is red, and then changed to green. */
    async image() {
        const texture = new THREE.DataTexture(new Uint8Array(Array(16).fill([255, 0, 0, 255]).flat()), 4, 4);
        texture.colorSpace = THREE.SRGBColorSpace;
        texture.generateMipmaps = true;
        texture.minFilter = THREE.LinearMipmapLinearFilter;
        texture.needsUpdate = true;
        const shining = new THREE.Mesh(new THREE.PlaneGeometry(1.6, 1.6), matte({ color: 0x000000, emissive: 0xffffff, emissiveMap: texture, emissiveIntensity: 2 }));
        shining.position.z = -0.8;
        const white = wall(Math.PI);
        white.position.z = 0.8;
        look([0, 0, 0], [0, 0, 1]);
        return during([shining, white], async () => {
            const before = await picture(16);
            for (let at = 0; at < 64; at += 4) texture.image.data.set([0, 255, 0, 255], at);
            texture.needsUpdate = true;
            return { before, after: await picture(16) };
        });
    },
    notes: () => gi.notes,
    async wrong() {
        const say = (promise) => promise.then(() => "nothing", ({ code, message }) => `${code}: ${message}`);
        return {
            scene: await say(createGi(renderer, { camera })),
            empty: await say(createGi(renderer, { scene: new THREE.Scene(), camera })),
            resolution: await say(createGi(renderer, { scene, camera, bounds, resolution: 63 })),
            option: await say(createGi(renderer, { scene, camera, bounds, glow: 3 })),
            webgl: await say((async () => createGi(new THREE.WebGPURenderer({ forceWebGL: true }), { scene, camera, bounds }))()),
        };
    },
};
globalThis.forms = forms;
document.documentElement.dataset.state = "ready";
