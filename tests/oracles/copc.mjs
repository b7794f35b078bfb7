// Prints the points of the levels 0 to LEVEL of a COPC file that are in a box, as npm's copc reads them: X Y Z intensity,
// a point a line, in the order of its nodes.
//   node copc.mjs FILE.copc.laz LEVEL x0 y0 z0 x1 y1 z1
//                                   exit status 77: copc is not installed (scripts/install-deps oracles)
import { existsSync } from "node:fs";

if (!existsSync(new URL("node_modules/copc/", import.meta.url))) process.exit(77);
const { Copc } = (await import("copc")).default;
const [name, level, ...box] = process.argv.slice(2).map((word, i) => (i === 0 ? word : Number(word)));
const copc = await Copc.create(name);
const pages = [copc.info.rootHierarchyPage];
for (let page; (page = pages.pop()); ) {
  const tree = await Copc.loadHierarchyPage(name, page);
  pages.push(...Object.values(tree.pages));
  for (const [key, node] of Object.entries(tree.nodes)) {
    if (node.pointCount === 0 || Number(key.split("-")[0]) > level) continue;
    const view = await Copc.loadPointDataView(name, copc, node);
    const get = ["X", "Y", "Z", "Intensity"].map((field) => view.getter(field));
    for (let i = 0; i < view.pointCount; ++i) {
      const p = get.map((of) => of(i));
      if ([0, 1, 2].every((k) => p[k] >= box[k] && p[k] <= box[k + 3])) console.log(p.join(" "));
    }
  }
}
