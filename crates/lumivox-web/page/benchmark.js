// @ts-check
// The benchmark of the first page: fixed scenes and sizes, for about 20 s. `lumivox bench --import`
// reads its result.

/** @typedef {import("./types.js").FrameReport} FrameReport */
/** @typedef {import("./types.js").Light} Light */
/** @typedef {import("./types.js").Opened} Opened */
/** @typedef {import("./types.js").Vec3} Vec3 */
/** @typedef {{ id: string, frames: number, median_ms: number, p95_ms: number }} Measured */
/** @typedef {{ name: string, is_fallback: boolean }} Gpu */
/** @typedef {{ kind: string, format: number, lumivox: string, date: string, gpu: Gpu,
 *   browser: string, clock: "timestamps" | "frames", cases: Measured[] }} Result */
/** @typedef {{ ask: (call: string, data?: unknown) => Promise<any>,
 *   frame: () => Promise<FrameReport>, say: (words: string) => void }} Stage
 *   `frame` resolves with the next report */

const SIZE = { width: 640, height: 360 };
const SETTINGS = { view: "final", wireframe: "off", level: 0, bounces: 16, resolution: 64, exposure: -6 };
/** The longest time of a case, ms, the fewest frames, those not counted (the first one after
 * loading also voxelizes), and the longest time of all. */
const [CASE_MS, FEWEST, IGNORED, ALL_MS] = [4000, 3, 2, 20_000];
/** Frames of a circle of what moves; the lamp's, metres; the block's, metres; the sun's, rad. */
const [TURN, LAMP_M, BLOCK_M, SUN_RAD] = [60, 0.1, 0.1, 0.05];

/** The measured scenes, and their moving things as lines of the console.
 * @type {{ scene: string, move: (light: Light, angle: number) => string }[]} */
const SCENES = [
    {
        scene: "cornell",
        move: ({ name, position: [x, y, z] = [0, 0, 0] }, angle) =>
            `light '${name}' position ${x + LAMP_M * Math.sin(angle)} ${y} ${z + LAMP_M * Math.cos(angle)}\n` +
            `place 'short block' 0.33 0 ${0.4 + BLOCK_M * Math.sin(angle)} 0 ${-17 + 10 * Math.sin(angle)} 0 1`,
    },
    {
        scene: "atrium",
        move: ({ name, direction = [0, -1, 0] }, angle) => {
            const turned = SUN_RAD * Math.sin(angle);
            const [x, y, z] = direction;
            return `light '${name}' direction ${x * Math.cos(turned) + z * Math.sin(turned)} ${y} ${z * Math.cos(turned) - x * Math.sin(turned)}`;
        },
    },
];

/** The name of the GPU: WebGL has all of it, WebGPU in some browsers only its maker.
 * @returns {Promise<Gpu>} */
export async function gpu() {
    const info = (await navigator.gpu?.requestAdapter())?.info;
    const context = document.createElement("canvas").getContext("webgl");
    const extension = context?.getExtension("WEBGL_debug_renderer_info");
    const long = extension && context ? String(context.getParameter(extension.UNMASKED_RENDERER_WEBGL)) : "";
    // ANGLE (NVIDIA, NVIDIA GeForce RTX 3080 Direct3D11 vs_5_0 ps_5_0, D3D11)
    const named = /^ANGLE \([^,]*, (.*?)(?: \(0x[0-9a-f]+\))?(?: Direct3D.*| OpenGL.*)?(?:,.*)?\)$/i.exec(long)?.[1] ?? long;
    const own = [info?.vendor, info?.architecture, info?.device, info?.description].filter(Boolean).join(" ");
    const is_fallback = /** @type {{ isFallbackAdapter?: boolean } | undefined} */ (info)?.isFallbackAdapter ?? /swiftshader|llvmpipe|basic render/i.test(`${own} ${long}`);
    return { name: named || own || "unknown", is_fallback };
}

/** @param {number[]} values @param {number} share */
const quantile = (values, share) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))];

/** The GPU's time of a frame, ms; undefined if it is not known or cannot be true.
 * @param {FrameReport} report */
function gpuTime({ stages, frame_ms }) {
    const sum = stages.reduce((all, { ms }) => all + ms, 0);
    return sum > 0 && sum <= frame_ms ? sum : undefined;
}

/** Measures. @param {Stage} stage @param {Gpu} gpu @returns {Promise<Result>} */
export async function measure(stage, gpu) {
    // All cases have the same clock.
    const timed = gpu.is_fallback ? undefined : await measureBy("timestamps", stage);
    const cases = timed ?? (await measureBy("frames", stage)) ?? [];
    await stage.ask("timed", false);
    const { version } = await (await fetch("lumivox/package.json")).json();
    return {
        kind: "lumivox visitor", format: 1, lumivox: version, date: new Date().toISOString().slice(0, 10),
        gpu, browser: navigator.userAgent, clock: timed ? "timestamps" : "frames", cases,
    };
}

/** Measures all cases by a clock; undefined if most frames of a case have no time of it.
 * @param {Result["clock"]} clock @param {Stage} stage @returns {Promise<Measured[] | undefined>} */
async function measureBy(clock, { ask, frame, say }) {
    const began = performance.now();
    /** @type {Measured[]} */
    const cases = [];
    await ask("budget", 0);
    await ask("timed", clock === "timestamps");
    await ask("preset", "balanced");
    await ask("set", SETTINGS);
    await ask("resize", SIZE);
    /** The next rendered frame, after `complete` ones. */
    const rendered = async () => {
        for (;;) {
            const report = await frame();
            if (!report.complete) return report;
        }
    };
    /** Measures a case; false if most of its frames have no time.
     * @param {string} id @param {() => Promise<FrameReport>} next */
    const run = async (id, next) => {
        say(`Measuring: ${id}`);
        for (let at = 0; at < IGNORED; at += 1) await next();
        const start = performance.now();
        /** @type {number[]} */
        const times = [];
        for (let frames = 1; times.length < FEWEST || performance.now() - start < CASE_MS; frames += 1) {
            const report = await next();
            const ms = clock === "timestamps" ? gpuTime(report) : report.frame_ms;
            if (ms !== undefined) times.push(ms);
            if (frames >= FEWEST && 2 * times.length < frames) return false;
        }
        const round = (/** @type {number} */ ms) => Number(ms.toPrecision(4));
        cases.push({ id, frames: times.length, median_ms: round(quantile(times, 0.5)), p95_ms: round(quantile(times, 0.95)) });
        return true;
    };
    for (const { scene, move } of SCENES) {
        if (cases.length > 0 && performance.now() - began > ALL_MS) break;
        say(`Loading ${scene}`);
        await ask("set", { frames: 65536 });
        /** @type {Opened} */
        const opened = await ask("load", { source: `builtin:${scene}`, options: {} });
        const light = opened.scene.lights[0];
        if (!(await run(`${scene} still`, rendered))) return undefined;
        if (performance.now() - began > ALL_MS) break;
        // One frame for each change; then it sleeps.
        await ask("set", { frames: 1 });
        let step = 0;
        const isMeasured = await run(`${scene} moving`, async () => {
            step += 1;
            const next = rendered();
            await ask("run", move(light, (2 * Math.PI * step) / TURN));
            const report = await next;
            while (!(await frame()).complete);
            return report;
        });
        if (!isMeasured) return undefined;
    }
    return cases;
}
