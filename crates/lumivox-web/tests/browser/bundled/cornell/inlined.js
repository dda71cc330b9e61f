// With the WebAssembly in the bundle.
import * as lumivox from "lumivox/inlined";
import { show } from "./cornell.js";

show(lumivox);
