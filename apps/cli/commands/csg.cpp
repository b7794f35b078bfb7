// Command `csg`: meshes an expression of functions, meshes and primitives.
#include "sansmesh/solids.h"

#include <fmt/core.h>

#include <memory>
#include <string>

#include "cli/input/surface_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"

namespace sansmesh::cli {
namespace {

struct CsgArguments {
  std::string expression;
  MeshOutput output;
  CsgMeshOptions options;
};

void run_csg(const CsgArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  const SolidModel solid = open_solid(a.expression, console);
  const CsgResult made = mesh_of_solid(solid, a.options, console.progress());
  const CsgMeshReport& r = made.report;
  console.note(a.output.file, made.notes);
  a.output.write(made.mesh, console);
  console.report(solid);
  console.report(r);

  print_mesh(a.output.file, made.mesh, r.components, r.closed, console);
  console.print(summary_of(r));
}

}  // namespace

Command add_csg(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("csg", "Functions, meshes and primitives, combined → closed triangle mesh with creases");
  auto a = std::make_shared<CsgArguments>();
  c.add_option("expression", a->expression, "Expression in quotes: see below").type_name("EXPRESSION").required();
  add_mesh_output(c, a->output);
  add_schema(c, a->options);
  c.footer(
      "Solids are function files (.smf, made by sansmesh fit), closed meshes (STL, PLY, OBJ, OFF, GLB, VTP; names\n"
      "with dashes or blanks in quotes), the region above a value in a volume (data.vtu[Temp=300]) and\n"
      "  sphere(r, center)                    box(size, center, r) or box(from=, to=, r=)\n"
      "  cylinder(r, h, axis, center)         without h it has no ends\n"
      "  cone(r, h, top, axis, center)        torus(R, r, axis, center)\n"
      "  capsule(r, from, to)                 plane(normal, offset) or plane(normal, through=)\n"
      "Operators: a | b or a + b union, a & b intersection, a - b difference, ~a complement; & comes first.\n"
      "Functions: union(a, b, …, r=) intersection difference: r rounds the crease; offset(a, d);\n"
      "  shell(a, t, side=both|inside|outside); translate(a, x, y, z); rotate(a, angle=, axis=, center=);\n"
      "  scale(a, factor, center=); mirror(a, normal=, offset=)\n"
      "Vectors are (x, y, z), axes also x, y, z, -x, …; angles are in degrees.\n"
      "Combined meshes keep the triangles that nothing cuts.\n\n"
      "Examples:\n"
      "  sansmesh csg 'scan.smf - cylinder(axis=z, r=0.1)' -o drilled.ply\n"
      "  sansmesh csg 'part.stl - cylinder(r=2)' -o drilled.stl\n"
      "  sansmesh csg 'shell(scan.smf, 2, side=inside) & plane(z, offset=40)' -o half.stl --cell 0.5\n"
      "  sansmesh csg 'difference(box(2), sphere(1.3), r=0.1)' -o part.glb --preview part.png\n"
      "  sansmesh csg 'cylinder(1) - cylinder(0.8)' -o pipe.ply --box -1,-1,0,1,1,5");
  c.announce({report_of<SolidModel>(), report_of<CsgMeshReport>()});
  return {&c, [a](Console& console) { run_csg(*a, console); }};
}

}  // namespace sansmesh::cli
