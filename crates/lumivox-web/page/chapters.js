// @ts-check
// The chapters of the first page: scenes, cameras, settings, and what moves in them.

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Vec3} Vec3 */
/** @typedef {{ call: string, data: unknown }} Order a call of the worker */
/** @typedef {{ scene: string, camera: Camera, settings: Settings, orders?: Order[],
 *   moving?: (seconds: number) => Order, isCompared?: boolean }} Chapter
 *   `orders` are run when the chapter begins; `moving` gives the pose at a time, by itself */

/** Usual values of the settings that chapters change. The exposure is fixed: the pictures below
 * the canvas have the same. @type {Settings} */
export const USUAL = { view: "final", wireframe: "off", level: 0, bounces: 4, frames: 24, exposure: -12 };

/** @param {Vec3} position @param {Vec3} target @param {number} vertical_fov_deg
 * @returns {Camera} */
const camera = (position, target, vertical_fov_deg) => ({ position, target, up: [0, 1, 0], vertical_fov_deg });

/** The sun of the hall; `turned` moves it across. @param {number} turned rad @returns {Order} */
const sun = (turned) => ({
    call: "light",
    data: {
        index: 0,
        light: { name: "sun", kind: "directional", intensity: 80_000, color: [1, 0.96, 0.9], direction: [0.3 + 0.25 * Math.sin(0.7 * turned), -1, 0.36 - 0.5 * Math.sin(turned)] },
    },
});

const hall = {
    scene: "builtin:atrium",
    camera: camera([-5.6, 1.65, -0.6], [3, 2.3, 0.4], 60.2),
    orders: [sun(0)],
};

/** The lamp of the furnished room. @param {Vec3} position @returns {Order} */
export const lampAt = (position) => ({
    call: "light",
    data: { index: 0, light: { name: "lamp", kind: "point", intensity: 120, position } },
});
/** Its first place, and the room in which it may be, metres.
 * @type {{ first: Vec3, min: Vec3, max: Vec3 }} */
export const LAMP = { first: [0, 1.75, 0], min: [-2.2, 0.3, -1.7], max: [2.2, 2.4, 1.7] };

/** The wall between two rooms, slid aside. @param {number} metres @returns {Order} */
export const wallAt = (metres) => ({ call: "run", data: `place 'dividing wall' 0 0 ${-metres} 0 0 0 1` });
export const WALL_FIRST_M = 0.5;

/** @type {Record<string, Chapter>} */
export const CHAPTERS = {
    room: { ...hall, settings: {}, moving: (seconds) => sun(0.5 * seconds) },
    triangles: { ...hall, settings: { view: "direct", wireframe: "over" } },
    voxels: { ...hall, settings: { view: "voxels", resolution: 48 } },
    light: { ...hall, settings: { view: "lit", resolution: 48 } },
    cones: { ...hall, settings: { view: "indirect" } },
    bounces: { ...hall, settings: { bounces: 8 } },
    truth: { ...hall, settings: {}, isCompared: true },
    lamp: {
        scene: "builtin:furnished",
        camera: camera([2.3, 1.7, 1.8], [-0.8, 0.75, -0.6], 57.3),
        settings: { exposure: -4.2, bounces: 8 },
        orders: [lampAt(LAMP.first)],
    },
    wall: {
        scene: "builtin:two-rooms-closed",
        camera: camera([1.85, 1.3, -0.8], [0, 0.85, 0.3], 60.2),
        settings: { exposure: -1.4, bounces: 8 },
        orders: [wallAt(WALL_FIRST_M)],
    },
};
