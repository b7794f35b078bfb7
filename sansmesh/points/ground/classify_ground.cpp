#include "sansmesh/points/ground/classify_ground.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/points/cleaning/point_classes.h"
#include "sansmesh/points/ground/find_ground.h"
#include "sansmesh/points/normals/flight_lines.h"
#include "sansmesh/points/remedies.h"
#include "sansmesh/points/shape/height_field.h"
#include "sansmesh/points/statistics/noise.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint8_t kUnclassified = 1, kGround = 2;
constexpr std::size_t kLowNoise = 7, kHighNoise = 18;

/// Class of each point; 0 without classes. Throws DataError if there are other values than 0..255.
std::vector<std::uint8_t> classes_of(const PointSet& points) {
  std::vector<std::uint8_t> classes(points.size(), 0);
  const Attribute* const given = find_point_classes(points);
  for (std::size_t i = 0; given && i < classes.size(); ++i) {
    const double number = given->number(i);
    if (!(number >= 0 && number <= 255))
      throw DataError("'" + given->name + "' has values beyond 0 to 255: these are no classes of a survey");
    classes[i] = static_cast<std::uint8_t>(number);
  }
  return classes;
}

/// Whether all points have class 0 or 1, or none.
bool is_unclassified(const PointSet& points) {
  const Attribute* const given = find_point_classes(points);
  if (!given) return true;
  const std::array<std::size_t, 256> counts = count_point_classes(*given);
  return counts[0] + counts[kUnclassified] == points.size();
}

/// Whether the ground can be found by shape: the cloud is a terrain, or known to be an airborne survey.
bool may_have_ground(const PointSet& points) {
  return is_survey_from_above(points) || is_height_field(measure_height_field(points, estimate_noise(points)), true);
}

/// Converts heights to the unit of x and y. False for degrees, which have no length.
bool to_one_unit(std::vector<Vec3f>& positions, const ReferenceSystem* system) {
  if (!system) return true;
  if (system->metres > 0 && system->vertical_metres > 0)
    for (Vec3f& p : positions) p.z *= static_cast<float>(system->vertical_metres / system->metres);
  return system->unit != "degree";
}

/// Number of samples that show whether there is much above the ground, and the least share of these.
constexpr std::size_t kJudgedSamples = 20000;
constexpr double kMuchAbove = 0.1;

/// Whether the cloud could come from the air: samples without faces, normals and scanners.
bool could_be_airborne(const PointSet& points) {
  return points.triangles.empty() && !points.of_faces && !points.has_normals() && points.scanners.empty() &&
         points.grid_normals.empty();
}

}  // namespace

std::string GroundClassification::words() const {
  if (had_ground) return "there is ground already: no class was changed";
  return grouped(ground) + " of " + counted(ground + others + kept, "point") + " are ground" +
         (kept > 0 ? ", " + grouped(kept) + " keep their class" : "");
}

GroundClassification classify_ground(PointSet& points, Progress& progress) {
  GroundClassification result;
  const Attribute* const given = find_point_classes(points);
  const std::string name = given ? given->name : "classification";
  std::vector<std::uint8_t> classes = classes_of(points);
  result.had_ground = std::find(classes.begin(), classes.end(), kGround) != classes.end();
  if (result.had_ground) return result;
  PointSet judged;
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (classes[i] == kLowNoise || classes[i] == kHighNoise) continue;
    rows.push_back(static_cast<std::uint32_t>(i));
    judged.positions.push_back(points.positions[i]);
  }
  if (!to_one_unit(judged.positions, points.reference.get()))
    throw DataError("its coordinates are degrees: the ground is found in coordinates of one unit of length");
  const GroundSamples found = find_ground(judged, progress);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    std::uint8_t& c = classes[rows[k]];
    if (c > kUnclassified) continue;
    c = found.ground[k] ? kGround : kUnclassified;
    ++(found.ground[k] ? result.ground : result.others);
  }
  result.kept = points.size() - result.ground - result.others;
  points.attributes.set(name, std::move(classes));
  return result;
}

std::vector<Note> select_classes(PointSet& points, const PointClasses& classes, Progress& progress) {
  std::vector<Note> notes;
  if (classes[kGround] && !classes[kUnclassified] && is_unclassified(points) && may_have_ground(points)) {
    const GroundClassification made = classify_ground(points, progress);
    notes.push_back({.code = "ground_found",
                     .text = "no point is classified: the ground was found by its shape: " + made.words(),
                     .severity = Note::Severity::information});
  }
  if (classes[kGround] && classes.count() == 1 && !find_point_classes(points))
    throw DataError(
        "is no terrain from above, in which the ground could be found, and its points have no class by which "
        "`class` could choose");
  keep_classes(points, classes);
  return notes;
}

std::vector<Note> suggest_ground(const PointSet& points) {
  if (!could_be_airborne(points) || !is_unclassified(points)) return {};
  PointSet some;
  const std::size_t step = 1 + points.size() / kJudgedSamples;
  for (std::size_t i = 0; i < points.size(); i += step) some.positions.push_back(points.positions[i]);
  if (!to_one_unit(some.positions, points.reference.get())) return {};
  // Return numbers do not tell: scans from the ground have them, too.
  if (!is_height_field(measure_height_field(some, 0), false)) return {};
  Progress silent;
  double above = 0;
  try {
    const GroundSamples found = find_ground(some, silent);
    above = static_cast<double>(std::count(found.ground.begin(), found.ground.end(), std::uint8_t{0})) /
            static_cast<double>(some.size());
  } catch (const DataError&) {
    return {};
  }
  if (above < kMuchAbove) return {};
  Note note = with_remedy(remedy("unclassified_survey", "class"),
                          fmt::format("a terrain without classes: {:.0f} % of its points are above the ground "
                                      "(vegetation, buildings)",
                                      100 * above));
  note.severity = Note::Severity::information;
  return {std::move(note)};
}

std::vector<Note> leave_out_vegetation(PointSet& points) {
  const Attribute* const given = find_point_classes(points);
  if (!given) return {};
  const std::array<std::size_t, 256> counts = count_point_classes(*given);
  PointClasses unwanted = parse_point_classes("noise");
  if (counts[kGround] > 0) unwanted |= parse_point_classes("vegetation");
  std::size_t lost = 0;
  for (std::size_t c = 0; c < counts.size(); ++c)
    if (unwanted[c]) lost += counts[c];
  if (lost == 0 || lost == points.size()) return {};
  const std::string list = point_classes_text(unwanted);
  keep_classes(points, ~unwanted);
  return {with_remedy(remedy("classes_left_out", "class"),
                      counted(lost, "point") + " left out: " +
                          (counts[kGround] > 0 ? "vegetation and noise" : "noise") + " (classes " + list + ")")};
}

}  // namespace sansmesh::inline v1
