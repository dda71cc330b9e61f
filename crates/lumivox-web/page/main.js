// @ts-check
// The page: what is shown, what was asked for, and how the parts come together. The renderer is in the worker.

import { fitted, frame } from "./camera.js";
import { Client, WorkerError } from "./client.js";
import { Controls } from "./controls.js";
import { byId, plain } from "./dom.js";
import { listenForFiles } from "./drop.js";
import { newLight, showLights } from "./lights.js";
import { decode, encode } from "./link.js";
import { announce, closeNewest, loading, say } from "./messages.js";
import { Parameters, radios, same } from "./parameters.js";
import { cameraChoices, showFacts, showScene } from "./scene.js";
import { SplitLine } from "./split.js";
import { addReport, clearReports, milliseconds, showMemory } from "./timing.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").Catalogue} Catalogue */
/** @typedef {import("./types.js").Changed} Changed */
/** @typedef {import("./types.js").FrameReport} FrameReport */
/** @typedef {import("./types.js").Light} Light */
/** @typedef {import("./types.js").LinkState} LinkState */
/** @typedef {import("./types.js").Memory} Memory */
/** @typedef {import("./types.js").Opened} Opened */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Source} Source */

/** The preset that the renderer starts with. */
const FIRST_PRESET = "balanced";
/** Browsers' default limit of a texture's edge, pixels. */
const LARGEST_PX = 8192;

const canvas = byId("canvas", HTMLCanvasElement);
const client = new Client(new URL("worker.js", import.meta.url));

/** @type {Catalogue} */
let catalogue;
/** @type {Parameters} */
let fields;
/** @type {SplitLine} */
let split;
/** @type {Opened | null} */
let opened = null;
/** @type {Source | null} */
let source = null;
/** @type {Camera | null} */
let camera = null;
/** @type {Settings} */
let settings = {};
let preset = FIRST_PRESET;
/** Settings that were changed by hand.
 * @type {Set<string>} */
const touched = new Set();
let aspect = 1;
/** Phones and the like have more pixels than one sees. */
const usualScale = devicePixelRatio >= 2 ? 0.5 : 1;

/** @param {string} state */
const setState = (state) => (document.documentElement.dataset.state = state);

// --- Errors --------------------------------------------------------------------------------------------------------

/** @param {unknown} error */
function fail(error) {
    const text = error instanceof Error ? error.message : String(error);
    const { fatal, code } = error instanceof WorkerError ? error : { fatal: false, code: undefined };
    if (fatal) say(text, { action: { label: "Start again", run: startAgain } });
    else if (code === "lost") say(text, { action: { label: "Try again", run: () => void attempt(client.call("restore")) } });
    else say(text);
    if (fatal) setState("failed");
}

/** What a promise gives; if it fails, that is told.
 * @template T @param {Promise<T>} promise @returns {Promise<T | undefined>} */
async function attempt(promise) {
    try {
        return await promise;
    } catch (error) {
        fail(error);
        return undefined;
    }
}

function startAgain() {
    history.replaceState(null, "", `#${encode(linkState())}`);
    location.reload();
}

/** Browsers without what is needed get a page of their own.
 * @param {unknown} error */
function unsupported(error) {
    const code = error instanceof WorkerError ? error.code : "no-webgpu";
    const titles = /** @type {Record<string, string>} */ ({
        "no-webgpu": "This browser has no WebGPU",
        "no-adapter": "WebGPU finds no graphics adapter",
        "no-device": "The graphics device could not be opened",
    });
    const title = titles[code ?? ""];
    if (title === undefined) return fail(error);
    setState("unsupported");
    byId("unsupported-title").textContent = title;
    byId("unsupported-reason").textContent = error instanceof Error ? error.message : "";
    byId("unsupported-http").hidden = isSecureContext;
    for (const id of ["stage", "panel"]) byId(id).hidden = true;
    byId("unsupported").hidden = false;
}

// --- Scene and camera ----------------------------------------------------------------------------------------------

/** Opens a scene; the one before stays if that fails.
 * @param {Source} from @param {Camera} [link] where the camera shall be */
async function open(from, link) {
    const name = typeof from === "string" ? from.replace(/^builtin:/, "") : (from.find(({ path }) => /\.(glb|gltf|obj)$/i.test(path)) ?? from[0]).path;
    const busy = loading(`Loading ${name}`);
    setState("loading");
    announce(`Loading ${name}`);
    try {
        /** @type {Opened} */
        const now = await client.call("load", { source: from, camera: link && fitted(link, aspect) }, busy.progress);
        [opened, source] = [now, from];
        camera = link ?? now.scene.camera;
        clearReports();
        split.show(split.value);
        showScene(now.scene, typeof from === "string" ? from : "", { client, attempt });
        showAllLights(now.scene.lights);
        showSettings(now.settings);
        if (!link && aspect < 1) sendCamera(false);
        announce(`${now.scene.name} is loaded: ${byId("facts").textContent}`);
        setState("rendering");
    } catch (error) {
        fail(error);
        setState(opened ? "rendering" : "empty");
        byId("scene", HTMLSelectElement).value = typeof source === "string" ? source : "";
    } finally {
        busy.end();
    }
}

/** @param {boolean} isMoving */
function sendCamera(isMoving) {
    if (camera && opened) void attempt(client.call("camera", { camera: fitted(camera, aspect), number: opened.number, isMoving }));
}

/** @param {Camera} to @param {boolean} isMoving */
function moveTo(to, isMoving) {
    camera = to;
    sendCamera(isMoving);
}

function goHome() {
    const chosen = opened && cameraChoices(opened.scene)[Number(byId("camera", HTMLSelectElement).value)];
    if (chosen) moveTo(chosen, false);
}

function listenForCamera() {
    new Controls(canvas, () => (camera && opened ? { camera, scene: opened.scene } : null), (to) => moveTo(to, true));
    byId("camera").addEventListener("change", goHome);
    byId("home").addEventListener("click", goHome);
    canvas.addEventListener("keydown", ({ code, ctrlKey, metaKey, altKey }) => {
        if (ctrlKey || metaKey || altKey) return;
        if (code === "Home") goHome();
        if (code === "KeyF" && camera && opened) moveTo(frame(camera, opened.scene.bounds), false);
    });
}

/** @param {Light[]} lights */
function showAllLights(lights) {
    if (!opened) return;
    opened.scene.lights = lights;
    const change = (/** @type {number} */ index, /** @type {Light} */ light) => void attempt(client.call("light", { index, light }));
    showLights(lights, change, async (index) => {
        /** @type {Light[] | undefined} */
        const left = await attempt(client.call("removeLight", index));
        if (left) showAllLights(left);
    });
}

async function addLight(/** @type {string | undefined} */ kind) {
    if (!opened || !camera) return;
    const light = newLight(/** @type {Light["kind"]} */ (kind), camera, opened.scene.lights.length);
    /** @type {Light[] | undefined} */
    const lights = await attempt(client.call("addLight", light));
    if (lights) showAllLights(lights);
}

// --- Settings ------------------------------------------------------------------------------------------------------

/** @param {Settings} now */
function showSettings(now) {
    settings = now;
    fields.show(settings);
    split.showLeft(String(settings.view ?? ""));
}

/** @param {string} call @param {Settings | string} data @returns {Promise<boolean>} */
async function change(call, data) {
    const busy = loading("Applying");
    /** @type {Changed | undefined} */
    const now = await attempt(client.call(call, data, busy.progress));
    busy.end();
    if (now && opened && now.voxels !== undefined) {
        opened.scene.voxels = now.voxels;
        showFacts(opened.scene);
    }
    showSettings(now?.settings ?? settings);
    return now !== undefined;
}

/** @param {Settings} changes */
function set(changes) {
    for (const name of Object.keys(changes)) touched.add(name);
    return change("set", changes);
}

/** @param {string} name */
async function setPreset(name) {
    const before = settings;
    if (!(await change("preset", name))) return false;
    preset = name;
    fields.usual = Object.fromEntries(
        catalogue.parameters.map(({ name, default: first }) => [name, same(settings[name], before[name]) ? first : settings[name]]),
    );
    fields.show(settings);
    return true;
}

/** What a link has to carry. */
function linkState() {
    const scale = byId("scale", HTMLInputElement).valueAsNumber;
    const isFirst = preset === FIRST_PRESET;
    const carried = (catalogue?.parameters ?? []).filter(({ name, default: first }) =>
        settings[name] !== undefined && (isFirst ? !same(settings[name], first) : touched.has(name)));
    /** @type {LinkState} */
    const state = { settings: Object.fromEntries(carried.map(({ name }) => [name, settings[name]])) };
    if (typeof source === "string") state.scene = source;
    if (!isFirst) state.preset = preset;
    if (camera) state.camera = camera;
    if (split?.value) state.split = split.value;
    if (scale !== usualScale) state.scale = scale;
    return state;
}

async function copyLink() {
    const address = new URL(`#${encode(linkState())}`, location.href).href;
    history.replaceState(null, "", address);
    const note = typeof source === "string" ? "" : " It carries the camera and the settings, but not your file.";
    try {
        await navigator.clipboard.writeText(address);
        say(`The link is copied.${note}`, { kind: "note" });
    } catch {
        say(`This browser does not let a page copy: here is the link.${note}`, { kind: "note", link: address });
    }
}

async function savePicture() {
    /** @type {Blob | undefined} */
    const picture = await attempt(client.call("picture"));
    if (!picture) return;
    const anchor = document.createElement("a");
    anchor.href = URL.createObjectURL(picture);
    anchor.download = `${(opened?.scene.name ?? "picture").replace(/[^\w.-]+/g, "-")}.png`;
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(anchor.href), 60_000);
}

// --- Size, panel, keys ---------------------------------------------------------------------------------------------

function resize() {
    const { clientWidth, clientHeight } = canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    const share = byId("scale", HTMLInputElement).valueAsNumber;
    byId("scale-value").textContent = plain(share);
    const scale = Math.min(devicePixelRatio * share, LARGEST_PX / Math.max(clientWidth, clientHeight));
    const [width, height] = [clientWidth, clientHeight].map((side) => Math.max(1, Math.round(side * scale)));
    void attempt(client.call("resize", { width, height, coarser: byId("coarser", HTMLInputElement).checked }));
    const before = aspect;
    aspect = clientWidth / clientHeight;
    if (aspect !== before && (aspect < 1 || before < 1)) sendCamera(false);
}

/** @param {boolean} isOpen */
function showPanel(isOpen) {
    byId("panel").hidden = !isOpen;
    byId("panel-toggle").setAttribute("aria-expanded", String(isOpen));
}

function listenForKeys() {
    const keys = /** @type {HTMLDialogElement} */ (byId("keys"));
    const clicks = /** @type {Record<string, () => void>} */ ({
        open: () => byId("files").click(),
        picture: () => void savePicture(),
        link: () => void copyLink(),
        help: () => keys.showModal(),
        "panel-toggle": () => showPanel(byId("panel").hidden),
        "panel-close": () => (showPanel(false), byId("panel-toggle").focus()),
    });
    for (const [id, click] of Object.entries(clicks)) byId(id).addEventListener("click", click);
    const shortcuts = /** @type {Record<string, string>} */ ({ o: "open", p: "picture", l: "link", "?": "help" });
    addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || keys.open) return;
        if (event.key === "Escape" && closeNewest()) event.preventDefault();
        // Letters belong to the field that has the focus.
        if (event.target !== canvas && event.target !== document.body) return;
        clicks[shortcuts[event.key.toLowerCase()]]?.();
    });
}

// --- What the worker tells -----------------------------------------------------------------------------------------

function listenToWorker() {
    /** @type {{ end: () => void } | null} */
    let restoring = null;
    client.on("frame", (/** @type {FrameReport} */ report) => {
        addReport(report);
        const reference = report.reference_samples === undefined ? "" : ` · reference ${report.reference_samples} samples`;
        byId("status").textContent = `${report.frame}/${report.frames} frames · ${milliseconds(report.frame_ms)}${reference}`;
        if (document.documentElement.dataset.state === "loading") return;
        setState(report.complete ? "complete" : "rendering");
        if (report.complete) void attempt(client.call("memory")).then((memory) => memory && showMemory(/** @type {Memory[]} */ (memory)));
    });
    client.on("error", fail);
    client.on("lost", (reason) => {
        restoring ??= loading("The graphics device was lost; everything is uploaded again");
        say(`The graphics device was lost: ${reason}`, { kind: "note" });
        setState("lost");
    });
    client.on("restored", () => {
        restoring?.end();
        restoring = null;
        announce("The graphics device is back");
        setState("rendering");
    });
}

// --- Start ---------------------------------------------------------------------------------------------------------

function fillPanel() {
    fields = new Parameters(catalogue.parameters, (name, value) => void set({ [name]: value }));
    const views = catalogue.parameters.find(({ name }) => name === "view")?.choices ?? [];
    split = new SplitLine(views, (now) => void attempt(client.call("split", now)), (view) => void set({ view }));
    const list = radios("preset", "Preset", catalogue.presets, async (name) => {
        if (!(await setPreset(name))) list.show(preset);
    }, byId("presets"));
    list.show(preset);
    showSettings(catalogue.settings);
    const scenes = byId("scene", HTMLSelectElement);
    scenes.append(new Option("a file or an address", ""), ...catalogue.scenes.map(({ name, title }) => new Option(title, `builtin:${name}`)));
    scenes.options[0].disabled = true;
    scenes.addEventListener("change", () => void open(scenes.value));
    byId("address-form").addEventListener("submit", (event) => {
        event.preventDefault();
        const address = byId("address", HTMLInputElement).value.trim();
        if (address) void open(address);
    });
    for (const button of document.querySelectorAll("[data-add]")) {
        button.addEventListener("click", () => void addLight(button.getAttribute("data-add") ?? undefined));
    }
    for (const id of ["scale", "coarser"]) byId(id).addEventListener("input", resize);
    return list;
}

async function start() {
    byId("scale", HTMLInputElement).value = String(usualScale);
    // A phone shows the picture first.
    showPanel(matchMedia("(min-width: 45rem)").matches);
    const busy = loading("Starting");
    listenToWorker();
    try {
        if (!("gpu" in navigator) || !canvas.transferControlToOffscreen) {
            throw new WorkerError({ message: "", code: "no-webgpu", fatal: true });
        }
        const screen = canvas.transferControlToOffscreen();
        catalogue = await client.call("start", { canvas: screen }, undefined, [screen]);
    } catch (error) {
        return unsupported(error);
    } finally {
        busy.end();
    }
    const presets = fillPanel();
    const { state, problems } = decode(location.hash, catalogue);
    if (problems.length > 0) say(`The link has an error: ${problems.join("; ")}. What could be read is shown.`);
    if (state.scale !== undefined) byId("scale", HTMLInputElement).value = String(state.scale);
    new ResizeObserver(resize).observe(canvas);
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener("change", resize);
    listenForCamera();
    listenForKeys();
    listenForFiles((files) => void open(files), (text) => say(text));
    addEventListener("hashchange", () => location.reload());
    resize();
    if (state.preset !== undefined && (await setPreset(state.preset))) presets.show(preset);
    // One by one, so that one that is refused is told of by name: the worker sets them together.
    await Promise.all(Object.entries(state.settings).map(([name, value]) => set({ [name]: value })));
    if (state.split) split.show(state.split);
    if (state.split) void attempt(client.call("split", state.split));
    await open(state.scene ?? `builtin:${catalogue.scenes[0].name}`, state.camera);
    // An address that is gone leaves no empty page.
    if (!opened && state.scene !== undefined) await open(`builtin:${catalogue.scenes[0].name}`);
}

void start().catch(fail);
