// sansmesh section: the curves in which planes cut a surface.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/io/io.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/measure/section_text.h"
#include "surface_input.h"

namespace sansmesh::cli {
namespace {

/// More planes than this are summed up in one line.
constexpr std::size_t kPrintedPlanes = 30;

struct SectionArguments {
  CloudInput input;
  std::string output;
  std::vector<std::string> planes;
  std::string axis;
  std::optional<double> start, step;
  std::optional<int> count;
  std::optional<int> resolution;
  std::string unit;
};

void check_output(const SectionArguments& a) {
  if (!a.output.empty() && !a.output.ends_with(".svg") && !a.output.ends_with(".csv"))
    throw FileError(a.output, "sections are written as .svg or .csv");
  if (!a.output.empty()) check_writable(a.output, "text");
  require(a.unit.empty() || a.output.ends_with(".svg"), "--unit is for drawings: -o FILE.svg");
}

/// What can be told before the file is read.
void check_planes(const SectionArguments& a) {
  for (const std::string& text : a.planes) parse_plane(text);
  if (a.axis.empty()) require(!a.start && !a.step && !a.count, "--start, --step and --count need --axis");
  require(!a.start || std::isfinite(*a.start), "--start must be finite");
  require(!a.step || (std::isfinite(*a.step) && *a.step != 0), "--step must be finite and not 0");
  require(a.step || !a.start || a.count.value_or(1) == 1, "several planes from --start on need --step");
}

/// The arguments are those that check_planes accepts.
std::vector<CutPlane> chosen_planes(const SectionArguments& a, const Box3& box) {
  std::vector<CutPlane> planes;
  planes.reserve(a.planes.size());
  for (const std::string& text : a.planes) planes.push_back(parse_plane(text));
  if (a.axis.empty()) return planes.empty() ? middle_planes(box) : planes;
  const int axis = a.axis[0] - 'x';
  const auto k = static_cast<std::size_t>(axis);
  std::vector<CutPlane> series;
  if (!a.start && !a.step) {
    series = spread_planes(box, axis, a.count.value_or(1));
  } else if (a.step && !a.count) {
    // As many as reach to the other end of the box.
    const double start = a.start.value_or(*a.step > 0 ? box.lower[k] + 0.5 * *a.step : box.upper[k] + 0.5 * *a.step);
    const double left = ((*a.step > 0 ? box.upper[k] : box.lower[k]) - start) / *a.step;
    series = plane_series(axis, start, *a.step, 1 + index_in<int>(left, 0, 1000000));
  } else {
    series = plane_series(axis, a.start.value_or(box.lower[k] + 0.5 * a.step.value_or(0)), a.step.value_or(1),
                          a.count.value_or(1));
  }
  planes.insert(planes.end(), series.begin(), series.end());
  return planes;
}

void run_section(const SectionArguments& a, Console& console) {
  check_planes(a);
  check_output(a);
  FieldSectionOptions options;
  if (a.resolution) options.resolution = *a.resolution;
  options.validate();

  Progress& progress = console.progress();
  SurfaceInput surface(a.input, console);
  require(!a.resolution || surface.field(), "--resolution is for functions: meshes are cut exactly");
  if (!surface.field() && surface.mesh().triangles.empty())
    throw FileError(surface.file(), "has no faces to cut: sansmesh reconstruct or fit makes a surface of points");
  const Box3 box = surface.bounds();
  if (box.empty()) throw FileError(surface.file(), "has no finite points");
  const std::vector<CutPlane> planes = chosen_planes(a, box);
  const std::vector<Section> sections = surface.field() ? section_field(*surface.field(), planes, options, progress)
                                                        : section_mesh(surface.mesh(), planes, progress);
  if (!a.output.empty()) {
    progress.begin("write");
    write_text(a.output, a.output.ends_with(".svg") ? section_svg(sections, {.unit = a.unit}) : section_csv(sections));
  }
  progress.finish();

  Json json = {{"input", surface.json()}, {"planes", Json::array()}};
  std::size_t curves = 0, open = 0, empty = 0;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const Section& s = sections[i];
    std::size_t open_here = 0, vertices = 0;
    for (const SectionCurve& c : s.curves) open_here += !c.closed, vertices += c.points.size();
    curves += s.curves.size(), open += open_here, empty += s.curves.empty();
    json["planes"].push_back({{"equation", equation(s.plane)},
                              {"normal", {s.plane.normal.x, s.plane.normal.y, s.plane.normal.z}},
                              {"offset", s.plane.offset},
                              {"curves", s.curves.size()},
                              {"open_curves", open_here},
                              {"vertices", vertices},
                              {"length", s.length},
                              {"area", s.area}});
    if (i < kPrintedPlanes)
      console.say(fmt::format("{:<20} length {:<11.6g} area {:<11.6g} {}{}", equation(s.plane), s.length, s.area,
                              s.curves.empty() ? "nothing there" : counted(s.curves.size(), "curve"),
                              open_here > 0 ? fmt::format(" ({} open)", grouped(open_here)) : ""));
  }
  if (sections.size() > kPrintedPlanes) console.say(fmt::format("… {}", counted(sections.size(), "plane")));
  if (open > 0)
    console.warn(surface.file(), {fmt::format("{} of {} open: the surface has borders there, which enclose no area",
                                              grouped(open), counted(curves, "curve"))});
  if (!a.output.empty()) {
    console.say(fmt::format("{}: {} in {}", a.output, counted(curves, "curve"), counted(sections.size(), "plane")));
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
  c.add_option("--plane", a->planes, "z=0.5, or nx,ny,nz,d for the points with n·x = d; may be repeated")
      .type_name("PLANE")
      .repeated();
  c.add_option("--axis", a->axis, "Planes perpendicular to x, y or z").type_name("AXIS").one_of({"x", "y", "z"});
  c.add_option("--start", a->start, "Position of the first of them [half a step inside the box]").type_name("LENGTH");
  c.add_option("--step", a->step, "Distance from one to the next [spread over the box]").type_name("LENGTH");
  c.add_option("--count", a->count, "How many, 1..100000 [1, or as many as --step fits into the box]")
      .type_name("COUNT");
  c.add_option("--resolution", a->resolution, "Of a function: lattice squares along the longer side, 2..4096 [512]")
      .type_name("COUNT");
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
