// @ts-check
// The split: a handle over the picture, and the view to its right.

import { byId, fillSelect } from "./dom.js";

/** @typedef {import("./types.js").Split} Split */

/** The steps of the arrow keys, and of Page Up and Page Down, as shares of the width. */
const [STEP, LEAP] = [0.02, 0.1];

export class SplitLine {
    /** @type {Split | null} */
    #split = null;
    #handle = byId("split");
    #compare = byId("compare", HTMLSelectElement);
    #left = "final";
    #change;
    #setView;

    /** @param {string[]} views @param {(split: Split | null) => void} change
     * @param {(view: string) => void} setView */
    constructor(views, change, setView) {
        this.#change = change;
        this.#setView = setView;
        const options = [{ value: "", label: "nothing" }, { value: "reference", label: "reference" }];
        fillSelect(this.#compare, [...options, ...views.map((view) => ({ value: view, label: view.replace(/-/g, " ") }))], "");
        this.#compare.addEventListener("change", () => this.#compareWith(this.#compare.value));
        byId("compare-indirect").addEventListener("click", () => this.#toggle("direct", "final"));
        byId("compare-reference").addEventListener("click", () => this.#toggle("final", "reference"));
        this.#handle.addEventListener("keydown", (event) => this.#key(event));
        this.#handle.addEventListener("pointerdown", (event) => {
            if (event.button !== 0) return;
            this.#handle.setPointerCapture(event.pointerId);
        });
        this.#handle.addEventListener("pointermove", (event) => {
            if (!this.#handle.hasPointerCapture(event.pointerId)) return;
            const { left, width } = byId("canvas").getBoundingClientRect();
            this.#moveTo((event.clientX - left) / width);
        });
    }

    get value() {
        return this.#split;
    }

    /** Shows a split without sending an event.
     * @param {Split | null} split */
    show(split) {
        this.#split = split;
        this.#handle.hidden = split === null;
        this.#compare.value = split?.right ?? "";
        const isPressed = (/** @type {string} */ left, /** @type {string} */ right) => String(this.#left === left && split?.right === right);
        byId("compare-indirect").setAttribute("aria-pressed", isPressed("direct", "final"));
        byId("compare-reference").setAttribute("aria-pressed", isPressed("final", "reference"));
        if (!split) return;
        const percent = Math.round(split.at * 100);
        const right = split.right.replace(/-/g, " ");
        this.#handle.style.left = `${split.at * 100}%`;
        this.#handle.setAttribute("aria-valuenow", String(percent));
        this.#handle.setAttribute("aria-valuetext", `${this.#left} on the left ${percent} %, ${right} on the right`);
        byId("split-left").textContent = this.#left;
        byId("split-right").textContent = right;
    }

    /** Sets the left view, which is the view of the settings.
     * @param {string} view */
    showLeft(view) {
        this.#left = view.replace(/-/g, " ");
        this.show(this.#split);
    }

    /** @param {string} right */
    #compareWith(right) {
        this.show(right === "" ? null : { right, at: this.#split?.at ?? 0.5 });
        this.#change(this.#split);
    }

    /** @param {string} left @param {string} right */
    #toggle(left, right) {
        const isOn = this.#left === left && this.#split?.right === right;
        if (!isOn && this.#left !== left) this.#setView(left);
        // Ending the split would leave only the left view: show all light instead.
        if (isOn && left !== "final") this.#setView("final");
        this.#compareWith(isOn ? "" : right);
    }

    /** @param {number} at */
    #moveTo(at) {
        if (!this.#split) return;
        this.show({ ...this.#split, at: Math.min(1, Math.max(0, at)) });
        this.#change(this.#split);
    }

    /** @param {KeyboardEvent} event */
    #key(event) {
        const at = this.#split?.at ?? 0.5;
        const place = /** @type {Record<string, number>} */ ({
            ArrowLeft: at - STEP,
            ArrowDown: at - STEP,
            ArrowRight: at + STEP,
            ArrowUp: at + STEP,
            PageDown: at - LEAP,
            PageUp: at + LEAP,
            Home: 0,
            End: 1,
        })[event.key];
        if (place === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        this.#moveTo(place);
    }
}
