// The class that a page uses: the light of one scene, frame by frame.

import { Box3, Matrix4, Vector2, Vector3 } from "three/webgpu";
import { context } from "three/tsl";
import { Environment } from "./environment.js";
import { failure } from "./failure.js";
import { GBuffer } from "./gbuffer.js";
import { lightRows } from "./lights.js";
import { LightNode, Outputs, ProbeNode } from "./nodes.js";
import { Draws } from "./draws.js";

/** Maximum frames until the first voxels are complete; each applies earlier read-backs. */
const FIRST_FRAMES = 16;
/**
 * Margin between the outermost surface and the end of the voxels, as a share of the scene's size.
 */
const MARGIN = 0.01;
const OWN = new Set(["scene", "camera", "bounds", "onProgress", "suns"]);

export class Gi {
    #renderer;
    #shared;
    #gbuffer = new GBuffer();
    #draws;
    #environment;
    #size = new Vector2();
    #clip = new Matrix4();
    #camera = new Float32Array(22);
    #notes = new Set();
    #isDisposed = false;
    /** The frame that has been updated, and whether anything since then asked for probes. */
    #frameId = -1;
    #hasProbes = false;
    #stats = { late: true, voxels: 0, faces: 0 };

    static async create(SharedGi, renderer, options) {
        const { scene, camera, onProgress = null } = options;
        scene.updateMatrixWorld();
        const bounds = options.bounds ?? boundsOf(scene);
        if (bounds.isEmpty()) throw failure("value", "the scene is empty, so that the voxels have no place; give options.bounds, a Box3 in metres");
        const corners = Float32Array.of(...bounds.min.toArray(), ...bounds.max.toArray());
        const chosen = Object.entries(options).filter(([name, value]) => !OWN.has(name) && value !== undefined && value !== null);
        chosen.push(["reversed", renderer.reversedDepthBuffer === true]);
        const [names, values] = [chosen.map(([name]) => name), chosen.map(([, value]) => String(value))];
        const shared = await SharedGi.adopt(renderer.backend.device, corners, names, values);
        const gi = new Gi(shared, renderer, scene, camera, bounds, options);
        try {
            gi.#resize();
            if (hasLater(scene)) gi.probes();
            await shared.compile(onProgress);
            await gi.#environment.update();
            await gi.#begin();
        } catch (error) {
            gi.dispose();
            throw error;
        }
        return gi;
    }

    constructor(shared, renderer, scene, camera, bounds, { suns = true }) {
        this.scene = scene;
        this.camera = camera;
        this.bounds = bounds;
        this.#shared = shared;
        this.#renderer = renderer;
        this.outputs = new Outputs();
        const note = (text) => this.#notes.add(text);
        this.#draws = new Draws(shared, renderer, note);
        this.#environment = new Environment(shared, renderer, scene, suns ? bounds : null, note);
        this.note = note;
        const [light, probes] = [new LightNode(this), new ProbeNode(this)];
        /** For `pass.contextNode`: gives all materials of a pass our light. */
        this.context = context({
            getGI: (given, { material }) => {
                const own = isLater(material) ? probes : light;
                return given === null ? own : own.add(given);
            },
        });
    }

    /** Texture nodes: irradiance (alpha: open share of the hemisphere), and reflected radiance. */
    get irradiance() {
        return this.outputs.irradiance;
    }

    get reflection() {
        return this.outputs.reflection;
    }

    /** Messages about parts of the scene that are ignored or approximated. */
    get notes() {
        return [...this.#notes];
    }

    /** Whether the last frame's voxels are older than its scene; numbers of voxels and faces. */
    get stats() {
        return this.#stats;
    }

    /** Bytes on the GPU. */
    get memory() {
        return this.#shared.memory() + this.#gbuffer.memory;
    }

    /** Changes a setting of the cones. */
    set(name, value) {
        this.#shared.setOption(name, String(value));
    }

    /** Forgets the light of earlier frames: for a cut. */
    cut() {
        this.#shared.cut();
    }

    /** Computes the light of a frame. The nodes call it once a frame. */
    update() {
        const [renderer, shared] = [this.#renderer, this.#shared];
        if (this.#isDisposed || !this.#resize()) return;
        this.#gbuffer.render(renderer, this.scene, this.camera);
        this.#environment.watch();
        this.#draws.update(this.scene);
        shared.setLights(lightRows(this.scene, this.note));
        const [late, voxels, faces] = shared.render(this.#cameraRow(), this.#environment.row(), this.#hasProbes);
        this.#hasProbes = false;
        // Counts are 0 while the list of voxels is being replaced; keep the last ones.
        const { voxels: lastVoxels, faces: lastFaces } = this.#stats;
        this.#stats = { late: late === 1, voxels: voxels || lastVoxels, faces: faces || lastFaces };
    }

    /** Updates once in a frame of three.js. Errors are noted: an exception would interrupt three.js
     * in the page's pass. */
    updateFor({ frameId }, hasProbes = false) {
        this.#hasProbes ||= hasProbes;
        if (frameId === this.#frameId) return;
        this.#frameId = frameId;
        try {
            this.update();
        } catch (error) {
            this.#noteError(`a frame has no new light: ${error.message}`, error);
        }
    }

    /** The light in the air, for `ProbeNode`; null after `dispose` if there was none before, and
     * after an error, which is noted. */
    probes() {
        if (this.outputs.probes === null && !this.#isDisposed) {
            try {
                this.outputs.setProbes(this.#shared.probes());
            } catch (error) {
                this.#noteError(`transparent materials have no indirect light: ${error.message}`, error);
            }
        }
        return this.outputs.probes;
    }

    /** Frees all memory on the GPU. Materials are then without its light. */
    dispose() {
        if (this.#isDisposed) return;
        this.#isDisposed = true;
        this.#environment.dispose();
        this.#draws.dispose();
        this.#gbuffer.dispose();
        this.outputs.dispose();
        this.#shared.free();
    }

    #noteError(text, error) {
        if (!this.notes.includes(text)) console.error(error);
        this.note(text);
    }

    /** Makes the first voxels, then lights all probes: no frame is shown without them. */
    async #begin() {
        const { queue } = this.#renderer.backend.device;
        for (let frame = 0; frame < FIRST_FRAMES && this.#stats.late; frame += 1) {
            this.update();
            await queue.onSubmittedWorkDone();
        }
        if (this.outputs.probes !== null) {
            while (!this.#shared.lightProbes()) await queue.onSubmittedWorkDone();
        }
        this.cut();
    }

    /** Adapts textures to the size of the picture; `false` if the picture is empty. */
    #resize() {
        const { x, y } = this.#renderer.getDrawingBufferSize(this.#size);
        if (!(x >= 1 && y >= 1)) return false;
        if (this.#gbuffer.setSize(this.#renderer, x, y)) {
            this.outputs.set(this.#shared.setScreen(x, y, this.#gbuffer.textures(this.#renderer)));
        }
        return true;
    }

    #cameraRow() {
        const { camera } = this;
        const { view } = camera;
        const row = this.#camera;
        const clip = this.#clip.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
        // TRAANode and similar nodes jitter the picture within a pixel; the matrix excludes the
        // jitter.
        const isShifted = view?.enabled === true && view.width === view.fullWidth;
        const [x, y] = isShifted ? [-view.offsetX, -view.offsetY] : [0, 0];
        if (isShifted) clip.premultiply(new Matrix4().makeTranslation((-2 * x) / view.width, (2 * y) / view.height, 0));
        clip.toArray(row, 0);
        new Vector3().setFromMatrixPosition(camera.matrixWorld).toArray(row, 16);
        [row[19], row[20]] = [x, y];
        row[21] = this.#renderer.reversedDepthBuffer === true ? 1 : 0;
        return row;
    }
}

/** Whether a material is outside the G-buffer: three.js draws it after opaque ones. */
const isLater = (material) => material.transparent === true || material.transmission > 0 || Boolean(material.transmissionNode || material.backdropNode);

function hasLater(scene) {
    let is = false;
    scene.traverseVisible(({ material }) => {
        is ||= [material ?? []].flat().some((each) => each && isLater(each));
    });
    return is;
}

/** The bounds of the lit volume: all meshes, and a margin. */
function boundsOf(scene) {
    const [bounds, own] = [new Box3(), new Box3()];
    scene.traverseVisible((object) => {
        if (!object.isMesh || object.userData.gi === false || object.geometry?.attributes.position === undefined) return;
        // Skinned and instanced meshes have their own box.
        const owner = object.computeBoundingBox ? object : object.geometry;
        owner.computeBoundingBox();
        bounds.union(own.copy(owner.boundingBox).applyMatrix4(object.matrixWorld));
    });
    const size = bounds.getSize(new Vector3());
    return bounds.isEmpty() ? bounds : bounds.expandByScalar(MARGIN * Math.max(size.x, size.y, size.z));
}
