// sansmesh info: what is in a file?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/sewn_mesh.h"
#include "sansmesh/points/cloud_shape.h"
#include "sansmesh/points/duplicates.h"
#include "sansmesh/points/orientation.h"
#include "volume_info.h"

namespace sansmesh::cli {
namespace {

const char* shape_word(CloudShape shape) {
  switch (shape) {
    case CloudShape::empty:
      return "empty";
    case CloudShape::point:
      return "a point";
    case CloudShape::line:
      return "a line";
    case CloudShape::plane:
      return "a plane";
    case CloudShape::volume:
      return "a volume";
  }
  return "";
}

/// What a cloud spans; of parts so far apart that it seems to be less than it is, that.
std::string span_words(const PointSet& points) {
  if (const auto parts = find_far_parts(points)) return fmt::format("parts {:.3g} apart", parts->apart);
  return shape_word(classify_shape(points));
}

void run_function_info(const std::string& file, Console& console) {
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(file);
  progress.finish();
  const PartitionReport& r = function.field.report();
  const PointSet& samples = *function.samples;
  const Placement& place = function.place;
  const auto [lower, upper] = place.to_input(function.field.bounds());
  console.say(fmt::format("{}: function, partition of unity", file));
  console.say(fmt::format("{:<12}{} down to depth {}; of degree 0 to 4: {}", "fits", grouped(r.functions), r.depth,
                          fmt::join(r.functions_of_degree, ", ")));
  console.say(fmt::format("{:<12}{}", "creases", counted(r.creased, "fit")));
  if (r.open_area > 0)
    console.say(fmt::format("{:<12}{:.3g} % of the surface bounds no solid and ends with its samples", "open",
                            100 * std::min(1.0, r.open_area / r.area)));
  console.say(fmt::format("{:<12}{}{}", "samples",
                          samples.size() == 0 ? std::string("not kept") : grouped(samples.size()),
                          samples.has_colors() ? ", with colours" : ""));
  console.say(fmt::format("{:<12}from ({:.10g}, {:.10g}, {:.10g}) to ({:.10g}, {:.10g}, {:.10g})", "cube", lower.x,
                          lower.y, lower.z, upper.x, upper.y, upper.z));
  console.say(fmt::format("{:<12}{}", "spacing", length(place.to_input(r.spacing))));
  console.say(
      fmt::format("{:<12}{} (of the samples from it, root mean square)", "deviation", length(place.to_input(r.noise))));
  console.say(fmt::format("{:<12}{} (expected error of the surface)", "accuracy", length(place.to_input(r.accuracy))));
  for (const std::string& line : function.history) console.say(fmt::format("{:<12}{}", "edited", line));
  const Json json = {{"file", file},
                     {"format", "function"},
                     {"fits", r.functions},
                     {"fits_of_degree", r.functions_of_degree},
                     {"creased", r.creased},
                     {"open_share", r.area > 0 ? std::min(1.0, r.open_area / r.area) : 0.0},
                     {"winding_number_behind", r.behind},
                     {"depth", r.depth},
                     {"samples", samples.size()},
                     {"spacing", place.to_input(r.spacing)},
                     {"deviation", place.to_input(r.noise)},
                     {"accuracy", place.to_input(r.accuracy)},
                     {"cube", {{lower.x, lower.y, lower.z}, {upper.x, upper.y, upper.z}}},
                     {"history", function.history}};
  console.say_json(json);
}

/// Least and largest finite number of a component; nothing where there is none.
std::optional<std::pair<double, double>> range_of(const Attribute& a, std::size_t component) {
  std::optional<std::pair<double, double>> range;
  for (std::size_t i = component; i < a.size(); i += a.components) {
    const double v = a.number(i);
    if (!std::isfinite(v)) continue;
    if (!range) range = {v, v};
    range->first = std::min(range->first, v), range->second = std::max(range->second, v);
  }
  return range;
}

/// A line and a JSON object for each array: name, type, components, ranges.
void describe(const AttributeTable& table, const char* of, Console& console, Json& list) {
  for (const Attribute& a : table) {
    std::string ranges;
    Json lower = Json::array(), upper = Json::array();
    const int digits = a.type() == NumberType::f32 ? 6 : 10;  // times of surveys differ in the last ones
    for (std::size_t c = 0; c < a.components; ++c) {
      const auto range = range_of(a, c);
      lower.push_back(range ? Json(range->first) : Json());
      upper.push_back(range ? Json(range->second) : Json());
      if (c == 9) ranges += ", …";
      if (c >= 9) continue;
      ranges +=
          range ? fmt::format("{}{:.{}g} to {:.{}g}", c > 0 ? ", " : "", range->first, digits, range->second, digits)
                : fmt::format("{}no numbers", c > 0 ? ", " : "");
    }
    const std::string components = a.components > 1 ? fmt::format(" × {}", a.components) : std::string();
    console.say(fmt::format("{:<12}{} ({}{} a {}): {}", "attribute", printable(a.name, 80), name_of(a.type()),
                            components, of, ranges));
    list.push_back({{"name", printable(a.name)},
                    {"of", of},
                    {"type", name_of(a.type())},
                    {"components", a.components},
                    {"lower", lower},
                    {"upper", upper}});
  }
}

/// How many points there are of each class.
void describe_classes(const PointSet& points, Console& console, Json& json) {
  const Attribute* const of = find_point_classes(points);
  if (!of) return;
  const auto counts = count_point_classes(*of);
  std::string text;
  for (unsigned c = 0; c < counts.size(); ++c) {
    if (counts[c] == 0) continue;
    const std::string_view name = point_class_name(c);
    text += fmt::format("{}{}{}: {}", text.empty() ? "" : ", ", c, name.empty() ? "" : fmt::format(" {}", name),
                        grouped(counts[c]));
    json["classes"][std::to_string(c).c_str()] = counts[c];
  }
  if (!text.empty()) console.say(fmt::format("{:<12}{}", "classes", text));
}

void run_info(const CloudInput& input, Console& console) {
  if (input.is_function()) return run_function_info(input.files[0], console);
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const PointSet points = input.read(console, read);

  progress.begin("measure");
  const Box3f box = bounds(points);
  const auto [lower, upper] = Placement{points.origin}.to_input(box);
  const std::size_t duplicates = points.size() - count_unique(points);
  const std::string shape = span_words(points);
  const CloudScale scale(points);
  const GivenNormals normals = judge_normals(points, scale.noise.deviation);
  const OrientBy orient_by = first_known_orientation(points, scale.noise.deviation);
  const Vec3f size = box.size();

  console.say(fmt::format("{}: {}", input.name(), read.format));
  console.say(fmt::format("{:<12}{}{}", "points", grouped(points.size()),
                          duplicates > 0 ? fmt::format(", {} of them given twice or more", grouped(duplicates)) : ""));
  console.say(fmt::format("{:<12}{} × {} × {}, from ({:.10g}, {:.10g}, {:.10g}) to ({:.10g}, {:.10g}, {:.10g})", "box",
                          length(size[0]), length(size[1]), length(size[2]), lower[0], lower[1], lower[2], upper[0],
                          upper[1], upper[2]));
  console.say(fmt::format("{:<12}{}", "spans", shape));
  console.say(fmt::format("{:<12}{}", "spacing", length(scale.spacing)));
  console.say(fmt::format("{:<12}{}", "noise", scale.noise_words()));
  console.say(fmt::format("{:<12}{}{}", "normals", normals.words,
                          normals.oriented ? "" : fmt::format("; signs {}", orientation_words(orient_by))));
  std::string attributes;
  const auto add = [&](bool present, const std::string& name) {
    if (present) attributes += (attributes.empty() ? "" : ", ") + name;
  };
  add(points.has_colors(), "colours");
  add(!points.scanners.empty(), counted(points.scanners.size(), "scanner position"));
  if (!attributes.empty()) console.say(fmt::format("{:<12}{}", "also", attributes));
  Json tables = Json::array();
  describe(points.attributes, "point", console, tables);
  describe(points.triangle_attributes, "triangle", console, tables);

  Json json = input.json();
  describe_classes(points, console, json);
  json["format"] = read.format;
  json["points"] = points.size();
  json["duplicates"] = duplicates;
  json["lower"] = {lower[0], lower[1], lower[2]};
  json["upper"] = {upper[0], upper[1], upper[2]};
  json["spans"] = shape;
  scale.add_to(json);
  json["normals"] = normals.words;
  json["orientation"] = json_of_normals(normals);
  json["orient_by"] = orient_by_word(orient_by);
  json["colors"] = points.has_colors();
  json["attributes"] = std::move(tables);
  json["scanners"] = points.scanners.size();
  json["triangles"] = points.triangles.size();
  if (!points.triangles.empty()) {
    const MeshTopology t = sewn_topology(to_mesh(points));
    console.say(fmt::format("{:<12}{}, {}", "faces", counted(t.triangles, "triangle"), topology_words(t)));
    json["mesh"] = topology_json(t);
  }
  progress.finish();
  console.say_json(json);
  console.print_timings();
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
  return {&c, [input, volume](Console& console) {
            const bool named = names_volume(input->files);
            if (!named && !volume->read.raw.given()) return run_info(*input, console);
            volume->files = input->files;
            run_volume_info(*volume, console);
          }};
}

}  // namespace sansmesh::cli
