import type { ReactNode } from "react";
import type { Gi, GiOptions, LumivoxError } from "./index.js";

/** Options of `createGi` except scene and camera, which are the canvas's. Changed settings of the
 * cones apply at once; other changed options make the light again, so keep `bounds` in a memo. */
export interface LumivoxGiProps extends Omit<GiOptions, "scene" | "camera"> {
    /** Options of three.js's `pass`, such as `{ samples: 4 }`; read when the light is made. */
    passOptions?: Record<string, unknown>;
    /** Gets the light once it is there. */
    onReady?: (gi: Gi) => void;
    /** Gets the error of a failed start; the scene is then drawn without the light. Default: throws
     * the error, for error boundaries. */
    onError?: (error: LumivoxError) => void;
    children?: ReactNode;
}

/** Global illumination for the scene of a react-three-fiber canvas, whose `gl` makes a
 * `WebGPURenderer`. The component draws the frames. */
export function LumivoxGi(props: LumivoxGiProps): ReactNode;
