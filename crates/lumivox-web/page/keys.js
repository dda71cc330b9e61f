// @ts-check
// The tool bar's buttons and their keys.

import { byId } from "./dom.js";
import { closeNewest, say } from "./messages.js";

/** Fields with an undo of their own. */
const TYPED = `input:not([type="range"], [type="checkbox"], [type="radio"], [type="color"])`;

/** Letters that press a button. */
const SHORTCUTS = /** @type {Record<string, string>} */ ({ c: "console-toggle", o: "open", p: "picture", l: "link", "?": "help" });

/** @param {boolean} isOpen */
export function showPanel(isOpen) {
    byId("panel").hidden = !isOpen;
    byId("panel-toggle").setAttribute("aria-expanded", String(isOpen));
}

/** Toggles full screen; entering it hides the panel. */
async function toggleFullScreen() {
    if (document.fullscreenElement) return document.exitFullscreen();
    await document.documentElement.requestFullscreen();
    showPanel(false);
}

/** Updates the button; restores the panel when full screen ends.
 * @param {boolean} hadPanel true if the panel was shown before */
function followFullScreen(hadPanel) {
    const isFull = document.fullscreenElement !== null;
    byId("fullscreen").setAttribute("aria-pressed", String(isFull));
    if (!isFull) showPanel(hadPanel);
}

/** Shows what can be undone and redone.
 * @param {{ undo?: string, redo?: string }} report */
export function showSteps({ undo, redo }) {
    for (const [id, what, keys] of [["undo", undo, "Ctrl + Z"], ["redo", redo, "Ctrl + Shift + Z"]]) {
        const button = byId(String(id), HTMLButtonElement);
        const name = id === "undo" ? "Undo" : "Redo";
        button.disabled = what === undefined;
        button.title = what === undefined ? `${name}: nothing (${keys})` : `${name}: ${what} (${keys})`;
    }
}

/** Listens to the buttons, and to their keys while no field has the focus.
 * @param {{ picture: () => void, link: () => void, undo: () => void, redo: () => void,
 *   "console-toggle": () => void }} actions */
export function listenToTools(actions) {
    const keys = byId("keys", HTMLDialogElement);
    let hadPanel = true;
    // iPhones have no full screen for pages.
    byId("fullscreen").hidden = !document.fullscreenEnabled;
    document.addEventListener("fullscreenchange", () => followFullScreen(hadPanel));
    /** @type {Record<string, () => void>} */
    const clicks = {
        ...actions,
        open: () => byId("files").click(),
        help: () => keys.showModal(),
        fullscreen: () => {
            if (!document.fullscreenElement) hadPanel = !byId("panel").hidden;
            toggleFullScreen().catch((error) => say(`The browser refuses full screen: ${error.message}`));
        },
        "panel-toggle": () => showPanel(byId("panel").hidden),
        "panel-close": () => (showPanel(false), byId("panel-toggle").focus()),
    };
    for (const [id, click] of Object.entries(clicks)) byId(id).addEventListener("click", click);
    addEventListener("keydown", (event) => {
        if (event.altKey && event.key === "Enter" && !keys.open) {
            event.preventDefault();
            return clicks.fullscreen();
        }
        const isTyped = event.target instanceof Element && event.target.matches(TYPED);
        if ((event.ctrlKey || event.metaKey) && !event.altKey && !keys.open && !isTyped) {
            const key = event.key.toLowerCase();
            const way = key === "y" || (key === "z" && event.shiftKey) ? "redo" : key === "z" ? "undo" : undefined;
            if (way) {
                event.preventDefault();
                byId(way).click();
            }
        }
        if (event.ctrlKey || event.metaKey || event.altKey || keys.open) return;
        if (event.key === "Escape" && closeNewest()) event.preventDefault();
        // Letter keys go to the focused field.
        if (event.target !== byId("canvas") && event.target !== document.body) return;
        clicks[SHORTCUTS[event.key.toLowerCase()]]?.();
    });
}
