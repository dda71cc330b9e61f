// Changes that come faster than they can be made.

import assert from "node:assert/strict";
import { test } from "node:test";
import { LastOf, Together } from "../../page/coalesce.js";

const nothing = () => {};
const soon = () => new Promise((resolve) => setTimeout(resolve));

test("of several changes of one thing the first and the last are made", async () => {
    const made = [];
    let afters = 0;
    const last = new LastOf(() => (afters += 1));
    const change = (what) => async () => {
        await soon();
        made.push(what);
    };
    const runs = [1, 2, 3, 4].map((size) => last.run("size", change(`size ${size}`)));
    runs.push(last.run("split", change("split")));
    await Promise.all(runs);
    assert.deepEqual(made.sort(), ["size 1", "size 4", "split"]);
    assert.equal(afters, 3);
    // And it goes on.
    await last.run("size", change("size 5"));
    assert.ok(made.includes("size 5"));
});

test("an error counts only where nothing has overtaken it", async () => {
    const last = new LastOf(nothing);
    const fails = async () => {
        await soon();
        throw new Error("refused");
    };
    const [first, second] = [last.run("size", fails), last.run("size", soon)];
    await Promise.all([first, second]);
    await assert.rejects(last.run("size", fails), /refused/);
    await last.run("size", soon);
});

test("settings that come at once are set at once, and the later value counts", async () => {
    const applied = [];
    const together = new Together(async (changes) => {
        await soon();
        applied.push(changes);
    }, nothing);
    await Promise.all([{ bounces: 1 }, { resolution: 64 }, { bounces: 2 }].map((changes) => together.set(changes, nothing)));
    assert.deepEqual(applied, [{ bounces: 2, resolution: 64 }]);
    await together.set({ bounces: 3 }, nothing);
    assert.deepEqual(applied.at(-1), { bounces: 3 });
});

test("a setting that is refused takes no other with it", async () => {
    const settings = {};
    const together = new Together(async (changes) => {
        if (changes.bounces > 16) throw new Error("bounces must be at most 16");
        Object.assign(settings, changes);
    }, nothing);
    const ends = await Promise.allSettled([{ resolution: 64 }, { bounces: 99 }, { view: "direct" }].map((changes) => together.set(changes, nothing)));
    assert.deepEqual(ends.map(({ status }) => status), ["fulfilled", "rejected", "fulfilled"]);
    assert.match(ends[1].reason.message, /at most 16/);
    assert.deepEqual(settings, { resolution: 64, view: "direct" });
});
