#include "cloud_input.h"

#include <fmt/core.h>

#include "command_line.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/points/spacing.h"

namespace sansmesh::cli {
namespace {

/// What --class or --without-class names.
PointClasses classes_of(const std::string& list) {
  try {
    return parse_point_classes(list);
  } catch (const ArgumentError& error) {
    throw ValueError(error.what());
  }
}

constexpr double kMostLookingAway = 0.1;  ///< of the normals, where a sensor saw all of the samples
constexpr double kNearlyAll = 0.95;

std::string percent(double share) { return fmt::format("{:.2g} %", 100 * share); }

/// Of signs that neighbours confirm, though not all of them are right.
std::string uncertain_words(const OrientationReport& r) {
  std::string why;
  if (r.doubt > 0)
    why = fmt::format("around {} of the samples they enclose less or more than a surface does", percent(r.doubt));
  if (1 - r.agreement > 0.0005)
    why +=
        fmt::format("{}{} of what neighbours say contradicts them", why.empty() ? "" : ", ", percent(1 - r.agreement));
  return "orientation uncertain: " + why;
}

}  // namespace

CloudScale::CloudScale(const PointSet& points) : spacing(estimate_spacing(points)), noise(measure_noise(points)) {}

std::string CloudScale::noise_words() const { return sansmesh::noise_words(noise, spacing); }

void CloudScale::add_to(Json& json) const {
  json["spacing"] = spacing;
  json["noise"] = noise.deviation;
  json["noise_known"] = noise.known;
  json["most_noise"] = noise.most;
}

GivenNormals judge_normals(const OrientationReport& r) {
  GivenNormals given;
  given.oriented = (r.check == OrientationCheck::oriented || r.check == OrientationCheck::inward) && r.certain();
  if (r.check == OrientationCheck::missing)
    given.words = "none";
  else if (r.related < kLeastRelated)
    given.words = "not oriented: they have nothing to do with those next to them";
  else if (r.check == OrientationCheck::unoriented)
    given.words = fmt::format("not oriented consistently{}",
                              r.agreement < kNearlyAll ? fmt::format(": {} of what neighbours say contradicts "
                                                                     "them",
                                                                     percent(1 - r.agreement))
                                                       : std::string());
  else if (!r.certain())
    given.words = uncertain_words(r);
  else if (r.open > kNearlyAll)
    given.words = "oriented consistently; the surface is open, it has no outside";
  else if (r.outward > kNearlyAll)
    given.words = "oriented outward";
  else if (r.inward > kNearlyAll)
    given.words = "oriented inward";
  else
    given.words = fmt::format("oriented consistently: {} of the samples outward, {} inward, {} in open parts",
                              percent(r.outward), percent(r.inward), percent(r.open));
  given.json = {{"oriented", given.oriented}, {"agreement", r.agreement}, {"related", r.related},
                {"outward", r.outward},       {"inward", r.inward},       {"open", r.open},
                {"certain", r.certain()},     {"doubt", r.doubt}};
  if (r.check == OrientationCheck::missing) given.json = {{"oriented", false}};
  return given;
}

GivenNormals judge_normals(const PointSet& points, double noise) {
  const OrientationReport report = measure_orientation(points, noise);
  GivenNormals given = judge_normals(report);
  if (report.check == OrientationCheck::missing || report.related < kLeastRelated) return given;
  const double spacing = estimate_spacing(points);
  const auto neighbours = static_cast<std::size_t>(choose_neighbours(spacing, noise));
  if (given.oriented && noise > spacing && 2 * neighbours > points.size()) {
    given.words = fmt::format(
        "consistent, but of no surface that could be told: with noise of {:.1f} spacings, neighbours are {} of {} "
        "points",
        noise / spacing, grouped(neighbours), grouped(points.size()));
    return given;
  }
  const bool consistent = report.check != OrientationCheck::unoriented;
  for (const OrientBy by : kOrientationOrder) {
    if (by == OrientBy::up && consistent) break;  // a guess, where the others know
    const std::vector<Vec3f> sights = find_own_sights(points, by, noise);
    if (sights.empty()) continue;
    const double away = share_looking_away(points, sights);
    if (away >= kMostLookingAway) continue;
    given.oriented = true;
    given.words = fmt::format("oriented {}, but for {}", orientation_words(by), percent(away));
    given.json["oriented"] = given.json["certain"] = true;
    given.json["oriented_by"] = orient_by_word(by);
    given.json["looking_away"] = away;
    break;
  }
  return given;
}

std::string CloudInput::name() const {
  if (files.size() == 1) return files[0];
  return fmt::format("{} and {}", files[0], counted(files.size() - 1, "other file"));
}

Json CloudInput::json() const {
  Json json;
  if (files.size() == 1)
    json["file"] = files[0];
  else
    json["files"] = files;
  return json;
}

Json CloudInput::json(const ReadReport& read, std::size_t points) const {
  Json all = json();
  all["format"] = read.format;
  all["points"] = points;
  return all;
}

bool CloudInput::is_function() const {
  if (files.size() != 1 || !is_function_file(files[0])) return false;
  if (classes) throw ArgumentError("--class and --without-class are for points: the input is a function");
  return true;
}

PointSet CloudInput::read(Console& console, ReadReport& report) const {
  PointSet points = read_merged(files, &report);
  if (files.size() == 1)
    console.warn(files[0], report.warnings);
  else
    console.warn(report.warnings);
  if (classes) {
    const std::size_t given = points.size();
    try {
      keep_classes(points, *classes);
    } catch (const DataError& error) {
      throw FileError(name(), console.in_flags(error.what()));
    }
    console.say(
        fmt::format("{}: {} of {} are of the classes chosen", name(), grouped(points.size()), counted(given, "point")));
  }
  return points;
}

void add_cloud_input(CommandLine& c, CloudInput& input, const std::string& what) {
  c.add_option("input", input.files, what + "; several (tiles) are read as one")
      .type_name("FILE")
      .required()
      .endings({".ply", ".obj", ".off", ".stl", ".xyz", ".txt", ".csv", ".asc", ".pts", ".pwn", ".pcd", ".las", ".vtp",
                ".conf", ".smf"});
  add_class_options(c, input);
}

void add_class_options(CommandLine& c, CloudInput& input, const std::string& of) {
  c.add_option_function(
       "--class",
       [&input](const std::string& list) {
         const PointClasses wanted = classes_of(list);
         input.classes = input.classes ? *input.classes & wanted : wanted;
         input.with = list;
       },
       "Only points" + of + " of these classes, with commas between them: names (ground, building) or numbers (2, 3-5)")
      .type_name("CLASSES")
      .group("Input");
  c.add_option_function(
       "--without-class",
       [&input](const std::string& list) {
         const PointClasses unwanted = classes_of(list);
         input.classes = input.classes ? *input.classes & ~unwanted : ~unwanted;
         input.without = list;
       },
       "All but points" + of + " of these classes: noise")
      .type_name("CLASSES")
      .group("Input");
}

}  // namespace sansmesh::cli
