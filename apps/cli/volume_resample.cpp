// sansmesh volume resample: a volume on a uniform grid.
#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/io/write_volume.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

struct ResampleArguments {
  VolumeInput input;
  std::string output;
  std::vector<double> size;
  ResampleOptions options;
  bool nan = false;
};

void run_resample(ResampleArguments& a, Console& console) {
  for (const double n : a.size)
    require(n >= 1 && n <= 65536 && n == static_cast<double>(static_cast<std::size_t>(n)),
            "--size must be whole numbers from 1 to 65536");
  const auto whole = [&](std::size_t k) { return static_cast<std::size_t>(a.size[k]); };
  require(a.size.size() <= 1 || a.size.size() == 3, "--size is one number or three");
  if (a.size.size() == 1) a.options.size = whole(0);
  if (a.size.size() == 3) a.options.sizes = {whole(0), whole(1), whole(2)};
  if (a.nan) a.options.outside = std::numeric_limits<double>::quiet_NaN();
  a.options.validate();
  require(!a.options.gradients || a.output.ends_with(".vti"),
          "--gradients needs a format of several arrays: -o FILE.vti");
  check_volume_writable(a.output);
  OpenVolume volume(a.input, console);
  const auto field = volume.field();
  GridBlock block;
  try {
    block = resample_volume(*field, volume.array_name(), a.options, console.progress());
  } catch (const DataError& error) {
    throw FileError(a.input.name(), error.what());
  }
  console.progress().begin("write");
  write_volume(a.output, block);
  console.progress().finish();

  const auto& inside = *block.point_arrays[block.point_arrays.size() - 1].as<std::uint8_t>();
  const auto within = std::count(inside.begin(), inside.end(), 1);
  const double share = static_cast<double>(within) / static_cast<double>(inside.size());
  volume.say_method();
  console.say(fmt::format("{}: {} × {} × {} values, {:.1f} % in the volume", a.output, block.axes[0].size(),
                          block.axes[1].size(), block.axes[2].size(), 100 * share));
  console.say_json({{"input", volume.json()},
                    {"output",
                     {{"file", a.output},
                      {"size", {block.axes[0].size(), block.axes[1].size(), block.axes[2].size()}},
                      {"inside", share}}}});
  console.print_timings();
}

}  // namespace

Command add_volume_resample(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("resample", "Volume on any grid → the same on a uniform one");
  auto a = std::make_shared<ResampleArguments>();
  add_volume_input(c, a->input);
  c.add_option("-o,--output", a->output, "Image to write: .vti (with the array `inside`), .mhd, .mha or .nrrd")
      .type_name("FILE")
      .required();
  c.add_option("--size", a->size, "Points along the longest side, or along x, y and z [128]").type_name("N [N N]");
  add_box_option(c, a->options.box, "Only this box: x0,y0,z0,x1,y1,z1 [that of the volume]");
  c.add_flag("--gradients", a->options.gradients, "Also the gradients, as NAME_gradient (.vti)");
  c.add_flag("--nan", a->nan, "Values outside of the volume are NaN instead of 0");
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh volume resample combustion.vts --array Density --size 256 -o density.vti\n"
           "  sansmesh volume resample amr.vthb --array Fraction --size 128 64 64 --method linear -o fraction.mhd");
  return {&c, [a](Console& console) { run_resample(*a, console); }};
}

}  // namespace sansmesh::cli
