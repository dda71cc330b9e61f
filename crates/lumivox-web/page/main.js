// @ts-check
// The page: its state, and the connection of its parts. The renderer is in the worker.

import { fitted, frame, lookAt } from "./camera.js";
import { CameraList } from "./cameras.js";
import { Client, WorkerError } from "./client.js";
import { Console } from "./console.js";
import { Controls } from "./controls.js";
import { byId, h, plain, title } from "./dom.js";
import { listenForFiles } from "./drop.js";
import { DROPPED, take } from "./files.js";
import { followHistogram } from "./histogram.js";
import { listenToTools, showPanel, showSteps } from "./keys.js";
import { showLights, showObjects } from "./lights.js";
import { decode } from "./link.js";
import { showMaterials } from "./materials.js";
import { announce, loading, say, showUnsupported } from "./messages.js";
import { Parameters, radios, same } from "./parameters.js";
import { Probe } from "./probe.js";
import { showChosen, showFacts, showScene, showTime } from "./scene.js";
import { copyLink, download, linkState, save, showLink } from "./share.js";
import { isPanorama, nameOf } from "./source.js";
import { SplitLine } from "./split.js";
import { EVERY_MS, statusText } from "./status.js";
import { showEnvironment } from "./surroundings.js";
import { addReport, clearReports, showMemory } from "./timing.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").Catalogue} Catalogue */
/** @typedef {import("./types.js").Changed} Changed */
/** @typedef {import("./types.js").Environment} Environment */
/** @typedef {import("./types.js").FrameReport} FrameReport */
/** @typedef {import("./types.js").Light} Light */
/** @typedef {import("./types.js").LinkState} LinkState */
/** @typedef {import("./types.js").Memory} Memory */
/** @typedef {import("./types.js").Opened} Opened */
/** @typedef {import("./types.js").Picked} Picked */
/** @typedef {import("./types.js").Progress} Progress */
/** @typedef {import("./types.js").Ran} Ran */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Source} Source */
/** @typedef {import("./types.js").Stepped} Stepped */

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
/** @type {Console} */
let lines;
/** @type {{ show: (name: string) => void }} */
let presetList;
/** @type {Opened | null} */
let opened = null;
/** @type {Source | null} */
let source = null;
/** The panorama that was loaded separately. @type {{ source: Source, name?: string } | null} */
let panorama = null;
/** Counts openings, so that a superseded one reports nothing. */
let openings = 0;
/** The latest loading of a scene. @type {Promise<unknown>} */
let sceneLoading = Promise.resolve();
/** The selected object. @type {Picked | undefined} */
let chosen;
/** The warning of the last picture. @type {string | undefined} */
let warned;
/** @type {Camera | null} */
let camera = null;
/** @type {Settings} */
let settings = {};
let preset = FIRST_PRESET;
/** Settings that were changed by hand.
 * @type {Set<string>} */
const touched = new Set();
let aspect = 1;
const cameras = new CameraList(() => camera, (to) => moveTo(to, false), async () => (await attempt(client.call("cameras"))) ?? []);
/** Default scale: half on high-density screens. */
const usualScale = devicePixelRatio >= 2 ? 0.5 : 1;

/** The page's state: starting, loading, rendering, complete, empty (no scene), lost, failed or
 * unsupported.
 * @param {string} [now] */
const state = (now = document.documentElement.dataset.state) => (document.documentElement.dataset.state = now);
/** The number of unanswered changes. */
let asked = 0;
/** Start of the wait for the next frame, ms. */
let waitedSince = 0;

/** Sends a change to the worker. Until it is answered and rendered, no picture is complete.
 * @template T
 * @param {string} call @param {unknown} data @param {(progress: Progress) => void} [onProgress]
 * @returns {Promise<T>} */
function ask(call, data, onProgress) {
    asked += 1;
    if (state() === "complete") {
        state("rendering");
        waitedSince = performance.now();
    }
    return client.call(call, data, onProgress).finally(() => (asked -= 1));
}

// --- Errors --------------------------------------------------------------------------------------

/** @param {unknown} error */
function fail(error) {
    const text = error instanceof Error ? error.message : String(error);
    const { fatal = false, code = "" } = error instanceof WorkerError ? error : {};
    if (fatal) say(`The renderer stopped: ${text}`, { action: { label: "Start again", run: startAgain } });
    else if (code === "lost") say(text, { action: { label: "Try again", run: () => void attempt(ask("restore", null)) } });
    else say(text);
}

/** The result of a promise; reports a failure.
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
    showLink(link());
    location.reload();
}

// --- Scene and camera ----------------------------------------------------------------------------

const surroundings = byId("surroundings", HTMLSelectElement);

/** Shows the progress of a load that can be cancelled; returns its result, or undefined if the
 * previous scene stays.
 * @template T
 * @param {string} name @param {(onProgress: (progress: Progress) => void) => Promise<T>} load
 * @returns {Promise<T | undefined>} */
async function opening(name, load) {
    const mine = (openings += 1);
    const busy = loading(`Loading ${name}`, () => void client.call("cancel"));
    state("loading");
    announce(`Loading ${name}`);
    try {
        const now = await load(busy.progress);
        state("rendering");
        return now;
    } catch (error) {
        // A later load replaced this one.
        if (mine !== openings) return undefined;
        state(opened ? "rendering" : "empty");
        if (error instanceof WorkerError && error.code === "aborted") say(`Loading ${name} was cancelled`, { kind: "note" });
        else fail(error);
        byId("scene", HTMLSelectElement).value = typeof source === "string" ? source : "";
        return undefined;
    } finally {
        busy.end();
    }
}

/** Opens a scene, or puts a panorama around the present one. On failure the present scene stays.
 * @param {Source} from @param {Camera} [place] the initial camera
 * @param {string} [around] the address of a panorama */
async function open(from, place, around) {
    if (isPanorama(from)) return surround(from);
    const options = { surroundings: surroundings.value === "panorama" ? "auto" : surroundings.value };
    const data = { source: from, panorama: around, camera: place && fitted(place, aspect), options };
    /** @type {Promise<Opened | undefined>} */
    const load = opening(nameOf(from), (onProgress) => ask("load", data, onProgress));
    sceneLoading = load;
    const now = await load;
    if (!now) return;
    if (around !== undefined) panorama = { source: around, name: now.scene.environment.panorama };
    else panorama = null;
    surroundings.value = options.surroundings;
    showOpened(now, from, place ?? now.scene.camera);
    if (!place && aspect < 1) sendCamera(false);
}

/** Shows the properties of a newly opened scene.
 * @param {Opened} now @param {Source} from @param {Camera} place */
function showOpened(now, from, place) {
    [opened, source, chosen, camera] = [now, from, undefined, place];
    clearReports();
    showScene(now.scene, typeof from === "string" ? from : "", (call, data) => void attempt(ask(call, data)));
    cameras.open(now.scene, typeof from === "string" ? from : now.scene.name);
    showAll(now);
    announce(`${now.scene.name} is loaded: ${byId("facts").textContent}`);
}

/** Shows everything that may have changed in the open scene.
 * @param {{ scene: Opened["scene"], materials: Opened["materials"], settings: Settings }} now */
function showAll({ scene, materials, settings }) {
    if (!opened) return;
    Object.assign(opened, { materials });
    Object.assign(opened.scene, { lights: scene.lights, objects: scene.objects, voxels: scene.voxels });
    showFacts(opened.scene);
    showAllObjects();
    showAllLights(scene.lights);
    showSurroundings(scene.environment);
    showAllMaterials();
    showSettings(settings);
}

/** Runs lines of the console.
 * @param {string} line */
async function run(line) {
    const busy = loading(`Running ${line}`, () => void client.call("cancel"));
    /** @type {Ran | undefined} */
    const ran = await attempt(ask("run", line, busy.progress));
    busy.end();
    if (!ran) return;
    lines.print(ran.text);
    lines.print(ran.failed ?? "", "failed");
    for (const file of ran.files) save(file, file.name);
    const { scene, opened: from } = ran;
    for (const name of Object.keys(ran.settings)) if (!same(ran.settings[name], settings[name])) touched.add(name);
    if (ran.preset !== preset) showPreset(ran.preset, ran.settings);
    if (!scene) return showSettings(ran.settings);
    if (from === undefined) {
        showAll({ ...ran, scene });
        camera = ran.camera ?? camera;
    } else {
        panorama = null;
        if (state() === "empty") state("rendering");
        showOpened({ ...ran, scene }, from, ran.camera ?? scene.camera);
    }
}

/** Puts a panorama around the scene, after waiting for a scene that is being loaded.
 * @param {Source} from */
async function surround(from) {
    await sceneLoading;
    const now = await opening(nameOf(from), (onProgress) => ask("panorama", from, onProgress));
    if (!now || !opened) return;
    panorama = { source: from, name: now.environment.panorama };
    showSurroundings(now.environment);
    showAllLights(now.lights);
    announce(`${now.environment.panorama} is around the scene`);
}

/** True while `panorama` surrounds the scene. */
const isPanoramaThere = () => panorama !== null && opened?.scene.environment.panorama === panorama.name;

/** @param {Environment} environment */
function showSurroundings(environment) {
    if (!opened) return;
    opened.scene.environment = environment;
    if (isPanoramaThere()) surroundings.value = "panorama";
    else if (surroundings.value === "panorama") surroundings.value = "auto";
    showEnvironment(environment, (change) => void attempt(ask("environment", change)));
}

function showAllObjects() {
    showObjects(opened?.scene.objects ?? [], (object, hidden) => void attempt(ask("hide", { object, hidden })));
    showChosen(chosen?.object);
}

/** Undoes the last change, or redoes it.
 * @param {"undo" | "redo"} way */
async function step(way) {
    if (!opened || byId(way, HTMLButtonElement).disabled) return;
    /** @type {Stepped | undefined} */
    const now = await attempt(ask(way, null));
    if (!now) return;
    showAll(now);
    announce(`${way === "undo" ? "Taken back" : "Done again"}: ${now.words}`);
}

function showAllMaterials() {
    const change = (/** @type {number} */ index, /** @type {object} */ change) => void attempt(ask("material", { index, change }));
    showMaterials(opened?.materials ?? [], chosen?.material, change);
}

/** @param {Picked | undefined} object */
function choose(object) {
    chosen = object;
    showChosen(object?.object);
    showAllMaterials();
    announce(object && opened ? `${opened.scene.objects[object.object].name} is selected` : "Nothing is selected");
}

/** Selects the object at a place of the picture, and looks at it; with Shift, frames all of it.
 * @param {MouseEvent} event */
async function pick({ clientX, clientY, shiftKey }) {
    if (!opened) return;
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const { number } = opened;
    /** @type {Picked | undefined} */
    const found = await attempt(client.call("pick", { x: (clientX - left) / width, y: (clientY - top) / height }));
    if (number !== opened?.number || !camera) return;
    choose(found);
    if (found) moveTo(shiftKey ? frame(camera, found.bounds) : lookAt(camera, found.position), false);
}

/** @param {boolean} isMoving */
function sendCamera(isMoving) {
    if (camera && opened) void attempt(ask("camera", { camera: fitted(camera, aspect), number: opened.number, isMoving }));
}

/** @param {Camera} to @param {boolean} isMoving */
function moveTo(to, isMoving) {
    camera = to;
    sendCamera(isMoving);
}

function listenForCamera() {
    new Controls(canvas, () => (camera && opened ? { camera, scene: opened.scene } : null), (to) => moveTo(to, true));
    surroundings.addEventListener("change", () => source && void open(source, camera ?? undefined));
    canvas.addEventListener("dblclick", (event) => void pick(event));
    canvas.addEventListener("keydown", ({ code, ctrlKey, metaKey, altKey }) => {
        if (ctrlKey || metaKey || altKey) return;
        if (code === "Home") void cameras.home();
        if (code === "KeyF" && camera && opened) moveTo(frame(camera, chosen?.bounds ?? opened.scene.bounds), false);
        if (code === "Escape" && chosen) choose(undefined);
    });
}

/** @param {Light[]} lights */
function showAllLights(lights) {
    if (!opened) return;
    opened.scene.lights = lights;
    const change = (/** @type {number} */ index, /** @type {Light} */ light) => void attempt(ask("light", { index, light }));
    showLights(lights, catalogue.lights, change, async (index) => {
        const left = await attempt(ask("removeLight", index));
        if (left) showAllLights(/** @type {Light[]} */ (left));
    });
}

async function addLight(/** @type {string} */ kind) {
    const lights = opened && await attempt(ask("addLight", kind));
    if (lights) showAllLights(/** @type {Light[]} */ (lights));
}

// --- Settings ------------------------------------------------------------------------------------

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
    const now = await attempt(ask(call, data, busy.progress));
    busy.end();
    if (now && opened && now.voxels !== undefined) {
        opened.scene.voxels = now.voxels;
        showFacts(opened.scene);
    }
    showSettings(now?.settings ?? settings);
    return now !== undefined;
}

/** @param {Settings} changes */
async function set(changes) {
    const isSet = await change("set", changes);
    if (isSet) for (const name of Object.keys(changes)) touched.add(name);
    return isSet;
}

/** @param {string} name */
async function setPreset(name) {
    const before = settings;
    if (!(await change("preset", name))) return false;
    showPreset(name, settings, before);
    return true;
}

/** Shows a preset; the reset buttons restore its values.
 * @param {string} name @param {Settings} now @param {Settings} [before] */
function showPreset(name, now, before = settings) {
    preset = name;
    presetList.show(name);
    fields.usual = Object.fromEntries(
        catalogue.parameters.map(({ name, default: first }) => [name, same(now[name], before[name]) ? first : now[name]]),
    );
    fields.show(now);
}

/** The content of a link to the present state. */
function link() {
    const scale = byId("scale", HTMLInputElement).valueAsNumber;
    const changed = { preset: preset === FIRST_PRESET ? undefined : preset, scale: scale === usualScale ? undefined : scale };
    const around = { panorama: isPanoramaThere() ? panorama?.source : null, environment: opened?.scene.environment };
    return linkState({ ...changed, ...around, source, camera, split: split?.value, settings, touched }, catalogue?.parameters ?? []);
}

async function savePicture() {
    /** @type {Blob | undefined} */
    const picture = await attempt(client.call("picture"));
    if (picture) download(picture, opened?.scene.name ?? "");
}

// --- Size ----------------------------------------------------------------------------------------

function resize() {
    const { clientWidth, clientHeight } = canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    const share = byId("scale", HTMLInputElement).valueAsNumber;
    byId("scale-value").textContent = plain(share);
    const scale = Math.min(devicePixelRatio * share, LARGEST_PX / Math.max(clientWidth, clientHeight));
    const [width, height] = [clientWidth, clientHeight].map((side) => Math.max(1, Math.round(side * scale)));
    void attempt(ask("resize", { width, height }));
    const isUpright = aspect < 1;
    aspect = clientWidth / clientHeight;
    if (isUpright || aspect < 1) sendCamera(false);
}

// --- Events of the worker ------------------------------------------------------------------------
function listenToWorker() {
    /** @type {{ end: () => void } | null} */
    let restoring = null;
    /** @type {FrameReport | undefined} */
    let last;
    const showStatus = () => {
        const complete = state() === "complete";
        if (last) byId("status").textContent = statusText({ ...last, complete }, performance.now() - waitedSince);
    };
    setInterval(showStatus, EVERY_MS);
    const probe = new Probe(canvas, (place) => opened ? client.call("probe", place) : Promise.resolve(undefined));
    const measure = () => attempt(followHistogram(() => client.call("histogram")));
    byId("picture-section").addEventListener("toggle", measure);
    client.on("frame", (/** @type {FrameReport} */ report) => {
        addReport(report);
        probe.look();
        showSteps(report);
        // The console may have changed the budget.
        const budget = byId("budget", HTMLInputElement);
        if (document.activeElement !== budget) budget.value = plain(report.budget_ms);
        byId("hint").hidden = !report.emission_alone;
        void measure();
        [last, waitedSince] = [report, performance.now()];
        if (asked === 0) {
            showTime(report.time_s);
            // The angle stays fitted to the window.
            if (camera && report.camera) camera = { ...camera, ...report.camera, vertical_fov_deg: camera.vertical_fov_deg };
        }
        showStatus();
        if (state() === "loading") return;
        if (report.warning !== undefined && report.warning !== warned) {
            say(`${report.warning}: choose other surroundings, add a light, or set the exposure`, { kind: "note" });
        }
        warned = report.warning;
        const isComplete = report.complete && asked === 0;
        state(isComplete ? "complete" : "rendering");
        showStatus();
        if (isComplete) void attempt(client.call("memory")).then((memory) => memory && showMemory(/** @type {Memory[]} */ (memory)));
    });
    const endRestoring = () => {
        restoring?.end();
        restoring = null;
    };
    client.on("error", (error) => {
        endRestoring();
        state("failed");
        fail(error);
    });
    client.on("lost", (reason) => {
        restoring ??= loading("Restoring the graphics device");
        say(`The graphics device was lost: ${reason}`, { kind: "note" });
        state("lost");
    });
    client.on("restored", () => {
        endRestoring();
        announce("The graphics device is restored");
        state("rendering");
    });
}

// --- Start ---------------------------------------------------------------------------------------

function fillPanel() {
    fields = new Parameters(catalogue.parameters, (name, value) => void set({ [name]: value }));
    const views = catalogue.parameters.find(({ name }) => name === "view")?.choices ?? [];
    split = new SplitLine(views, (now) => void attempt(ask("split", now)), (view) => void set({ view }));
    presetList = radios("preset", "Preset", catalogue.presets, async (name) => {
        if (!(await setPreset(name))) presetList.show(preset);
    }, byId("presets"));
    presetList.show(preset);
    lines = new Console(run, (line) => client.call("complete", line));
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
    byId("add-light").append(...catalogue.lights.map(({ word, summary }) =>
        h("button", { "data-add": word, title: summary, click: () => void addLight(word) }, title(word))));
    byId("scale").addEventListener("input", resize);
    const budget = byId("budget", HTMLInputElement);
    budget.addEventListener("change", () => {
        if (budget.validity.valid) void attempt(ask("budget", budget.valueAsNumber));
    });
}

/** Applies a link's intensity and rotation to the panorama. @param {LinkState} linked */
async function turnSurroundings({ environment_intensity: factor = 1, environment_rotation: rotation_deg = 0 }) {
    if (!opened) return;
    await attempt(ask("environment", { radiance: [factor, factor, factor], rotation_deg }));
    showSurroundings({ ...opened.scene.environment, radiance: [factor, factor, factor], rotation_deg });
}

/** The files that were dropped on the first page, which opened this one. */
async function droppedBefore() {
    if (location.search !== DROPPED) return [];
    // They are gone after a reload.
    history.replaceState(null, "", location.pathname + location.hash);
    return (await attempt(take())) ?? [];
}

async function start() {
    byId("scale", HTMLInputElement).value = String(usualScale);
    // Hide the panel on phones.
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
        const { code = "", message } = error instanceof WorkerError ? error : { message: String(error) };
        const isKnown = showUnsupported(code, message);
        state(isKnown ? "unsupported" : "failed");
        return isKnown || fail(error);
    } finally {
        busy.end();
    }
    fillPanel();
    const { state: linked, problems } = decode(location.hash, catalogue);
    if (problems.length > 0) say(`The link has an error: ${problems.join("; ")}. The rest is shown.`);
    if (linked.scale !== undefined) byId("scale", HTMLInputElement).value = String(linked.scale);
    new ResizeObserver(resize).observe(canvas);
    matchMedia(`(resolution: ${devicePixelRatio}dppx)`).addEventListener("change", resize);
    listenForCamera();
    listenToTools({ picture: () => void savePicture(), link: () => void copyLink(link()), undo: () => void step("undo"), redo: () => void step("redo"), "console-toggle": () => lines.show() });
    // Releasing a slider or entering a number ends a step of undo.
    addEventListener("change", () => void client.call("endGesture"), true);
    listenForFiles((files) => void open(files), (text) => say(text));
    addEventListener("hashchange", () => location.reload());
    resize();
    if (linked.preset !== undefined && (await setPreset(linked.preset))) presetList.show(preset);
    // One request each, so that a refusal names its setting; loading the scene applies all of them.
    await Promise.all(Object.entries(linked.settings).map(([name, value]) => set({ [name]: value })));
    if (linked.split) {
        split.show(linked.split);
        void attempt(ask("split", linked.split));
    }
    const dropped = await droppedBefore();
    if (dropped.length > 0 && !isPanorama(dropped)) await open(dropped);
    if (!opened) await open(linked.scene ?? `builtin:${catalogue.scenes[0].name}`, linked.camera, linked.environment);
    if (linked.environment !== undefined) await turnSurroundings(linked);
    // Fall back to a built-in scene if the link's fails.
    if (!opened && linked.scene !== undefined) await open(`builtin:${catalogue.scenes[0].name}`);
    if (isPanorama(dropped)) await surround(dropped);
}

void start().catch(fail);
