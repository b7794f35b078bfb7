// sansmesh volume fit: a volume with its reconstruction, ready for all that comes after.
#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "commands.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/volume_file.h"
#include "sansmesh/io/io.h"
#include "sansmesh/io/output_batch.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

struct VolumeFitArguments {
  VolumeInput input;
  std::string output;
  bool all = false;
};

void run_volume_fit(const VolumeFitArguments& a, Console& console) {
  if (!is_volume_file(a.output))
    throw FileError(a.output, "fitted volumes are written to files with the ending .smv (or .smv.gz)");
  check_writable(a.output, "text");
  OpenVolume volume(a.input, console);
  const FittedVolume fitted = volume.fit(a.all);
  console.progress().begin("write");
  write_volume_file(a.output, fitted);
  console.progress().finish();

  const std::uint64_t bytes = written_size(a.output);
  const std::size_t samples = fitted.volume->size();
  const std::vector<std::size_t> by_degree = fitted.coefficients.by_degree();
  volume.say_method();
  console.say(fmt::format("{}: {} ({})", a.input.name(), counted(samples, "sample"), fitted.volume->facts.grid));
  if (!by_degree.empty())
    console.say(fmt::format("polynomials of degree 0 to {}: {}", by_degree.size() - 1, fmt::join(by_degree, ", ")));
  console.say(fmt::format("{}: {}, {:.3g} MB{}", a.output, counted(fitted.arrays.size(), "array"),
                          static_cast<double>(bytes) / 1e6,
                          fitted.coefficients.empty() ? "; this method has no coefficients to keep" : ""));
  std::vector<std::string> arrays;
  arrays.reserve(fitted.arrays.size());
  for (const DatasetArray& array : fitted.arrays) arrays.push_back(printable(array.name));
  console.say_json({{"input", volume.json()},
                    {"by_degree", by_degree},
                    {"output", {{"file", a.output}, {"arrays", arrays}, {"samples", samples}}}});
  console.print_timings();
}

}  // namespace

Command add_volume_fit(CommandLine& volume) {
  CommandLine& c =
      volume.add_subcommand("fit", "Volume on any grid → fitted volume, which all others start from at once");
  auto a = std::make_shared<VolumeFitArguments>();
  add_volume_input(c, a->input);
  c.add_option("-o,--output", a->output, "Fitted volume to write: .smv").type_name("FILE").required();
  c.add_flag("--all", a->all, "Keep the other arrays as well, for other reconstructions and to carry along");
  c.footer(
      std::string(kReadableVolumes) +
      "\n\nThe file holds the samples and the coefficients of the reconstruction: every command takes it in place of "
      "DATA,\nwithout another fit.\n\nExamples:\n"
      "  sansmesh volume fit fire.vtu --array t -o fire.smv\n"
      "  sansmesh volume probe fire.smv --at 0.5,0.5,0.5\n"
      "  sansmesh info fire.smv");
  return {&c, [a](Console& console) { run_volume_fit(*a, console); }};
}

}  // namespace sansmesh::cli
