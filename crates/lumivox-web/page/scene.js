// @ts-check
// The scene in the panel: its name and size, animations, objects, and notes of the loader.

import { byId, fillSelect, grouped, h } from "./dom.js";

/** @typedef {import("./types.js").SceneInfo} SceneInfo */
/** @typedef {(call: string, data: unknown) => void} Tell to the worker */

/** @param {SceneInfo} scene @param {string} address @param {Tell} tell */
export function showScene(scene, address, tell) {
    byId("title").textContent = scene.name;
    document.title = `${scene.name} · Lumivox`;
    byId("canvas").setAttribute("aria-label", `Picture of ${scene.name}`);
    const scenes = byId("scene", HTMLSelectElement);
    scenes.value = [...scenes.options].some(({ value }) => value === address) ? address : "";
    scenes.options[0].textContent = scenes.value === "" ? scene.name : "a file or an address";
    showFacts(scene);
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
    byId("time-value").textContent = "0.00";
    time.oninput = () => {
        if (play.getAttribute("aria-pressed") === "true") set(false);
        byId("time-value").textContent = time.valueAsNumber.toFixed(2);
        tell("time", time.valueAsNumber);
    };
}

/** Moves the slider along with the animation, unless the user drags it.
 * @param {number | undefined} seconds */
export function showTime(seconds) {
    const time = byId("time", HTMLInputElement);
    if (seconds === undefined || time.matches(":active")) return;
    time.value = String(seconds);
    byId("time-value").textContent = seconds.toFixed(2);
}

/** Marks the chosen object in the list, and brings it into view.
 * @param {number | undefined} object */
export function showChosen(object) {
    for (const label of byId("objects").querySelectorAll(".object")) {
        const isChosen = label.getAttribute("data-object") === String(object);
        label.toggleAttribute("aria-current", isChosen);
        if (isChosen) label.scrollIntoView({ block: "nearest" });
    }
}
