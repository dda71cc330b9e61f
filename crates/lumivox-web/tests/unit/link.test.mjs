// Links: encoding and decoding agree; broken parts are reported and left out.

import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, encode } from "../../page/link.js";
import { linkState } from "../../page/share.js";

const known = {
    presets: [{ name: "fast" }, { name: "high" }],
    parameters: [
        { name: "view", kind: "choice", choices: ["final", "direct", "wire-voxels"], default: "final" },
        { name: "resolution", kind: "whole", min: 16, max: 1024, default: 64 },
        { name: "exposure", kind: "number", min: -64, max: 64, words: ["auto"], default: "auto" },
        { name: "specular", kind: "switch", default: true },
        { name: "grid_offset", kind: "vector", default: [0, 0, 0] },
    ],
};

test("links round-trip through encode and decode", () => {
    const state = {
        scene: "https://example.org/a b/hall.glb?x=1&y=2#part",
        environment: "skies/day.exr",
        environment_intensity: 2500,
        environment_rotation: -90,
        preset: "high",
        camera: { position: [0.1, -2, 3e-8], target: [4, 5, 6.25], up: [0, 0, 1], vertical_fov_deg: 40 },
        split: { right: "reference", at: 0.375 },
        scale: 0.5,
        settings: { view: "wire-voxels", resolution: 128, exposure: "auto", specular: false, grid_offset: "0.5,0,0.25" },
    };
    assert.deepEqual(decode(`#${encode(state)}`, known), { state, problems: [] });
    for (const up of [[0, 1, 0.5], [0.5, 1, 0], [0, -1, 0]]) {
        const rolled = { ...state, camera: { ...state.camera, up } };
        assert.deepEqual(decode(encode(rolled), known).state, rolled);
    }
});

test("vectors are written as comma-separated numbers", () => {
    assert.equal(encode({ settings: { grid_offset: [0.5, 0, 0.1] } }), "grid_offset=0.5,0,0.1");
});

test("numbers have no more digits than tell single floats apart", () => {
    const exposures = [-1.5, 3.799999952316284, 40.03192138671875, 1 / 3, 65504];
    const texts = ["-1.5", "3.8", "40.03192", "0.33333333", "65504"];
    assert.deepEqual(exposures.map((exposure) => encode({ settings: { exposure } })), texts.map((text) => `exposure=${text}`));
});

test("numbers come back as the renderer's single floats", () => {
    for (const number of [3.799999952316284, 40.03192138671875, 1 / 3, 2.8161563873291016, 1e-8, 65504, 0]) {
        const camera = { position: [number, 0, 0], target: [0, 0, 1], up: [0, 1, 0], vertical_fov_deg: 40 };
        const back = decode(encode({ camera, settings: {} }), known).state.camera.position[0];
        assert.equal(Math.fround(back), Math.fround(number));
        assert.ok(String(back).length <= 12, String(back));
    }
});

test("a link can be read by people", () => {
    const camera = { position: [0, 1, 4], target: [0, 1, 0], up: [0, 1, 0], vertical_fov_deg: 40 };
    const text = encode({ scene: "builtin:cornell", camera, settings: { exposure: -1.5 } });
    assert.equal(text, "scene=builtin:cornell&camera=0,1,4,0,1,0,40&exposure=-1.5");
});

test("a link carries only values that differ from defaults", () => {
    const settings = { view: "direct", resolution: 64, exposure: "auto", specular: false, grid_offset: [0, 0, 0] };
    const now = { source: "builtin:cornell", camera: null, settings, touched: new Set(["resolution", "specular", "grid_offset"]) };
    assert.deepEqual(linkState(now, known.parameters), { scene: "builtin:cornell", settings: { specular: false } });
    // A preset's own values are not carried, but values set by hand are, even defaults.
    const behind = linkState({ ...now, preset: "high" }, known.parameters);
    assert.deepEqual(behind, { scene: "builtin:cornell", preset: "high", settings: { resolution: 64, specular: false, grid_offset: [0, 0, 0] } });
    const environment = { radiance: [3, 3, 3], panorama: "day", rotation_deg: 45 };
    const surrounded = linkState({ ...now, panorama: "day.hdr", environment }, known.parameters);
    assert.equal(encode({ ...surrounded, settings: {} }), "scene=builtin:cornell&environment=day.hdr&environment_intensity=3&environment_rotation=45");
    assert.equal(linkState({ ...now, panorama: [], environment }, known.parameters).environment, undefined);
    // A link cannot carry files.
    assert.equal(linkState({ ...now, source: [] }, known.parameters).scene, undefined);
});

test("an empty link gives an empty state", () => {
    for (const hash of ["", "#"]) assert.deepEqual(decode(hash, known), { state: { settings: {} }, problems: [] });
});

test("broken fields are reported and the rest applies", () => {
    const { state, problems } = decode("#resolution=many&exposure=2&view=nothing", known);
    assert.deepEqual(state.settings, { exposure: 2 });
    assert.deepEqual(problems, [
        'resolution must be a whole number, not "many"',
        'view must be one of final, direct, wire-voxels, not "nothing"',
    ]);
});

for (const [field, part] of [
    ["colour=red", 'no setting named "colour"'],
    ["__proto__=1", 'no setting named "__proto__"'],
    ["resolution=64.5", "a whole number"],
    ["exposure=1e999", "a number or auto"],
    ["exposure=0x10", "a number or auto"],
    ["specular=1", "one of on, off"],
    ["preset=best", "one of fast, high"],
    ["scale=0.1", "from 0.25 to 1"],
    ["camera=1,2,3", "7 or 10 numbers"],
    ["camera=0,1,4,0,1,0,x", "7 or 10 numbers"],
    ["camera=0,1,4,0,1,0,", "7 or 10 numbers"],
    ["camera=0,1,4,0,1,0,180", "from 1 to 170"],
    ["camera=0,1,4,0,1,4,40", "stands where it looks at"],
    ["camera=0,1,4,0,1,0,40,0,0,0", "no direction"],
    ["split=reference", "a view and a place"],
    ["split=nowhere,0.5", "one of final"],
    ["split=direct,2", "from 0 to 1"],
    ["scene=javascript:alert(1)", "http or https"],
    ["scene=builtin:../etc", "http or https"],
    ["scene=data:model/gltf-binary,x", "http or https"],
    ["scene=", "http or https"],
    ["environment=builtin:cornell", "http or https"],
    ["environment=data:image/png,x", "http or https"],
    ["environment_intensity=-1", "from 0 to"],
    ["environment_rotation=400", "from -360 to 360"],
    ["scene=%E0%A4%A", "hexadecimal"],
    ["nonsense", "name=value"],
    ["=1", "name=value"],
    ["resolution=64&resolution=128", "twice"],
]) {
    test(`a broken link: ${field}`, () => {
        const { problems } = decode(`#${field}`, known);
        assert.equal(problems.length, 1);
        assert.ok(problems[0].includes(part), problems[0]);
    });
}

test("an overlong link is reported as a problem", () => {
    const { state, problems } = decode(`#scene=${"a".repeat(100_000)}`, known);
    assert.deepEqual(state, { settings: {} });
    assert.equal(problems.length, 1);
});
