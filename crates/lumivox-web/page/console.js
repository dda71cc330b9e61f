// @ts-check
// The console: the same commands as in the window and in scripts.

import { byId, h } from "./dom.js";

/** @typedef {{ start: number, candidates: string[] }} Completion */

/** The most lines of the log. */
const MOST_LINES = 500;
/** The initial text of the prompt. */
const HELLO = "help lists all commands, help NAME tells about one; TAB completes, arrows bring lines back.";

export class Console {
    #place = byId("console");
    #log = byId("console-log");
    #line = byId("console-line", HTMLInputElement);
    /** @type {string[]} */
    #history = [];
    /** The line of the history that is shown. */
    #at = 0;
    #run;
    #complete;

    /** @param {(line: string) => Promise<void>} run
     * @param {(line: string) => Promise<Completion>} complete */
    constructor(run, complete) {
        this.#run = run;
        this.#complete = complete;
        this.print(HELLO);
        byId("console-form").addEventListener("submit", (event) => {
            event.preventDefault();
            void this.#enter();
        });
        this.#line.addEventListener("keydown", (event) => this.#key(event));
        byId("console-close").addEventListener("click", () => this.show(false));
    }

    /** Shows and focuses the console, or hides it.
     * @param {boolean} isOpen */
    show(isOpen = this.#place.hidden) {
        this.#place.hidden = !isOpen;
        byId("console-toggle").setAttribute("aria-expanded", String(isOpen));
        (isOpen ? this.#line : byId("canvas")).focus();
    }

    /** @param {string} text @param {"said" | "typed" | "failed"} kind */
    print(text, kind = "said") {
        if (text === "") return;
        this.#log.append(h("p", { class: kind }, text));
        while (this.#log.children.length > MOST_LINES) this.#log.firstElementChild?.remove();
        this.#log.scrollTop = this.#log.scrollHeight;
    }

    async #enter() {
        const line = this.#line.value.trim();
        this.#line.value = "";
        if (line === "") return;
        if (this.#history.at(-1) !== line) this.#history.push(line);
        this.#at = this.#history.length;
        this.print(line, "typed");
        await this.#run(line);
    }

    /** @param {KeyboardEvent} event */
    #key(event) {
        if (event.key === "Escape") this.show(false);
        else if (event.key === "ArrowUp") this.#recall(-1);
        else if (event.key === "ArrowDown") this.#recall(1);
        // In an empty prompt, Tab moves the focus as usual.
        else if (event.key === "Tab" && !event.shiftKey && this.#line.value !== "") void this.#finish();
        else return;
        event.preventDefault();
        event.stopPropagation();
    }

    /** @param {number} by */
    #recall(by) {
        this.#at = Math.min(Math.max(this.#at + by, 0), this.#history.length);
        this.#line.value = this.#history[this.#at] ?? "";
    }

    /** Completes the word at the cursor as far as it is unambiguous, and prints the candidates. */
    async #finish() {
        const { value } = this.#line;
        const cursor = this.#line.selectionStart ?? value.length;
        const { start, candidates } = await this.#complete(value.slice(0, cursor));
        if (candidates.length === 0 || this.#line.value !== value) return;
        const shared = candidates.reduce((one, other) => {
            let length = 0;
            while (length < one.length && one[length] === other[length]) length += 1;
            return one.slice(0, length);
        });
        const word = candidates.length === 1 ? `${shared} ` : shared;
        if (candidates.length > 1 && shared.length <= cursor - start) this.print(candidates.join("  "));
        this.#line.setRangeText(word, start, cursor, "end");
    }
}
