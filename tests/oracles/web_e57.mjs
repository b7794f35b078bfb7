// Prints the points of an E57 file as npm's web-e57 reads them: x y z [r g b], a point a line.
//   node web_e57.mjs FILE.e57       exit status 77: web-e57 is not installed (scripts/install-deps oracles)
import { existsSync, readFileSync } from "node:fs";

const folder = new URL("node_modules/web-e57/", import.meta.url);
if (!existsSync(folder)) process.exit(77);
// The package is made for bundlers, which load its WebAssembly themselves.
const glue = await import(new URL("e57_bg.js", folder));
const { instance } = await WebAssembly.instantiate(readFileSync(new URL("e57_bg.wasm", folder)), {
  "./e57_bg.js": glue,
});
glue.__wbg_set_wasm(instance.exports);
instance.exports.__wbindgen_start?.();
process.stdout.write(glue.convertE57(new Uint8Array(readFileSync(process.argv[2])), "XYZ"));
