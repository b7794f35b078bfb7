// Command `assess`: measures the quality of a mesh.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/file_reports.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"

namespace sansmesh::cli {
namespace {

struct AssessArguments {
  std::string surface;
  CloudInput reference;  ///< optional
  AssessOptions options;
};

void run_assess(const AssessArguments& a, Console& console) {
  require(!a.reference.files.empty() || !a.reference.selects(),
          "--class, --without-class, --read-box and --read-spacing select points of the reference");
  a.options.validate();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const TriangleMesh surface = to_mesh(read_points(a.surface, &read));
  console.warn(a.surface, read.warnings);
  const AssessResult made = a.reference.files.empty()
                                ? assess(surface, progress)
                                : assess(surface, a.reference.read(console, read), a.options, progress);
  const AssessReport& r = made.report;
  console.note(a.surface, made.notes);
  console.report(FileReport{a.surface}, "surface");
  if (r.distance) console.report(a.reference.report(), "reference");
  console.report(r);

  console.print(r.topology ? fmt::format("{}: {} vertices, {}", a.surface, grouped(r.topology->vertices),
                                         counted(r.topology->triangles, "triangle"))
                           : fmt::format("{}: {} without faces", a.surface, counted(r.vertices, "point")));
  console.print(summary_of(r));
}

}  // namespace

Command add_assess(CommandLine& app) {
  CommandLine& c = app.add_subcommand("assess", "Mesh → distances to a reference, topology, shape of triangles");
  c.former_name("evaluate");
  auto shared = std::make_shared<AssessArguments>();
  AssessArguments& a = *shared;
  c.add_option("mesh", a.surface, "Mesh or points").reads(endings_read(kPoints)).required();
  c.add_option("reference", a.reference.files, "Mesh or points to compare with; several (tiles) are read as one")
      .reads(endings_read(kPoints));
  add_selection_options(c, a.reference, " of the reference");
  add_schema(c, a.options);
  c.footer(
      "To the reference: accuracy. From the reference: completeness. Angles of normals are between planes, 0..90°.\n"
      "If one side is a set of points, distances do not fall below half their spacing.\n"
      "For samples of a cloud or a meshed scan: lost is the share of samples farther from the surface than "
      "two\n"
      "spacings and four times the noise; invented is the share of the mesh's area farther than four spacings from "
      "all samples.\n\n"
      "Examples:\n"
      "  sansmesh assess surface.ply\n"
      "  sansmesh assess surface.ply scan.ply");
  c.announce({report_of<FileReport>("surface"), report_of<ReadFiles>("reference"), report_of<AssessReport>()});
  return {&c, [shared](Console& console) { run_assess(*shared, console); }};
}

}  // namespace sansmesh::cli
