// The camera's movements, as the window's (lumivox-app/src/window/camera.rs) are tested.

import assert from "node:assert/strict";
import { test } from "node:test";
import { axes, dolly, dot, fitted, fly, frame, length, look, lookAt, orbit, pan, subtract } from "../../page/camera.js";

const camera = { position: [0, 1, 5], target: [0, 1, 0], up: [0, 1, 0], vertical_fov_deg: 46 };

/** Asserts that vectors are equal up to rounding. */
function near(actual, expected) {
    actual.forEach((value, axis) => assert.ok(Math.abs(value - expected[axis]) < 1e-9, `${actual} is not ${expected}`));
}

test("an orbit keeps its target and its distance, and follows the pointer", () => {
    const turned = orbit(camera, 0.7, -0.3);
    assert.deepEqual(turned.target, camera.target);
    assert.ok(Math.abs(length(subtract(turned.position, turned.target)) - 5) < 1e-9);
    // Dragged to the right, the scene turns to the right: the camera goes to the left. Dragged
    // down, it rises.
    assert.ok(orbit(camera, 0.1, 0).position[0] < 0);
    assert.ok(orbit(camera, 0, 0.1).position[1] > 1);
});

test("orbiting past the poles never flips the camera", () => {
    for (const move of [orbit, look]) {
        let turned = camera;
        for (let step = 0; step < 50; step += 1) turned = move(turned, 0.1, 0.2);
        const down = axes(turned).forward[1];
        assert.ok(down < -0.99 && down > -0.9999, `${down}`);
        assert.ok(Math.abs(axes(move(turned, 0, -1.55)).forward[1]) < 0.05);
    }
});

test("a camera that looks straight down still has axes at right angles", () => {
    const { forward, right, above } = axes({ ...camera, target: [0, 0, 5], position: [0, 1, 5] });
    for (const [a, b] of [[forward, right], [right, above], [above, forward]]) assert.ok(Math.abs(dot(a, b)) < 1e-12);
    for (const axis of [forward, right, above]) assert.ok(Math.abs(length(axis) - 1) < 1e-12);
    for (const turned of [orbit, look].map((move) => move({ ...camera, target: [0, 0, 5], position: [0, 1, 5] }, 0.1, 0.1))) {
        assert.ok([...turned.position, ...turned.target].every(Number.isFinite));
    }
});

test("flying follows the view", () => {
    const moved = fly(camera, [1, 2, 3]);
    near(moved.position, [1, 3, 2]);
    near(subtract(moved.target, moved.position), [0, 0, -5]);
});

test("panning keeps the target under the pointer", () => {
    const height = 2 * 5 * Math.tan((23 * Math.PI) / 180);
    near(pan(camera, 0.5, 0).position, [-0.5 * height, 1, 5]);
    near(pan(camera, 0, 0.25).position, [0, 1 + 0.25 * height, 5]);
});

test("a dolly stops before its target", () => {
    near(dolly(camera, 0.5, 0.1).position, [0, 1, 2.5]);
    near(dolly(camera, 1e-9, 0.1).position, [0, 1, 0.1]);
    // A camera that is already nearer is not moved back.
    const close = { ...camera, position: [0, 1, 0.05] };
    near(dolly(close, 0.5, 0.1).position, [0, 1, 0.05]);
    near(dolly(close, 4, 0.1).position, [0, 1, 0.2]);
});

test("a framed box is all in the picture", () => {
    const bounds = { min: [-1, 2, 3], max: [4, 5, 9] };
    for (const aspect of [0.5, 2]) {
        const framed = fitted(frame(orbit(camera, 0.4, 0.3), bounds), aspect);
        const { forward, right, above } = axes(framed);
        const tangent = Math.tan((framed.vertical_fov_deg * Math.PI) / 360);
        for (let corner = 0; corner < 8; corner += 1) {
            const point = [0, 1, 2].map((axis) => (corner & (1 << axis) ? bounds.max : bounds.min)[axis]);
            const seen = subtract(point, framed.position);
            const depth = dot(seen, forward);
            assert.ok(depth > 0);
            assert.ok(Math.abs(dot(seen, above)) <= depth * tangent * 1.001);
            assert.ok(Math.abs(dot(seen, right)) <= depth * tangent * aspect * 1.001);
        }
    }
});

test("an upright picture sees as far to the sides as a square one", () => {
    assert.equal(fitted(camera, 1.6), camera);
    const half = (fov) => Math.tan((fov * Math.PI) / 360);
    const upright = fitted(camera, 0.5);
    assert.ok(Math.abs(half(upright.vertical_fov_deg) * 0.5 - half(46)) < 1e-12);
    assert.equal(fitted(camera, 0.01).vertical_fov_deg, 150);
    assert.equal(fitted({ ...camera, vertical_fov_deg: 160 }, 0.5).vertical_fov_deg, 160);
});

test("another axis may point up", () => {
    const lying = { position: [0, -5, 1], target: [0, 0, 1], up: [0, 0, 1], vertical_fov_deg: 46 };
    assert.ok(orbit(lying, 0.1, 0).position[0] < 0);
    near(fly(lying, [0, 2, 0]).position, [0, -5, 3]);
});

test("lookAt keeps the position and sets the target", () => {
    const turned = lookAt(camera, [2, 1, 1]);
    assert.deepEqual(turned.position, camera.position);
    near(axes(turned).forward, [2 / Math.hypot(2, 4), 0, -4 / Math.hypot(2, 4)]);
    assert.deepEqual(orbit(turned, 0.3, 0.1).target, [2, 1, 1]);
    // The camera's own position has no direction.
    assert.equal(lookAt(camera, camera.position), camera);
});
