// Views that are stored under names.

import assert from "node:assert/strict";
import { test } from "node:test";
import { KeptCameras } from "../../page/cameras.js";

const camera = { position: [0, 1, 4], target: [0, 1, 0], up: [0, 1, 0], vertical_fov_deg: 40 };

function storage() {
    const items = new Map();
    return { items, getItem: (key) => items.get(key) ?? null, setItem: (key, text) => void items.set(key, text), removeItem: (key) => void items.delete(key) };
}

test("stored views are restored per scene", () => {
    const store = storage();
    const kept = new KeptCameras(() => store, "builtin:cornell");
    kept.keep("corner", camera);
    kept.keep("above", { ...camera, position: [0, 9, 0.5] });
    kept.keep("corner", { ...camera, vertical_fov_deg: 30 });
    const again = new KeptCameras(() => store, "builtin:cornell");
    assert.deepEqual(again.all, [{ ...camera, vertical_fov_deg: 30, name: "corner" }, { ...camera, position: [0, 9, 0.5], name: "above" }]);
    assert.deepEqual(new KeptCameras(() => store, "builtin:atrium").all, []);
    again.forget("corner");
    assert.deepEqual(again.all.map(({ name }) => name), ["above"]);
    again.forget("above");
    assert.equal(store.items.size, 0);
});

test("unreadable stored views are skipped", () => {
    const store = storage();
    store.setItem("lumivox cameras a", JSON.stringify({ broken: "1,2", whole: "0,1,4,0,1,0,40", odd: 3 }));
    assert.deepEqual(new KeptCameras(() => store, "a").all.map(({ name }) => name), ["whole"]);
    for (const text of ["no json", "null", "[]", "3"]) {
        store.setItem("lumivox cameras a", text);
        assert.deepEqual(new KeptCameras(() => store, "a").all, []);
    }
});

test("without storage, views last until the page closes", () => {
    const kept = new KeptCameras(() => { throw new Error("forbidden"); }, "a");
    assert.throws(() => kept.keep("corner", camera), /when the page is closed/);
    assert.equal(kept.all[0].name, "corner");
});
