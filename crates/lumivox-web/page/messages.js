// @ts-check
// Messages: errors that stay until they are closed, progress of loading, and announcements for
// screen readers.

import { byId, h, iconButton, title } from "./dom.js";
import { seconds } from "./status.js";

/** @typedef {import("./types.js").Progress} Progress */

/** The most messages; older ones are removed. */
const MOST = 4;
/** Shorter work shows no bar, ms. */
const PATIENCE_MS = 200;

/** Words for the renderer's stages. */
const STAGES = /** @type {Record<string, string>} */ ({
    fetching: "Fetching",
    reading: "Reading",
    compile: "Compiling shaders",
    upload: "Uploading",
    voxelize: "Voxelizing",
    light: "Lighting",
});

/** Shows a message until it is closed. An equal message replaces the first.
 * @param {string} text
 * @param {{ kind?: "error" | "note", action?: { label: string, run: () => void },
 *   link?: string }} options */
export function say(text, { kind = "error", action, link } = {}) {
    const list = byId("messages");
    for (const old of [...list.children]) if (old.getAttribute("data-text") === text) old.remove();
    const body = h("div", {}, h("p", {}, text));
    const message = h("div", { class: kind, "data-text": text }, body);
    if (link !== undefined) {
        const field = h("input", { readonly: true, value: link, "aria-label": "Link" });
        field.addEventListener("focus", () => field.select());
        body.append(field);
    }
    if (action) body.append(h("button", { click: () => (message.remove(), action.run()) }, action.label));
    message.append(iconButton("close", "Close the message", () => {
        message.remove();
        byId("canvas").focus({ preventScroll: true });
    }));
    list.append(message);
    while (list.children.length > MOST) list.firstElementChild?.remove();
}

/** Closes the newest message; false if there is none. */
export function closeNewest() {
    const newest = byId("messages").lastElementChild;
    newest?.remove();
    return newest !== null;
}

/** Announces a text to screen readers.
 * @param {string} text */
export function announce(text) {
    byId("live").textContent = text;
}

/** Stages in which loading can no longer be cancelled. */
const FINAL = new Set(["compile", "upload", "voxelize", "light"]);

let loadings = 0;

/** Shows the present work and its time after PATIENCE_MS. `end` must be called in every case.
 * @param {string} what @param {() => void} [cancel]
 * @returns {{ progress: (progress: Progress) => void, end: () => void }} */
export function loading(what, cancel) {
    loadings += 1;
    const start = performance.now();
    let text = what;
    const button = byId("loading-cancel");
    const show = () => {
        byId("loading-stage").textContent = text;
        byId("loading-time").textContent = seconds(performance.now() - start);
    };
    const bar = byId("loading-bar", HTMLProgressElement);
    bar.removeAttribute("value");
    show();
    button.hidden = !cancel;
    button.onclick = () => {
        text = `${what}: cancelling`;
        button.hidden = true;
        show();
        cancel?.();
    };
    const timer = setTimeout(() => (byId("loading").hidden = false), PATIENCE_MS);
    const clock = setInterval(show, 100);
    return {
        progress({ stage, done, total }) {
            text = `${what}: ${(STAGES[stage] ?? title(stage)).toLowerCase()}`;
            if (FINAL.has(stage)) button.hidden = true;
            if (total > 1) bar.value = done / total;
            else bar.removeAttribute("value");
            show();
        },
        end() {
            clearTimeout(timer);
            clearInterval(clock);
            loadings -= 1;
            if (loadings === 0) byId("loading").hidden = true;
        },
    };
}

/** Reasons for a missing renderer, by error code.
 * @type {Record<string, string>} */
const MISSING = {
    "no-webgpu": "This browser has no WebGPU",
    "no-adapter": "WebGPU finds no graphics adapter",
};

/** Shows a page for browsers without WebGPU; returns false for other errors.
 * @param {string} code @param {string} reason */
export function showUnsupported(code, reason) {
    if (!Object.hasOwn(MISSING, code)) return false;
    byId("unsupported-title").textContent = MISSING[code];
    byId("unsupported-reason").textContent = reason;
    byId("unsupported-http").hidden = isSecureContext;
    for (const id of ["stage", "panel"]) byId(id).hidden = true;
    byId("unsupported").hidden = false;
    return true;
}
