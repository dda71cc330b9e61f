// @ts-check
// Small helpers for elements, and the rows that settings and lights are made of.

/** @typedef {Record<string,
 *   string | number | boolean | EventListener | ((event: any) => void)>} Attributes */

/** Makes an element. Functions become listeners; false attributes are left out. Text is never
 * parsed as HTML.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag @param {Attributes} attributes @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[T]} */
export function h(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (typeof value === "function") element.addEventListener(name, value);
        else if (value !== false) element.setAttribute(name, value === true ? "" : String(value));
    }
    element.append(...children);
    return element;
}

/** The page's element with this id.
 * @template {HTMLElement} [T=HTMLElement]
 * @param {string} id @param {new () => T} [type] @returns {T} */
export function byId(id, type) {
    const element = document.getElementById(id);
    if (!(element instanceof (type ?? HTMLElement))) throw new Error(`the page has no ${id}`);
    return /** @type {T} */ (element);
}

/** A button with an icon of the page.
 * @param {string} icon @param {string} label @param {() => void} click */
export function iconButton(icon, label, click) {
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.setAttribute("aria-hidden", "true");
    const use = document.createElementNS("http://www.w3.org/2000/svg", "use");
    use.setAttribute("href", `#icon-${icon}`);
    svg.append(use);
    return h("button", { class: "plain", "aria-label": label, title: label, click }, svg);
}

/** A name as a label: "shadow_resolution" becomes "Shadow resolution".
 * @param {string} name */
export function title(name) {
    const words = name.replace(/[_-]/g, " ");
    return words.charAt(0).toUpperCase() + words.slice(1);
}

/** A number in at most six digits, the precision of a single float.
 * @param {number} value */
export const plain = (value) => String(Number(value.toPrecision(6)));

/** @param {number} value */
export const grouped = (value) => value.toLocaleString("en").replace(/,/g, "\u202f");

/** @param {number} bytes */
export const mebibytes = (bytes) => `${(bytes / 1048576).toFixed(bytes < 10485760 ? 1 : 0)} MiB`;

/** A number field that reports only finite numbers. It has `data-typing` while the user types.
 * @param {Attributes} attributes @param {(value: number) => void} change */
export function numberInput(attributes, change) {
    const input = h("input", { type: "number", step: "any", ...attributes });
    input.addEventListener("input", () => (input.dataset.typing = ""));
    for (const end of ["change", "blur"]) input.addEventListener(end, () => delete input.dataset.typing);
    input.addEventListener("change", () => {
        if (Number.isFinite(input.valueAsNumber)) change(input.valueAsNumber);
    });
    return input;
}

/** A number field with a value.
 * @param {number} value @param {(value: number) => void} change @param {Attributes} [attributes] */
export function number(value, change, attributes = {}) {
    const input = numberInput(attributes, change);
    input.value = plain(value);
    return input;
}

/** A slider with a number field beside it.
 * @param {string} label @param {number} value
 * @param {{ min?: number, max: number, step?: number }} range
 * @param {(value: number) => void} change */
export function slider(label, value, { min = 0, max, step = 0.01 }, change) {
    const range = h("input", { type: "range", min, max, step: "any", "aria-label": label });
    range.value = String(value);
    const field = number(value, (now) => {
        range.value = String(now);
        change(now);
    }, { step, min, max, class: "short" });
    range.addEventListener("input", () => {
        field.value = String(Number(range.valueAsNumber.toFixed(2)));
        change(Number(field.value));
    });
    return h("span", { class: "pair" }, range, field);
}

/** Fills a list with options, and selects one.
 * @param {HTMLSelectElement} select @param {{ value: string, label: string }[]} options
 * @param {string} chosen */
export function fillSelect(select, options, chosen) {
    select.replaceChildren(...options.map(({ value, label }) => h("option", { value }, label)));
    select.value = chosen;
}

/** A row of name and field.
 * @param {string} label @param {string} unit @param {HTMLElement} field
 * @param {HTMLElement[]} more */
export function row(label, unit, field, ...more) {
    // The label names the number field, if any; other fields have their own.
    const named = field.querySelector(`input[type="number"]:not([aria-label])`) ?? field;
    named.id ||= `field-${(last += 1)}`;
    const name = h("label", { for: named.id }, label);
    if (unit) name.append(" ", h("small", {}, unit));
    return h("div", { class: "row" }, name, field, ...more);
}

let last = 0;
