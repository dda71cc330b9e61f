// How bright the picture is: the histogram, and the light under the mouse.

import assert from "node:assert/strict";
import { test } from "node:test";
import { inWords, shown } from "../../page/histogram.js";
import { lightText, threeDigits } from "../../page/probe.js";

const histogram = (filled, white) => {
    const bins = Array.from({ length: 144 }, (_, bin) => (filled.includes(bin) ? 5 : 0));
    return { bins, bins_per_stop: 4, first_stop: -14, stops: -3.25, middle_grey: white - 10, white, share_above_white: 0.0123 };
};

test("the histogram shows the display range and filled bins", () => {
    assert.deepEqual(shown(histogram([60, 70], 80)), { first: 32, end: 92 });
    assert.deepEqual(shown(histogram([20, 140], 80)), { first: 20, end: 141 });
    // Black does not extend the range.
    assert.deepEqual(shown(histogram([0, 70], 80)), { first: 32, end: 92 });
    for (const white of [-40, 300]) {
        const { first, end } = shown(histogram([0], white));
        assert.ok(first >= 0 && end <= 144 && first < end, `${first} to ${end}`);
    }
});

test("a histogram says how the picture is exposed", () => {
    assert.equal(inWords(histogram([], 80)), "Exposed by -3.3 stops; 1.2 % is brighter than white");
    assert.match(inWords({ ...histogram([], 80), share_above_white: 0 }), /nothing is brighter/);
    assert.match(inWords({ ...histogram([], 80), share_above_white: 0.5 }), /50 % is brighter/);
});

test("light has three digits, whatever its strength", () => {
    assert.deepEqual([98765, 1234, 45.678, 0.01234, 0.0000456, 0].map(threeDigits), ["98\u202f800", "1\u202f230", "45.7", "0.0123", "4.6e-5", "0"]);
    assert.equal(lightText({ luminance_cd_m2: 45.678, illuminance_lux: 312.4 }), "312 lux · 45.7 cd/m²");
    assert.equal(lightText({ luminance_cd_m2: 3000 }), "3\u202f000 cd/m²");
    assert.equal(lightText(undefined), "");
});
