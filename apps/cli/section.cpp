// sansmesh section: the curves in which planes cut a surface.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/measure/section_text.h"
#include "schema_options.h"
#include "surface_input.h"

namespace sansmesh::cli {
namespace {

/// More planes than this are summed up in one line.
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
  progress.finish();

  Json json = {{"input", opened.json}, {"planes", Json::array()}};
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& s = sections[i];
    std::size_t open = 0, vertices = 0;
    for (const SectionCurve& c : s.curves) open += !c.closed, vertices += c.points.size();
    json["planes"].push_back({{"equation", equation(s.plane)},
                              {"normal", {s.plane.normal.x, s.plane.normal.y, s.plane.normal.z}},
                              {"offset", s.plane.offset},
                              {"curves", s.curves.size()},
                              {"open_curves", open},
                              {"vertices", vertices},
                              {"length", s.length},
                              {"area", s.area}});
    if (i < kPrintedPlanes)
      console.say(fmt::format("{:<20} length {:<11.6g} area {:<11.6g} {}{}", equation(s.plane), s.length, s.area,
                              s.curves.empty() ? "nothing there" : counted(s.curves.size(), "curve"),
                              open > 0 ? fmt::format(" ({} open)", grouped(open)) : ""));
  }
  if (sections.size() > kPrintedPlanes) console.say(fmt::format("… {}", counted(sections.size(), "plane")));
  console.note(opened.surface.name(), made.notes);
  if (!a.output.empty()) {
    console.say(
        fmt::format("{}: {} in {}", a.output, counted(made.report.curves, "curve"), counted(sections.size(), "plane")));
    json["output"] = {{"file", a.output}};
  }
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_section(CommandLine& app) {
  CommandLine& c = app.add_subcommand("section", "Mesh or function → the curves in which planes cut it");
  auto a = std::make_shared<SectionArguments>();
  c.add_option("input", a->input.files,
               "Mesh, function (.smf) or DATA[NAME=VALUE] of a volume; several meshes are cut as one")
      .type_name("FILE")
      .required();
  c.add_option("-o,--output", a->output, "Drawing (.svg) or table of vertices (.csv) to write").type_name("FILE");
  add_schema(c, a->options);
  c.add_option("--unit", a->unit, "mm, cm or in: the drawing is true to scale")
      .type_name("UNIT")
      .one_of({"mm", "cm", "in"});
  c.footer(
      "Without --plane and --axis: three planes through the middle of the bounding box. Holes are subtracted\n"
      "from areas. Functions are cut without a mesh.\n\n"
      "Examples:\n"
      "  sansmesh section part.ply -o part.svg\n"
      "  sansmesh section part.ply --axis z --count 10 -o slices.svg\n"
      "  sansmesh section part.smf --plane z=0.5 --plane 1,1,0,0 -o cuts.csv");
  return {&c, [a](Console& console) { run_section(*a, console); }};
}

}  // namespace sansmesh::cli
