// The types that the page's modules pass to each other. The renderer's own types come from the package.

import type {
    Camera as AnyCamera, EnvironmentChange, EnvironmentInfo as Environment, FrameReport,
    HistogramInfo as Histogram, Light, LightHere, LightKindInfo, Material, MaterialChange, ParameterInfo, Picked, Progress, SceneInfo as AnySceneInfo, SceneOptions,
} from "./lumivox/lumivox.js";

export type {
    Environment, EnvironmentChange, FrameReport, Histogram, Light, LightHere, LightKindInfo, Material, MaterialChange,
    ParameterInfo,
    Picked, Progress, SceneOptions,
};
export type Vec3 = [number, number, number];
/** Objects from the renderer have all properties that are optional in its input. */
export type Camera = Required<Omit<AnyCamera, "name">> & { name?: string };
export interface SceneInfo extends AnySceneInfo { camera: Camera; cameras: Camera[] }

/** A setting's value; for three numbers also their text, separated by commas. */
export type Value = boolean | number | string | Vec3;
export type Settings = Record<string, Value>;

/** Where a scene comes from: an address or "builtin:NAME", or files with their paths below what was dropped. */
export type Source = string | SourceFile[];
export interface SourceFile { file: File; path: string }

/** The line between two views: the right one's name or "reference", and its place from 0 (left) to 1. */
export interface Split { right: string; at: number }

/** The content of a link: everything that differs from the defaults. */
export interface LinkState {
    scene?: string;
    /** The address of a panorama, its factor, and its rotation in degrees. */
    environment?: string;
    environment_intensity?: number;
    environment_rotation?: number;
    preset?: string;
    camera?: Camera;
    split?: Split;
    scale?: number;
    settings: Settings;
}

/** The worker's data before any scene. */
export interface Catalogue {
    scenes: { name: string; title: string }[];
    presets: { name: string; title: string }[];
    parameters: ParameterInfo[];
    lights: LightKindInfo[];
    settings: Settings;
}

/** An opened scene; its number distinguishes its cameras from those of earlier scenes. */
export interface Opened { scene: SceneInfo; materials: Material[]; settings: Settings; number: number }

/** Everything that may change with undo, and the undone step. */
export interface Stepped { words: string; scene: SceneInfo; materials: Material[]; settings: Settings }

/** The output and the files of console lines, and everything that they may change. */
export interface Ran {
    text: string;
    files: File[];
    /** The scene that they opened last. */
    opened?: string;
    /** Why the following lines were not run. */
    failed?: string;
    scene?: SceneInfo;
    materials: Material[];
    settings: Settings;
    preset: string;
    /** The camera, if it has moved. */
    camera?: Camera;
    number: number;
}

/** The result of a change of settings. */
export interface Changed { settings: Settings; voxels?: number }

export interface Memory { name: string; bytes: number }

/** A message from the worker: the end of a call, its progress, or an event. */
export type FromWorker =
    | { id: number; result: unknown }
    | { id: number; error: Failure }
    | { id: number; progress: Progress }
    | { event: string; data: unknown };

/** An error in a message; after a fatal one the worker's renderer cannot be used. */
export interface Failure { message: string; code?: string; fatal: boolean }
