// @ts-check
// The scene's materials, with the same properties as in the window.

import { apart, hex, linear } from "./color.js";
import { byId, h, number, row, slider } from "./dom.js";

/** @typedef {import("./types.js").Material} Material */
/** @typedef {import("./types.js").MaterialChange} MaterialChange */
/** @typedef {import("./types.js").Vec3} Vec3 */
/** @typedef {(number: number, change: MaterialChange) => void} Change */

/** Materials beyond this many are only listed for the chosen object. */
const MOST = 60;

/** Numbers that have a slider: label and highest value.
 * @type {["metallic" | "roughness" | "specular" | "shininess", string, number][]} */
const SLIDERS = [["metallic", "Metallic", 1], ["roughness", "Roughness", 1], ["specular", "Specular", 1], ["shininess", "Shininess", 256]];

/** Fields for all materials; the selected object's is first and open.
 * @param {Material[]} materials @param {number | undefined} chosen @param {Change} change */
export function showMaterials(materials, chosen, change) {
    const list = byId("materials");
    const opened = new Set([...list.querySelectorAll("details[open]")].map((details) => details.getAttribute("data-number")));
    const order = materials.map((_, index) => index).filter((index) => index !== chosen).slice(0, MOST);
    if (chosen !== undefined && materials[chosen]) order.unshift(chosen);
    list.replaceChildren(...order.map((index) => {
        const open = index === chosen || opened.has(String(index));
        return one(materials[index], index, open, (changes) => {
            Object.assign(materials[index], changes);
            change(index, changes);
        });
    }));
    const more = materials.length - order.length;
    if (more > 0) list.append(h("p", { class: "weak" }, `and ${more} more: double-click an object`));
}

/** @param {Material} material @param {number} index @param {boolean} open
 * @param {(change: MaterialChange) => void} change */
function one(material, index, open, change) {
    const name = material.name || `material ${index + 1}`;
    const dot = h("i", { class: "dot" });
    const paint = () => (dot.style.background = hex(material.color, 1));
    paint();
    const color = colorField(material.color, (color) => {
        change({ color });
        paint();
    });
    if (material.textured) color.title = "Multiplies the texture";
    const fields = h("div", {}, row("Colour", "", color));
    for (const [property, label, max] of SLIDERS) {
        const value = material[property];
        if (value !== undefined) fields.append(row(label, "", slider(label, value, { max }, (now) => change({ [property]: now }))));
    }
    if (material.specular_color) {
        fields.append(row("Specular colour", "", colorField(material.specular_color, (specular_color) => change({ specular_color }))));
    }
    fields.append(emission(material.emission, (emission) => change({ emission })));
    return h("details", { "data-number": index, open }, h("summary", {}, dot, name, " ", h("small", {}, material.shading.replace("-", " "))), fields);
}

/** @param {Vec3} color from 0 to 1 @param {(color: Vec3) => void} change */
function colorField(color, change) {
    const field = h("input", { type: "color", value: hex(color, 1) });
    field.addEventListener("input", () => change(linear(field.value)));
    return field;
}

/** A colour, and its strength in cd/m².
 * @param {Vec3} emission @param {(emission: Vec3) => void} change */
function emission(emission, change) {
    let { strength, color } = apart(emission);
    const tell = () => change(/** @type {Vec3} */ (color.map((part) => part * strength)));
    const tint = h("input", { type: "color", value: hex(color), "aria-label": "Colour of the emission" });
    tint.addEventListener("input", () => {
        color = apart(linear(tint.value)).color;
        tell();
    });
    const field = number(strength, (now) => {
        strength = now;
        tell();
    }, { min: 0 });
    return row("Emission", "cd/m²", h("span", { class: "pair" }, tint, field));
}
