// @ts-check
// The page's side of the worker: calls are promises, and the worker's own reports are events.

/** @typedef {import("./types.js").Failure} Failure */
/** @typedef {import("./types.js").FromWorker} FromWorker */
/** @typedef {import("./types.js").Progress} Progress */

/** An error from the worker: `code` is its kind; `fatal` is true if the renderer is unusable. */
export class WorkerError extends Error {
    /** @param {Failure} failure */
    constructor({ message, code, fatal }) {
        super(message);
        this.name = "WorkerError";
        this.code = code;
        this.fatal = fatal;
    }
}

/** @typedef {{ resolve: (result: any) => void, reject: (error: Error) => void,
 *   onProgress?: (p: Progress) => void }} Call */

export class Client {
    /** @type {Map<number, Call>} */
    #calls = new Map();
    /** @type {Map<string, (data: any) => void>} */
    #listeners = new Map();
    #last = 0;
    #worker;

    /** @param {URL} address of the worker's module */
    constructor(address) {
        this.#worker = new Worker(address, { type: "module" });
        this.#worker.addEventListener("message", (event) => this.#received(event.data));
        // Also fired if the module cannot be loaded; then there is no message.
        this.#worker.addEventListener("error", (event) => {
            const message = event.message || "its module could not be loaded";
            const error = new WorkerError({ message, code: "stopped", fatal: true });
            for (const call of this.#calls.values()) call.reject(error);
            if (this.#calls.size === 0) this.#listeners.get("error")?.(error);
            this.#calls.clear();
        });
    }

    /** Calls a method of the worker.
     * @template T
     * @param {string} call @param {unknown} [data]
     * @param {(progress: Progress) => void} [onProgress]
     * @param {Transferable[]} [transfer] @returns {Promise<T>} */
    call(call, data, onProgress, transfer = []) {
        const id = (this.#last += 1);
        return new Promise((resolve, reject) => {
            this.#calls.set(id, { resolve, reject, onProgress });
            this.#worker.postMessage({ id, call, data }, transfer);
        });
    }

    /** Listens for an event of the worker: "frame", "error", "lost", "restored".
     * @param {string} event @param {(data: any) => void} listener */
    on(event, listener) {
        this.#listeners.set(event, listener);
    }

    /** @param {FromWorker} message */
    #received(message) {
        if ("event" in message) {
            const data = message.event === "error" ? new WorkerError(/** @type {Failure} */ (message.data)) : message.data;
            this.#listeners.get(message.event)?.(data);
            return;
        }
        const call = this.#calls.get(message.id);
        if ("progress" in message) {
            call?.onProgress?.(message.progress);
            return;
        }
        this.#calls.delete(message.id);
        if ("error" in message) call?.reject(new WorkerError(message.error));
        else call?.resolve(message.result);
    }
}
