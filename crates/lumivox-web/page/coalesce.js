// @ts-check
// Changes that come faster than they can be made: those that a later one has overtaken are left out.

/** @typedef {import("./types.js").Progress} Progress */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {(progress: Progress) => void} OnProgress */

/** Of several changes of one thing that wait, the last counts. */
export class LastOf {
    /** The change of each thing that waits, and the runs that take them up.
     * @type {Map<string, () => Promise<unknown>>} */
    #waiting = new Map();
    /** @type {Map<string, Promise<void>>} */
    #runs = new Map();
    #after;

    /** @param {() => void} after each change */
    constructor(after) {
        this.#after = after;
    }

    /** Makes a change, or has it take the place of the one that waits. Ends when nothing of this thing waits any more.
     * @param {string} thing @param {() => Promise<unknown>} change @returns {Promise<void>} */
    run(thing, change) {
        this.#waiting.set(thing, change);
        const run = this.#runs.get(thing) ?? this.#all(thing).finally(() => this.#runs.delete(thing));
        this.#runs.set(thing, run);
        return run;
    }

    /** Ends when nothing waits any more, however it ended. */
    async settled() {
        await Promise.allSettled(this.#runs.values());
    }

    /** @param {string} thing */
    async #all(thing) {
        for (let change = this.#waiting.get(thing); change; change = this.#waiting.get(thing)) {
            this.#waiting.delete(thing);
            try {
                await change();
            } catch (error) {
                // What was overtaken may have failed.
                if (!this.#waiting.has(thing)) throw error;
            }
            this.#after();
        }
    }
}

/** @typedef {{ changes: Settings, onProgress: OnProgress, resolve: () => void, reject: (error: unknown) => void }} Change */

/** Sets settings that come at once, or while others are set, together. One that is refused takes no other with it. */
export class Together {
    /** @type {Change[]} */
    #waiting = [];
    #isSetting = false;
    #apply;
    #after;

    /** @param {(changes: Settings, onProgress: OnProgress) => Promise<void>} apply that does all or nothing
     * @param {() => void} after each time */
    constructor(apply, after) {
        this.#apply = apply;
        this.#after = after;
    }

    /** @param {Settings} changes @param {OnProgress} onProgress @returns {Promise<void>} */
    set(changes, onProgress) {
        return new Promise((resolve, reject) => {
            this.#waiting.push({ changes, onProgress, resolve, reject });
            if (!this.#isSetting) void this.#all();
        });
    }

    async #all() {
        this.#isSetting = true;
        // Messages that were sent at once are here after this.
        await new Promise((resolve) => setTimeout(resolve));
        while (this.#waiting.length > 0) {
            const all = this.#waiting.splice(0);
            try {
                await this.#apply(Object.assign({}, ...all.map(({ changes }) => changes)), all[0].onProgress);
                for (const { resolve } of all) resolve();
            } catch (error) {
                if (all.length === 1) all[0].reject(error);
                else for (const one of all) await this.#apply(one.changes, one.onProgress).then(one.resolve, one.reject);
            }
            this.#after();
        }
        this.#isSetting = false;
    }
}
