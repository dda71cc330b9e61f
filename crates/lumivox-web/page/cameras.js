// @ts-check
// The list of cameras: the scene's own, and named views that the browser stores for each scene.

import { byId, fillSelect } from "./dom.js";
import { cameraOf, cameraText } from "./link.js";
import { say } from "./messages.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").SceneInfo} SceneInfo */
/** @typedef {Pick<Storage, "getItem" | "setItem" | "removeItem">} Store */

/** The stored views of a scene. The storage may be full, forbidden, or hold unknown data. */
export class KeptCameras {
    #store;
    #key;
    /** @type {Map<string, Camera>} */
    #cameras = new Map();

    /** @param {() => Store} store throws if the browser refuses it
     * @param {string} scene its address, or its name */
    constructor(store, scene) {
        this.#store = store;
        this.#key = `lumivox cameras ${scene}`;
        try {
            const kept = JSON.parse(store().getItem(this.#key) ?? "{}");
            for (const [name, text] of Object.entries(kept)) {
                // Skip unreadable views, keep the others.
                try {
                    this.#cameras.set(name, { ...cameraOf(String(text)), name });
                } catch {}
            }
        } catch {}
    }

    /** @returns {Camera[]} */
    get all() {
        return [...this.#cameras.values()];
    }

    /** Stores a camera, in place of one of the same name.
     * @param {string} name @param {Camera} camera */
    keep(name, camera) {
        this.#cameras.set(name, { ...camera, name });
        this.#write();
    }

    /** @param {string} name */
    forget(name) {
        this.#cameras.delete(name);
        this.#write();
    }

    #write() {
        const texts = Object.fromEntries([...this.#cameras].map(([name, camera]) => [name, cameraText(camera)]));
        try {
            if (this.#cameras.size > 0) this.#store().setItem(this.#key, JSON.stringify(texts));
            else this.#store().removeItem(this.#key);
        } catch {
            throw new Error("This browser does not let the page store anything: the view is lost when the page is closed");
        }
    }
}

/** The list in the panel. */
export class CameraList {
    /** @type {SceneInfo | null} */
    #scene = null;
    /** @type {KeptCameras | null} */
    #kept = null;
    #list = byId("camera", HTMLSelectElement);
    #forget = byId("camera-forget");
    #now;
    #move;
    #moved;

    /** @param {() => Camera | null} now @param {(camera: Camera) => void} move
     * @param {() => Promise<Camera[]>} moved the scene's cameras at the animation's present time */
    constructor(now, move, moved) {
        this.#now = now;
        this.#move = move;
        this.#moved = moved;
        this.#list.addEventListener("change", () => void this.home());
        byId("home").addEventListener("click", () => void this.home());
        this.#forget.addEventListener("click", () => this.#change((kept) => kept.forget(this.#chosen?.name ?? "")));
        byId("camera-form").addEventListener("submit", (event) => {
            event.preventDefault();
            const field = byId("camera-name", HTMLInputElement);
            this.#keep(field.value.trim() || `view ${(this.#kept?.all.length ?? 0) + 1}`);
            field.value = "";
        });
    }

    /** @param {SceneInfo} scene @param {string} key the storage key of its views */
    open(scene, key) {
        this.#scene = scene;
        this.#kept = new KeptCameras(() => localStorage, key);
        this.#show();
    }

    /** Moves to the chosen camera. */
    async home() {
        const to = this.#chosen;
        if (!to) return;
        const isKept = this.#kept?.all.includes(to) ?? false;
        this.#forget.hidden = !isKept;
        const moved = isKept || !to.name ? [] : await this.#moved();
        this.#move(moved.find(({ name }) => name === to.name) ?? to);
    }

    /** The scene's cameras, the initial one first. @returns {Camera[]} */
    get #own() {
        if (!this.#scene) return [];
        const { camera, cameras } = this.#scene;
        return [camera, ...cameras.filter(({ name }) => !name || name !== camera.name)];
    }

    /** @returns {Camera | undefined} */
    get #chosen() {
        return [...this.#own, ...(this.#kept?.all ?? [])][Number(this.#list.value)];
    }

    /** @param {string} name */
    #keep(name) {
        const camera = this.#now();
        if (!camera) return;
        const isTaken = this.#own.some((other) => other.name === name);
        if (isTaken) return say(`A camera of the scene is called "${name}": choose another name`);
        this.#change((kept) => kept.keep(name, camera), name);
    }

    /** @param {(kept: KeptCameras) => void} change @param {string} [chosen] */
    #change(change, chosen) {
        if (!this.#kept) return;
        try {
            change(this.#kept);
        } catch (error) {
            say(error instanceof Error ? error.message : String(error));
        }
        this.#show(chosen);
    }

    /** @param {string} [chosen] the name of the stored view to select */
    #show(chosen) {
        const kept = this.#kept?.all ?? [];
        const choices = [...this.#own, ...kept].map(({ name }, index) => ({ value: String(index), label: name || `camera ${index + 1}` }));
        const place = kept.findIndex(({ name }) => name === chosen);
        fillSelect(this.#list, choices, String(place < 0 ? 0 : choices.length - kept.length + place));
        this.#forget.hidden = place < 0;
    }
}
