// Writes the point records of a LAZ file as npm's laz-perf decompresses them to standard output, and the seconds that it
// took to standard error.
//   node laz_perf.mjs FILE.laz      exit status 77: laz-perf is not installed (scripts/install-deps oracles)
import { existsSync, readFileSync, writeSync } from "node:fs";

if (!existsSync(new URL("node_modules/laz-perf/", import.meta.url))) process.exit(77);
const { createLazPerf } = await import("laz-perf");
const module = await createLazPerf();
const bytes = readFileSync(process.argv[2]);
const input = module._malloc(bytes.length);
module.HEAPU8.set(bytes, input);
const file = new module.LASZip();
file.open(input, bytes.length);
const length = file.getPointLength();
const record = module._malloc(length);
const records = Buffer.alloc(file.getCount() * length);
const begin = performance.now();
for (let at = 0; at < records.length; at += length) {
  file.getPoint(record);
  records.set(module.HEAPU8.subarray(record, record + length), at);
}
process.stderr.write(`${(performance.now() - begin) / 1000}\n`);
if (process.argv[3] !== "--time") for (let at = 0; at < records.length; ) at += writeSync(1, records, at);
