#include "volume_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {
namespace {

void say(Console& console, const char* what, const std::string& text) {
  console.say(fmt::format("{:<12}{}", what, text));
}

/// "name double × 3 (points): 0 to 1, 2 to 3, …"
void describe_array(const DatasetArray& a, Console& console, Json& list) {
  std::string ranges;
  const int digits = a.type == NumberType::f32 ? 6 : 10;
  for (std::size_t c = 0; c < std::min<std::size_t>(a.components, 9); ++c)
    ranges += std::isnan(a.least[c])
                  ? fmt::format("{}no numbers", c > 0 ? ", " : "")
                  : fmt::format("{}{:.{}g} to {:.{}g}", c > 0 ? ", " : "", a.least[c], digits, a.most[c], digits);
  if (a.components > 9) ranges += ", …";
  const char* const of = a.of == Association::points ? "point" : "cell";
  say(console, "array",
      fmt::format("{} ({}{} a {}): {}{}", printable(a.name, 80), name_of(a.type),
                  a.components > 1 ? fmt::format(" × {}", a.components) : "", of, ranges,
                  a.not_finite > 0 ? fmt::format("; {} not finite", counted(a.not_finite, "number")) : ""));
  const auto numbers = [](const std::vector<double>& v) {
    Json json = Json::array();
    for (const double x : v) json.push_back(std::isnan(x) ? Json() : Json(x));
    return json;
  };
  list.push_back({{"name", printable(a.name)},
                  {"of", of},
                  {"type", name_of(a.type)},
                  {"components", a.components},
                  {"lower", numbers(a.least)},
                  {"upper", numbers(a.most)},
                  {"not_finite", a.not_finite}});
}

/// The reconstruction that a fitted volume holds.
void describe_fitted(const HeldReconstruction& fitted, Console& console, Json& json) {
  const ReconstructionOptions& o = fitted.options;
  const std::string_view method = o.method.value();
  std::string options;
  const auto add = [&](const char* name, const auto& value) {
    if (value) options += fmt::format("{}{} {}", options.empty() ? "" : ", ", name, *value);
  };
  add("degree at most", o.degree), add("radius", o.radius), add("epsilon", o.epsilon), add("order", o.order);
  add("iterations", o.iterations);
  if (o.spherical.value_or(false)) options += options.empty() ? "spherical" : ", spherical";
  say(console, "fitted",
      fmt::format("{} by {}{}", printable(fitted.array, 80), method, options.empty() ? "" : " (" + options + ")"));
  const std::vector<std::size_t>& by_degree = fitted.by_degree;
  if (!by_degree.empty())
    say(console, "polynomials", fmt::format("of degree 0 to {}: {}", by_degree.size() - 1, fmt::join(by_degree, ", ")));
  json["reconstruction"] = {{"array", printable(fitted.array)},
                            {"method", method},
                            {"degree", o.degree},
                            {"radius", o.radius},
                            {"epsilon", o.epsilon},
                            {"order", o.order},
                            {"iterations", o.iterations},
                            {"spherical", o.spherical.value_or(false)},
                            {"by_degree", by_degree}};
}

}  // namespace

void run_volume_info(const VolumeInput& input, Console& console) {
  VolumeInput any = input;
  any.bare = true;
  VolumeModel volume = any.open(console);
  const VolumeInfo info = volume_info(volume, console.progress());
  const auto& samples = info.samples;
  const VolumeFacts& f = samples->facts;
  const Box3 box = samples->bounds();
  const Vec3 size = box.size();
  console.progress().finish();

  console.say(fmt::format("{}: {}", input.name(), volume.format()));
  say(console, "grid",
      fmt::format("{}, {}{}", f.grid, counted(f.points, "point"),
                  f.cells > 0 ? fmt::format(", {}", counted(f.cells, "cell")) : ""));
  if (f.blocks > 1 || f.levels > 1)
    say(console, "blocks",
        fmt::format("{}{}", grouped(f.blocks), f.levels > 1 ? fmt::format(" in {}", counted(f.levels, "level")) : ""));
  say(console, "samples",
      fmt::format("{} (values of {})", grouped(samples->size()), samples->in_cells ? "cells" : "points"));
  say(console, "box",
      fmt::format("{} × {} × {}, from ({:.10g}, {:.10g}, {:.10g}) to ({:.10g}, {:.10g}, {:.10g})", length(size.x),
                  length(size.y), length(size.z), box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y,
                  box.upper.z));
  say(console, "spacing",
      fmt::format("{} to {}, median {}; cells up to {:.3g} times as long as wide", length(f.least_spacing),
                  length(f.most_spacing), length(f.median_spacing), f.aspect));
  if (f.parts > 1) say(console, "parts", fmt::format("{} that are not connected", grouped(f.parts)));
  for (const Note& note : info.notes) say(console, "mended", note.text);
  if (!volume.times().empty())
    say(console, "times",
        fmt::format("{}, from {:.6g} to {:.6g}", counted(volume.times().size(), "step"), volume.times().front(),
                    volume.times().back()));
  Json arrays = Json::array();
  for (const DatasetArray& a : volume.arrays()) describe_array(a, console, arrays);

  Json json = input.json();
  json["format"] = volume.format();
  json["grid"] = f.grid;
  json["blocks"] = f.blocks;
  json["levels"] = f.levels;
  json["points"] = f.points;
  json["cells"] = f.cells;
  json["samples"] = samples->size();
  json["values_of"] = samples->in_cells ? "cells" : "points";
  json["lower"] = {box.lower.x, box.lower.y, box.lower.z};
  json["upper"] = {box.upper.x, box.upper.y, box.upper.z};
  json["spacing"] = {{"least", f.least_spacing}, {"median", f.median_spacing}, {"most", f.most_spacing}};
  json["aspect"] = f.aspect;
  json["parts"] = f.parts;
  json["merged"] = f.merged;
  json["hidden"] = f.hidden;
  json["overlapped"] = f.overlapped;
  json["degenerate"] = f.degenerate;
  json["inverted"] = f.inverted;
  json["not_finite"] = f.not_finite;
  json["layer"] = f.layer;
  json["arrays"] = std::move(arrays);
  if (info.fitted) describe_fitted(*info.fitted, console, json);
  json["times"] = volume.times();
  json["notes"] = Json::array();
  for (const Note& note : volume.notes()) json["notes"].push_back(note.text);
  console.say_json(json);
  console.print_timings();
}

}  // namespace sansmesh::cli
