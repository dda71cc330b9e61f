// @ts-check
// The scene's lights and objects.

import { hex, linear } from "./color.js";
import { byId, h, number, numberInput, plain, row } from "./dom.js";

/** @typedef {import("./types.js").Light} Light */
/** @typedef {import("./types.js").LightKindInfo} LightKindInfo */
/** @typedef {import("./types.js").SceneInfo} SceneInfo */
/** @typedef {import("./types.js").Vec3} Vec3 */

/** The most objects that are listed; the filter finds the others. */
const MOST_OBJECTS = 200;

/** Fields for all lights. A change sends the whole light.
 * @param {Light[]} lights @param {LightKindInfo[]} kinds
 * @param {(index: number, light: Light) => void} change @param {(index: number) => void} remove */
export function showLights(lights, kinds, change, remove) {
    const list = byId("lights");
    const open = new Set([...list.querySelectorAll("details[open]")].map((details) => details.getAttribute("data-name")));
    list.replaceChildren(...lights.flatMap((light, index) => {
        const kind = kinds.find(({ name }) => name === light.kind);
        const changed = (/** @type {Partial<Light>} */ changes) => change(index, Object.assign(light, changes));
        return kind ? [lightFields(light, kind, open.has(light.name ?? ""), changed, () => remove(index))] : [];
    }));
    if (lights.length === 0) list.append(h("p", { class: "weak" }, "No lamps; light comes from emission and the surroundings."));
}

/** @param {Light} light @param {LightKindInfo} kind @param {boolean} open
 * @param {(changes: Partial<Light>) => void} change @param {() => void} remove */
function lightFields(light, kind, open, change, remove) {
    const { name = "", color: shown = [1, 1, 1] } = light;
    const dot = h("i", { class: "dot" });
    const paint = () => (dot.style.background = hex(light.color ?? shown));
    paint();
    const colorField = () => {
        const color = h("input", { type: "color", value: hex(shown) });
        color.addEventListener("input", () => {
            const peak = Math.max(...(light.color ?? shown)) || 1;
            const [red, green, blue] = linear(color.value);
            change({ color: [red * peak, green * peak, blue * peak] });
            paint();
        });
        return color;
    };
    const fields = kind.fields.map(({ key, title, unit, is_color: isColor, parts, optional }) => {
        const value = /** @type {Record<string, number | Vec3 | null>} */ (/** @type {unknown} */ (light))[key];
        if (isColor) return row(title, unit, colorField());
        if (parts.length > 0) {
            // If all are 0, an optional field is null.
            const put = (/** @type {Vec3} */ now) => change({ [key]: optional && now.every((part) => part === 0) ? null : now });
            return three(title, unit, /** @type {Vec3} */ (value ?? [0, 0, 0]), put, parts);
        }
        const put = (/** @type {number} */ now) => change({ [key]: optional && now === 0 ? null : now });
        return row(title, unit, number(Number(value ?? 0), put, optional ? { title: "0 is none" } : {}));
    });
    fields.push(h("div", { class: "pair" }, h("button", { click: remove }, `Remove ${name}`)));
    return h("details", { "data-name": name, open }, h("summary", {}, dot, name, " ", h("small", {}, kind.word)), h("div", {}, ...fields));
}

/** @param {string} label @param {string} unit @param {Vec3} vector
 * @param {(vector: Vec3) => void} change @param {string[]} parts */
function three(label, unit, vector, change, parts) {
    const now = /** @type {Vec3} */ ([...vector]);
    const inputs = parts.map((axis, index) => {
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
