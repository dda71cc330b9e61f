// Colours: linear ones and those of screens.

import assert from "node:assert/strict";
import { test } from "node:test";
import { apart, hex, linear } from "../../page/color.js";

test("hex colours round-trip through linear", () => {
    for (const text of ["#000000", "#ffffff", "#1234ab", "#0a0b0c", "#fe8000"]) assert.equal(hex(linear(text), 1), text);
    assert.deepEqual(linear("#ff0000"), [1, 0, 0]);
    // Middle grey of a screen has a fifth of its light (IEC 61966-2-1).
    assert.ok(Math.abs(linear("#808080")[0] - 0.2158605) < 1e-6);
});

test("light colours are normalized, surface colours are not", () => {
    assert.equal(hex([2000, 1000, 0]), hex([1, 0.5, 0]));
    assert.equal(hex([0.5, 0.5, 0.5]), "#ffffff");
    assert.equal(hex([0.5, 0.5, 0.5], 1), "#bcbcbc");
    assert.equal(hex([0, 0, 0]), "#000000");
});

test("strength and colour are separated", () => {
    assert.deepEqual(apart([4, 2, 0]), { strength: 4, color: [1, 0.5, 0] });
    // Black is given the colour white.
    assert.deepEqual(apart([0, 0, 0]), { strength: 0, color: [1, 1, 1] });
});
