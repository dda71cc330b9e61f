// A closed room that reflects half, in react-three-fiber: its radiance is twice its emission.

import { Canvas } from "@react-three/fiber";
import { LumivoxGi } from "lumivox/react";
import { useState } from "react";
import { createRoot } from "react-dom/client";
import * as THREE from "three/webgpu";

const root = document.documentElement;
const say = (state) => (root.dataset.state = state);
const half = new THREE.Color(0.5, 0.5, 0.5);

async function makeRenderer(props) {
    const renderer = new THREE.WebGPURenderer({ ...props, antialias: false });
    await renderer.init();
    return renderer;
}

function Room() {
    const [isBright, setBright] = useState(true);
    const [isThere, setThere] = useState(true);
    const [cones, setCones] = useState(9);
    Object.assign(globalThis, { setBright, setThere, setCones });
    return (
        <Canvas gl={makeRenderer} flat dpr={1} camera={{ position: [0.3, 0.2, 0.1], rotation: [0, 1.2, 0], near: 0.05 }}>
            <mesh>
                <boxGeometry args={[2, 2, 2]} />
                <meshLambertMaterial color={half} emissive="white" emissiveIntensity={isBright ? 0.4 : 0.1} side={THREE.BackSide} />
            </mesh>
            {isThere && <LumivoxGi resolution={16} preset="fast" cones={cones} onReady={(gi) => {
                globalThis.gi = gi;
                say("ready");
            }} onError={(error) => say(`${error.code}: ${error.message}`)} />}
        </Canvas>
    );
}

createRoot(document.querySelector("#root")).render(<Room />);
