// sansmesh compare: the inspection map, how far every place of a part lies from where it should.
#include "sansmesh/inspect.h"
#include "sansmesh/jobs/cloud_or_mesh.h"
#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "align_report.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/io.h"
#include "schema_options.h"
#include "surface_input.h"

namespace sansmesh::cli {
namespace {

struct CompareArguments {
  CloudInput part, reference;
  std::string output, preview, unit;
  bool ascii = false, histogram = false;
  CompareOptions options;
  PictureArguments picture;
};

Json to_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json to_json(const DistanceStatistics& s) {
  return {{"mean", s.mean},
          {"mean_absolute", s.mean_absolute},
          {"rms", s.rms},
          {"deviation", s.deviation},
          {"p05", s.p05},
          {"median", s.median},
          {"p95", s.p95},
          {"p95_absolute", s.p95_absolute},
          {"lowest", {{"value", s.lowest}, {"at", to_json(s.lowest_at)}}},
          {"highest", {{"value", s.highest}, {"at", to_json(s.highest_at)}}},
          {"within_tolerance", s.within_tolerance},
          {"area", s.area}};
}

std::string place(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

void say_statistics(const DistanceMap& map, const std::optional<double>& tolerance, Console& console) {
  const DistanceStatistics& s = map.statistics;
  if (map.has_sides)
    console.say(
        fmt::format("{:<16}mean {:+.4g}, standard deviation {}, 5 % below {:+.4g}, half below {:+.4g}, "
                    "95 % below {:+.4g}",
                    "signed", s.mean, length(s.deviation), s.p05, s.median, s.p95));
  console.say(fmt::format("{:<16}mean {}, rms {}, 95 % below {}", "absolute", length(s.mean_absolute), length(s.rms),
                          length(s.p95_absolute)));
  if (map.has_sides && s.lowest < 0)
    console.say(fmt::format("{:<16}{:+.4g} at {}", "farthest inside", s.lowest, place(s.lowest_at)));
  if (s.highest > 0)
    console.say(
        fmt::format("{:<16}{:+.4g} at {}", map.has_sides ? "and outside" : "farthest", s.highest, place(s.highest_at)));
  if (s.within_tolerance)
    console.say(fmt::format("{:<16}{:.3f} % within ±{}", "tolerance", 100 * *s.within_tolerance, length(*tolerance)));
}

void say_histogram(const DistanceMap& map, Console& console) {
  const DistanceStatistics& s = map.statistics;
  const double most = *std::max_element(s.histogram.begin(), s.histogram.end());
  const double low = map.has_sides ? -s.range : 0, width = (s.range - low) / static_cast<double>(s.histogram.size());
  const auto line = [&](const std::string& where, double share) {
    const int bar = most > 0 ? index_in<int>(std::round(50 * share / most), 0, 50) : 0;
    console.say(fmt::format("{:>23} {:8.3f} % {:#<{}}", where, 100 * share, "", bar));
  };
  if (map.has_sides) line(fmt::format("below {:.4g}", low), s.below_range);
  for (std::size_t i = 0; i < s.histogram.size(); ++i)
    line(
        fmt::format("{:.4g} .. {:.4g}", low + width * static_cast<double>(i), low + width * static_cast<double>(i + 1)),
        s.histogram[i]);
  line(fmt::format("above {:.4g}", s.range), s.above_range);
}

void check_arguments(const CompareArguments& a) {
  a.options.validate();
  if (!a.output.empty()) check_writable(a.output, "text");
  const RenderOptions look = a.picture.chosen();
  look.validate();
  if (a.preview.empty()) return;
  check_writable(a.preview, "image");
  check_map_picture(look, a.unit);
}

/// The mesh has the colours of the map.
void write_map(const CompareArguments& a, const CompareResult& made, Progress& progress) {
  MapPicture picture;
  if (!a.preview.empty()) picture = draw_map(made, a.options, a.picture.chosen(), a.unit, progress);
  if (!a.output.empty() || !a.preview.empty()) progress.begin("write");
  if (!a.output.empty()) {
    if (made.mesh.triangles.empty())
      write_points(a.output, vertices_of(made.mesh), {.ascii = a.ascii});
    else
      write_mesh(a.output, made.mesh, {.ascii = a.ascii});
  }
  if (!a.preview.empty()) a.picture.write(a.preview, picture.image, picture.made_with);
}

/// What was left out, and what was written.
void say_rest(const CompareArguments& a, const DistanceMap& map, const std::string& reference, Console& console) {
  const auto line = [&](const char* title, std::size_t count, const std::string& what) {
    if (count > 0) console.say(fmt::format("{:<16}{} {}", title, grouped(count), what));
  };
  line("left out", map.beyond, fmt::format("farther off than {} (grey)", length(map.max_distance)));
  line("not found", map.not_found, "from where no surface was found (grey)");
  line("borders", map.at_border,
       fmt::format("closest to the border of {}{}", reference,
                   a.options.map.skip_border ? " (left out, grey)" : ": --skip-border leaves them out"));
  line("unused", map.not_finite, "that no triangle uses");
  if (a.histogram && map.measured > 0) say_histogram(map, console);
  const DistanceStatistics& s = map.statistics;
  for (const std::string& file : {a.output, a.preview})
    if (!file.empty())
      console.say(fmt::format("{}: blue inside, red outside, full colour at ±{}{}", file, length(s.range),
                              s.smallest_range ? ", a millionth of the diagonal: 99 % are nearer" : ""));
}

Json to_json(const CompareArguments& a, const CompareResult& made, const Json& part, const Json& reference) {
  const DistanceMap& map = made.map;
  const DistanceStatistics& s = map.statistics;
  Json json = {{"part", part},
               {"reference", reference},
               {"on", a.options.on == MapSide::part ? "part" : "reference"},
               {"signed", map.has_sides},
               {"vertices", map.distance.size()},
               {"measured", map.measured},
               {"beyond", map.beyond},
               {"not_found", map.not_found},
               {"at_border", map.at_border},
               {"not_finite", map.not_finite},
               {"max_distance", map.max_distance},
               {"within", a.options.map.within},
               {"distance", to_json(s)},
               {"histogram",
                {{"lower", map.has_sides ? -s.range : 0.0},
                 {"upper", s.range},
                 {"below", s.below_range},
                 {"above", s.above_range},
                 {"shares", s.histogram}}}};
  json["reference"]["diagonal"] = made.report.diagonal;
  if (!a.output.empty()) json["output"] = {{"file", a.output}};
  if (!a.preview.empty()) json["preview"] = {{"file", a.preview}};
  if (const auto& moved = made.report.alignment) {
    json["alignment"] = json_of_alignment(*moved);
    json["matrix"] = json_of_matrix(made.report.motion);
  }
  return json;
}

void run_compare(const CompareArguments& a, Console& console) {
  check_arguments(a);
  Progress& progress = console.progress();
  const SurfaceInput part = open_surface(a.part, console), reference = open_surface(a.reference, console);
  const bool reversed = a.options.on == MapSide::reference;
  const AnySurface& mapped = (reversed ? reference : part).surface;
  const AnySurface& other = (reversed ? part : reference).surface;
  const bool points = mapped.kind() == AnySurface::Kind::points;
  if (!a.output.empty()) check_writable(a.output, points ? "points" : "mesh");
  const CompareResult made = compare(part.surface, reference.surface, a.options, progress);
  console.note(mapped.name(), made.notes);
  write_map(a, made, progress);
  progress.finish();

  console.say(fmt::format("{}: {} of {} {} compared with {} ({})", mapped.name(), grouped(made.map.measured),
                          grouped(made.mesh.vertices.size()), points ? "points" : "vertices", other.name(),
                          other.kind_word()));
  if (made.report.alignment) say_alignment(*made.report.alignment, console);
  if (made.map.measured > 0) say_statistics(made.map, a.options.map.within, console);
  say_rest(a, made.map, other.name(), console);
  console.say_json(to_json(a, made, part.json, reference.json));
  console.print_timings();
}

}  // namespace

Command add_compare(CommandLine& app) {
  CommandLine& c = app.add_subcommand("compare", "Two surfaces → signed distances as numbers, colours and a picture");
  auto a = std::make_shared<CompareArguments>();
  a->part.files.resize(1);
  c.add_option("part", a->part.files[0], "What was made: mesh, points, or function (.smf)")
      .type_name("FILE")
      .required();
  c.add_option("reference", a->reference.files,
               "What it should be: mesh, points, or function (.smf); several files are read as one")
      .type_name("FILE")
      .required();
  add_class_options(c, a->reference, " of the reference");
  c.add_option("-o,--output", a->output,
               "The map to write, distance as quality and as colours: .ply .vtp .glb (others: colours)")
      .type_name("FILE");
  add_preview_option(c, a->preview, "the map, with a scale in its --width,");
  const std::vector<std::string_view> of_alignment = {"align", "from", "find_scale", "align_samples",
                                                      "align_iterations"};
  add_schema(c, a->options, {.without = of_alignment});
  add_schema(c, a->options, {.group = "Alignment", .only = of_alignment});
  c.add_flag("--histogram", a->histogram, "Print the distribution as well");
  add_ascii_flag(c, a->ascii);
  add_picture_options(c, a->picture);
  add_wireframe_options(c, a->picture.options);
  c.add_option("--unit", a->unit, "Of lengths, at the scale").type_name("UNIT").group("Picture");
  c.footer(
      "Positive distances lie outside of the reference. Statistics are weighted by area. Nothing is moved "
      "without --align.\n\n"
      "Examples:\n"
      "  sansmesh compare made.ply design.stl --within 0.05 -o map.ply --preview map.png\n"
      "  sansmesh compare scan.ply design.stl --max-distance 2 --histogram\n"
      "  sansmesh compare design.stl scan.smf --refine 0.5 --json");
  return {&c, [a](Console& console) { run_compare(*a, console); }};
}

}  // namespace sansmesh::cli
