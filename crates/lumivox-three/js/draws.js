// The draws of a scene: meshes with their matrices, and whether they have ever moved.

import { Matrix4 } from "three/webgpu";
import { Geometries } from "./geometries.js";
import { Materials, hasSurface, isTurned } from "./materials.js";

const instance = new Matrix4();
const placed = new Matrix4();

export class Draws {
    #shared;
    #geometries;
    #materials;
    #note;
    /** By object: its last matrix, the last frame in which it was seen, and whether it moves. */
    #objects = new WeakMap();
    #frame = 0;
    #rows = [];
    #matrices = [];

    constructor(shared, renderer, note) {
        this.#shared = shared;
        this.#note = note;
        this.#geometries = new Geometries(shared, renderer, note);
        this.#materials = new Materials(shared, renderer, note);
    }

    /** Collects the scene's present draws and passes them to the library. */
    update(scene) {
        this.#frame += 1;
        this.#rows.length = 0;
        this.#matrices.length = 0;
        scene.traverseVisible((object) => {
            if (object.isMesh === true && object.userData.gi !== false) this.#look(object);
        });
        this.#geometries.submit();
        this.#shared.setDraws(Uint32Array.from(this.#rows), Float32Array.from(this.#matrices));
        this.#geometries.sweep(this.#frame);
        this.#materials.sweep(this.#frame);
    }

    #look(object) {
        const { geometry, material } = object;
        if (object.isBatchedMesh) {
            this.#note("BatchedMesh is not taken; use InstancedMesh, or meshes");
            return;
        }
        const position = geometry?.attributes.position;
        if (position === undefined) return;
        if (geometry.isInstancedBufferGeometry === true) {
            this.#note("InstancedBufferGeometry is not taken; use InstancedMesh");
            return;
        }
        if (position.itemSize < 3) {
            this.#note(`positions of ${position.itemSize} numbers are not taken`);
            return;
        }
        const materials = Array.isArray(material) ? material : [material];
        const states = materials.map((each) => each && this.#materials.of(each, this.#frame));
        const known = this.#known(object);
        // As in three.js, only the mesh's own matrix counts, not those of instances.
        const isMirrored = object.matrixWorld.determinant() < 0;
        for (const { group, start, count } of parts(object, materials)) {
            const own = materials[group];
            if (!own || !hasSurface(own) || count < 3) continue;
            const mesh = this.#geometries.of(object, [isTurned(own) !== isMirrored, own.vertexColors === true], this.#frame);
            known.moves ||= mesh.changes || states[group].changes;
            const row = [mesh.id, start, count, states[group].index, known.moves ? 0 : 1];
            if (object.isInstancedMesh) this.#instances(object, row);
            else this.#push(row, object.matrixWorld);
        }
    }

    #instances(object, row) {
        if (object.instanceColor !== null) this.#note("colours of instances are not taken: their material's stands for all");
        for (let at = 0; at < object.count; at += 1) {
            object.getMatrixAt(at, instance);
            this.#push(row, placed.multiplyMatrices(object.matrixWorld, instance));
        }
    }

    #push(row, matrix) {
        this.#rows.push(...row);
        this.#matrices.push(...matrix.elements);
    }

    /**
     * An object's state in this frame. An object that has moved once stays dynamic: making it
     * static again would cost more than it saves.
     */
    #known(object) {
        const frame = this.#frame;
        let known = this.#objects.get(object);
        if (known === undefined) {
            const moves = object.isSkinnedMesh === true || object.morphTargetInfluences !== undefined;
            known = { moves, frame, matrix: object.matrixWorld.clone(), instances: object.instanceMatrix?.version };
            this.#objects.set(object, known);
            return known;
        }
        const isGone = known.frame !== frame - 1;
        const isInstanced = known.instances !== object.instanceMatrix?.version;
        if (isGone || isInstanced || !known.matrix.equals(object.matrixWorld)) known.moves = true;
        known.frame = frame;
        known.matrix.copy(object.matrixWorld);
        known.instances = object.instanceMatrix?.version;
        return known;
    }

    dispose() {
        this.#geometries.dispose();
    }
}

/** Runs of indices with the number of their material. */
function parts({ geometry, material }, materials) {
    const all = geometry.index ? geometry.index.count : geometry.attributes.position.count;
    const first = geometry.drawRange.start;
    const last = Math.min(all, first + geometry.drawRange.count);
    const whole = (start, end) => ({ start, count: Math.max(0, 3 * Math.floor((end - start) / 3)) });
    if (!Array.isArray(material)) return [{ group: 0, ...whole(first, last) }];
    return geometry.groups
        .filter((group) => materials[group.materialIndex])
        .map((group) => ({ group: group.materialIndex, ...whole(Math.max(first, group.start), Math.min(last, group.start + group.count)) }));
}
