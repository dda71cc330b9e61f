// @ts-check
// The scene's lights and objects.

import { hex, linear } from "./color.js";
import { byId, h, number, numberInput, plain, row } from "./dom.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").Light} Light */
/** @typedef {import("./types.js").SceneInfo} SceneInfo */
/** @typedef {import("./types.js").Vec3} Vec3 */
/** @typedef {NonNullable<Light["kind"]>} Kind */

/** The most objects that are listed; the filter finds the others. */
const MOST_OBJECTS = 200;

const KINDS = { directional: "sun", point: "point", spot: "spot" };

/** A new light: at the camera, as the console adds it.
 * @param {Kind} kind @param {Camera} camera
 * @param {number} count of existing lights @returns {Light} */
export function newLight(kind, camera, count) {
    const name = `${KINDS[kind]} ${count + 1}`;
    /** @type {Vec3} */
    const down = [0, -1, 0];
    const [from, to] = [camera.position, camera.target];
    if (kind === "directional") return { name, kind, intensity: 100000, direction: down };
    const lamp = { name, kind, intensity: 100, position: from };
    if (kind === "point") return lamp;
    return { ...lamp, direction: [to[0] - from[0], to[1] - from[1], to[2] - from[2]], inner_cone_deg: 20, outer_cone_deg: 30 };
}

/** Fields for all lights. A change sends the whole light.
 * @param {Light[]} lights @param {(index: number, light: Light) => void} change
 * @param {(index: number) => void} remove */
export function showLights(lights, change, remove) {
    const list = byId("lights");
    const open = new Set([...list.querySelectorAll("details[open]")].map((details) => details.getAttribute("data-name")));
    list.replaceChildren(...lights.map((light, index) => lightFields(light, open.has(light.name ?? ""), (changes) => {
        Object.assign(light, changes);
        change(index, light);
    }, () => remove(index))));
    if (lights.length === 0) list.append(h("p", { class: "weak" }, "No lamps; light comes from emission and the surroundings."));
}

/** The properties of each kind besides colour and strength.
 * @type {Record<Kind, (keyof Light)[]>} */
const HEEDED = {
    directional: ["direction", "angular_radius_deg"],
    point: ["position", "radius_m", "range_m"],
    spot: ["position", "direction", "radius_m", "range_m", "inner_cone_deg", "outer_cone_deg"],
};

/** @type {[keyof Light, string, string][]} */
const NUMBERS = [
    ["angular_radius_deg", "Angular radius", "°"], ["radius_m", "Radius", "m"], ["range_m", "Range", "m"],
    ["inner_cone_deg", "Inner cone", "°"], ["outer_cone_deg", "Outer cone", "°"],
];

/** @param {Light} light @param {boolean} open @param {(changes: Partial<Light>) => void} change
 * @param {() => void} remove */
function lightFields(light, open, change, remove) {
    const { kind = "point", name = "", color: shown = [1, 1, 1], intensity = 0, position, direction } = light;
    const dot = h("i", { class: "dot" });
    const paint = () => (dot.style.background = hex(light.color ?? shown));
    paint();
    const color = h("input", { type: "color", value: hex(shown) });
    color.addEventListener("input", () => {
        const peak = Math.max(...(light.color ?? shown)) || 1;
        const [red, green, blue] = linear(color.value);
        change({ color: [red * peak, green * peak, blue * peak] });
        paint();
    });
    const fields = h("div", {},
        row("Colour", "", color),
        row("Strength", kind === "directional" ? "lux" : "cd", number(intensity, (intensity) => change({ intensity }))),
    );
    const isHeeded = (/** @type {keyof Light} */ property) => HEEDED[kind].includes(property);
    if (position && isHeeded("position")) fields.append(three("Position", "m", position, (position) => change({ position })));
    if (direction && isHeeded("direction")) fields.append(three("Direction", "", direction, (direction) => change({ direction })));
    for (const [property, label, unit] of NUMBERS) {
        const value = light[property];
        if (typeof value === "number" && isHeeded(property)) {
            fields.append(row(label, unit, number(value, (now) => change({ [property]: now }))));
        }
    }
    fields.append(h("div", { class: "pair" }, h("button", { click: remove }, `Remove ${name}`)));
    return h("details", { "data-name": name, open }, h("summary", {}, dot, name, " ", h("small", {}, KINDS[kind])), fields);
}

/** @param {string} label @param {string} unit @param {Vec3} vector
 * @param {(vector: Vec3) => void} change */
function three(label, unit, vector, change) {
    const now = /** @type {Vec3} */ ([...vector]);
    const inputs = ["x", "y", "z"].map((axis, index) => {
        const input = numberInput({ "aria-label": `${label} ${axis}`, step: 0.1 }, (value) => {
            now[index] = value;
            change([...now]);
        });
        input.value = plain(vector[index]);
        return input;
    });
    const name = h("span", {}, label);
    if (unit) name.append(" ", h("small", {}, unit));
    return h("div", { class: "row", role: "group", "aria-label": label }, name, h("span", { class: "pair" }, ...inputs));
}

/** Objects by name, each with a box that hides it.
 * @param {SceneInfo["objects"]} objects @param {(object: number, hidden: boolean) => void} hide */
export function showObjects(objects, hide) {
    const filter = byId("objects-filter", HTMLInputElement);
    const list = byId("objects");
    const show = () => {
        const wanted = filter.value.trim().toLowerCase();
        const found = objects.map((object, index) => ({ object, index })).filter(({ object }) => object.name.toLowerCase().includes(wanted));
        const boxes = found.slice(0, MOST_OBJECTS).map(({ object, index }) => {
            const box = h("input", { type: "checkbox", checked: !object.hidden });
            box.addEventListener("change", () => {
                object.hidden = !box.checked;
                hide(index, object.hidden);
            });
            return h("label", { class: "object", "data-object": index }, box, object.name || `object ${index + 1}`);
        });
        list.replaceChildren(...boxes);
        if (found.length > MOST_OBJECTS) list.append(h("p", { class: "weak" }, `and ${found.length - MOST_OBJECTS} more: filter by name`));
    };
    filter.oninput = show;
    show();
}
