// @ts-check
// What the panel says of a scene: its name and size, cameras, animations, objects, and what was approximated.

import { byId, fillSelect, grouped, h } from "./dom.js";
import { showObjects } from "./lights.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").SceneInfo} SceneInfo */
/** @typedef {(call: string, data: unknown) => void} Tell to the worker */

/** The cameras that one can choose, the one of the beginning first.
 * @param {SceneInfo} scene @returns {Camera[]} */
export function cameraChoices({ camera, cameras }) {
    return [camera, ...cameras.filter(({ name }) => !name || name !== camera.name)];
}

/** @param {SceneInfo} scene @param {string} address @param {Tell} tell */
export function showScene(scene, address, tell) {
    byId("title").textContent = scene.name;
    document.title = `${scene.name} · Lumivox`;
    byId("canvas").setAttribute("aria-label", `Picture of ${scene.name}`);
    const scenes = byId("scene", HTMLSelectElement);
    scenes.value = [...scenes.options].some(({ value }) => value === address) ? address : "";
    scenes.options[0].textContent = scenes.value === "" ? scene.name : "a file or an address";
    showFacts(scene);
    const cameras = cameraChoices(scene).map(({ name }, index) => ({ value: String(index), label: name || `camera ${index + 1}` }));
    fillSelect(byId("camera", HTMLSelectElement), cameras, "0");
    showObjects(scene.objects, (object, hidden) => tell("hide", { object, hidden }));
    showNotes(scene.notes);
    showAnimations(scene, tell);
}

/** @param {SceneInfo} scene */
export function showFacts({ triangles, voxels, materials, lights }) {
    const facts = [[triangles, "triangle"], [voxels, "voxel"], [materials.length, "material"], [lights.length, "light"]];
    byId("facts").textContent = facts
        .filter(([count]) => count !== undefined)
        .map(([count, word]) => `${grouped(Number(count))} ${word}${count === 1 ? "" : "s"}`)
        .join(", ");
}

/** @param {string[]} notes */
function showNotes(notes) {
    const place = byId("notes", HTMLDetailsElement);
    place.hidden = notes.length === 0;
    const [summary, list] = place.children;
    summary.textContent = `${notes.length} ${notes.length === 1 ? "note" : "notes"} on what was chosen and approximated`;
    list.replaceChildren(...notes.map((note) => h("li", {}, note)));
}

/** @param {SceneInfo} scene @param {Tell} tell */
function showAnimations({ animations }, tell) {
    for (const id of ["animation-row", "time-row"]) byId(id).hidden = animations.length === 0;
    if (animations.length === 0) return;
    const select = byId("animation", HTMLSelectElement);
    fillSelect(select, animations.map(({ name }, index) => ({ value: String(index), label: name || `animation ${index + 1}` })), "0");
    const play = byId("play", HTMLButtonElement);
    const time = byId("time", HTMLInputElement);
    const show = (/** @type {boolean} */ isPlaying) => {
        play.setAttribute("aria-pressed", String(isPlaying));
        play.textContent = isPlaying ? "Pause" : "Play";
        time.max = String(animations[Number(select.value)].duration_s);
    };
    const set = (/** @type {boolean} */ isPlaying) => {
        show(isPlaying);
        tell("play", isPlaying ? Number(select.value) : null);
    };
    show(false);
    time.value = "0";
    play.onclick = () => set(play.getAttribute("aria-pressed") !== "true");
    select.onchange = () => set(true);
    time.oninput = () => {
        if (play.getAttribute("aria-pressed") === "true") set(false);
        tell("time", time.valueAsNumber);
    };
}
