// Not run: compiled against the package's declarations, with what must not compile marked as such.

import init, {
    builtinScenes, createRenderer, parameters, presets,
    type Camera, type Completion, type EnvironmentInfo, type FrameReport, type Light, type LumivoxError, type Material,
    type MaterialChange, type ParameterInfo, type Picked, type Progress, type Ran, type Renderer, type SceneInfo, type Settings,
    type Split,
} from "lumivox";

await init();
await init({ module_or_path: new URL("https://example.org/lumivox_bg.wasm") });

const names: string[] = [...builtinScenes(), ...presets()].map(({ name, title }) => `${name}: ${title}`);
const table: ParameterInfo[] = parameters();
const range: [number | undefined, number | undefined] = [table[0].min, table[0].max];

const canvas = document.querySelector("canvas")!;
const renderer: Renderer = await createRenderer(canvas);
await createRenderer(canvas.transferControlToOffscreen());

const hear = ({ stage, done, total }: Progress) => `${stage} ${done} of ${total}`;
const scene: SceneInfo = await renderer.loadScene("builtin:cornell", hear);
await renderer.loadScene(new URL("https://example.org/scene.glb"));
await renderer.loadScene(new File([], "scene.glb"));
await renderer.loadScene([new File([], "scene.gltf"), new File([], "scene.bin")]);
await renderer.loadScene(document.querySelector<HTMLInputElement>("input")!.files!);

const abort = new AbortController();
const file = new File([], "hall.hdr");
await renderer.loadScene("hall.glb", null, { signal: abort.signal, panorama: file, surroundings: "auto" });
const around: EnvironmentInfo = await renderer.loadPanorama(file, hear, { signal: AbortSignal.timeout(1000) });
await renderer.loadPanorama(new URL("https://example.org/hall.exr"));
await renderer.setEnvironment({ rotation_deg: around.rotation_deg + 90, radiance: [2, 2, 2] });
await renderer.setEnvironment({ panorama: null });
const materials: Material[] = await renderer.materials();
const change: MaterialChange = { roughness: 0.25, emission: [100, 90, 80] };
await renderer.setMaterial(0, change);
const picked: Picked | undefined = await renderer.pick(0.5, 0.5);
const object: string | undefined = picked && scene.objects[picked.object].name;

const camera: Camera = { position: [0, 1, 4], target: [0, 1, 0] };
await renderer.setCamera({ ...camera, up: [0, 1, 0], vertical_fov_deg: 40 });
const height: number = (await renderer.camera()).position[1];
const light: Light = { kind: "spot", intensity: 800, position: [0, 2, 0], inner_angle_deg: 20, range_m: null };
const number: number = await renderer.addLight(light);
await renderer.setLight(number, { ...scene.lights[0], color: [1, 0.5, 0] });
await renderer.removeLight(number);
await renderer.setHidden(0, true);
await renderer.play(0);
await renderer.play(null);
await renderer.setTime(0.5);

const ran: Ran = await renderer.run("load builtin:cornell; screenshot a.png", hear, { signal: abort.signal });
const [printed, written]: [string, File[]] = [ran.text, ran.files];
const { start, candidates }: Completion = await renderer.complete("reso");

const settings: Settings = { resolution: 64, volume: "octree", exposure: "auto", view: "indirect", grid_offset: [0, 0.5, 0] };
await renderer.set(settings, hear);
await renderer.set({ exposure: -1.5 });
const now: Required<Settings> = await renderer.settings();
const frames: number = now.frames;
await renderer.setPreset("fast", hear);
const split: Split = { right: "reference", at: 0.25, samples: 64 };
await renderer.setSplit(split);
await renderer.setSplit({ right: "direct" });
await renderer.setSplit(null);

await renderer.resize(640, 360);
await renderer.setCamera(camera, true);
await renderer.setFrameBudget(0);
await renderer.setTimed(true);
const report: FrameReport = await renderer.render();
const moment: number | undefined = report.time_s;
const text = `${moment} ${report.frame}/${report.frames} ${report.complete} ${report.frame_ms} ${report.budget_ms} ${report.scale} ${report.samples_per_pixel} ${report.history_frames} ${report.stages[0]?.name}`;
const image: ImageData = await renderer.readPixels();
const bytes: number = (await renderer.memory()).reduce((sum, part) => sum + part.bytes, 0);
const device: GPUDevice = await renderer.device();
if (await renderer.isLost()) await renderer.restore(hear);
const reason: string = await renderer.lost();
renderer.free();

try {
    await renderer.render();
} catch (error) {
    const { code, message } = error as LumivoxError;
    if (code === "limit") console.log(message);
    // @ts-expect-error: there is no such code
    if (code === "limits") console.log(message);
}

// @ts-expect-error: a renderer needs a canvas
await createRenderer();
// @ts-expect-error: not just any element
await createRenderer(document.body);
// @ts-expect-error: renderers are made by createRenderer
new Renderer();
// @ts-expect-error: no scene
await renderer.loadScene(3);
// @ts-expect-error: no such setting
await renderer.set({ resolutoin: 64 });
// @ts-expect-error: no such volume
await renderer.set({ volume: "sparse" });
// @ts-expect-error: no such word
await renderer.set({ exposure: "automatic" });
// @ts-expect-error: no number
await renderer.set({ resolution: "64" });
// @ts-expect-error: two numbers
await renderer.setCamera({ position: [0, 0], target: [0, 0, 1] });
// @ts-expect-error: a camera looks somewhere
await renderer.setCamera({ position: [0, 0, 0] });
// @ts-expect-error: a material's name stays
await renderer.setMaterial(0, { name: "red" });
// @ts-expect-error: no signal
await renderer.loadScene("hall.glb", null, { signal: true });
// @ts-expect-error: two numbers make a place
await renderer.pick(0.5);
// @ts-expect-error: another panorama is loaded
await renderer.setEnvironment({ panorama: 3 });
// @ts-expect-error: no such kind
await renderer.addLight({ kind: "sun" });
// @ts-expect-error: nothing on the right
await renderer.setSplit({ at: 0.5 });
// @ts-expect-error: both sides count
await renderer.resize(640);
// @ts-expect-error: pixels come as an ImageData
const wrong: Uint8Array = await renderer.readPixels();

export { bytes, device, frames, height, image, materials, names, object, range, reason, text, wrong };
