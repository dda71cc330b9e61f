// @ts-check
// The worker owns the renderer and its canvas, so that reading, compiling and tracing never block
// the page. It renders until the picture is complete, then sleeps until something changes. All of
// the page's uses of the package's API are here.

import init, { builtinScenes, createRenderer, lightKinds, parameters, presets } from "./lumivox/lumivox.js";

/** @typedef {import("./lumivox/lumivox.js").Renderer} Renderer */
/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").EnvironmentChange} EnvironmentChange */
/** @typedef {import("./types.js").Failure} Failure */
/** @typedef {import("./types.js").Light} Light */
/** @typedef {import("./types.js").MaterialChange} MaterialChange */
/** @typedef {import("./types.js").Memory} Memory */
/** @typedef {import("./types.js").Opened} Opened */
/** @typedef {import("./types.js").Progress} Progress */
/** @typedef {import("./types.js").Ran} Ran */
/** @typedef {import("./types.js").SceneInfo} SceneInfo */
/** @typedef {import("./types.js").SceneOptions} SceneOptions */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Source} Source */
/** @typedef {import("./types.js").Split} Split */
/** @typedef {import("./types.js").Stepped} Stepped */
/** @typedef {(progress: Progress) => void} OnProgress */

/** The time within which a lost device reports itself after a failed frame, ms. */
const LOSS_MS = 250;
/** The longest wait for an animation frame, ms; then a picture is rendered anyway. */
const UNASKED_MS = 500;
/** Losses in a row, without a frame in between, that are restored automatically. */
const LOSSES = 3;

/** @type {Renderer} */
let renderer;
let number = 0;
let isReady = false;
let isComplete = false;
let isLost = false;
let losses = 0;
/** The next frame's camera, if it moved. @type {{ camera: Camera, isMoving: boolean } | null} */
let place = null;
/** Cancels what is being loaded. */
let loading = new AbortController();

/** @param {string} event @param {unknown} data */
const tell = (event, data) => self.postMessage({ event, data });

// --- Frames --------------------------------------------------------------------------------------

/** Wakes the loop, if it sleeps. */
let wake = () => {};

function changed() {
    isComplete = false;
    wake();
}

/** Waits for the next animation frame, at most UNASKED_MS: hidden pages get few, and Chromium gives
 * none after a crash of its GPU process, though it still shows pictures. */
const nextPicture = () => new Promise((resolve) => {
    if (typeof requestAnimationFrame === "function") requestAnimationFrame(resolve);
    setTimeout(resolve, typeof requestAnimationFrame === "function" ? UNASKED_MS : 0);
});

async function frames() {
    for (;;) {
        if (!isReady || isLost || isComplete) {
            await new Promise((/** @type {(value?: undefined) => void} */ resolve) => (wake = resolve));
            wake = () => {};
            continue;
        }
        try {
            // Changes from here on set it to false.
            isComplete = true;
            const asked = place;
            place = null;
            if (asked) await renderer.setCamera(asked.camera, asked.isMoving);
            const report = await renderer.render();
            isComplete = isComplete && report.complete;
            losses = 0;
            // A camera moved since the frame began takes precedence.
            tell("frame", { ...report, camera: place ? undefined : report.camera, complete: isComplete });
        } catch (error) {
            isComplete = true;
            // A lost device fails the frame before it reports the loss.
            await new Promise((resolve) => setTimeout(resolve, LOSS_MS));
            if (!isLost) tell("error", failure(error));
        }
        await nextPicture();
    }
}

// --- A lost device -------------------------------------------------------------------------------

/** Waits for the loss of the present device. */
const listen = () => void renderer.lost().then(lost);

/** @param {string} reason */
async function lost(reason) {
    if (isLost) return;
    isLost = true;
    losses += 1;
    tell("lost", reason);
    if (losses <= LOSSES) await restore().catch((error) => tell("error", failure(error)));
    else tell("error", { message: `The graphics device was lost ${losses} times: ${reason}`, code: "lost", fatal: false });
}

async function restore() {
    await renderer.restore();
    listen();
    isLost = false;
    tell("restored", null);
    changed();
}

// --- Calls ---------------------------------------------------------------------------------------

/** @param {Source} source @returns {string | File | File[]} */
function sourceFor(source) {
    if (typeof source === "string") return source;
    const files = source.map(({ file, path }) => {
        // Some browsers do not send the path to workers.
        Object.defineProperty(file, "webkitRelativePath", { value: path, configurable: true });
        return file;
    });
    return files.length === 1 ? files[0] : files;
}

/** Cancels the last load; returns the signal of the next. */
function another() {
    loading.abort();
    loading = new AbortController();
    return loading.signal;
}

/** Everything that a change may affect. */
const everything = async () => {
    const scene = /** @type {SceneInfo} */ (await renderer.scene());
    return { scene, materials: scene ? await renderer.materials() : [], settings: await renderer.settings() };
};

/** Undoes or redoes a step; returns everything that it may affect.
 * @param {"undo" | "redo"} way @returns {Promise<Stepped>} */
async function step(way) {
    const words = await renderer[way]();
    return { words, ...(await everything()) };
}

const outcome = async () => ({ settings: await renderer.settings(), voxels: (await renderer.scene())?.voxels });

const calls = {
    /** The page may have compiled the package already.
     * @param {{ canvas: OffscreenCanvas, module?: WebAssembly.Module }} data */
    async start({ canvas, module }) {
        await init(module && { module_or_path: module });
        renderer = await createRenderer(canvas);
        // For the browser's developer tools.
        Object.assign(self, { renderer });
        listen();
        void frames();
        const settings = await renderer.settings();
        return { scenes: builtinScenes(), presets: presets(), parameters: parameters(), lights: lightKinds(), settings };
    },
    /** Loads a scene, with a panorama around it if one is named. Earlier loading is cancelled.
     * @param {{ source: Source, panorama?: Source, camera?: Camera, options?: SceneOptions }} data
     * @param {OnProgress} onProgress @returns {Promise<Opened>} */
    async load(data, onProgress) {
        const signal = another();
        const panorama = data.panorama && /** @type {string | File} */ (sourceFor(data.panorama));
        const options = { ...data.options, panorama, signal, camera: data.camera };
        const scene = /** @type {SceneInfo} */ (await renderer.loadScene(sourceFor(data.source), onProgress, options));
        number += 1;
        place = null;
        isReady = true;
        return { scene, materials: await renderer.materials(), settings: await renderer.settings(), number };
    },
    /** @param {Source} source @param {OnProgress} onProgress */
    async panorama(source, onProgress) {
        const signal = another();
        const environment = await renderer.loadPanorama(/** @type {File} */ (sourceFor(source)), onProgress, { signal });
        return { environment, lights: (await renderer.scene())?.lights ?? [] };
    },
    async cancel() {
        loading.abort();
    },
    /** @param {Settings} changes @param {OnProgress} onProgress */
    async set(changes, onProgress) {
        await renderer.set(changes, onProgress);
        return outcome();
    },
    /** @param {string} name @param {OnProgress} onProgress */
    async preset(name, onProgress) {
        await renderer.setPreset(name, onProgress);
        return outcome();
    },
    /** Moves the camera if the scene still has that number.
     * @param {{ camera: Camera, number: number, isMoving: boolean }} data */
    async camera(data) {
        if (data.number !== number) return;
        place = data;
    },
    /** @param {{ width: number, height: number }} data */
    async resize({ width, height }) {
        await renderer.resize(width, height);
    },
    /** @param {number} milliseconds */
    async budget(milliseconds) {
        await renderer.setFrameBudget(milliseconds);
    },
    /** @param {boolean} timed whether reports of frames have the times of stages */
    async timed(timed) {
        await renderer.setTimed(timed);
    },
    /** @param {Split | null} split */
    async split(split) {
        await renderer.setSplit(split);
    },
    /** @param {{ index: number, light: Light }} data */
    async light({ index, light }) {
        await renderer.setLight(index, light);
    },
    /** @param {EnvironmentChange} change */
    async environment(change) {
        await renderer.setEnvironment(change);
    },
    /** @param {{ index: number, change: MaterialChange }} data */
    async material({ index, change }) {
        await renderer.setMaterial(index, change);
    },
    /** The surface at a place of the picture. @param {{ x: number, y: number }} place */
    async pick({ x, y }) {
        return renderer.pick(x, y);
    },
    /** Adds a light at the camera, as the console does. @param {string} kind */
    async addLight(kind) {
        await renderer.run(`add_light ${kind}`);
        return (await renderer.scene())?.lights ?? [];
    },
    /** @param {number} index */
    async removeLight(index) {
        await renderer.removeLight(index);
        return (await renderer.scene())?.lights ?? [];
    },
    /** @param {{ object: number, hidden: boolean }} data */
    async hide({ object, hidden }) {
        await renderer.setHidden(object, hidden);
    },
    /** @param {number | null} animation */
    async play(animation) {
        await renderer.play(animation);
    },
    /** @param {number} seconds */
    async time(seconds) {
        await renderer.setTime(seconds);
    },
    /** The light at a place. @param {{ x: number, y: number }} place from 0 to 1 */
    async probe({ x, y }) {
        return renderer.probe(x, y);
    },
    async histogram() {
        return renderer.histogram();
    },
    /** Runs lines. @param {string} line @param {OnProgress} onProgress @returns {Promise<Ran>} */
    async run(line, onProgress) {
        const signal = another();
        const before = JSON.stringify(await renderer.camera());
        /** @type {{ text: string, files: File[], opened?: string, failed?: string }} */
        let ran;
        try {
            ran = await renderer.run(line, onProgress, { signal });
        } catch (error) {
            // Earlier lines have been run.
            const { printed = "" } = /** @type {{ printed?: string }} */ (error ?? {});
            if (error instanceof WebAssembly.RuntimeError) throw error;
            ran = { text: printed, files: [], failed: failure(error).message };
        }
        if (ran.opened !== undefined) number += 1;
        const now = await everything();
        isReady = now.scene !== undefined;
        const camera = /** @type {Camera} */ (await renderer.camera());
        const moved = ran.opened !== undefined || JSON.stringify(camera) !== before;
        return { ...ran, ...now, number, preset: await renderer.preset(), camera: moved ? camera : undefined };
    },
    /** @param {string} line up to the cursor */
    async complete(line) {
        return renderer.complete(line);
    },
    undo: () => step("undo"),
    redo: () => step("redo"),
    /** Begins a new step of undo. */
    async endGesture() {
        await renderer.endGesture();
    },
    /** The picture as a PNG. */
    async picture() {
        const { width, height, data } = await renderer.readPixels();
        const canvas = new OffscreenCanvas(width, height);
        const context = canvas.getContext("2d");
        if (!context) throw new Error("the browser gave no canvas to make the picture's file with");
        const image = context.createImageData(width, height);
        image.data.set(data);
        context.putImageData(image, 0, 0);
        return canvas.convertToBlob({ type: "image/png" });
    },
    /** The scene's cameras at the animation's present time. @returns {Promise<Camera[]>} */
    async cameras() {
        return /** @type {SceneInfo} */ (await renderer.scene())?.cameras ?? [];
    },
    /** @returns {Promise<Memory[]>} */
    async memory() {
        return renderer.memory();
    },
    restore,
};

/** Calls that change nothing. */
const LOOKS = new Set(["picture", "complete", "memory", "pick", "cancel", "probe", "histogram", "endGesture"]);

/** @param {unknown} error @returns {Failure} */
function failure(error) {
    const message = error instanceof Error ? error.message : String(error);
    const { name, code } = /** @type {{ name?: string, code?: string }} */ (error ?? {});
    // The browser's own exceptions have a number as code.
    if (name === "AbortError") return { message, code: "aborted", fatal: false };
    // A trap in WASM leaves its memory in an unknown state.
    return { message, code, fatal: error instanceof WebAssembly.RuntimeError };
}

self.addEventListener("message", async ({ data: { id, call, data } }) => {
    try {
        const method = /** @type {(data: unknown, onProgress: OnProgress) => Promise<unknown>} */ (
            calls[/** @type {keyof typeof calls} */ (call)]
        );
        const result = await method(data, (progress) => self.postMessage({ id, progress }));
        self.postMessage({ id, result });
    } catch (error) {
        self.postMessage({ id, error: failure(error) });
    }
    if (!LOOKS.has(call)) changed();
});

self.addEventListener("unhandledrejection", ({ reason }) => tell("error", failure(reason)));
