// Command `info`: describes the contents of a file.
#include "sansmesh/points.h"
#include "sansmesh/volume_pictures.h"
#include "sansmesh/volumes.h"

#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/error_words.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/io/grids/write_volume.h"
#include "sansmesh/io/names.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::cli {
namespace {

void run_function_info(const std::string& file, Console& console) {
  console.progress().begin("read");
  const FunctionInfo made = info(read_function(file));
  console.report(FileReport{file});
  console.report_value("format", "function");
  console.report(made);
  console.print(fmt::format("{}: function, partition of unity", file));
  console.print(summary_of(made));
}

void run_info(const CloudInput& input, Console& console) {
  if (input.is_function()) return run_function_info(input.files[0], console);
  ReadReport read;
  const PointSet points = input.read(console, read);
  const CloudInfo made = info(points, console.progress());
  console.report(input.report(read, made.points));
  console.report(made);

  console.print(fmt::format("{}: {}", input.name(), read.format));
  console.print(summary_of(made));
}

/// Estimated errors of a volume: whether they are wanted, and files for them.
struct ResolutionArguments {
  bool wanted = false;
  std::vector<std::string> outputs;

  void check() const {
    if (!wanted && !outputs.empty()) throw ArgumentError("`-o` needs `--resolution`: it writes the estimated errors");
    for (const std::string& file : outputs) {
      const std::string ending = io::ending(file);
      if (ending == "png")
        check_writable(file, "image");
      else if (ending == "vtu")
        check_writable(file, "text");
      else
        check_volume_writable(file);
    }
  }
};

void write_errors(const ResolutionResult& found, const std::string& name, const std::string& file, Console& console) {
  if (io::ending(file) != "png") return write_resolution(file, found);
  VolumePicturesOptions options;
  options.look.preset = "flow", options.look.color_title = "error of " + found.report.array;
  VolumePictures pictures(resolution_volume(found, name), options, {}, console.progress());
  write_image(file, pictures.render(pictures.look().picture.view.direction, console.progress()));
}

void tell_resolution(const VolumeModel& volume, const ResolutionArguments& a, Console& console) {
  for (const std::string& file : a.outputs)
    if (io::ending(file) != "png") check_smoothed_writable(file, volume, {}, console.progress());
  const ResolutionResult found = estimate_resolution(volume, console.progress());
  console.note(volume.name(), found.notes);
  for (const std::string& file : a.outputs) write_errors(found, volume.name(), file, console);
  console.report(found.report, "resolution");
  console.print(summary_of(found.report));
  for (const std::string& file : a.outputs) console.print(fmt::format("{}: estimated errors", file));
}

void run_volume_info(const VolumeInput& input, const ResolutionArguments& resolution, Console& console) {
  VolumeInput any = input;
  any.bare = true;
  VolumeModel volume = any.open(console);
  const VolumeInfo made = volume_info(volume, console.progress());
  console.report(input.report());
  console.report(made);
  console.print(fmt::format("{}: {}", input.name(), made.format));
  console.print(summary_of(made));
  if (resolution.wanted) tell_resolution(volume, resolution, console);
}

/// `marked`: the word `data` marked the files as a volume.
void run_any_info(const CloudInput& input, VolumeInput volume, const ResolutionArguments& resolution, bool marked,
                  Console& console) {
  if (!marked && !are_volumes(input.files) && !volume.read.raw.given()) {
    if (resolution.wanted || !volume.array.empty())
      throw ArgumentError("`resolution` and `array` are for volumes: `data FILE` treats points as samples of one");
    return run_info(input, console);
  }
  volume.files = input.files;
  check_inputs_stay(volume.files, resolution.outputs);
  run_volume_info(volume, resolution, console);
}

}  // namespace

Command add_info(CommandLine& app) {
  CommandLine& c = app.add_subcommand("info",
                                      "File → description: points, box, spacing, noise, normals, faces; grid "
                                      "and arrays of volumes");
  auto input = std::make_shared<CloudInput>();
  input->names_system = false;
  auto volume = std::make_shared<VolumeInput>();
  add_cloud_input(
      c, *input,
      "Points, mesh, function (.smf) or volume, or several of them; `data FILE` treats points as samples of a "
      "volume",
      false);
  add_raw_options(c, volume->read);
  auto resolution = std::make_shared<ResolutionArguments>();
  add_schema<VolumeModelOptions>(c, *volume, {.only = {"array"}});
  c.add_flag(
      "--resolution", resolution->wanted,
      "Estimate the error of interpolation in the cells of a volume, and how much finer reaches 1 % of the range");
  c.add_option(
       "-o,--output", resolution->outputs,
       "Write the estimated errors: .vtu (any grid), .vti, .mhd, .mha or .nrrd (uniform grids), .png (picture); "
       "may be repeated")
      .writes({".vtu", ".vti", ".mhd", ".mha", ".nrrd", ".png"})
      .repeated();
  c.footer(std::string(kReadable) + "\n" + kReadableVolumes +
           "\n\nExamples:\n"
           "  sansmesh info scan.ply\n"
           "  sansmesh info *.ply --json\n"
           "  sansmesh info west.las east.las --as-one\n"
           "  sansmesh info fire.vtu\n"
           "  sansmesh info fire.vtu --array t --resolution -o errors.vtu -o errors.png\n"
           "  sansmesh info data samples.csv");
  auto as_one = std::make_shared<bool>(false);
  c.add_flag("--as-one", *as_one, "Read several files (tiles, blocks) as one cloud or volume");
  c.announce({report_of<ReadCloud>(), report_of<CloudInfo>(), report_of<FileReport>(),
              value_of<std::string>("format", "Format of the file"), report_of<FunctionInfo>(), report_of<ReadFiles>(),
              report_of<VolumeInfo>(), report_of<ResolutionReport>("resolution")});
  return {&c, [input, volume, resolution, as_one, &c](Console& console) {
            resolution->check();
            const bool marked = take_volume_word(input->files);
            if (*as_one || input->files.size() == 1) return run_any_info(*input, *volume, *resolution, marked, console);
            if (!resolution->outputs.empty()) throw ArgumentError("`-o` is for one volume");
            console.list_results();
            bool printed = false;
            for (const std::string& file : input->files) {
              CloudInput one = *input;
              one.files = {file};
              if (std::exchange(printed, true)) console.print("");
              try {
                run_any_info(one, *volume, *resolution, marked, console);
                console.end_result();
              } catch (const FileError& error) {
                printed = false;
                console.fail(file, words_of_file_error(error, c));
              } catch (const DataError& error) {
                printed = false;
                console.fail(file, file + ": " + console.in_flags(error.what()));
              }
            }
          }};
}

}  // namespace sansmesh::cli
