// Command `section`: cuts a surface with planes.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/input/surface_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/measure/section_text.h"

namespace sansmesh::cli {
namespace {

/// Number of planes that are printed individually.
constexpr std::size_t kPrintedPlanes = 30;

struct SectionArguments {
  CloudInput input;
  std::string output, unit;
  SectionOptions options;
};

void check_output(const SectionArguments& a) {
  if (!a.output.empty() && !a.output.ends_with(".svg") && !a.output.ends_with(".csv"))
    throw FileError(a.output, "sections are written as .svg or .csv");
  if (!a.output.empty()) check_writable(a.output, "text");
  require(a.unit.empty() || a.output.ends_with(".svg"), "--unit is for drawings: -o FILE.svg");
}

void run_section(const SectionArguments& a, Console& console) {
  a.options.validate();
  check_output(a);
  Progress& progress = console.progress();
  const SurfaceInput opened = open_surface(a.input, console);
  const SectionResult made = section(opened.surface, a.options, progress);
  const std::vector<Section>& sections = made.sections;
  if (!a.output.empty()) {
    progress.begin("write");
    write_text(a.output, a.output.ends_with(".svg") ? section_svg(sections, {.unit = a.unit}) : section_csv(sections));
  }
  console.report(opened.report, "input");
  console.report(made);
  if (!a.output.empty()) console.report(FileReport{a.output}, "output");

  for (std::size_t i = 0; i < std::min(kPrintedPlanes, sections.size()); ++i) console.print(section_words(sections[i]));
  if (sections.size() > kPrintedPlanes) console.print(fmt::format("… {}", counted(sections.size(), "plane")));
  console.note(opened.surface.name(), made.notes);
  if (!a.output.empty())
    console.print(
        fmt::format("{}: {} in {}", a.output, counted(made.report.curves, "curve"), counted(sections.size(), "plane")));
}

}  // namespace

Command add_section(CommandLine& app) {
  CommandLine& c = app.add_subcommand("section", "Mesh or function → cross-sections by planes");
  auto a = std::make_shared<SectionArguments>();
  add_surface_input(c, "input", a->input.files,
                    "Mesh, function (.smf) or DATA[NAME=VALUE] of a volume; several meshes are cut as one");
  c.add_option("-o,--output", a->output, "Drawing (.svg) or table of vertices (.csv) to write")
      .writes({".svg", ".csv"});
  add_schema(c, a->options);
  add_drawing_unit(c, a->unit);
  c.footer(
      "Without --plane and --axis: three planes through the middle of the bounding box. Holes are subtracted\n"
      "from areas. Functions are cut without a mesh.\n\n"
      "Examples:\n"
      "  sansmesh section part.ply -o part.svg\n"
      "  sansmesh section part.ply --axis z --count 10 -o slices.svg\n"
      "  sansmesh section part.smf --plane z=0.5 --plane 1,1,0,0 -o cuts.csv");
  c.announce({report_of<ReadSurface>("input"), report_of<SectionResult>(), report_of<FileReport>("output")});
  return {&c, [a](Console& console) { run_section(*a, console); }};
}

}  // namespace sansmesh::cli
