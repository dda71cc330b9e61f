// @ts-check
// Frame and stage times: stacked bars of the last frames, and numbers of the newest one.

import { byId, h, mebibytes } from "./dom.js";
import { milliseconds, timesText } from "./status.js";

/** @typedef {import("./types.js").FrameReport} FrameReport */
/** @typedef {import("./types.js").Memory} Memory */

/** The number of shown frames. */
const FRAMES = 80;
/** Colours of stages, distinguishable on dark ground even without colour vision (after Okabe and
 * Ito 2008). */
const COLORS = ["#8c8c8c", "#cc79a7", "#f0e442", "#56b4e9", "#009e73", "#e69f00", "#0072b2", "#d55e00"];
/** Time outside of stages. */
const REST = "#4a4e57";

/** @type {FrameReport[]} */
const reports = [];
/** @type {string[]} */
const stages = [];
let isDue = false;

/** @param {FrameReport} report */
export function addReport(report) {
    reports.push(report);
    if (reports.length > FRAMES) reports.shift();
    for (const { name } of report.stages) if (!stages.includes(name)) stages.push(name);
    if (isDue) return;
    isDue = true;
    requestAnimationFrame(() => {
        isDue = false;
        show();
    });
}

export function clearReports() {
    reports.length = 0;
}

/** @param {string} stage */
const color = (stage) => COLORS[stages.indexOf(stage) % COLORS.length];

function show() {
    const last = reports.at(-1);
    if (!last) return;
    const mean = reports.reduce((sum, report) => sum + report.frame_ms, 0) / reports.length;
    byId("times").textContent = timesText(last, reports.length, mean);
    chart();
    const rows = last.stages.map(({ name, ms }) => {
        const mark = h("i");
        mark.style.background = color(name);
        const bar = h("b");
        bar.style.width = `${(100 * ms) / Math.max(last.frame_ms, ms, 1e-6)}%`;
        bar.style.background = color(name);
        return h("tr", {}, h("th", { scope: "row" }, mark, name), h("td", { "aria-hidden": "true" }, bar), h("td", {}, milliseconds(ms)));
    });
    byId("stages").querySelector("tbody")?.replaceChildren(...rows);
}

function chart() {
    const canvas = byId("chart", HTMLCanvasElement);
    const { clientWidth, clientHeight } = canvas;
    const context = canvas.getContext("2d");
    if (!context || clientWidth === 0) return;
    canvas.width = clientWidth * devicePixelRatio;
    canvas.height = clientHeight * devicePixelRatio;
    context.scale(devicePixelRatio, devicePixelRatio);
    const most = Math.max(...reports.map((report) => report.frame_ms), 1e-6);
    const width = clientWidth / FRAMES;
    reports.forEach((report, index) => {
        const x = clientWidth - (reports.length - index) * width;
        let y = clientHeight;
        const piece = (/** @type {number} */ ms, /** @type {string} */ fill) => {
            const height = (ms / most) * clientHeight;
            y -= height;
            context.fillStyle = fill;
            context.fillRect(x, y, Math.max(1, width - 0.5), height);
        };
        for (const { name, ms } of report.stages) piece(ms, color(name));
        piece(Math.max(0, report.frame_ms - report.stages.reduce((sum, stage) => sum + stage.ms, 0)), REST);
    });
}

/** @param {Memory[]} memory */
export function showMemory(memory) {
    const total = { name: "total", bytes: memory.reduce((sum, { bytes }) => sum + bytes, 0) };
    const rows = [...memory, total].map(({ name, bytes }) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, mebibytes(bytes))));
    byId("memory").querySelector("tbody")?.replaceChildren(...rows);
}
