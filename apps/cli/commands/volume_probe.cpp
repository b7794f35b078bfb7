// Command `volume probe`: values and gradients of a volume at points.
#include "sansmesh/volumes.h"

#include <fmt/core.h>

#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/points/point_table.h"

namespace sansmesh::cli {
namespace {

struct ProbeArguments {
  VolumeInput input;
  std::string points, output;
  std::vector<double> at;
};

void run_probe(const ProbeArguments& a, Console& console) {
  if (a.points.empty() == a.at.empty()) throw ArgumentError("give either --points FILE or --at x,y,z");
  if (!a.output.empty()) {
    if (!a.output.ends_with(".csv")) throw FileError(a.output, "tables are written as .csv");
    check_writable(a.output, "text");
  }
  const std::vector<Vec3> x = a.points.empty() ? query_points(a.at) : read_point_table(a.points);
  require(!a.output.empty() || x.size() <= kListedPoints || console.options().json,
          "this many points need an output table: -o FILE.csv");
  VolumeModel volume = a.input.open(console);
  const ProbeResult p = probe_volume(volume, x, console.progress());
  console.note(volume.name(), p.notes);
  if (!a.output.empty()) {
    console.progress().begin("write");
    write_text(a.output, probe_table(p));
  }
  const std::size_t n = x.size();
  console.report(a.input.report(volume, console.progress()), "input");
  console.report_value("points", n);
  console.report(p.report);
  if (!a.output.empty()) console.report(FileReport{a.output}, "output");

  console.print(summary_of(volume, console.progress()));
  console.print(summary_of(p));
  if (n <= kListedPoints) console.report(probed_values(p), "values");
  if (!a.output.empty()) console.print(fmt::format("{}: {}", a.output, counted(n, "row")));
}

}  // namespace

Command add_volume_probe(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("probe", "Values and gradients of a volume at points");
  auto a = std::make_shared<ProbeArguments>();
  add_volume_input(c, a->input);
  c.add_option("--points", a->points, "Query points: a table with columns x, y, z, or any file of points").reads();
  c.add_option("--at", a->at, "Query point x,y,z; may be repeated").numbers(3).repeated().type_name("POINT");
  c.add_option("-o,--output", a->output, "Table to write (.csv): x,y,z,NAME,NAME_dx,NAME_dy,NAME_dz,inside")
      .writes({".csv"});
  c.footer(std::string(kReadableVolumes) +
           "\n\nOne row per point, in order. Outside the volume `inside` is 0, and values are extrapolated from its "
           "boundary.\n\nExamples:\n"
           "  sansmesh volume probe fire.vtu --array t --at 0.5,0.5,0.5\n"
           "  sansmesh volume probe post.bin --points where.csv --array Density -o density.csv");
  c.announce({report_of<ReadVolume>("input"), value_of<std::size_t>("points", "Query points"), report_of<ProbeReport>(),
              report_of<FileReport>("output"), reports_of<ProbedValue>("values")});
  return {&c, [a](Console& console) { run_probe(*a, console); }};
}

}  // namespace sansmesh::cli
