// Command `diagnose`: finds doubtful regions of a function.
#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/error.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/functions.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/files/frame_names.h"

namespace sansmesh::cli {
namespace {

struct DiagnoseArguments {
  std::string input, script, preview, pictures;
  bool separate = false;
  PictureArguments picture;
  DiagnoseOptions options;
};

void check_files(const DiagnoseArguments& a) {
  if (!a.script.empty()) {
    if (!a.script.ends_with(".json")) throw FileError(a.script, "scripts are written to files with the ending .json");
    check_writable(a.script, "text");
  }
  if (!a.preview.empty()) check_writable(a.preview, "image");
  if (!a.pictures.empty()) check_writable(a.pictures, "image");
  require(!a.separate || !a.pictures.empty(), "--separate is for --pictures FILE.png");
}

void run_diagnose(const DiagnoseArguments& a, Console& console) {
  a.options.validate();
  const RenderOptions look = a.picture.chosen();
  look.validate();
  check_files(a);
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(a.input);
  const DiagnoseResult made = naming(a.input, console, [&] { return diagnose(function, a.options, progress); });
  Image picture;
  std::vector<Image> pictures;
  if (!a.preview.empty()) picture = render_mesh(made.diagnosis.mesh, look, progress);
  if (!a.pictures.empty()) pictures = draw_regions(made, look, !a.separate, progress);
  progress.begin("write");
  if (!a.script.empty()) write_text(a.script, edit_script(made.edits));
  if (!a.preview.empty()) a.picture.write(a.preview, picture, look);
  std::vector<std::string> files;
  for (const Image& one : pictures) {
    files.push_back(a.separate ? frame_name(a.pictures, files.size() + 1) : a.pictures);
    write_image(files.back(), one);
  }
  console.report(FileReport{a.input}, "input");
  console.report(made);
  if (!a.script.empty()) console.report(FileReport{a.script}, "script");
  if (!a.pictures.empty()) console.report_value("pictures", files);

  console.print(fmt::format("{}: {}", a.input, counted(made.fits, "local fit")));
  console.print(summary_of(made, !a.script.empty()));
  if (!a.script.empty())
    console.print(fmt::format("{}: {} to try with `sansmesh edit`", a.script, counted(made.edits.size(), "edit")));
  if (!a.preview.empty())
    console.print(fmt::format("{}: yellow low coverage, orange high error, red extra sheets, violet steep", a.preview));
  if (!a.pictures.empty())
    console.print(files.empty() ? a.pictures + ": not written, there are no doubtful regions"
                                : WrittenPictures{files}.words() + ": the regions, by number");
}

}  // namespace

Command add_diagnose(CommandLine& app) {
  CommandLine& c = app.add_subcommand("diagnose", "Function file → doubtful regions, a picture, and proposed edits");
  auto a = std::make_shared<DiagnoseArguments>();
  add_function_input(c, a->input);
  c.add_option("--script-output", a->script, "Write a script for `sansmesh edit`, one step per region: .json")
      .former_name("--script")
      .writes({".json"});
  c.add_option("--preview", a->preview, "Draw the surface with coloured doubtful regions into this PNG")
      .writes({".png"});
  c.add_option("--pictures", a->pictures, "Draw each region from outside, ringed and numbered, on one sheet, a PNG")
      .writes({".png"});
  c.add_flag("--separate", a->separate,
             "Write one picture per region instead of the sheet: FILE_001.png, FILE_002.png, …");
  add_picture_options(c, a->picture);
  add_wireframe_options(c, a->picture.options);
  add_schema(c, a->options);
  c.footer(
      "Examples:\n"
      "  sansmesh diagnose scan.smf --preview scan.png --pictures places.png --script-output edits.json\n"
      "  sansmesh edit scan.smf --script edits.json -o repaired.smf");
  c.announce({report_of<FileReport>("input"), report_of<DiagnoseResult>(), report_of<FileReport>("script"),
              value_of<std::vector<std::string>>("pictures", "Pictures of the regions")});
  return {&c, [a](Console& console) { run_diagnose(*a, console); }};
}

}  // namespace sansmesh::cli
