// Command `probe`: value, gradient and curvature of a function at points.
#include "sansmesh/functions.h"

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"

namespace sansmesh::cli {
namespace {

struct ProbeArguments {
  std::string input, output;
  CloudInput points;  ///< optional
  std::vector<double> at;
  bool ascii = false;
};

PointSet points_of(const ProbeArguments& a, Console& console) {
  if (a.points.files.empty() == a.at.empty()) throw ArgumentError("give either --points FILE or --at x,y,z");
  PointSet points;
  if (!a.points.files.empty()) {
    ReadReport read;
    points = a.points.read(console, read);
    points.triangles.clear();
    points.triangle_attributes.clear();
    return points;
  }
  require(!a.points.selects(), "--class, --without-class, --read-box and --read-spacing select among --points");
  points.origin = {a.at[0], a.at[1], a.at[2]};
  for (const Vec3& x : query_points(a.at)) points.positions.push_back(Vec3f(x - points.origin));
  return points;
}

void run_probe(const ProbeArguments& a, Console& console) {
  if (!a.output.empty()) check_writable(a.output, "points");
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(a.input);
  PointSet points = points_of(a, console);
  // Values of --at are used in double precision.
  const std::vector<Vec3> x = a.at.empty() ? positions_of(points) : query_points(a.at);
  const ProbeFunctionResult made = probe_function(function, x, progress);
  if (!a.output.empty()) {
    progress.begin("write");
    made.add_to(points.attributes);
    write_points(a.output, points, {.ascii = a.ascii});
  }
  const ProbeFunctionReport& r = made.report;
  console.report(FileReport{a.input}, "input");
  console.report(r);
  if (!a.output.empty()) console.report(FileReport{a.output}, "output");

  console.print_named(a.input, summary_of(made));
  if (r.points <= kListedPoints) console.report(made.values, "values");
}

}  // namespace

Command add_probe(CommandLine& app) {
  CommandLine& c = app.add_subcommand("probe", "Function file → its value, gradient and curvature at points");
  c.former_name("eval");
  auto a = std::make_shared<ProbeArguments>();
  add_function_input(c, a->input);
  c.add_option("--points", a->points.files, "File of query points; may be repeated (tiles)")
      .reads(endings_read(kPoints))
      .repeated();
  add_selection_options(c, a->points);
  c.add_option("--at", a->at, "Query point x,y,z; may be repeated").numbers(3).repeated().type_name("POINT");
  c.add_option("-o,--output", a->output, "Points to write with attributes: .ply .csv .pcd .vtp")
      .writes({".ply", ".csv", ".pcd", ".vtp"});
  add_ascii_flag(c, a->ascii);
  c.footer(
      "The value is approximately the distance to the surface, negative inside, in the unit of the input. k1 and k2\n"
      "are the principal curvatures of the level set through the point, per length, positive where it is convex.\n\n"
      "Examples:\n"
      "  sansmesh probe scan.smf --at 0.1,0.2,0.3\n"
      "  sansmesh probe scan.smf --at 0,0,0 --at 0,0,1 --json\n"
      "  sansmesh probe scan.smf --points probes.xyz -o values.csv");
  c.announce({report_of<FileReport>("input"), report_of<ProbeFunctionReport>(), report_of<FileReport>("output"),
              reports_of<ProbedPoint>("values")});
  return {&c, [a](Console& console) { run_probe(*a, console); }};
}

}  // namespace sansmesh::cli
