// Materials of three.js as rows of numbers and textures (`src/input.rs`).

import { BackSide, DoubleSide, MirroredRepeatWrapping, RepeatWrapping } from "three/webgpu";

/** Reflectance at normal incidence of an index of refraction of 1.5. */
const DIELECTRIC = 0.04;
const NO_TEXTURE = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
/** Frames after which a material that is not drawn is forgotten. */
const KEPT_FRAMES = 120;

/** The materials that draws refer to, by number. */
export class Materials {
    #shared;
    #renderer;
    #note;
    #known = new Map();
    /** Numbers of forgotten materials, to be used again. */
    #free = [];

    constructor(shared, renderer, note) {
        this.#shared = shared;
        this.#renderer = renderer;
        this.#note = note;
    }

    /** A material's number, and whether it has ever changed. Each material is read once a frame. */
    of(material, frame) {
        let state = this.#known.get(material);
        if (state === undefined) {
            state = { index: this.#free.pop() ?? this.#known.size, frame: -1, row: null, textures: [], versions: [], places: null, changes: false };
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
        const versions = images.map((image) => image?.version ?? 0);
        const textures = images.map((image, at) => this.#texture(image, versions[at] !== state.versions[at]));
        const places = images.flatMap((image, at) => (textures[at] ? placeOf(image) : NO_TEXTURE));
        const isSame = (a, b) => a.length === b.length && a.every((value, at) => value === b[at]);
        const isNew = state.row === null;
        // `true` if an image was redrawn in place. The first load of an image is not an edit.
        const isDrawn = textures.some((texture, at) => texture !== null && texture === state.textures[at] && versions[at] !== state.versions[at]);
        state.versions = versions;
        state.changes ||= isDrawn || images.some((image) => image?.isRenderTargetTexture === true);
        if (!isNew && isSame(row, state.row) && isSame(places, state.places) && isSame(textures, state.textures)) return;
        state.changes ||= !isNew && !isSame(row, state.row);
        Object.assign(state, { row, places, textures });
        const set = (textures) => this.#shared.setMaterial(state.index, Float32Array.from(row), textures, Float32Array.from(places));
        try {
            set(textures);
        } catch (error) {
            if (textures.every((texture) => texture === null)) throw error;
            this.#note(`the images of a material are not taken: ${error.message}`);
            set(textures.map(() => null));
        }
    }

    /** Forgets materials that are no longer drawn, or their emission would still count. */
    sweep(frame) {
        for (const [material, state] of this.#known) {
            if (frame - state.frame < KEPT_FRAMES) continue;
            this.#known.delete(material);
            this.#free.push(state.index);
            if (state.row === null) continue;
            const nothing = state.textures.map(() => null);
            this.#shared.setMaterial(state.index, new Float32Array(state.row.length), nothing, Float32Array.from(nothing.flatMap(() => NO_TEXTURE)));
        }
    }

    /** The `GPUTexture` of an image, or null. */
    #texture(image, isOther) {
        if (!image?.isTexture) return null;
        const { backend } = this.#renderer;
        // three.js creates the texture when it draws into the render target.
        if (image.isRenderTargetTexture === true) return backend.get(image).texture ?? null;
        if (image.version === 0) return null;
        if (image.isVideoTexture || image.isCubeTexture || image.isDataArrayTexture || image.isData3DTexture) {
            this.#note(`an image that is a ${image.constructor.name} is not taken; its material's colour stands for it`);
            return null;
        }
        if (isOther || backend.get(image).texture === undefined) this.#renderer.initTexture(image);
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
    if (isUnlit && material.vertexColors) note("colours of vertices do not count in what a MeshBasicMaterial shines with");
    if (material.alphaMap) note("an alphaMap is not taken; use the alpha of map");
    if (material.displacementMap) note("a displacementMap is not taken: surfaces stay where their geometry is");
    if (material.envMap) note("a material's own envMap is seen on it as three.js draws it; cones see scene.environment");
    const isSparse = transparent || material.alphaHash === true;
    const isCovering = material.alphaTest > 0 || isSparse;
    const { ior = 1.5, specularIntensity = 1, transmission = 0 } = material;
    const normal = ((ior - 1) / (ior + 1)) ** 2;
    const f0 = isPhysical ? Math.min(1, (material.isMeshPhysicalMaterial ? normal : DIELECTRIC) * specularIntensity) : 0;
    const reflectance = isUnlit ? [0, 0, 0] : rgb(color ?? { r: 1, g: 1, b: 1 });
    const emission = isUnlit ? rgb(color) : rgb(emissive, material.emissiveIntensity ?? 1);
    const row = [
        ...reflectance.map((channel) => Math.min(Math.max(channel, 0), 1)), isSparse ? opacity : 1,
        f0, roughness, 1 - metalness,
        ...emission.map((channel) => Math.max(channel, 0)), transmission,
        isCovering ? 1 : 0, material.side === DoubleSide ? 1 : 0, 0,
    ].map(Math.fround);
    const map = material.map ?? null;
    return { row, images: isUnlit ? [isCovering ? map : null, map, null] : [map, material.emissiveMap ?? null, material.transmissionMap ?? null] };
}

/** Whether a material has a surface that light can hit. */
export const hasSurface = (material) =>
    material.visible !== false && material.colorWrite !== false && material.wireframe !== true && material.isShadowMaterial !== true && material.isShadowNodeMaterial !== true;

/** Whether a material is only visible from the back of its triangles. */
export const isTurned = (material) => material.side === BackSide;

function placeOf(image) {
    const wrap = (mode) => (mode === RepeatWrapping ? 1 : mode === MirroredRepeatWrapping ? 2 : 0);
    if (image.matrixAutoUpdate) image.updateMatrix();
    return [Math.min(image.channel, 1), wrap(image.wrapS), wrap(image.wrapT), ...image.matrix.elements].map(Math.fround);
}
