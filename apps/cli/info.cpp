// sansmesh info: what is in a file?
#include "sansmesh/points.h"

#include <fmt/format.h>

#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "error_words.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/surface_function.h"
#include "volume_info.h"

namespace sansmesh::cli {
namespace {

/// A line with a title.
template <class... T>
void say_line(Console& console, const char* title, fmt::format_string<T...> text, T&&... values) {
  console.say(fmt::format("{:<12}{}", title, fmt::format(text, std::forward<T>(values)...)));
}

std::string box_words(const Box3& box) {
  const auto& [lower, upper] = box;
  return fmt::format("from ({:.10g}, {:.10g}, {:.10g}) to ({:.10g}, {:.10g}, {:.10g})", lower.x, lower.y, lower.z,
                     upper.x, upper.y, upper.z);
}

Json corner_json(const Vec3& p) { return {p.x, p.y, p.z}; }

void run_function_info(const std::string& file, Console& console) {
  Progress& progress = console.progress();
  progress.begin("read");
  const FunctionInfo made = info(read_function(file));
  progress.finish();
  console.say(fmt::format("{}: function, partition of unity", file));
  say_line(console, "fits", "{} down to depth {}; of degree 0 to 4: {}", grouped(made.fits), made.depth,
           fmt::join(made.fits_of_degree, ", "));
  say_line(console, "creases", "{}", counted(made.creased, "fit"));
  if (made.open_share > 0)
    say_line(console, "open", "{:.3g} % of the surface bounds no solid and ends with its samples",
             100 * made.open_share);
  say_line(console, "samples", "{}{}", made.samples == 0 ? std::string("not kept") : grouped(made.samples),
           made.colors ? ", with colours" : "");
  say_line(console, "cube", "{}", box_words(made.cube));
  say_line(console, "spacing", "{}", length(made.spacing));
  say_line(console, "deviation", "{} (of the samples from it, root mean square)", length(made.deviation));
  say_line(console, "accuracy", "{} (expected error of the surface)", length(made.accuracy));
  for (const std::string& line : made.history) say_line(console, "edited", "{}", line);
  console.say_json({{"file", file},
                    {"format", "function"},
                    {"fits", made.fits},
                    {"fits_of_degree", made.fits_of_degree},
                    {"creased", made.creased},
                    {"open_share", made.open_share},
                    {"winding_number_behind", made.behind},
                    {"depth", made.depth},
                    {"samples", made.samples},
                    {"spacing", made.spacing},
                    {"deviation", made.deviation},
                    {"accuracy", made.accuracy},
                    {"cube", {corner_json(made.cube.lower), corner_json(made.cube.upper)}},
                    {"history", made.history}});
}

/// A line for each array: name, type, components, ranges.
void say_attribute(const AttributeInfo& a, Console& console) {
  constexpr std::size_t kMostRanges = 9;
  const int digits = a.type == NumberType::f32 ? 6 : 10;  // times of surveys differ in the last ones
  std::string ranges;
  for (std::size_t c = 0; c < a.ranges.size() && c <= kMostRanges; ++c) {
    if (c > 0) ranges += ", ";
    if (const auto& range = a.ranges[c]; c == kMostRanges)
      ranges += "…";
    else
      ranges += range ? fmt::format("{:.{}g} to {:.{}g}", range->first, digits, range->second, digits) : "no numbers";
  }
  say_line(console, "attribute", "{} ({}{} a {}): {}", printable(a.name, 80), name_of(a.type),
           a.ranges.size() > 1 ? fmt::format(" × {}", a.ranges.size()) : "", a.of_triangles ? "triangle" : "point",
           ranges);
}

Json attribute_json(const AttributeInfo& a) {
  Json lower = Json::array(), upper = Json::array();
  for (const auto& range : a.ranges) {
    lower.push_back(range ? Json(range->first) : Json());
    upper.push_back(range ? Json(range->second) : Json());
  }
  return {{"name", printable(a.name)},
          {"of", a.of_triangles ? "triangle" : "point"},
          {"type", name_of(a.type)},
          {"components", a.ranges.size()},
          {"lower", lower},
          {"upper", upper}};
}

/// How many points there are of each class.
void say_classes(const CloudInfo& made, Console& console, Json& json) {
  if (!made.classes) return;
  std::string text;
  for (unsigned c = 0; c < made.classes->size(); ++c) {
    const std::size_t count = (*made.classes)[c];
    if (count == 0) continue;
    const std::string_view name = point_class_name(c);
    text += fmt::format("{}{}{}: {}", text.empty() ? "" : ", ", c, name.empty() ? "" : fmt::format(" {}", name),
                        grouped(count));
    json["classes"][std::to_string(c).c_str()] = count;
  }
  if (!text.empty()) say_line(console, "classes", "{}", text);
}

void run_info(const CloudInput& input, Console& console) {
  if (input.is_function()) return run_function_info(input.files[0], console);
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  const CloudInfo made = info(input.read(console, read), progress);
  progress.finish();
  const CloudScale scale{made.spacing, made.noise};

  console.say(fmt::format("{}: {}", input.name(), read.format));
  say_line(console, "points", "{}{}", grouped(made.points),
           made.duplicates > 0 ? fmt::format(", {} of them given twice or more", grouped(made.duplicates)) : "");
  say_line(console, "box", "{} × {} × {}, {}", length(made.size.x), length(made.size.y), length(made.size.z),
           box_words(made.box));
  say_line(console, "spans", "{}", made.spans);
  say_line(console, "spacing", "{}", length(scale.spacing));
  say_line(console, "noise", "{}", scale.noise_words());
  say_line(console, "normals", "{}{}", made.normals.words,
           made.normals.oriented ? "" : fmt::format("; signs {}", orientation_words(made.orient_by)));
  if (made.colors || made.scanners > 0)
    say_line(console, "also", "{}{}{}", made.colors ? "colours" : "", made.colors && made.scanners > 0 ? ", " : "",
             made.scanners > 0 ? counted(made.scanners, "scanner position") : "");
  Json json = input.json(), attributes = Json::array();
  for (const AttributeInfo& a : made.attributes) {
    say_attribute(a, console);
    attributes.push_back(attribute_json(a));
  }
  say_classes(made, console, json);
  json["format"] = read.format;
  json["points"] = made.points;
  json["duplicates"] = made.duplicates;
  json["lower"] = corner_json(made.box.lower);
  json["upper"] = corner_json(made.box.upper);
  json["spans"] = made.spans;
  scale.add_to(json);
  json["normals"] = made.normals.words;
  json["orientation"] = json_of_normals(made.normals);
  json["orient_by"] = orient_by_word(made.orient_by);
  json["colors"] = made.colors;
  json["attributes"] = std::move(attributes);
  json["scanners"] = made.scanners;
  json["triangles"] = made.triangles;
  if (made.mesh) {
    say_line(console, "faces", "{}, {}", counted(made.mesh->triangles, "triangle"), topology_words(*made.mesh));
    json["mesh"] = topology_json(*made.mesh);
  }
  console.say_json(json);
  console.print_timings();
}

/// `said`: the files were said to be a volume.
void run_any_info(const CloudInput& input, VolumeInput volume, bool said, Console& console) {
  if (!said && !are_volumes(input.files) && !volume.read.raw.given()) return run_info(input, console);
  volume.files = input.files;
  run_volume_info(volume, console);
}

}  // namespace

Command add_info(CommandLine& app) {
  CommandLine& c = app.add_subcommand("info",
                                      "File → what is in it: points, box, spacing, noise, normals, faces; grid "
                                      "and arrays of volumes");
  auto input = std::make_shared<CloudInput>();
  auto volume = std::make_shared<VolumeInput>();
  add_cloud_input(
      c, *input,
      "Points, mesh, function (.smf) or volume, or several of them; `data FILE` takes points for samples of a "
      "volume",
      false);
  add_raw_options(c, volume->read);
  c.footer(std::string(kReadable) + "\n" + kReadableVolumes +
           "\n\nExamples:\n"
           "  sansmesh info scan.ply\n"
           "  sansmesh info *.ply --json\n"
           "  sansmesh info west.las east.las --as-one\n"
           "  sansmesh info fire.vtu\n"
           "  sansmesh info data samples.csv");
  auto as_one = std::make_shared<bool>(false);
  c.add_flag("--as-one", *as_one, "Several files (tiles, blocks) are one cloud, or one volume");
  return {&c, [input, volume, as_one, &c](Console& console) {
            const bool said = says_volume(input->files);
            if (*as_one || input->files.size() == 1) return run_any_info(*input, *volume, said, console);
            console.list_results();
            bool told = false;
            for (const std::string& file : input->files) {
              CloudInput one = *input;
              one.files = {file};
              if (std::exchange(told, true)) console.say("");
              try {
                run_any_info(one, *volume, said, console);
              } catch (const FileError& error) {
                told = false;
                console.fail(file, words_of_file_error(error, c));
              } catch (const DataError& error) {
                told = false;
                console.fail(file, file + ": " + console.in_flags(error.what()));
              }
            }
          }};
}

}  // namespace sansmesh::cli
