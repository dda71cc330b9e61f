// lumivox/react: `createGi` as a component of react-three-fiber.

import { useFrame, useThree } from "@react-three/fiber";
import { useEffect, useRef, useState } from "react";
import { RenderPipeline } from "three/webgpu";
import { pass } from "three/tsl";
import { createGi } from "./index.js";

/** Options that can be changed without making the light again. */
const CHANGEABLE = new Set([
    "cones", "specular", "specular_share", "voxel_per_diameter", "normal_offset", "step", "clearance", "min_transmittance", "occlusion_distance",
]);
/** Options that make it again. */
const FIXED = ["resolution", "bounds", "preset", "volume", "facesPerFrame", "memoryBudget", "suns", "temporal", "trace_resolution"];
/** Frames are drawn after the callbacks that move things, which have the priority 0. */
const LAST = 1;

/**
 * Lights the scene of its canvas, and draws each frame. The canvas needs a `WebGPURenderer`. The
 * declarations (`react.d.ts`) have the options.
 */
export function LumivoxGi({ onReady, onError, passOptions, children, ...options }) {
    const [gl, scene, camera] = [useThree((state) => state.gl), useThree((state) => state.scene), useThree((state) => state.camera)];
    const pipeline = useRef(null);
    const [gi, setGi] = useState(null);
    const [error, setError] = useState(null);
    const events = useRef({});
    events.current = { onReady, onError };
    const fixed = FIXED.map((name) => options[name]);

    useEffect(() => {
        let isGone = false;
        let own = null;
        let output = null;
        const free = () => {
            output?.dispose();
            own?.dispose();
        };
        const begin = async () => {
            own = await createGi(gl, { ...options, scene, camera });
            if (isGone) return free();
            const view = pass(scene, camera, passOptions);
            view.contextNode = own.context;
            output = new RenderPipeline(gl, view);
            pipeline.current = output;
            setGi(own);
            events.current.onReady?.(own);
        };
        begin().catch((problem) => {
            if (isGone) return;
            if (events.current.onError) events.current.onError(problem);
            else setError(problem);
        });
        return () => {
            isGone = true;
            pipeline.current = null;
            setGi(null);
            free();
        };
    }, [gl, scene, camera, ...fixed]);

    useEffect(() => {
        for (const name of CHANGEABLE) if (gi !== null && options[name] !== undefined) gi.set(name, options[name]);
    }, [gi, ...[...CHANGEABLE].map((name) => options[name])]);

    useFrame(() => {
        if (pipeline.current !== null) pipeline.current.render();
        else gl.render(scene, camera);
    }, LAST);
    // For the error boundary around the canvas.
    if (error !== null) throw error;
    return children ?? null;
}
