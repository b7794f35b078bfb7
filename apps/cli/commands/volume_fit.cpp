// Command `volume fit`: writes a volume with its reconstruction.
#include "sansmesh/volumes.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/schema_options.h"
#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/output_batch.h"

namespace sansmesh::cli {
namespace {

struct VolumeFitArguments {
  VolumeInput input;
  std::string output;
  FitVolumeOptions options;
};

void run_volume_fit(const VolumeFitArguments& a, Console& console) {
  if (!is_volume_file(a.output))
    throw FileError(a.output, "fitted volumes are written to files with the ending .smv (or .smv.gz)");
  check_writable(a.output, "text");
  VolumeModel volume = a.input.open(console);
  const FitVolumeResult made = fit_volume(volume, a.options, console.progress());
  const FitVolumeReport& r = made.report;
  console.progress().begin("write");
  write_fit(a.output, made);
  std::vector<std::string> arrays;
  arrays.reserve(r.arrays.size());
  for (const std::string& array : r.arrays) arrays.push_back(printable(array));
  console.report(a.input.report(volume, console.progress()), "input");
  console.report(r);
  console.report(FileReport{a.output}, "output");
  console.report_value("output.arrays", arrays);

  console.print(summary_of(volume, console.progress()));
  if (!r.by_degree.empty())
    console.print(
        fmt::format("polynomials of degree 0 to {}: {}", r.by_degree.size() - 1, fmt::join(r.by_degree, ", ")));
  console.note(volume.name(), made.notes);
  console.print(fmt::format("{}: {}, {:.3g} MB", a.output, counted(r.arrays.size(), "array"),
                            static_cast<double>(written_size(a.output)) / 1e6));
}

}  // namespace

Command add_volume_fit(CommandLine& volume) {
  CommandLine& c =
      volume.add_subcommand("fit", "Volume on any grid → fitted volume, a fast input for all other commands");
  auto a = std::make_shared<VolumeFitArguments>();
  add_volume_input(c, a->input);
  c.add_option("-o,--output", a->output, "Fitted volume to write: .smv").writes({".smv"}).required();
  add_schema(c, a->options);
  c.footer(std::string(kReadableVolumes) +
           "\n\nThe file contains the samples and the coefficients of the reconstruction: every command accepts it as "
           "DATA,\nwithout fitting again.\n\nExamples:\n"
           "  sansmesh volume fit fire.vtu --array t -o fire.smv\n"
           "  sansmesh volume probe fire.smv --at 0.5,0.5,0.5\n"
           "  sansmesh info fire.smv");
  c.announce({report_of<ReadVolume>("input"), report_of<FitVolumeReport>(), report_of<FileReport>("output"),
              value_of<std::vector<std::string>>("output.arrays", "Arrays in the file")});
  return {&c, [a](Console& console) { run_volume_fit(*a, console); }};
}

}  // namespace sansmesh::cli
