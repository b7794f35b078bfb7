// Command `volume smooth`: writes the samples of a volume without their noise, on their own grid.
#include "sansmesh/volumes.h"

#include <fmt/format.h>

#include <string>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/write_volume.h"
#include "sansmesh/io/names.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::cli {
namespace {

struct VolumeSmoothArguments {
  VolumeInput input;
  std::string output;
  SmoothVolumeOptions options;
};

void run_volume_smooth(const VolumeSmoothArguments& a, Console& console) {
  if (io::ending(a.output) != "vtu") check_volume_writable(a.output);
  check_inputs_stay(a.input.files, {a.output});
  VolumeModel volume = a.input.open(console);
  check_smoothed_writable(a.output, volume, a.options, console.progress());
  const SmoothVolumeResult made = smooth_volume(volume, a.options, console.progress());
  console.note(volume.name(), made.notes);
  console.progress().begin("write");
  write_smoothed(a.output, made);
  console.report(a.input.report(), "input");
  console.report(FileReport{a.output}, "output");
  console.report(made.report);
  console.print(summary_of(made.report));
  console.print(fmt::format("{}: {}", a.output, counted(made.report.samples, "sample")));
}

}  // namespace

Command add_volume_smooth(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("smooth", "Volume on any grid → the same samples without noise");
  auto a = std::make_shared<VolumeSmoothArguments>();
  add_volume_input(c, a->input);
  c.add_option("-o,--output", a->output, "Volume to write: .vtu (any grid), .vti, .mhd, .mha or .nrrd (uniform grids)")
      .writes({".vtu", ".vti", ".mhd", ".mha", ".nrrd"})
      .required();
  add_schema(c, a->options);
  c.footer(std::string(kReadableVolumes) +
           "\n\nSteps between materials stay. Data without noise stay unchanged.\n\nExamples:\n"
           "  sansmesh volume smooth head.mhd -o smooth.mhd\n"
           "  sansmesh volume smooth piv.vts --array velocity --deviations -o velocity.vtu");
  c.announce({report_of<ReadFiles>("input"), report_of<FileReport>("output"), report_of<SmoothVolumeReport>()});
  return {&c, [a](Console& console) { run_volume_smooth(*a, console); }};
}

}  // namespace sansmesh::cli
