// Everything that a page and its workers say on the console, by themselves or through the browser: a test that leaves
// an error or a warning there fails, if it did not expect it. What WebGPU's validation finds comes as a warning.

import assert from "node:assert/strict";

/** @typedef {import("playwright-core").Page} Page */

/** Says nothing about the page. */
const HARMLESS = [
    // SwiftShader's own, when a canvas is read back by the screenshots of these tests.
    /GPU stall due to ReadPixels/,
];

export class Messages {
    /** @type {string[]} */
    #bad = [];
    /** @type {RegExp[]} */
    #expected = [];

    /** Listens to a page from now on. @param {Page} page */
    static async of(page) {
        const messages = new Messages();
        page.on("console", (message) => {
            if (["error", "warning", "assert"].includes(message.type())) messages.#add(`${message.type()}: ${message.text()}`);
        });
        page.on("pageerror", (error) => messages.#add(`uncaught: ${error.stack ?? error.message}`));
        page.on("crash", () => messages.#add("the page crashed"));
        await messages.#listenToWorkers(page);
        return messages;
    }

    /** Playwright hears what workers say themselves, but not what the browser says of them.
     * @param {Page} page */
    async #listenToWorkers(page) {
        const devtools = await page.context().newCDPSession(page);
        devtools.on("Target.attachedToTarget", ({ sessionId }) => {
            const message = JSON.stringify({ id: 1, method: "Log.enable" });
            // A worker may be gone already.
            devtools.send("Target.sendMessageToTarget", { sessionId, message }).catch(() => {});
        });
        devtools.on("Target.receivedMessageFromTarget", ({ message }) => {
            const { method, params } = JSON.parse(message);
            if (method !== "Log.entryAdded") return;
            const { level, source, text, url = "" } = params.entry;
            if (level === "error" || level === "warning") this.#add(`${level} (${source}): ${text} ${url}`.trim());
        });
        await devtools.send("Target.setAutoAttach", { autoAttach: true, waitForDebuggerOnStart: false, flatten: false });
    }

    /** @param {string} text */
    #add(text) {
        if (![...HARMLESS, ...this.#expected].some((pattern) => pattern.test(text))) this.#bad.push(text);
    }

    /** Lets messages of a kind pass from now on. @param {RegExp} pattern */
    expect(pattern) {
        this.#expected.push(pattern);
    }

    /** What was said since the last time, and should not have been. */
    take() {
        return this.#bad.splice(0);
    }

    /** The next message that should not have been said; waits until there is one. */
    async next() {
        while (this.#bad.length === 0) await new Promise((resolve) => setTimeout(resolve, 20));
        return /** @type {string} */ (this.#bad.shift());
    }

    /** Fails if anything was said. */
    check() {
        assert.deepEqual(this.take(), [], "the console must be free of errors and warnings");
    }
}
