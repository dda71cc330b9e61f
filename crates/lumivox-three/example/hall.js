// A hall with a sky: a lamp and objects that move, a skinned banner, a glossy floor.

import * as THREE from "three/webgpu";

const WHITE = 0xd9d4c8;

/**
 * The scene, its camera, some of its objects, and a function that moves them to a time in seconds.
 * For measurements its windows can be closed and all surfaces made matte.
 */
export function createHall({ aspect = 16 / 9, shadows = 1024, isClosed = false, isMatte = false } = {}) {
    const scene = new THREE.Scene();
    if (!isClosed) {
        scene.environment = sky();
        scene.environment.mapping = THREE.EquirectangularReflectionMapping;
        scene.background = scene.environment;
    }

    const camera = new THREE.PerspectiveCamera(58, aspect, 0.1, 60);
    camera.position.set(4.6, 1.7, 3.1);
    camera.lookAt(-1.2, 1.5, -0.7);

    walls(scene);
    if (isClosed) {
        const shutter = mesh(new THREE.BoxGeometry(10, 2.4, 0.2), { color: WHITE });
        shutter.position.set(0, 2.2, -3.8);
        scene.add(shutter);
    }
    const lamp = new THREE.PointLight(0xffc58a, 14);
    lamp.castShadow = true;
    lamp.shadow.mapSize.set(shadows, shadows);
    lamp.shadow.normalBias = 0.02;
    const bulb = mesh(new THREE.SphereGeometry(0.07, 24, 16), { color: 0x000000, emissive: 0xffc58a, emissiveIntensity: 60 }, { casts: false });
    // The lamp already gives the bulb's light.
    bulb.userData.gi = false;
    lamp.add(bulb);

    const box = mesh(new THREE.BoxGeometry(0.9, 0.9, 0.9), { color: 0xc23b22, roughness: 0.6 });
    const knot = mesh(new THREE.TorusKnotGeometry(0.42, 0.14, 160, 24), { color: 0xe8b04a, metalness: 1, roughness: 0.25 });
    knot.position.set(-2.4, 1.25, 0.7);
    const panel = mesh(new THREE.BoxGeometry(0.06, 0.5, 1.8), { color: 0x101010, emissive: 0x3f7bff, emissiveIntensity: 9 }, { casts: false });
    panel.position.set(-4.9, 2.1, 1.2);
    const { banner, bones } = createBanner();
    scene.add(lamp, box, knot, panel, banner);

    function animate(seconds) {
        lamp.position.set(-1.2 + 2.6 * Math.sin(0.5 * seconds), 2.2 + 0.3 * Math.sin(0.9 * seconds), -0.4 + 1.3 * Math.cos(0.5 * seconds));
        box.position.set(0.6 + 1.2 * Math.sin(0.7 * seconds), 0.45, -0.9);
        box.rotation.y = 0.4 * seconds;
        knot.rotation.set(0.6 * seconds, 0.8 * seconds, 0);
        for (const [at, bone] of bones.entries()) bone.rotation.x = at === 0 ? 0 : 0.22 * Math.sin(1.6 * seconds - 0.9 * at);
    }
    animate(0);
    if (isMatte) scene.traverse(({ material }) => material && makeMatte(material));
    return { scene, camera, animate, lamp, box, knot, banner };
}

/** Removes all but the diffuse reflection of a material. */
function makeMatte(material) {
    Object.assign(material, { metalness: 0, roughness: 1, specularIntensity: 0, clearcoat: 0 });
}

/** A mesh with a physical material. */
function mesh(geometry, material, { casts = true } = {}) {
    const made = new THREE.Mesh(geometry, new THREE.MeshPhysicalMaterial({ roughness: 0.9, ...material }));
    made.castShadow = casts;
    made.receiveShadow = true;
    return made;
}

/** Floor, roof, walls with windows to the sky, columns: 10 by 4 by 7 metres. */
function walls(scene) {
    const block = (size, place, material = {}) => {
        const made = mesh(new THREE.BoxGeometry(...size), { color: WHITE, ...material });
        made.position.set(...place);
        scene.add(made);
    };
    block([10.4, 0.2, 7.4], [0, -0.1, 0], { color: 0x4a4038, roughness: 0.18 });
    block([10.4, 0.2, 7.4], [0, 4.1, 0]);
    block([0.2, 4, 7.4], [-5.1, 2, 0], { color: 0x9c2f24 });
    block([0.2, 4, 7.4], [5.1, 2, 0], { color: 0x2f6b3a });
    block([10, 4, 0.2], [0, 2, 3.6]);
    // The wall with windows: below, above, and between them.
    block([10, 1, 0.2], [0, 0.5, -3.6]);
    block([10, 0.6, 0.2], [0, 3.7, -3.6]);
    for (let at = 0; at < 4; at += 1) block([at === 0 || at === 3 ? 0.8 : 1, 2.4, 0.2], [-4.6 + at * 3.067, 2.2, -3.6]);
    const column = new THREE.CylinderGeometry(0.24, 0.28, 4, 32);
    const columns = new THREE.InstancedMesh(column, new THREE.MeshPhysicalMaterial({ color: WHITE, roughness: 0.5, clearcoat: 0.4 }), 4);
    for (let at = 0; at < 4; at += 1) columns.setMatrixAt(at, new THREE.Matrix4().setPosition(-3.4 + 2.3 * at, 2, -2.2));
    columns.castShadow = columns.receiveShadow = true;
    scene.add(columns);
}

/** A cloth on four bones. */
function createBanner() {
    const [width, height, parts] = [1.1, 2.4, 24];
    const geometry = new THREE.PlaneGeometry(width, height, 4, parts);
    const position = geometry.attributes.position;
    const [joints, weights] = [[], []];
    for (let at = 0; at < position.count; at += 1) {
        const along = Math.min(Math.max(3 * (0.5 - position.getY(at) / height), 0), 3);
        const bone = Math.min(2, Math.floor(along));
        joints.push(bone, bone + 1, 0, 0);
        weights.push(1 - (along - bone), along - bone, 0, 0);
    }
    geometry.setAttribute("skinIndex", new THREE.Uint16BufferAttribute(joints, 4));
    geometry.setAttribute("skinWeight", new THREE.Float32BufferAttribute(weights, 4));
    const material = new THREE.MeshPhysicalMaterial({ color: 0x2d4fb5, roughness: 0.95, side: THREE.DoubleSide });
    const banner = new THREE.SkinnedMesh(geometry, material);
    const bones = Array.from({ length: 4 }, () => new THREE.Bone());
    bones[0].position.y = height / 2;
    for (let at = 1; at < 4; at += 1) {
        bones[at].position.y = -height / 3;
        bones[at - 1].add(bones[at]);
    }
    banner.add(bones[0]);
    banner.bind(new THREE.Skeleton(bones));
    banner.castShadow = banner.receiveShadow = true;
    banner.position.set(-1.1, 2.5, -2.6);
    return { banner, bones };
}

/** A sky with a sun, in thousands of cd/m²: bright around the sun, blue above, brown below. */
function sky() {
    const [width, height] = [256, 128];
    const data = new Float32Array(4 * width * height);
    const sun = new THREE.Vector3(0.45, 0.62, -0.64).normalize();
    const direction = new THREE.Vector3();
    const [above, level, below] = [[1.1, 2.2, 5.2], [4.2, 4.6, 5], [0.5, 0.45, 0.4]];
    for (let y = 0; y < height; y += 1) {
        for (let x = 0; x < width; x += 1) {
            // As three.js reads it: rows go up, and the middle is the direction +x.
            const around = ((x + 0.5) / width - 0.5) * 2 * Math.PI;
            const up = ((y + 0.5) / height - 0.5) * Math.PI;
            direction.set(Math.cos(around) * Math.cos(up), Math.sin(up), Math.sin(around) * Math.cos(up));
            const height01 = Math.max(direction.y, 0) ** 0.5;
            const glow = 6 * Math.exp(-12 * (1 - direction.dot(sun)));
            const disc = direction.dot(sun) > 0.9985 ? 4500 : 0;
            const at = 4 * (y * width + x);
            for (let channel = 0; channel < 3; channel += 1) {
                const clear = level[channel] + (above[channel] - level[channel]) * height01;
                data[at + channel] = direction.y < 0 ? below[channel] : clear + glow * [1, 0.9, 0.7][channel] + disc * [1, 0.93, 0.82][channel];
            }
            data[at + 3] = 1;
        }
    }
    const texture = new THREE.DataTexture(data, width, height, THREE.RGBAFormat, THREE.FloatType);
    texture.needsUpdate = true;
    return texture;
}
