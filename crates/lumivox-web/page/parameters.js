// @ts-check
// The fields of all settings, from the renderer's table: name, unit, range, meaning, reset button.

import { byId, h, iconButton, numberInput, plain, title } from "./dom.js";

/** @typedef {import("./types.js").ParameterInfo} ParameterInfo */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Value} Value */
/** @typedef {{ info: ParameterInfo, show: (value: Value) => void, reset: HTMLElement }} Field */

/** Numbers in a range at most this wide have a slider. */
const WIDEST_SLIDER = 64;

export class Parameters {
    /** @type {Map<string, Field>} */
    #fields = new Map();
    /** The values that the reset buttons restore.
     * @type {Settings} */
    usual = {};

    /** @param {ParameterInfo[]} infos @param {(name: string, value: Value) => void} change */
    constructor(infos, change) {
        const panel = byId("panel");
        for (const info of infos) {
            this.usual[info.name] = info.default;
            const place = panel.querySelector(`[data-parameter="${info.name}"]`) ?? panel.querySelector(`[data-group="${info.group}"]`);
            const reset = iconButton("reset", `Reset ${info.name}`, () => change(info.name, this.usual[info.name]));
            const { row, show } = (info.name === "view" ? viewList : line)(info, (value) => change(info.name, value), reset);
            place?.append(row);
            this.#fields.set(info.name, { info, show, reset });
        }
        for (const group of panel.querySelectorAll("details")) {
            const place = group.querySelector("[data-group]");
            if (place && !group.querySelector(".row, [role=radiogroup], button")) group.hidden = true;
        }
    }

    /** Shows values, except in the field that the user types in.
     * @param {Settings} settings */
    show(settings) {
        for (const [name, { info, show, reset }] of this.#fields) {
            const value = settings[name];
            if (value === undefined) continue;
            show(value);
            const usual = this.usual[name];
            reset.hidden = same(value, usual);
            const text = typeof usual === "boolean" ? (usual ? "on" : "off") : String(usual);
            reset.title = `Back to ${text}`;
            reset.setAttribute("aria-label", `Reset ${title(info.name)} to ${text}`);
        }
    }
}

/** True if two values are equal, up to single-float precision; vectors may be given as text.
 * @param {Value} a @param {Value} b */
export function same(a, b) {
    return String(a) === String(b) || (typeof a === "number" && typeof b === "number" && plain(a) === plain(b));
}

/** @param {ParameterInfo} info @param {(value: Value) => void} change @param {HTMLElement} reset */
function line(info, change, reset) {
    const field = FIELDS[info.kind] ?? textField;
    const id = `set-${info.name}`;
    const { control, show } = field(info, change, id);
    const name = h("label", { for: id }, title(info.name));
    // Skip a unit that repeats the name.
    if (info.unit && info.unit !== info.name) name.append(" ", h("small", {}, info.unit));
    const hint = h("p", { class: "hint", id: `${id}-hint` }, hintText(info));
    const row = h("div", { class: "row", title: hintText(info) }, name, control, reset, hint);
    for (const input of row.querySelectorAll("input, select")) input.setAttribute("aria-describedby", hint.id);
    return { row, show };
}

/** @param {ParameterInfo} info */
function hintText(info) {
    const { min, max, unit, words: names = [] } = info;
    const range = min === undefined || max === undefined ? "" : ` ${plain(min)} to ${plain(max)}${unit ? ` ${unit}` : ""}`;
    const words = names.map((name, index) => (range || index ? ` or ${name}` : ` ${name}`)).join("");
    return `${info.summary}.${range || words ? `${range}${words}.` : ""}`;
}

/** @param {ParameterInfo} info @param {(value: Value) => void} change @param {string} id */
function switchField(info, change, id) {
    const control = h("input", { type: "checkbox", id });
    control.addEventListener("change", () => change(control.checked));
    return { control, show: (/** @type {Value} */ value) => void (control.checked = value === true) };
}

/** @param {ParameterInfo} info @param {(value: Value) => void} change @param {string} id */
function choiceField(info, change, id) {
    const options = (info.choices ?? []).map((name) => h("option", { value: name }, title(name).toLowerCase()));
    const control = h("select", { id }, ...options);
    control.addEventListener("change", () => change(control.value));
    return { control, show: (/** @type {Value} */ value) => void (control.value = String(value)) };
}

/** A text field, for vectors and unknown kinds.
 * @param {ParameterInfo} info @param {(value: Value) => void} change @param {string} id */
function textField(info, change, id) {
    const control = h("input", { id, autocomplete: "off", spellcheck: "false" });
    control.addEventListener("change", () => change(control.value.trim()));
    return { control, show: (/** @type {Value} */ value) => void (control.value = String(value)) };
}

/** @param {ParameterInfo} info @param {(value: Value) => void} change @param {string} id */
function numberField(info, change, id) {
    const { min = -Infinity, max = Infinity } = info;
    const span = max - min;
    const step = info.kind === "whole" ? (info.multiple ?? 1) : span <= 1 ? 0.01 : span <= WIDEST_SLIDER ? 0.1 : 0.5;
    const input = numberInput({ id, step }, change);
    const control = h("span", { class: "pair" }, input);
    /** @type {HTMLInputElement | undefined} */
    let slider;
    if (span <= WIDEST_SLIDER && !info.words?.length) {
        slider = h("input", { type: "range", min, max, step: info.kind === "whole" ? step : "any", "aria-label": title(info.name) });
        const slide = slider;
        slide.addEventListener("input", () => {
            input.value = plain(slide.valueAsNumber);
            change(Number(input.value));
        });
        input.classList.add("short");
        control.prepend(slide);
    }
    /** @type {HTMLButtonElement | undefined} */
    let word;
    const [text] = info.words ?? [];
    if (text !== undefined) {
        word = h("button", { "aria-pressed": "false", "aria-label": `${title(info.name)}: ${text}`, click: () => change(text) }, text);
        control.append(word);
    }
    const show = (/** @type {Value} */ value) => {
        const isNumber = typeof value === "number";
        if (!("typing" in input.dataset)) input.value = isNumber ? plain(value) : "";
        input.placeholder = isNumber ? "" : "–";
        if (slider && isNumber && document.activeElement !== slider) slider.value = String(value);
        word?.setAttribute("aria-pressed", String(!isNumber));
    };
    return { control, show };
}

/** The field for a kind of value; other kinds have a text field.
 * @type {Record<string, typeof switchField | typeof choiceField | typeof numberField>} */
const FIELDS = { switch: switchField, choice: choiceField, whole: numberField, number: numberField };

/** The views as radio buttons, without a reset button.
 * @param {ParameterInfo} info @param {(value: Value) => void} change */
function viewList(info, change) {
    const { group, show } = radios("view", title(info.name), (info.choices ?? []).map((name) => ({ name, title: name.replace(/-/g, " ") })), change);
    return { row: group, show: (/** @type {Value} */ value) => show(String(value)) };
}

/** Radio buttons that look like chips.
 * @param {string} name @param {string} label
 * @param {{ name: string, title: string, summary?: string }[]} choices
 * @param {(name: string) => void} change @param {HTMLElement} group */
export function radios(name, label, choices, change, group = h("div", { class: "chips", role: "radiogroup", "aria-label": label })) {
    const inputs = choices.map((choice) => {
        const input = h("input", { type: "radio", name, value: choice.name });
        input.addEventListener("change", () => change(choice.name));
        group.append(h("label", { title: choice.summary ?? "" }, input, h("span", {}, choice.title)));
        return input;
    });
    return { group, show: (/** @type {string} */ chosen) => inputs.forEach((input) => (input.checked = input.value === chosen)) };
}
