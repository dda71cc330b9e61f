// The results of the cones, as nodes of TSL.

import { Data3DTexture, DataTexture, ExternalTexture, HalfFloatType, LinearFilter, Node, NodeUpdateType, NoColorSpace } from "three/webgpu";
import { clamp, metalness, normalWorld, positionWorld, screenUV, select, texture, texture3D, vec3 } from "three/tsl";

/** The output textures of a frame. */
export class Outputs {
    /** The light of probes and their place, once `setProbes` has been called. */
    probes = null;

    constructor() {
        this.irradiance = texture(wrapped(null));
        this.reflection = texture(wrapped(null));
    }

    /** Sets what `SharedGi.probes` returned. */
    setProbes([source, x, y, z, edge, a, b, c]) {
        const external = wrapped(source);
        external.is3DTexture = true;
        external.image.depth = source.depthOrArrayLayers;
        const [low, cells] = [vec3(x, y, z), vec3(a, b, c)];
        this.probes = { light: texture3D(external), low, cells, size: cells.mul(edge) };
    }

    /** Replaces the textures when the size changes. */
    set([irradiance, reflection]) {
        this.#disposeScreen();
        this.irradiance.value = wrapped(irradiance);
        this.reflection.value = wrapped(reflection);
    }

    /** Leaves materials without light: `SharedGi` destroys its textures. */
    dispose() {
        this.#disposeScreen();
        for (const node of [this.irradiance, this.reflection]) node.value = dark(new DataTexture(new Uint8Array(4), 1, 1));
        if (this.probes === null) return;
        const { light } = this.probes;
        light.value.dispose();
        light.value = dark(new Data3DTexture(new Uint8Array(4), 1, 1, 1));
    }

    #disposeScreen() {
        this.irradiance.value.dispose();
        this.reflection.value.dispose();
    }
}

function dark(made) {
    made.needsUpdate = true;
    return made;
}

function wrapped(source) {
    const external = new ExternalTexture(source);
    external.type = HalfFloatType;
    external.colorSpace = NoColorSpace;
    external.minFilter = external.magFilter = LinearFilter;
    external.generateMipmaps = false;
    if (source !== null) external.image = { width: source.width, height: source.height };
    return external;
}

/** The irradiance of a material; also adds the reflection to its indirect specular light. */
export class LightNode extends Node {
    static get type() {
        return "LumivoxLightNode";
    }

    constructor(gi) {
        super("vec3");
        this.gi = gi;
        this.updateBeforeType = NodeUpdateType.FRAME;
    }

    updateBefore(frame) {
        this.gi.updateFor(frame);
    }

    setup(builder) {
        const { irradiance, reflection } = this.gi;
        const { radiance, iblIrradiance, reflectedLight } = builder.context;
        if (reflectedLight) {
            if (builder.material?.envMap) {
                // Our light does not include a material's own `envMap`: gloss and metal mirror it
                // as three.js does.
                iblIrradiance?.mulAssign(metalness);
            } else {
                // Our reflection includes the scene's surroundings and their occlusion, so it
                // replaces that of three.js.
                radiance?.assign(vec3(0));
                iblIrradiance?.assign(vec3(0));
                reflectedLight.indirectSpecular.addAssign(reflection.sample(screenUV).rgb);
            }
        }
        return irradiance.sample(screenUV).rgb;
    }
}

/** The irradiance of materials that three.js draws after the opaque ones: that of the probes around
 * a surface. Their gloss stays three.js's own. */
export class ProbeNode extends Node {
    static get type() {
        return "LumivoxProbeNode";
    }

    constructor(gi) {
        super("vec3");
        this.gi = gi;
        this.updateBeforeType = NodeUpdateType.FRAME;
    }

    updateBefore(frame) {
        this.gi.updateFor(frame, true);
    }

    setup(builder) {
        // The probes include the light of the scene's surroundings, and its occlusion.
        const { iblIrradiance } = builder.context;
        if (builder.material?.envMap) iblIrradiance?.mulAssign(metalness);
        else iblIrradiance?.assign(vec3(0));
        const probes = this.gi.probes();
        if (probes === null) return vec3(0);
        const { low, size, cells } = probes;
        // Within the centres of the outermost cells: behind them in the texture are others.
        const inset = vec3(0.5).div(cells);
        const place = clamp(positionWorld.sub(low).div(size), inset, inset.oneMinus()).toConst();
        // An ambient cube (Mitchell 2006, "Shading in Valve's Source Engine").
        const share = normalWorld.mul(normalWorld).toConst();
        const light = ["x", "y", "z"].map((axis, at) => {
            const isNegative = select(normalWorld[axis].lessThan(0), 1, 0);
            const uv = vec3(place.x, place.y.add(isNegative).div(2), place.z.add(at).div(3));
            return probes.light.sample(uv).level(0).rgb.mul(share[axis]);
        });
        // The texture has the radiance of white surfaces.
        return light[0].add(light[1]).add(light[2]).mul(Math.PI);
    }
}
