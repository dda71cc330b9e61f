// @ts-check
// Camera controls: mouse, touch and keys on the picture.

import { dolly, fitted, fly, look, orbit, pan, radius } from "./camera.js";

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").SceneInfo} SceneInfo */

/** Rotation for a drag over the picture's height, rad: half a turn. */
const TURN_RAD = Math.PI;
/** Turn by the arrow keys, rad/s. */
const TURN_RAD_S = 1.2;
/** Zoom exponent per wheel pixel: a notch of 100 pixels changes the distance by a seventh. */
const WHEEL = 0.0015;
/** Pixels per unit of `deltaMode`: pixels, lines, pages. */
const WHEEL_PIXELS = [1, 16, 400];
/** Speed of flight in scene radii per second, and its factor with Shift. */
const [SPEED, FASTER] = [0.5, 4];
/** The least distance to the target when zooming, in scene radii. */
const NEAREST = 1e-3;

/** Keys that act while held: motion to the right, up, forwards; rotation to the right, down. */
const HELD = /** @type {Record<string, [number, number, number, number, number]>} */ ({
    KeyW: [0, 0, 1, 0, 0],
    KeyS: [0, 0, -1, 0, 0],
    KeyA: [-1, 0, 0, 0, 0],
    KeyD: [1, 0, 0, 0, 0],
    KeyQ: [0, -1, 0, 0, 0],
    KeyE: [0, 1, 0, 0, 0],
    ArrowLeft: [0, 0, 0, -1, 0],
    ArrowRight: [0, 0, 0, 1, 0],
    ArrowUp: [0, 0, 0, 0, -1],
    ArrowDown: [0, 0, 0, 0, 1],
});

export class Controls {
    /** @type {Map<number, { x: number, y: number }>} */
    #pointers = new Map();
    /** @type {Set<string>} */
    #held = new Set();
    #isFast = false;
    #canvas;
    #now;
    #move;

    /** @param {HTMLElement} canvas @param {() => { camera: Camera, scene: SceneInfo } | null} now
     * @param {(camera: Camera) => void} move */
    constructor(canvas, now, move) {
        this.#canvas = canvas;
        this.#now = now;
        this.#move = move;
        canvas.addEventListener("pointerdown", (event) => this.#down(event));
        canvas.addEventListener("pointermove", (event) => this.#drag(event));
        for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
            canvas.addEventListener(end, (event) => this.#pointers.delete(/** @type {PointerEvent} */ (event).pointerId));
        }
        canvas.addEventListener("contextmenu", (event) => event.preventDefault());
        canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
        canvas.addEventListener("keydown", (event) => this.#key(event));
        canvas.addEventListener("keyup", (event) => this.#held.delete(event.code));
        // A key that is held when the page loses the focus sends no keyup here.
        canvas.addEventListener("blur", () => this.#held.clear());
        addEventListener("blur", () => this.#held.clear());
    }

    /** @param {(camera: Camera, scene: SceneInfo) => Camera} change */
    #apply(change) {
        const now = this.#now();
        if (now) this.#move(change(now.camera, now.scene));
    }

    /** @param {PointerEvent} event */
    #down(event) {
        this.#canvas.focus({ preventScroll: true });
        this.#canvas.setPointerCapture(event.pointerId);
        this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        event.preventDefault();
    }

    /** @param {PointerEvent} event */
    #drag(event) {
        const before = this.#pointers.get(event.pointerId);
        if (!before) return;
        const now = { x: event.clientX, y: event.clientY };
        this.#pointers.set(event.pointerId, now);
        const { width, height } = this.#canvas.getBoundingClientRect();
        // Each of two fingers moves the midpoint by half its motion.
        const fingers = Math.min(this.#pointers.size, 2);
        const [right, down] = [(now.x - before.x) / height / fingers, (now.y - before.y) / height / fingers];
        const isPan = event.pointerType === "mouse" && (event.buttons !== 1 || event.shiftKey);
        this.#apply((camera, scene) => {
            if (fingers === 1 && !isPan) return orbit(camera, right * TURN_RAD, down * TURN_RAD);
            const panned = pan(fitted(camera, width / height), right, down);
            const moved = { ...panned, vertical_fov_deg: camera.vertical_fov_deg };
            const other = [...this.#pointers].find(([id]) => id !== event.pointerId)?.[1];
            if (fingers === 1 || !other) return moved;
            const apart = (/** @type {{ x: number, y: number }} */ a) => Math.max(1, Math.hypot(a.x - other.x, a.y - other.y));
            return dolly(moved, apart(before) / apart(now), radius(scene.bounds) * NEAREST);
        });
    }

    /** @param {WheelEvent} event */
    #wheel(event) {
        event.preventDefault();
        const pixels = event.deltaY * WHEEL_PIXELS[event.deltaMode];
        // A touch-pad pinch arrives as a wheel event with Ctrl, in small steps.
        this.#dolly(Math.exp(pixels * WHEEL * (event.ctrlKey ? 8 : 1)));
    }

    /** @param {number} factor */
    #dolly(factor) {
        this.#apply((camera, scene) => dolly(camera, factor, radius(scene.bounds) * NEAREST));
    }

    /** @param {KeyboardEvent} event */
    #key(event) {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        this.#isFast = event.shiftKey;
        if (event.key === "+" || event.key === "-") this.#dolly(event.key === "+" ? 0.8 : 1.25);
        else if (event.code in HELD) this.#hold(event.code);
        else return;
        event.preventDefault();
    }

    /** @param {string} code */
    #hold(code) {
        const isMoving = this.#held.size > 0;
        this.#held.add(code);
        if (!isMoving) requestAnimationFrame((start) => this.#step(start, start));
    }

    /** @param {number} before @param {number} now both ms */
    #step(before, now) {
        if (this.#held.size === 0) return;
        // Limits the jump after the page was blocked.
        const seconds = Math.min(now - before, 100) / 1000;
        const keys = [...this.#held].map((code) => HELD[code]);
        const [right, up, forwards, aside, down] = [0, 1, 2, 3, 4].map((part) => keys.reduce((sum, key) => sum + key[part], 0));
        this.#apply((camera, scene) => {
            const way = radius(scene.bounds) * SPEED * seconds * (this.#isFast ? FASTER : 1);
            const turn = TURN_RAD_S * seconds;
            return fly(look(camera, aside * turn, down * turn), [right * way, up * way, forwards * way]);
        });
        requestAnimationFrame((next) => this.#step(now, next));
    }
}
