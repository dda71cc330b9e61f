// Materials of three.js as rows of numbers and textures (`src/input.rs`).

import { BackSide, DoubleSide, MirroredRepeatWrapping, RepeatWrapping } from "three/webgpu";

/** Reflectance at normal incidence of an index of refraction of 1.5. */
const DIELECTRIC = 0.04;
const NO_TEXTURE = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];

/** The materials that draws refer to, by number. */
export class Materials {
    #shared;
    #renderer;
    #note;
    #known = new Map();

    constructor(shared, renderer, note) {
        this.#shared = shared;
        this.#renderer = renderer;
        this.#note = note;
    }

    /** A material's state: its number, and whether it has ever changed. Looks at each material once a frame. */
    of(material, frame) {
        let state = this.#known.get(material);
        if (state === undefined) {
            state = { index: this.#known.size, frame: -1, row: null, textures: [], places: null, changes: false };
            this.#known.set(material, state);
        }
        if (state.frame !== frame) {
            state.frame = frame;
            this.#look(material, state);
        }
        return state;
    }

    #look(material, state) {
        const { row, images } = describe(material, this.#note);
        const textures = images.map((image) => this.#texture(image));
        const places = images.flatMap((image, at) => (textures[at] ? placeOf(image) : NO_TEXTURE));
        const isSame = (a, b) => a.length === b.length && a.every((value, at) => value === b[at]);
        const isNew = state.row === null;
        if (!isNew && isSame(row, state.row) && isSame(places, state.places) && isSame(textures, state.textures)) return;
        // An image that has come at last is no change of the page's.
        state.changes ||= !isNew && !isSame(row, state.row);
        Object.assign(state, { row, places, textures });
        this.#shared.setMaterial(state.index, Float32Array.from(row), textures, Float32Array.from(places));
    }

    /** The `GPUTexture` of an image, or null. */
    #texture(image) {
        if (!image?.isTexture || image.version === 0) return null;
        if (image.isVideoTexture || image.isCubeTexture || image.isDataArrayTexture || image.isData3DTexture) {
            this.#note(`an image that is a ${image.constructor.name} is not taken; its material's colour stands for it`);
            return null;
        }
        const { backend } = this.#renderer;
        if (backend.get(image).texture === undefined) this.#renderer.initTexture(image);
        const { texture } = backend.get(image);
        if (texture && /32float/.test(texture.format)) {
            this.#note("an image of 32-bit floats is not taken; use half floats");
            return null;
        }
        return texture ?? null;
    }
}

/** The numbers of a material, and its images: of reflectance, emission and transmission. */
function describe(material, note) {
    const { color, emissive, opacity = 1, transparent = false, metalness = 0, roughness = 1 } = material;
    if (material.colorNode || material.emissiveNode || material.positionNode) {
        note("materials with nodes of their own are taken by color, map, emissive and emissiveMap alone");
    }
    const isUnlit = material.isMeshBasicMaterial === true || material.isMeshBasicNodeMaterial === true;
    const isPhysical = material.isMeshStandardMaterial === true || material.isMeshStandardNodeMaterial === true;
    const rgb = (of, by = 1) => (of ? [of.r * by, of.g * by, of.b * by] : [0, 0, 0]);
    const isCovering = material.alphaTest > 0 || transparent;
    const { ior = 1.5, specularIntensity = 1, transmission = 0 } = material;
    const normal = ((ior - 1) / (ior + 1)) ** 2;
    const f0 = isPhysical ? Math.min(1, (material.isMeshPhysicalMaterial ? normal : DIELECTRIC) * specularIntensity) : 0;
    const reflectance = isUnlit ? [0, 0, 0] : rgb(color ?? { r: 1, g: 1, b: 1 });
    const emission = isUnlit ? rgb(color) : rgb(emissive, material.emissiveIntensity ?? 1);
    const row = [
        ...reflectance.map((channel) => Math.min(channel, 1)), transparent ? opacity : 1,
        f0, roughness, 1 - metalness,
        ...emission, transmission,
        isCovering ? 1 : 0, material.side === DoubleSide ? 1 : 0, 0,
    ].map(Math.fround);
    const map = material.map ?? null;
    return { row, images: isUnlit ? [isCovering ? map : null, map, null] : [map, material.emissiveMap ?? null, material.transmissionMap ?? null] };
}

/** Whether a material is seen from the other side of its triangles. */
export const isTurned = (material) => material.side === BackSide;

function placeOf(image) {
    const wrap = (mode) => (mode === RepeatWrapping ? 1 : mode === MirroredRepeatWrapping ? 2 : 0);
    if (image.matrixAutoUpdate) image.updateMatrix();
    return [Math.min(image.channel, 1), wrap(image.wrapS), wrap(image.wrapT), ...image.matrix.elements].map(Math.fround);
}
