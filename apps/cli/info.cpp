// sansmesh info: what is in a file?
#include "sansmesh/jobs/volume_info.h"
#include "sansmesh/points.h"

#include <fmt/core.h>

#include <string>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

void run_function_info(const std::string& file, Console& console) {
  console.progress().begin("read");
  const FunctionInfo made = info(read_function(file));
  console.tell(ToldFile{file});
  console.tell_value("format", "function");
  console.tell(made);
  console.say(fmt::format("{}: function, partition of unity", file));
  console.say(summary_of(made));
}

void run_info(const CloudInput& input, Console& console) {
  if (input.is_function()) return run_function_info(input.files[0], console);
  ReadReport read;
  const PointSet points = input.read(console, read);
  const CloudInfo made = info(points, console.progress());
  console.tell(input.told(read, made.points));
  console.tell(made);

  console.say(fmt::format("{}: {}", input.name(), read.format));
  console.say(summary_of(made));
}

void run_volume_info(const VolumeInput& input, Console& console) {
  VolumeInput any = input;
  any.bare = true;
  VolumeModel volume = any.open(console);
  const VolumeInfo made = volume_info(volume, console.progress());
  console.tell(input.told());
  console.tell(made);
  console.say(fmt::format("{}: {}", input.name(), made.format));
  console.say(summary_of(made));
}

}  // namespace

Command add_info(CommandLine& app) {
  CommandLine& c = app.add_subcommand("info",
                                      "File → what is in it: points, box, spacing, noise, normals, faces; grid "
                                      "and arrays of volumes");
  auto input = std::make_shared<CloudInput>();
  auto volume = std::make_shared<VolumeInput>();
  add_cloud_input(c, *input,
                  "Points, mesh, function (.smf) or volume; `data FILE` takes points for samples of a volume");
  add_raw_options(c, volume->read);
  c.footer(std::string(kReadable) + "\n" + kReadableVolumes +
           "\n\nExamples:\n"
           "  sansmesh info scan.ply\n"
           "  sansmesh info fire.vtu\n"
           "  sansmesh info data samples.csv");
  c.tells({told<ReadCloud>(), told<CloudInfo>(), told<ToldFile>(),
           told_value<std::string>("format", "Format of the file"), told<FunctionInfo>(), told<ReadFiles>(),
           told<VolumeInfo>()});
  return {&c, [input, volume](Console& console) {
            const bool named = names_volume(input->files);
            if (!named && !volume->read.raw.given()) return run_info(*input, console);
            volume->files = input->files;
            run_volume_info(*volume, console);
          }};
}

}  // namespace sansmesh::cli
