// Console messages of a page, its workers and the browser. A test fails if it leaves unexpected
// errors or warnings. WebGPU's validation errors are reported as warnings.

import assert from "node:assert/strict";

/** @typedef {import("playwright-core").Page} Page */

/** Messages that are not about the page. */
const HARMLESS = [
    // From SwiftShader, when a screenshot of these tests reads a canvas back.
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

    /** Playwright reports workers' own messages, but not the browser's about them.
     * @param {Page} page */
    async #listenToWorkers(page) {
        const devtools = await page.context().newCDPSession(page);
        devtools.on("Target.attachedToTarget", ({ sessionId }) => {
            const message = JSON.stringify({ id: 1, method: "Log.enable" });
            // A worker may have ended.
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

    /** Ignores messages of a kind from now on. @param {RegExp} pattern */
    expect(pattern) {
        this.#expected.push(pattern);
    }

    /** The unexpected messages since the last call. */
    take() {
        return this.#bad.splice(0);
    }

    /** Waits for the next unexpected message. */
    async next() {
        while (this.#bad.length === 0) await new Promise((resolve) => setTimeout(resolve, 20));
        return /** @type {string} */ (this.#bad.shift());
    }

    /** Fails if there were unexpected messages. */
    check() {
        assert.deepEqual(this.take(), [], "the console must be free of errors and warnings");
    }
}
