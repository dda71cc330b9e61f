/// <reference types="@webgpu/types" />
import type { Box3, Camera, ContextNode, Scene, TextureNode, WebGPURenderer } from "three/webgpu";

/** Settings of the cones by name, as in the console and in Python: `gi.set("cones", 12)`. */
export type ConeSettings = {
    /** Diffuse cones of a pixel in a frame. Default: 9. More: less noise, at proportional cost. */
    cones?: 6 | 9 | 12;
    /** Cones from every pixel, or from one of each 2x2 block. Default: that of the preset. */
    trace_resolution?: "full" | "half";
    /** Light of earlier frames, carried along with the surfaces that it is on. Default: that of the preset. */
    temporal?: boolean;
    /** Glossy reflections. Default: true. */
    specular?: boolean;
    /** Width of a glossy cone as a share of the lobe's solid angle, 0.02 to 1. Default: 0.25. Lower: sharper, noisier. */
    specular_share?: number;
    /** Sampled voxel's edge as a share of the cone's diameter, 0.05 to 1. Default: that of the preset. Lower: sharper, slower. */
    voxel_per_diameter?: number;
    /** Start of the cones above the surface, voxels, 0 to 4. Default: 0.5. */
    normal_offset?: number;
    /** Distance between samples as a share of the sampled voxel's edge, 0.25 to 1. Default: 1. */
    step?: number;
    /** Greatest growth of the sampled voxels by metre and cosine: 0 (off) or 0.1 to 1. Default: that of the preset. */
    clearance?: number;
    /** Share of light below which a cone ends, 0 to 0.25. Default: 0.15. */
    min_transmittance?: number;
    /** Reach of ambient occlusion, metres, or "unlimited", the default; it never changes the light. */
    occlusion_distance?: number | "unlimited";
};

export interface GiOptions extends ConeSettings {
    /** What is lit. Its unit of length is the metre. */
    scene: Scene;
    /** What sees it. */
    camera: Camera;
    /** Voxels along the longest axis, a multiple of 8 from 16 to 1024; above 384 in an octree. Default: 128. */
    resolution?: number;
    /** Where voxels are, metres. Default: around all meshes that the scene has now. */
    bounds?: Box3 | null;
    /** Quality against cost. Default: "realtime", which keeps light of earlier frames. */
    preset?: "fast" | "realtime" | "balanced" | "high";
    /** Where cells are stored: "dense" (the default) is faster, "octree" takes less memory at high resolutions. */
    volume?: "dense" | "octree";
    /** The most faces of voxels that gather light in a frame. Default: all. Fewer: cheaper frames, later light. */
    facesPerFrame?: number | null;
    /** The most bytes that the volume may take. Default: as much as the device gives. */
    memoryBudget?: number | null;
    /** Whether the suns in `scene.environment` become lights of three.js, with shadows. Default: true. */
    suns?: boolean;
    /** Hears how many pipelines are compiled, and of how many. */
    onProgress?: ((done: number, total: number) => void) | null;
}

/** The light of one scene. */
export interface Gi {
    readonly scene: Scene;
    readonly camera: Camera;
    /** Where voxels are, metres. */
    readonly bounds: Box3;
    /** For `pass.contextNode`: gives all materials of the pass this light, in place of that of `scene.environment`; transparent
     * ones and glass get it from probes. */
    readonly context: ContextNode;
    /** Irradiance in rgb, and in a the open share of the hemisphere; of the size of the renderer's drawing buffer. */
    readonly irradiance: TextureNode;
    /** What surfaces reflect glossily towards the camera, cd/m². */
    readonly reflection: TextureNode;
    /** What of the scene is not taken as it is, in words. */
    readonly notes: string[];
    /** The last frame: whether it shows older voxels, since there was no room yet, how many voxels there are, and sides of them. */
    readonly stats: { late: boolean; voxels: number; faces: number };
    /** Bytes on the GPU. */
    readonly memory: number;
    /** Changes a setting of the cones; but not `temporal` and `trace_resolution`. */
    set<Name extends Exclude<keyof ConeSettings, "temporal" | "trace_resolution">>(name: Name, value: NonNullable<ConeSettings[Name]>): void;
    /** Forgets the light of earlier frames: for a cut. */
    cut(): void;
    /** Computes the light of a frame. Passes with `context` do so themselves; it is for pages that use the textures alone. */
    update(): void;
    /** Frees all memory on the GPU. Materials are then without its light. */
    dispose(): void;
}

/** An error of this module. */
export interface LumivoxError extends Error {
    code: "no-webgpu" | "value" | "limit" | "device";
}

/** Loads the WebAssembly; `createGi` does so itself. `source` is needed only where a bundler does not find the file. */
export function initialize(source?: string | URL | Response | BufferSource | WebAssembly.Module | Promise<Response>): Promise<unknown>;

/** A device with limits as high as the GPU goes, for `new WebGPURenderer({ device })`. A renderer's own device does as well,
 * unless a scene needs more than 128 MiB in one buffer. */
export function createDevice(options?: GPURequestAdapterOptions): Promise<GPUDevice>;

/** Global illumination of a scene on the renderer's own device. Rejects with a `LumivoxError`. */
export function createGi(renderer: WebGPURenderer, options: GiOptions): Promise<Gi>;
