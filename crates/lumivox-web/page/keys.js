// @ts-check
// The tool bar's buttons and their keys.

import { byId } from "./dom.js";
import { closeNewest } from "./messages.js";

/** Letters that press a button. */
const SHORTCUTS = /** @type {Record<string, string>} */ ({ o: "open", p: "picture", l: "link", "?": "help" });

/** @param {boolean} isOpen */
export function showPanel(isOpen) {
    byId("panel").hidden = !isOpen;
    byId("panel-toggle").setAttribute("aria-expanded", String(isOpen));
}

/** Listens to the buttons, and to their keys while no field has the focus.
 * @param {{ picture: () => void, link: () => void }} actions */
export function listenToTools(actions) {
    const keys = byId("keys", HTMLDialogElement);
    /** @type {Record<string, () => void>} */
    const clicks = {
        ...actions,
        open: () => byId("files").click(),
        help: () => keys.showModal(),
        "panel-toggle": () => showPanel(byId("panel").hidden),
        "panel-close": () => (showPanel(false), byId("panel-toggle").focus()),
    };
    for (const [id, click] of Object.entries(clicks)) byId(id).addEventListener("click", click);
    addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || keys.open) return;
        if (event.key === "Escape" && closeNewest()) event.preventDefault();
        // Letters belong to the field that has the focus.
        if (event.target !== byId("canvas") && event.target !== document.body) return;
        clicks[SHORTCUTS[event.key.toLowerCase()]]?.();
    });
}
