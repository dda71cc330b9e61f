// The results of the cones, as nodes of TSL.

import { ExternalTexture, HalfFloatType, LinearFilter, Node, NodeUpdateType, NoColorSpace } from "three/webgpu";
import { metalness, screenUV, texture, vec3 } from "three/tsl";

/** The two output textures of a frame. */
export class Outputs {
    constructor() {
        this.irradiance = texture(wrapped(null));
        this.reflection = texture(wrapped(null));
    }

    /** Replaces the textures when the size changes. */
    set([irradiance, reflection]) {
        this.dispose();
        this.irradiance.value = wrapped(irradiance);
        this.reflection.value = wrapped(reflection);
    }

    dispose() {
        this.irradiance.value.dispose();
        this.reflection.value.dispose();
    }
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

    updateBefore() {
        // An exception would interrupt three.js in the page's pass.
        try {
            this.gi.update();
        } catch (error) {
            const text = `a frame has no new light: ${error.message}`;
            if (!this.gi.notes.includes(text)) console.error(error);
            this.gi.note(text);
        }
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
