// @ts-check
// The first page: pictures of chapters, over which one renderer shows the chapter in view. Without
// WebGPU the pictures stay.

import { gpu, measure } from "./benchmark.js";
import { add, axes, dot, scale, subtract } from "./camera.js";
import { CHAPTERS, LAMP, USUAL, WALL_FIRST_M, lampAt, wallAt } from "./chapters.js";
import { Client, WorkerError } from "./client.js";
import { byId, h } from "./dom.js";
import { listenForFiles } from "./drop.js";
import { DROPPED, keep } from "./files.js";

/** @typedef {import("./chapters.js").Order} Order */
/** @typedef {import("./types.js").FrameReport} FrameReport */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Vec3} Vec3 */

/** The first size and settings: quick everywhere. Reflections, light of earlier frames and half
 * resolution take the longest to compile. */
const FIRST_PX = [192, 108];
/** @type {Settings} */
const FIRST = { resolution: 32, cones: "6", specular: false, temporal: false, trace_resolution: "full" };
/** By the time of a frame at the first size, ms: the width of the picture, px (Infinity: that of
 * the figure), the budget of a frame in motion, ms, and settings.
 * @type {{ upTo: number, width: number, budget: number, settings: Settings }[]} */
const SPEEDS = [
    { upTo: 16, width: Infinity, budget: 33, settings: { resolution: 96, cones: "9", specular: true, temporal: true, trace_resolution: "half" } },
    { upTo: 60, width: 960, budget: 50, settings: { resolution: 64, cones: "9", specular: true, temporal: true, trace_resolution: "half" } },
    { upTo: Infinity, width: 384, budget: 400, settings: FIRST },
];
/** All chapters have it, with the settings above. */
const PRESET = "realtime";
/** Frames whose times decide. */
const TIMED = 3;
/** Frames that a still chapter gathers before it replaces its picture. */
const GATHERED = 12;
/** Frames of a moving chapter before they replace its picture: their light has settled by then. */
const SETTLED = 2;
/** A step of the arrow keys for the lamp, metres. */
const STEP_M = 0.1;

const state = byId("state");
const canvas = h("canvas", { "aria-hidden": true });
/** @type {Client | null} */
let client = null;
/** The chapter in view, and the one that the renderer shows. */
let [wanted, shown] = ["", ""];
/** The open scene and its settings. */
let scene = "";
/** @type {Settings} */
let settings = {};
/** Settings that a visitor has chosen, by chapter. @type {Record<string, Settings>} */
const chosen = {};
/** The visitor's places of the lamp and of the wall. */
let lamp = LAMP.first;
let wall = WALL_FIRST_M;
/** @type {typeof SPEEDS[number] | undefined} */
let speed;
/** Times of the first frames, ms. @type {number[]} */
const times = [];
/** The number of calls that the worker has not answered. */
let asked = 0;
/** When the chapter began, ms, and its frames since then. */
let [began, frames] = [0, 0];
/** The size of the picture at rest, pixels. */
let size = { width: 0, height: 0 };
const isStill = matchMedia("(prefers-reduced-motion: reduce)");

/** Marks for the developer tools, and for the page's tests. @param {string} name */
const mark = (name) => performance.getEntriesByName(name).length > 0 || performance.mark(name);

/** @param {string} call @param {unknown} [data] */
async function ask(call, data) {
    asked += 1;
    try {
        const result = await client?.call(call, data);
        // The worker's answer to a line with an error.
        const { failed } = /** @type {{ failed?: string }} */ (result ?? {});
        if (failed !== undefined) throw new Error(failed);
        return result;
    } finally {
        asked -= 1;
    }
}

/** @param {Order} order */
const give = ({ call, data }) => ask(call, data).catch(fail);

/** @param {unknown} error */
function fail(error) {
    const message = error instanceof Error ? error.message : String(error);
    const isMissing = error instanceof WorkerError && (error.code === "no-webgpu" || error.code === "no-adapter");
    document.documentElement.dataset.state = isMissing ? "unsupported" : "failed";
    state.textContent = isMissing
        ? "These are pictures: this browser has no WebGPU here. Chrome and Edge 113, Safari 26 and Firefox 145 or newer show them live, over https."
        : `These are pictures: the renderer stopped. ${message}`;
    canvas.classList.remove("live");
    client = null;
}

// --- Chapters ------------------------------------------------------------------------------------

/** @param {string} name */
const figureOf = (name) => /** @type {HTMLElement} */ (document.querySelector(`figure[data-chapter="${name}"]`));

/** Orders of a chapter, as the visitor left it. @param {string} name */
function ordersOf(name) {
    if (name === "lamp") return [lampAt(lamp)];
    if (name === "wall") return [wallAt(wall)];
    return CHAPTERS[name].orders ?? [];
}

/** `true` while `show` runs: it continues until the wanted chapter is shown. */
let isShowing = false;

/** Shows the chapter in view. */
async function show() {
    if (isShowing || isMeasuring || !client) return;
    isShowing = true;
    try {
        while (shown !== wanted && client) await turnTo(wanted);
    } catch (error) {
        fail(error);
    } finally {
        isShowing = false;
    }
}

/** @param {string} name the chapter; empty: none */
async function turnTo(name) {
    // The picture of the last chapter is behind the canvas.
    canvas.classList.remove("live");
    if (CHAPTERS[shown]?.isCompared) await ask("split", null);
    shown = name;
    if (name === "") return;
    const chapter = CHAPTERS[name];
    await setFor(name);
    if (scene !== chapter.scene) {
        scene = chapter.scene;
        const onProgress = (/** @type {import("./types.js").Progress} */ { stage, done, total }) => {
            mark(stage);
            if (!speed) state.textContent = `${stage}${total > 1 ? `, ${done} of ${total}` : ""}`;
        };
        await client?.call("load", { source: scene, camera: chapter.camera, options: {} }, onProgress);
        mark("loaded");
    }
    for (const order of ordersOf(name)) await ask(order.call, order.data);
    if (chapter.isCompared) await ask("split", { right: "reference", at: lineOf(name).valueAsNumber });
    if (wanted !== name) return;
    figureOf(name).querySelector("img")?.after(canvas);
    resize();
    [began, frames] = [performance.now(), 0];
}

/** Gives the renderer the settings of a chapter, as the visitor left it. @param {string} name */
async function setFor(name) {
    const next = { ...USUAL, ...(speed?.settings ?? FIRST), ...CHAPTERS[name].settings, ...chosen[name] };
    const changed = Object.entries(next).filter(([key, value]) => settings[key] !== value);
    settings = next;
    if (changed.length > 0) await ask("set", Object.fromEntries(changed));
}

/** @param {FrameReport} report */
function onFrame(report) {
    const chapter = CHAPTERS[shown];
    reported?.(report);
    if (!chapter || isShowing) return;
    mark("first frame");
    learn(report.frame_ms);
    const isMoving = chapter.moving !== undefined && !isStill.matches;
    const isReady = report.complete || report.frame >= GATHERED || (isMoving && (frames += 1) >= SETTLED) || report.reference_samples !== undefined;
    if (isReady && !canvas.classList.contains("live")) {
        canvas.classList.add("live");
        mark("live");
    }
    animate();
    const pixels = `${Math.round(size.width * report.scale)} x ${Math.round(size.height * report.scale)} pixels`;
    state.textContent = `Live: ${pixels}, ${report.frame_ms.toFixed(report.frame_ms < 10 ? 1 : 0)} ms a frame on this device`;
    document.documentElement.dataset.state = "live";
}

/** Moves what moves in the chapter, unless the page is hidden. */
function animate() {
    const moving = CHAPTERS[shown]?.moving;
    if (!moving || isShowing || isStill.matches || asked > 0 || document.hidden) return;
    mark("moving");
    void give(moving((performance.now() - began) / 1000));
}

/** Chooses size and voxels by the times of the first frames. @param {number} ms */
function learn(ms) {
    if (speed) return;
    times.push(ms);
    if (times.length < TIMED) return;
    const fastest = Math.min(...times);
    speed = SPEEDS.find(({ upTo }) => fastest <= upTo);
    void ask("budget", speed?.budget).catch(fail);
    resize();
    void setFor(shown).catch(fail);
}

function resize() {
    const { clientWidth, clientHeight } = canvas;
    if (clientWidth === 0 || isMeasuring) return;
    const [width, height] = FIRST_PX;
    const scale = speed ? Math.min(devicePixelRatio, speed.width / clientWidth) : Math.min(width / clientWidth, height / clientHeight);
    size = { width: Math.round(clientWidth * scale), height: Math.round(clientHeight * scale) };
    void ask("resize", size).catch(fail);
}

/** Watches which chapter is in the middle of the window. */
function watch() {
    const inView = new Set();
    const observer = new IntersectionObserver((entries) => {
        for (const { target, isIntersecting } of entries) inView[isIntersecting ? "add" : "delete"](target);
        const middle = innerHeight / 2;
        const away = (/** @type {HTMLElement} */ figure) => {
            const { top, bottom } = figure.getBoundingClientRect();
            return Math.abs((top + bottom) / 2 - middle);
        };
        const [nearest] = [...inView].sort((a, b) => away(a) - away(b));
        wanted = CHAPTERS[nearest?.dataset.chapter] ? nearest.dataset.chapter : "";
        void show();
    }, { threshold: [0, 0.35, 0.65, 1], rootMargin: "-15% 0px" });
    for (const figure of document.querySelectorAll("figure[data-chapter]")) observer.observe(figure);
}

// --- Controls ------------------------------------------------------------------------------------

/** @param {string} name */
const lineOf = (name) => /** @type {HTMLInputElement} */ (figureOf(name).querySelector(".line"));

/** Shows a value beside its slider and in the code below.
 * @param {HTMLElement} near @param {string} text */
function say(near, text) {
    const section = near.closest("section");
    const [output, code] = [section?.querySelector("output"), section?.querySelector("pre b")];
    if (output) output.textContent = text.replace("-", "");
    if (code) code.textContent = text;
}

function listen() {
    for (const input of document.querySelectorAll("input[data-set]")) {
        if (!(input instanceof HTMLInputElement)) continue;
        const name = input.closest("section")?.id ?? "";
        const setting = input.dataset.set ?? "";
        say(input, input.value);
        input.addEventListener("input", () => {
            say(input, input.value);
            chosen[name] = { [setting]: input.valueAsNumber };
            if (shown !== name || isShowing) return;
            settings = { ...settings, ...chosen[name] };
            void ask("set", chosen[name]).catch(fail);
        });
    }
    const line = lineOf("truth");
    line.addEventListener("input", () => {
        say(line, line.valueAsNumber.toFixed(2));
        if (shown === "truth") void ask("split", { right: "reference", at: line.valueAsNumber }).catch(fail);
    });
    const door = byId("wall-open", HTMLInputElement);
    door.addEventListener("input", () => {
        wall = door.valueAsNumber;
        say(door, String(-wall));
        if (shown === "wall" && !isShowing) void give(wallAt(wall));
    });
    door.value = String(wall);
    say(door, String(-wall));
    byId("measure-start").addEventListener("click", () => void benchmark());
    listenToLamp();
}

/** The lamp's handle in the picture: drags move it parallel to the picture. */
function listenToLamp() {
    const handle = /** @type {HTMLElement} */ (figureOf("lamp").querySelector(".lamp"));
    const { camera } = CHAPTERS.lamp;
    const { forward, right, above } = axes(camera);
    const tangent = Math.tan((camera.vertical_fov_deg * Math.PI) / 360);
    const place = () => {
        const { clientWidth, clientHeight } = figureOf("lamp");
        const offset = subtract(lamp, camera.position);
        const reach = dot(offset, forward) * tangent;
        handle.style.left = `${50 + (50 * dot(offset, right) * clientHeight) / (reach * clientWidth)}%`;
        handle.style.top = `${50 - (50 * dot(offset, above)) / reach}%`;
    };
    const move = (/** @type {Vec3} */ by) => {
        lamp = /** @type {Vec3} */ (add(lamp, by).map((value, axis) => Math.min(Math.max(value, LAMP.min[axis]), LAMP.max[axis])));
        place();
        if (shown === "lamp" && !isShowing) void give(lampAt(lamp));
    };
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const { left, top, width, height } = figureOf("lamp").getBoundingClientRect();
        const depth = dot(subtract(lamp, camera.position), forward);
        const [x, y] = [(2 * (event.clientX - left)) / width - 1, 1 - (2 * (event.clientY - top)) / height];
        const to = add(camera.position, scale(add(forward, add(scale(right, (x * tangent * width) / height), scale(above, y * tangent))), depth));
        move(subtract(to, lamp));
    });
    handle.addEventListener("keydown", (event) => {
        const by = /** @type {Record<string, Vec3>} */ ({
            ArrowLeft: scale(right, -STEP_M),
            ArrowRight: scale(right, STEP_M),
            ArrowUp: scale(above, STEP_M),
            ArrowDown: scale(above, -STEP_M),
        })[event.key];
        if (!by) return;
        event.preventDefault();
        move(by);
    });
    place();
}

// --- The benchmark -------------------------------------------------------------------------------

let isMeasuring = false;
/** Gets the next report of a frame, while something is measured.
 * @type {((report: FrameReport) => void) | undefined} */
let reported;

/** Measures, and shows the result. */
async function benchmark() {
    if (isMeasuring || !client) return;
    const words = byId("measure-state");
    const button = byId("measure-start", HTMLButtonElement);
    isMeasuring = button.disabled = true;
    byId("measure-save").hidden = byId("measure-name").hidden = true;
    try {
        while (isShowing) await new Promise((resolve) => setTimeout(resolve, 50));
        await turnTo("");
        figureOf("measure").append(canvas);
        canvas.classList.add("live");
        const device = await gpu();
        const frame = () => new Promise((/** @type {(report: FrameReport) => void} */ resolve) => (reported = resolve));
        const result = await measure({ ask, frame, say: (text) => (words.textContent = text) }, device);
        offer(result);
        words.textContent = result.clock === "timestamps" ? "Times are those of the GPU." : "Times are those of whole frames, since this browser has no true times of the GPU.";
    } catch (error) {
        words.textContent = `Nothing was measured: ${error instanceof Error ? error.message : error}. Reload the page, and try again.`;
    } finally {
        reported = undefined;
        isMeasuring = button.disabled = false;
    }
    // The next chapter opens its scene again.
    [scene, settings] = ["", {}];
    await ask("preset", PRESET).catch(fail);
    await ask("budget", speed?.budget ?? 0).catch(fail);
    void show();
}

/** Shows a result in the table, and offers it as a file.
 * @param {import("./benchmark.js").Result} result */
function offer(result) {
    const rows = byId("measured", HTMLTableElement).tBodies[0];
    rows.querySelector(".own")?.remove();
    const ids = ["cornell still", "cornell moving", "atrium still", "atrium moving"];
    const times = ids.map((id) => result.cases.find((found) => found.id === id)?.median_ms);
    const cells = times.map((ms) => h("td", {}, ms === undefined ? "-" : String(Number(ms.toPrecision(3)))));
    rows.prepend(h("tr", { class: "own" }, h("th", { scope: "row" }, "This device ", h("small", {}, `${result.gpu.name}; ${result.clock}`)), ...cells));
    const [label, save] = [byId("measure-name"), byId("measure-save")];
    const name = /** @type {HTMLInputElement} */ (label.querySelector("input"));
    name.value = result.gpu.name;
    label.hidden = save.hidden = false;
    save.onclick = () => {
        const named = { ...result, gpu: { ...result.gpu, name: name.value.trim() } };
        const address = URL.createObjectURL(new Blob([`${JSON.stringify(named, null, 2)}\n`], { type: "application/json" }));
        h("a", { href: address, download: "lumivox-result.json" }).click();
        setTimeout(() => URL.revokeObjectURL(address), 10_000);
    };
}

// --- Start ---------------------------------------------------------------------------------------

async function start() {
    byId("open").addEventListener("click", () => byId("files").click());
    listenForFiles((files) => {
        state.textContent = "Opening the viewer";
        keep(files).then(() => location.assign(`viewer.html${DROPPED}`), (error) => {
            state.textContent = `This browser cannot pass files to the viewer (${error.message}): drop them there.`;
        });
    }, (text) => (state.textContent = text));
    if (!("gpu" in navigator) || !canvas.transferControlToOffscreen) {
        return fail(new WorkerError({ message: "", code: "no-webgpu", fatal: true }));
    }
    state.textContent = "These are pictures until the renderer has started";
    mark("script");
    const module = WebAssembly.compileStreaming(fetch(new URL("lumivox/lumivox_bg.wasm", import.meta.url)));
    [canvas.width, canvas.height] = FIRST_PX;
    figureOf("room").append(canvas);
    const screen = canvas.transferControlToOffscreen();
    client = new Client(new URL("worker.js", import.meta.url));
    client.on("frame", onFrame);
    client.on("error", fail);
    await client.call("start", { canvas: screen, module: await module }, undefined, [screen]);
    mark("started");
    await client.call("budget", 0);
    await client.call("preset", PRESET);
    listen();
    new ResizeObserver(resize).observe(canvas);
    document.addEventListener("visibilitychange", animate);
    watch();
}

// Links to the viewer, which was at this address.
if (/^#[^=]+=/.test(location.hash)) location.replace(`viewer.html${location.hash}`);
else void start().catch(fail);
