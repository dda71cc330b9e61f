// The kind of a source: a scene, or a panorama to put around it.

import assert from "node:assert/strict";
import { test } from "node:test";
import { isPanorama, nameOf } from "../../page/source.js";

const files = (...paths) => paths.map((path) => ({ path }));

test("a picture is a panorama only without a scene", () => {
    for (const source of ["https://example.org/hall.hdr", "a/b.EXR?raw=1#x", "sky.jpg", files("hall.hdr"), files("photo.png"), files("a.hdr", "readme.md")]) {
        assert.equal(isPanorama(source), true, JSON.stringify(source));
    }
    for (const source of ["builtin:cornell", "hall.glb", "https://example.org/hdr", files("hall.hdr", "room.glb"), files("wood.png", "room.obj"), files("room.bin")]) {
        assert.equal(isPanorama(source), false, JSON.stringify(source));
    }
});

test("a source is named after its main file", () => {
    assert.equal(nameOf("builtin:cornell"), "cornell");
    assert.equal(nameOf(files("room/wood.png", "room/hall.hdr", "room/room.gltf")), "room/room.gltf");
    assert.equal(nameOf(files("readme.md", "hall.hdr")), "hall.hdr");
    assert.equal(nameOf(files("notes.zip")), "notes.zip");
});
