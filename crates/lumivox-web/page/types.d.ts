// What the page's modules pass to each other. The renderer's own types come from the package.

import type {
    Camera as AnyCamera, EnvironmentChange, EnvironmentInfo as Environment, FrameReport,
    HistogramInfo as Histogram, Light, LightHere, Material, MaterialChange, ParameterInfo, Picked, Progress, SceneInfo as AnySceneInfo, SceneOptions,
} from "./lumivox/lumivox.js";

export type {
    Environment, EnvironmentChange, FrameReport, Histogram, Light, LightHere, Material, MaterialChange, ParameterInfo,
    Picked, Progress, SceneOptions,
};
export type Vec3 = [number, number, number];
/** What comes from the renderer has all that may be left out on the way to it. */
export type Camera = Required<Omit<AnyCamera, "name">> & { name?: string };
export interface SceneInfo extends AnySceneInfo { camera: Camera; cameras: Camera[] }

/** A setting's value; of three numbers also their text, separated by commas. */
export type Value = boolean | number | string | Vec3;
export type Settings = Record<string, Value>;

/** Where a scene comes from: an address or "builtin:NAME", or files with their paths below what was dropped. */
export type Source = string | SourceFile[];
export interface SourceFile { file: File; path: string }

/** The line between two views: the right one's name or "reference", and its place from 0 (left) to 1. */
export interface Split { right: string; at: number }

/** What a link carries: all but what is as it would be anyway. */
export interface LinkState {
    scene?: string;
    /** The address of a panorama, what it is multiplied by, and its turn in degrees. */
    environment?: string;
    environment_intensity?: number;
    environment_rotation?: number;
    preset?: string;
    camera?: Camera;
    split?: Split;
    scale?: number;
    settings: Settings;
}

/** What the worker knows before any scene. */
export interface Catalogue {
    scenes: { name: string; title: string }[];
    presets: { name: string; title: string }[];
    parameters: ParameterInfo[];
    settings: Settings;
}

/** A scene that was opened; its number tells cameras of the one before apart. */
export interface Opened { scene: SceneInfo; materials: Material[]; settings: Settings; number: number }

/** All that may be another after a step back, and what was taken back. */
export interface Stepped { words: string; scene: SceneInfo; materials: Material[]; settings: Settings }

/** What lines of the console have printed and written, and all that may be another after them. */
export interface Ran {
    text: string;
    files: File[];
    /** The scene that they opened last. */
    opened?: string;
    /** Why the lines after were not done. */
    failed?: string;
    scene?: SceneInfo;
    materials: Material[];
    settings: Settings;
    preset: string;
    /** Where the camera is now, if it has moved. */
    camera?: Camera;
    number: number;
}

/** What a change of settings leads to. */
export interface Changed { settings: Settings; voxels?: number }

export interface Memory { name: string; bytes: number }

/** What crosses from the worker: the end of a call, its progress, or an event. */
export type FromWorker =
    | { id: number; result: unknown }
    | { id: number; error: Failure }
    | { id: number; progress: Progress }
    | { event: string; data: unknown };

/** An error as it crosses; after a fatal one the worker's renderer is of no use. */
export interface Failure { message: string; code?: string; fatal: boolean }
