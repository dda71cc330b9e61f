// @ts-check
// Links with scene, camera, split and settings after the '#': writing, reading and checking them.
// Example: #scene=builtin:cornell&camera=0,1,4,0,1,0,40&split=reference,0.5&resolution=128

/** @typedef {import("./types.js").Camera} Camera */
/** @typedef {import("./types.js").LinkState} LinkState */
/** @typedef {import("./types.js").ParameterInfo} ParameterInfo */
/** @typedef {import("./types.js").Settings} Settings */
/** @typedef {import("./types.js").Value} Value */
/** @typedef {import("./types.js").Vec3} Vec3 */

/** The longest link that is read, in characters: many times the length that a page writes. */
const LONGEST = 16384;

/** The text after the '#'.
 * @param {LinkState} state @returns {string} */
export function encode(state) {
    /** @type {[string, string][]} */
    const fields = [];
    if (state.scene !== undefined) fields.push(["scene", state.scene]);
    if (state.environment !== undefined) fields.push(["environment", state.environment]);
    if (state.environment_intensity !== undefined) fields.push(["environment_intensity", short(state.environment_intensity)]);
    if (state.environment_rotation !== undefined) fields.push(["environment_rotation", short(state.environment_rotation)]);
    if (state.preset !== undefined) fields.push(["preset", state.preset]);
    if (state.camera) fields.push(["camera", cameraText(state.camera)]);
    if (state.split) fields.push(["split", `${state.split.right},${short(state.split.at)}`]);
    if (state.scale !== undefined) fields.push(["scale", short(state.scale)]);
    for (const [name, value] of Object.entries(state.settings)) fields.push([name, valueText(value)]);
    const plain = (/** @type {string} */ text) =>
        encodeURIComponent(text).replace(/%2C/g, ",").replace(/%3A/g, ":").replace(/%2F/g, "/");
    return fields.map(([name, value]) => `${plain(name)}=${plain(value)}`).join("&");
}

/** Reads the text behind a '#', with or without it. Unreadable parts are left out and reported.
 * @param {string} hash
 * @param {{ parameters: ParameterInfo[], presets: { name: string }[] }} known
 * @returns {{ state: LinkState, problems: string[] }} */
export function decode(hash, known) {
    /** @type {LinkState} */
    const state = { settings: {} };
    /** @type {string[]} */
    const problems = [];
    if (hash.length > LONGEST) return { state, problems: [`the link is longer than ${LONGEST} characters`] };
    const seen = new Set();
    for (const field of hash.replace(/^#/, "").split("&")) {
        if (field === "") continue;
        try {
            const [name, text] = nameAndText(field);
            if (seen.has(name)) throw new Error(`${name} is given twice`);
            seen.add(name);
            readField(state, name, text, known);
        } catch (error) {
            problems.push(error instanceof Error ? error.message : String(error));
        }
    }
    return { state, problems };
}

/** @param {LinkState} state @param {string} name @param {string} text
 * @param {{ parameters: ParameterInfo[], presets: { name: string }[] }} known */
function readField(state, name, text, { parameters, presets }) {
    if (name === "scene") state.scene = sceneOf(text);
    else if (name === "environment") state.environment = addressOf(name, text);
    else if (name === "environment_intensity") state.environment_intensity = between(name, text, 0, 1e10);
    else if (name === "environment_rotation") state.environment_rotation = between(name, text, -360, 360);
    else if (name === "camera") state.camera = cameraOf(text);
    else if (name === "split") state.split = splitOf(text, parameters);
    else if (name === "preset") state.preset = oneOf(name, text, presets.map((preset) => preset.name));
    else if (name === "scale") state.scale = between(name, text, 0.25, 1);
    else {
        const info = parameters.find((parameter) => parameter.name === name);
        if (!info) throw new Error(`there is no setting named "${name}"`);
        state.settings[name] = valueOf(info, text);
    }
}

/** The value of a setting from its text. The renderer checks the range.
 * @param {ParameterInfo} info @param {string} text @returns {Value} */
export function valueOf(info, text) {
    const words = info.words ?? [];
    if (words.includes(text)) return text;
    if (info.kind === "switch") return oneOf(info.name, text, ["on", "off"]) === "on";
    if (info.kind === "choice") return oneOf(info.name, text, info.choices ?? []);
    if (info.kind !== "whole" && info.kind !== "number") return text;
    const number = numberOf(text);
    if (number === undefined || (info.kind === "whole" && !Number.isInteger(number))) {
        const what = info.kind === "whole" ? "a whole number" : "a number";
        throw new Error(`${info.name} must be ${[what, ...words].join(" or ")}, not "${text}"`);
    }
    return number;
}

/** @param {Value} value @returns {string} */
function valueText(value) {
    if (typeof value === "boolean") return value ? "on" : "off";
    if (typeof value === "number") return short(value);
    return typeof value === "string" ? value : value.map(short).join(",");
}

/** The shortest decimal, of 6 to 9 digits, for the single float that the renderer uses.
 * @param {number} number */
function short(number) {
    for (let digits = 6; digits < 9; digits += 1) {
        const shorter = Number(number.toPrecision(digits));
        if (Math.fround(shorter) === Math.fround(number)) return String(shorter);
    }
    return String(Number(number.toPrecision(9)));
}

/** @param {Camera} camera */
export function cameraText(camera) {
    const numbers = [...camera.position, ...camera.target, camera.vertical_fov_deg];
    const [x, y, z] = camera.up;
    if (x !== 0 || y !== 1 || z !== 0) numbers.push(x, y, z);
    return numbers.map(short).join(",");
}

/** @param {string} text @returns {Camera} */
export function cameraOf(text) {
    const numbers = text.split(",").map(numberOf);
    const format = "camera must be 7 or 10 numbers: position, target, vertical angle in degrees, and up";
    if (numbers.length !== 7 && numbers.length !== 10) throw new Error(format);
    const [px, py, pz, tx, ty, tz, fov, ux = 0, uy = 1, uz = 0] = numbers.map((number) => {
        if (number === undefined) throw new Error(format);
        return number;
    });
    if (fov < 1 || fov > 170) throw new Error(`the camera's angle must be from 1 to 170 degrees, not ${fov}`);
    /** @type {Camera} */
    const camera = { position: [px, py, pz], target: [tx, ty, tz], up: [ux, uy, uz], vertical_fov_deg: fov };
    if (px === tx && py === ty && pz === tz) throw new Error("the camera stands where it looks at");
    if (ux === 0 && uy === 0 && uz === 0) throw new Error("the camera's up has no direction");
    return camera;
}

/** @param {string} text @param {ParameterInfo[]} parameters */
function splitOf(text, parameters) {
    const [right, at, ...rest] = text.split(",");
    if (at === undefined || rest.length > 0) throw new Error("split must be a view and a place, as in reference,0.5");
    const views = parameters.find((parameter) => parameter.name === "view")?.choices ?? [];
    return { right: oneOf("split", right, [...views, "reference"]), at: between("the place of the split", at, 0, 1) };
}

/** @param {string} text */
function sceneOf(text) {
    return /^builtin:[a-z0-9-]+$/.test(text) ? text : addressOf("scene", text, "builtin:NAME or ");
}

/** Accepts only addresses that a page may fetch: no scripts, no data within the link.
 * @param {string} name @param {string} text @param {string} [others] alternatives, for the error */
function addressOf(name, text, others = "") {
    if (/^https?:\/\/[^/\s]/i.test(text) || (text !== "" && !/^[a-z][a-z0-9+.-]*:/i.test(text))) return text;
    throw new Error(`${name} must be ${others}an address with http or https, not "${text}"`);
}

/** @param {string} field @returns {[string, string]} */
function nameAndText(field) {
    const at = field.indexOf("=");
    if (at < 1) throw new Error(`"${field}" is not of the form name=value`);
    try {
        return [decodeURIComponent(field.slice(0, at)), decodeURIComponent(field.slice(at + 1))];
    } catch {
        throw new Error(`"${field}" has a % without two hexadecimal digits of UTF-8 behind it`);
    }
}

/** @param {string} text @returns {number | undefined} */
function numberOf(text) {
    return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) && Number.isFinite(Number(text)) ? Number(text) : undefined;
}

/** @param {string} name @param {string} text @param {number} low @param {number} high */
function between(name, text, low, high) {
    const number = numberOf(text);
    if (number === undefined || number < low || number > high) {
        throw new Error(`${name} must be a number from ${low} to ${high}, not "${text}"`);
    }
    return number;
}

/** @param {string} name @param {string} text @param {string[]} names */
function oneOf(name, text, names) {
    if (!names.includes(text)) throw new Error(`${name} must be one of ${names.join(", ")}, not "${text}"`);
    return text;
}
