// Command `volume resample`: resamples a volume on a uniform grid.
#include "sansmesh/volumes.h"

#include <string>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/io/grids/write_volume.h"

namespace sansmesh::cli {
namespace {

struct ResampleArguments {
  VolumeInput input;
  std::string output;
  ResampleOptions options;
};

void run_resample(const ResampleArguments& a, Console& console) {
  a.options.validate();
  require(!a.options.gradients || a.output.ends_with(".vti"),
          "--gradients needs a format with several arrays: -o FILE.vti");
  check_volume_writable(a.output);
  VolumeModel volume = a.input.open(console);
  const ResampleResult made = resample(volume, a.options, console.progress());
  console.note(volume.name(), made.notes);
  console.progress().begin("write");
  write_volume(a.output, made.block);
  console.report(a.input.report(volume, console.progress()), "input");
  console.report(FileReport{a.output}, "output");
  console.report(made.report);
  console.print(summary_of(volume, console.progress()));
  console.print(a.output + ": " + lattice_words(made.report.size, made.report.inside));
}

}  // namespace

Command add_volume_resample(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("resample", "Volume on any grid → the same on a uniform one");
  auto a = std::make_shared<ResampleArguments>();
  add_volume_input(c, a->input);
  c.add_option("-o,--output", a->output, "Image to write: .vti (with the array `inside`), .mhd, .mha or .nrrd")
      .writes({".vti", ".mhd", ".mha", ".nrrd"})
      .required();
  add_schema(c, a->options);
  add_nan_flag(c, a->options.outside);
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume resample combustion.vts --array Density --size 256 -o density.vti\n"
           "  sansmesh volume resample amr.vthb --array Fraction --size 128 64 64 --method linear -o fraction.mhd");
  c.announce({report_of<ReadVolume>("input"), report_of<FileReport>("output"), report_of<ResampleReport>()});
  return {&c, [a](Console& console) { run_resample(*a, console); }};
}

}  // namespace sansmesh::cli
