// With the WebAssembly in a file beside the bundle.
import * as lumivox from "lumivox";
import { show } from "./cornell.js";

show(lumivox);
