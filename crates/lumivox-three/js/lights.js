// Lights of three.js as rows of numbers (`src/input.rs`). Both have the same units: lux, candela,
// cd/m².

import { Vector3 } from "three/webgpu";

const [DIRECTIONAL, POINT, SPOT] = [0, 1, 2];
/** Angular radius of the sun, rad: the softness of shadows of directional lights. */
const SUN_RAD = 0.00465;

const position = new Vector3();
const target = new Vector3();

/** The rows of all visible lights. */
export function lightRows(scene, note) {
    const rows = [];
    scene.traverseVisible((object) => {
        if (object.isLight !== true || object.userData.gi === false) return;
        if (object.isAmbientLight || object.isHemisphereLight || object.isLightProbe) {
            note(`${object.type} is left as it is: ambient light is what Lumivox computes, so take it away, or it is there twice`);
        } else if (object.isRectAreaLight) {
            note("RectAreaLight lights surfaces directly, but not by Lumivox; a mesh that emits does both");
        } else if (object.intensity > 0) {
            const row = rowOf(object, note);
            if (row) rows.push(...row);
        }
    });
    return Float32Array.from(rows);
}

function rowOf(light, note) {
    const { r, g, b } = light.color;
    const [red, green, blue] = [r, g, b].map((channel) => Math.max(0, channel) * light.intensity);
    position.setFromMatrixPosition(light.matrixWorld);
    const place = position.toArray();
    if (light.isPointLight || light.isSpotLight) {
        if (light.decay !== 2) note(`the decay of a ${light.type} is ${light.decay}; Lumivox knows nature's alone, 2`);
    }
    // As in three.js, 0 means unlimited.
    const range = Number.isFinite(light.distance) ? light.distance : 0;
    if (light.isPointLight) return [POINT, ...place, 0, -1, 0, red, green, blue, 0, range, 0, 0];
    if (!light.target) {
        note(`${light.type} is not taken`);
        return null;
    }
    light.target.updateWorldMatrix(true, false);
    const direction = target.setFromMatrixPosition(light.target.matrixWorld).sub(position).normalize().toArray();
    if (light.isSpotLight) {
        const inner = light.angle * (1 - light.penumbra);
        return [SPOT, ...place, ...direction, red, green, blue, 0, range, inner, light.angle];
    }
    return [DIRECTIONAL, ...place, ...direction, red, green, blue, SUN_RAD, 0, 0, 0];
}
