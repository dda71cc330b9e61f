// Geometries of three.js in buffers that Lumivox reads. Positions are copied on the GPU if three.js
// has uploaded them.

import { Skins } from "./skins.js";

/** Bytes of two texture coordinates, and of a colour of four 16-bit numbers. */
const [TEXCOORD, COLOR] = [8, 8];
/** Frames after which a geometry that is not drawn is freed. */
const KEPT_FRAMES = 120;

export class Geometries {
    #shared;
    #renderer;
    #note;
    #skins;
    /**
     * Buffers by object if it deforms its geometry, else by geometry; then by side and use of
     * colours.
     */
    #known = new Map();
    #next = 0;
    #encoder = null;

    constructor(shared, renderer, note) {
        this.#shared = shared;
        this.#renderer = renderer;
        this.#note = note;
        this.#skins = new Skins(renderer.backend.device);
    }

    /** The buffers of an object's triangles, updated for this frame. */
    of(object, [isTurned, hasColors], frame) {
        const { geometry } = object;
        const isSkinned = object.isSkinnedMesh === true && object.skeleton !== undefined && geometry.attributes.skinIndex !== undefined;
        const isMorphed = object.morphTargetInfluences?.length > 0 && geometry.morphAttributes.position !== undefined;
        const owner = isSkinned || isMorphed ? object : geometry;
        let sides = this.#known.get(owner);
        if (sides === undefined) this.#known.set(owner, (sides = [null, null, null, null]));
        const side = (isTurned ? 1 : 0) + (hasColors ? 2 : 0);
        const layout = layoutOf(geometry, isSkinned || isMorphed, hasColors);
        let mesh = sides[side];
        if (mesh === null || mesh.key !== layout.key || mesh.geometry !== geometry) {
            if (mesh !== null) this.#free(mesh);
            mesh = sides[side] = this.#make(geometry, layout, isTurned, isSkinned);
        }
        if (mesh.frame === frame) return mesh;
        mesh.frame = frame;
        mesh.changes ||= this.#fill(mesh, object, isMorphed) && mesh.isFilled;
        mesh.isFilled = true;
        if (isSkinned) this.#skins.run(this.#commands(), mesh, object);
        return mesh;
    }

    #make(geometry, layout, isTurned, isSkinned) {
        const { count, stride, offset, attributes, indices, isShort } = layout;
        const id = this.#next++;
        const positionBytes = Math.max(12, layout.isShared ? layout.array.byteLength : count * stride);
        const [positions, others, numbers] = this.#shared.mesh(id, Uint32Array.of(
            positionBytes, stride, offset, attributes.stride * count, attributes.stride,
            attributes.uv + 1, attributes.uv1 + 1, attributes.color + 1, indices * (isShort ? 2 : 4), isShort ? 2 : 4,
        ));
        return {
            id, geometry, key: layout.key, layout, isTurned, positions, others, numbers, frame: -1, isFilled: false, changes: false,
            versions: {}, skin: isSkinned ? this.#skins.make(geometry, positions, count) : null, influences: null,
        };
    }

    /** Copies the attributes that have changed; `true` if any has. */
    #fill(mesh, object, isMorphed) {
        const { geometry, layout, versions } = mesh;
        const { position, uv, uv1, color } = geometry.attributes;
        let hasChanged = false;
        const isOther = (name, version) => {
            if (versions[name] === version) return false;
            versions[name] = version;
            return (hasChanged = true);
        };
        const isMoved = isOther("position", stampOf(position));
        if (isMorphed) {
            const influences = [...object.morphTargetInfluences];
            if (isMoved || influences.some((value, at) => value !== mesh.influences?.[at])) {
                mesh.influences = influences;
                hasChanged = true;
                this.#write(mesh.skin?.rest ?? mesh.positions, morphed(object));
            }
        } else if (isMoved || object.userData.gi === "deforms") {
            hasChanged = true;
            this.#copyPositions(mesh, position);
        }
        const others = layout.attributes;
        if (others.stride > 0 && isOther("others", [uv, uv1, color].map(stampOf).join())) {
            this.#write(mesh.others, interleaved(geometry, others, layout.count));
        }
        if (isOther("index", geometry.index ? stampOf(geometry.index) : 0)) {
            this.#write(mesh.numbers, indicesOf(geometry, layout, mesh.isTurned));
        }
        return hasChanged;
    }

    #copyPositions({ positions, layout, skin }, attribute) {
        const { backend } = this.#renderer;
        const shared = attribute.isInterleavedBufferAttribute ? attribute.data : attribute;
        const { buffer } = backend.get(shared);
        // Positions come from the CPU if three.js has not uploaded their last version, as for
        // objects that it has not drawn.
        const isThere = buffer !== undefined && this.#renderer._attributes?.get(attribute)?.version === versionOf(attribute);
        const target = skin?.rest ?? positions;
        if (isThere && layout.isShared) {
            this.#commands().copyBufferToBuffer(buffer, 0, target, 0, Math.min(buffer.size, target.size));
        } else if (layout.isShared) {
            this.#write(target, shared.array);
        } else {
            this.#write(target, floats(attribute, 3));
        }
    }

    #write(buffer, array) {
        const { byteOffset, byteLength } = array;
        const rest = byteLength % 4;
        this.#renderer.backend.device.queue.writeBuffer(buffer, 0, array.buffer, byteOffset, byteLength - rest);
        if (rest === 0) return;
        const last = new Uint8Array(4);
        last.set(new Uint8Array(array.buffer, byteOffset + byteLength - rest, rest));
        this.#renderer.backend.device.queue.writeBuffer(buffer, byteLength - rest, last);
    }

    #commands() {
        return (this.#encoder ??= this.#renderer.backend.device.createCommandEncoder());
    }

    /** Submits the commands recorded since the last call. */
    submit() {
        if (this.#encoder !== null) this.#renderer.backend.device.queue.submit([this.#encoder.finish()]);
        this.#encoder = null;
    }

    /** Frees geometries that have not been drawn for `KEPT_FRAMES` frames. */
    sweep(frame) {
        for (const [owner, sides] of this.#known) {
            sides.forEach((mesh, side) => {
                if (mesh === null || frame - mesh.frame < KEPT_FRAMES) return;
                this.#free(mesh);
                sides[side] = null;
            });
            if (sides.every((mesh) => mesh === null)) this.#known.delete(owner);
        }
    }

    #free(mesh) {
        mesh.skin?.dispose();
        this.#shared.removeMesh(mesh.id);
    }

    dispose() {
        for (const sides of this.#known.values()) for (const mesh of sides) if (mesh !== null) this.#free(mesh);
        this.#known.clear();
    }
}

const versionOf = (attribute) => (attribute?.isInterleavedBufferAttribute ? attribute.data.version : (attribute?.version ?? -1));

const numbers = new WeakMap();
let lastNumber = 0;

/** A text that identifies an attribute and its version. */
function stampOf(attribute) {
    if (attribute === undefined) return "";
    if (!numbers.has(attribute)) numbers.set(attribute, (lastNumber += 1));
    return `${numbers.get(attribute)}:${versionOf(attribute)}`;
}

/**
 * The layout of a geometry in buffers. Positions keep three.js's layout if they are floats and not
 * deformed; everything else is packed.
 */
function layoutOf(geometry, isDeformed, hasColors) {
    const { position, uv, uv1, color: given } = geometry.attributes;
    const color = hasColors ? given : undefined;
    const isInterleaved = position.isInterleavedBufferAttribute === true;
    const array = isInterleaved ? position.data.array : position.array;
    const isShared = array instanceof Float32Array && !isDeformed;
    const width = isInterleaved ? position.data.stride : position.itemSize;
    const [stride, offset] = isShared ? [4 * width, isInterleaved ? 4 * position.offset : 0] : [12, 0];
    const attributes = { uv: -1, uv1: -1, color: -1, stride: 0 };
    for (const [name, given, bytes] of [["uv", uv, TEXCOORD], ["uv1", uv1, TEXCOORD], ["color", color, COLOR]]) {
        if (given === undefined) continue;
        attributes[name] = attributes.stride;
        attributes.stride += bytes;
    }
    const count = position.count;
    const indices = geometry.index ? geometry.index.count : count;
    const isShort = count <= 0xffff;
    const key = [count, stride, offset, isShared ? array.byteLength : 0, indices, attributes.uv, attributes.uv1, attributes.color].join();
    return { key, array, isShared, stride, offset, count, indices, isShort, attributes };
}

/** Components of an attribute as floats, whatever their type. */
export function floats(attribute, size) {
    const { count } = attribute;
    const all = new Float32Array(size * count);
    for (let at = 0; at < count; at += 1) for (let axis = 0; axis < size; axis += 1) all[size * at + axis] = attribute.getComponent(at, axis);
    return all;
}

function interleaved(geometry, { uv, uv1, color, stride }, count) {
    const bytes = new DataView(new ArrayBuffer(stride * count));
    const texcoords = [[uv, geometry.attributes.uv], [uv1, geometry.attributes.uv1]];
    for (const [offset, attribute] of texcoords) {
        if (offset < 0) continue;
        for (let at = 0; at < Math.min(count, attribute.count); at += 1) {
            bytes.setFloat32(at * stride + offset, attribute.getX(at), true);
            bytes.setFloat32(at * stride + offset + 4, attribute.getY(at), true);
        }
    }
    if (color >= 0) {
        const given = geometry.attributes.color;
        for (let at = 0; at < Math.min(count, given.count); at += 1) {
            for (let channel = 0; channel < 4; channel += 1) {
                const value = channel < given.itemSize ? given.getComponent(at, channel) : 1;
                bytes.setUint16(at * stride + color + 2 * channel, Math.round(65535 * Math.min(Math.max(value, 0), 1)), true);
            }
        }
    }
    return new Uint8Array(bytes.buffer);
}

/** Indices of triangles, with reversed winding if `isTurned`. */
function indicesOf(geometry, { indices, isShort }, isTurned) {
    const all = isShort ? new Uint16Array(indices) : new Uint32Array(indices);
    for (let at = 0; at < indices; at += 1) all[at] = geometry.index ? geometry.index.getX(at) : at;
    if (isTurned) for (let at = 0; at + 2 < indices; at += 3) [all[at + 1], all[at + 2]] = [all[at + 2], all[at + 1]];
    return all;
}

/** Positions with their morph targets, blended on the CPU. */
function morphed({ geometry, morphTargetInfluences }) {
    const base = floats(geometry.attributes.position, 3);
    const result = base.slice();
    geometry.morphAttributes.position.forEach((target, which) => {
        const influence = morphTargetInfluences[which] ?? 0;
        if (influence === 0) return;
        const moved = floats(target, 3);
        for (let at = 0; at < result.length; at += 1) result[at] += influence * (moved[at] - (geometry.morphTargetsRelative ? 0 : base[at]));
    });
    return result;
}
