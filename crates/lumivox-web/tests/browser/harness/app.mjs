// The page in a tab: what it shows, what it says, and the renderer in its worker.

import assert from "node:assert/strict";
import { Messages } from "./messages.mjs";

/** @typedef {import("playwright-core").Page} Page */
/** @typedef {import("playwright-core").BrowserContextOptions} ContextOptions */
/** @typedef {import("./browser.mjs").Session} Session */
/** @typedef {import("./picture.mjs").Picture} Picture */

/** The longest that anything takes beside another browser on a software GPU, ms. */
const LONGEST_MS = 120_000;

/** The size of the window; at a scale of 1/4 the picture has SIZE. */
export const VIEWPORT = { width: 384, height: 288 };
export const SIZE = { width: 96, height: 72 };
/** The largest mean FLIP between pictures of two software GPUs, SwiftShader and lavapipe. Edges at
 * pixel centres fall to either side, and so do cones beside them; rounding decides which point of a
 * lamp a pixel samples. Measured: 0.0019 to 0.025, 0.047 (glow) and 0.069 (atrium); a wrong picture
 * had 0.12 and more. */
export const BOUND = 0.1;
/** Small and quick; `NATIVE` is the same for the native program. */
export const QUICK = { resolution: 32, frames: 2, bounces: 1 };
export const NATIVE = ["--size", "96x72", "--resolution", "32", "--frames", "2", "--bounces", "1"];
/** How long keys are held to move, ms. */
export const HELD = { delay: 150 };
/** `NATIVE` as the parameters of a link. */
export const LINK = "scale=0.25&resolution=32&frames=2&bounces=1";

/** The result of a promise; fails after LONGEST_MS, since a stopped worker never answers.
 * @template T @param {Promise<T>} promise @param {string} what @returns {Promise<T>} */
function within(promise, what) {
    /** @type {NodeJS.Timeout | undefined} */
    let timer;
    const late = new Promise((_, reject) => {
        timer = setTimeout(() => reject(new Error(`${what} did not end within ${LONGEST_MS / 1000} s`)), LONGEST_MS);
    });
    return Promise.race([promise, /** @type {Promise<never>} */ (late)]).finally(() => clearTimeout(timer));
}

export class App {
    /** @param {Page} page @param {Messages} messages */
    constructor(page, messages) {
        this.page = page;
        this.messages = messages;
    }

    /** Opens the viewer, or another page, in a tab of its own context.
     * @param {Session} session
     * @param {{ link?: string, path?: string, context?: ContextOptions,
     *   before?: (page: Page) => Promise<unknown> }} options
     *   `before` may prepare the tab */
    static async open(session, { link = "", path = "viewer.html", context = {}, before } = {}) {
        const tab = await session.browser.newContext({ viewport: VIEWPORT, ...context });
        const page = await tab.newPage();
        page.setDefaultTimeout(LONGEST_MS);
        const messages = await Messages.of(page);
        await before?.(page);
        await page.goto(new URL(`${path}${link && `#${link}`}`, session.address).href, { timeout: LONGEST_MS });
        return new App(page, messages);
    }

    /** Opens it with a scene, and waits for the picture.
     * @param {Session} session @param {string} scene */
    static async show(session, scene) {
        const app = await App.open(session, { link: `scene=${scene}&${LINK}` });
        await app.complete();
        return app;
    }

    async close() {
        await this.page.context().close();
    }

    /** Opens another built-in scene in the same tab, by the page's list. Objects, lights,
     * surroundings and undo are as in a new tab, and nothing is compiled again. Settings stay.
     * @param {string} scene */
    async load(scene) {
        await this.inPanel("Scene", () => this.page.locator("#scene").selectOption(scene));
    }

    // --- State of the page ---

    /** Waits until the page is in a state. @param {string} state */
    async state(state) {
        await this.page.waitForSelector(`html[data-state=${state}]`, { state: "attached", timeout: LONGEST_MS });
    }

    /** Waits for the finished picture. */
    async complete() {
        // A failed page is never complete.
        const ends = ["complete", "failed", "empty", "unsupported"].map((state) => `html[data-state=${state}]`);
        await this.page.waitForSelector(ends.join(), { state: "attached", timeout: LONGEST_MS });
        const state = await this.page.evaluate(() => document.documentElement.dataset.state);
        assert.equal(state, "complete", `the page says: ${(await this.errors()).join(" | ")} ${this.messages.take().join(" | ")}`);
    }

    /** Waits for the finished picture after input or a resize, which the page sees frames later. */
    async settled() {
        await this.page.evaluate(() => new Promise((resolve) => {
            // Held keys and resizes are handled once a frame; then the camera rests for a moment.
            let frames = 0;
            const next = () => ((frames += 1) < 3 ? requestAnimationFrame(next) : setTimeout(resolve, 300));
            requestAnimationFrame(next);
        }));
        await this.complete();
    }

    /** The errors that it shows. @returns {Promise<string[]>} */
    async errors() {
        return (await this.page.locator("#messages .error p").allTextContents()).map((text) => text.trim());
    }

    /** Waits for an error, closes it, and gives its text. */
    async error() {
        const message = this.page.locator("#messages .error").last();
        const text = (await message.locator("p").textContent()) ?? "";
        // The panel may cover the button.
        await message.getByLabel("Close the message").press("Enter");
        return text.trim();
    }

    /** Waits for a note, and closes it. @param {string} text a part of it */
    async note(text) {
        await this.page.locator("#messages .note", { hasText: text }).getByLabel("Close the message").click();
    }

    /** Fails if there are errors, on the page or on the console. */
    async check() {
        assert.deepEqual(await this.errors(), [], "the page must show no error");
        this.messages.check();
    }

    /** Works in the panel with a section open, then closes it, since it covers a part of small
     * windows. @param {string} section @param {() => Promise<unknown>} work */
    async inPanel(section, work) {
        const show = async (/** @type {string} */ expanded) => {
            const toggle = this.page.locator("#panel-toggle");
            if ((await toggle.getAttribute("aria-expanded")) !== expanded) await toggle.click();
        };
        await show("true");
        await this.page.locator("#panel > details", { has: this.page.getByRole("heading", { name: section, exact: true }) })
            .evaluate((/** @type {HTMLDetailsElement} */ details) => (details.open = true));
        try {
            await work();
        } finally {
            await show("false");
            await this.settled();
        }
    }

    /** Drops files on the page, as a mouse would.
     * @param {{ name: string, bytes: Buffer | string }[]} files */
    async drop(files) {
        const contents = files.map(({ name, bytes }) => ({ name, base64: Buffer.from(bytes).toString("base64") }));
        await this.page.evaluate((contents) => {
            const transfer = new DataTransfer();
            for (const { name, base64 } of contents) {
                transfer.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
            }
            for (const type of ["dragenter", "dragover", "drop"]) {
                const event = new DragEvent(type, { dataTransfer: transfer, bubbles: true, cancelable: true });
                document.querySelector("canvas")?.dispatchEvent(event);
            }
        }, contents);
    }

    // --- The renderer in the worker ---

    get worker() {
        const [worker] = this.page.workers();
        assert.ok(worker, "the page has no worker");
        return worker;
    }

    /** Calls the renderer; its error is thrown here, with message and code.
     * @param {string} method @param {unknown[]} args @returns {Promise<any>} */
    async call(method, ...args) {
        const { result, error } = await within(this.worker.evaluate(async ([method, args]) => {
            try {
                // @ts-ignore: the page leaves it there
                return { result: await self.renderer[method](...args) };
            } catch (thrown) {
                const { message = String(thrown), code } = /** @type {{ message?: string, code?: string }} */ (thrown ?? {});
                return { error: { message, code, isError: thrown instanceof Error } };
            }
        }, /** @type {const} */ ([method, args])), method);
        if (error) throw Object.assign(new Error(error.message), error);
        return result;
    }

    /** Renders until nothing is left to do. The page's own loop does not notice direct calls. */
    async render() {
        return within(this.worker.evaluate(async () => {
            // @ts-ignore
            const renderer = self.renderer;
            let report = await renderer.render();
            while (!report.complete) report = await renderer.render();
            return report;
        }), "rendering");
    }

    /** The canvas's pixels. @returns {Promise<Picture>} */
    async pixels() {
        const { width, height, base64 } = await this.worker.evaluate(async () => {
            // @ts-ignore
            const { width, height, data } = await self.renderer.readPixels();
            let text = "";
            for (let at = 0; at < data.length; at += 8192) text += String.fromCharCode(...data.subarray(at, at + 8192));
            return { width, height, base64: btoa(text) };
        });
        return { width, height, data: Buffer.from(base64, "base64") };
    }

    /** The picture with some settings. @param {Record<string, unknown>} settings */
    async pictureWith(settings) {
        await this.call("set", settings);
        await this.render();
        return this.pixels();
    }
}
