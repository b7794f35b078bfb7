#include "sansmesh/points/prepare_cloud.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/points/cleaning/clean_samples.h"
#include "sansmesh/points/cleaning/outliers.h"
#include "sansmesh/points/ground/classify_ground.h"
#include "sansmesh/points/normals/denoise_normals.h"
#include "sansmesh/points/normals/flight_lines.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/points/orientation/inward_parts.h"
#include "sansmesh/points/orientation/orientation.h"
#include "sansmesh/points/registration/align_scans.h"
#include "sansmesh/points/remedies.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/points/shape/cloud_shape.h"
#include "sansmesh/points/shape/face_shape.h"
#include "sansmesh/points/shape/height_field.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Least number of samples for a local fit.
constexpr std::size_t kFewest = 9;
/// Largest share of given normals facing away from the sensor: noise at grazing angles.
constexpr double kMostFacingAway = 0.1;
/// Share of inward normals from which closed parts are examined.
constexpr double kFewInward = 0.001;

void clean(PointSet& points, std::vector<Note>& notes) {
  const std::size_t given = points.size();
  const SampleCleaning cleaned = clean_samples(points);
  const auto warn = [&](const char* code, std::size_t n, const char* why) {
    if (n > 0) notes.push_back({.code = code, .text = counted(n, "sample") + " left out: " + why});
  };
  warn("not_finite", cleaned.non_finite, "position or normal not finite");
  warn("far_away", cleaned.far_away, "far away from all others");
  warn("duplicates", cleaned.duplicates, "at the position of another sample");
  if (given > 1 && points.size() == 1) throw DataError("all points coincide: there is no surface to reconstruct");
}

/// `unit`: input length of 1. `as_mesh`: triangles supplement few or flat points.
void check_shape(const PointSet& points, double unit, bool as_mesh = false) {
  const CloudShape shape = classify_shape(points);
  const bool flat = shape == CloudShape::line || shape == CloudShape::plane;
  if (const auto parts = flat && !as_mesh ? find_far_parts(points) : std::nullopt)
    throw DataError(
        fmt::format("the points lie in parts that are {:.3g} apart and at most {:.3g} large: too far from each other "
                    "for one surface",
                    unit * parts->apart, unit * parts->size));
  if (!as_mesh && points.size() < kFewest)
    throw DataError("only " + counted(points.size(), "point") + ": at least " + std::to_string(kFewest) +
                    " are needed");
  switch (shape) {
    case CloudShape::empty:
      throw DataError("no finite points");
    case CloudShape::point:
      throw DataError("all points coincide: there is no surface to reconstruct");
    case CloudShape::line:
      throw DataError("all points lie on one line: there is no surface to reconstruct");
    case CloudShape::plane:  // an open sheet
    case CloudShape::volume:
      break;
  }
}

bool all_on_faces(const PointSet& mesh) {
  std::vector<std::uint8_t> on_face(mesh.size(), 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v < mesh.size()) on_face[v] = 1;
  return std::find(on_face.begin(), on_face.end(), 0) == on_face.end();
}

/// Samples the faces if the vertices are insufficient, and uses face normals. Returns the orientation of these, if any.
FaceSides use_faces(PointSet& points, FaceUse faces, std::vector<Note>& notes) {
  if (points.triangles.empty() || faces == FaceUse::ignore) return FaceSides::unknown;
  const bool forced = faces == FaceUse::sample;
  const std::size_t wanted = forced ? kFaceSamples : faces == FaceUse::vertices ? 0 : face_samples_wanted(points);
  FaceSides sides = FaceSides::unknown;
  if (wanted > 0) {
    PointSet samples = sample_faces(points, wanted);
    if (samples.size() == 0) return FaceSides::unknown;
    sides = face_sides(points);
    points = std::move(samples);
    points.of_faces = true;
    if (!forced)
      notes.push_back(
          {.code = "faces_sampled", .text = "its vertices alone do not describe it: its faces are sampled instead"});
  } else if (!points.has_normals()) {
    sides = face_sides(points);
    set_normals_from_faces(points);
  }
  if (wanted == 0) points.of_faces = all_on_faces(points);
  return sides;
}

/// Flips consistent normals that face away from the sensor. Returns false, without changes, if the sensor is unknown or
/// implausible.
bool look_at_sensors(PreparedCloud& cloud, Progress& progress) {
  PointSet& points = cloud.points;
  for (const OrientBy by : {OrientBy::scanner, OrientBy::rows, OrientBy::flight}) {
    const std::vector<Vec3f> directions = find_sensor_directions(points, by);
    if (directions.empty()) continue;
    if (share_facing_away(points, directions) < kMostFacingAway) return true;
    OrientationOptions orientation;
    orientation.noise = cloud.noise;
    const std::vector<Vec3f> given = points.normals;
    if (orient_normals(points, orientation, progress) != by) {
      points.normals = given;
      continue;
    }
    std::size_t turned = 0;
    for (std::size_t i = 0; i < given.size(); ++i) turned += points.normals[i] != given[i];
    cloud.oriented_by = by;
    cloud.notes.push_back(
        {.code = "normals_flipped", .text = counted(turned, "normal") + " flipped: they faced away from the sensor"});
    return true;
  }
  return false;
}

void estimate_missing_normals(PreparedCloud& cloud, const KdTree& tree, Progress& progress) {
  progress.begin("estimate normals");
  cloud.spacing = estimate_spacing(cloud.points);
  NormalOptions estimation;
  estimation.spacing = cloud.spacing, estimation.noise = cloud.noise;
  estimate_normals(cloud.points, tree, estimation, progress);
  cloud.estimated_normals = true;
}

/// Replaces given normals that are unrelated to those of neighbouring samples by estimates that are related.
bool replace_unrelated_normals(PreparedCloud& cloud, const OrientationReport& given_ones, const KdTree& tree,
                               Progress& progress) {
  PointSet& points = cloud.points;
  if (given_ones.related >= kLeastRelated) return false;
  const std::vector<Vec3f> given = points.normals;
  estimate_missing_normals(cloud, tree, progress);
  const char* unrelated = "the normals are unrelated to those of neighbouring samples";
  if (measure_orientation(points, cloud.noise, false).related < kLeastRelated) {
    points.normals = given, cloud.estimated_normals = false;
    cloud.notes.push_back({.code = "unrelated_normals", .text = unrelated});
    return false;
  }
  cloud.face_sides = FaceSides::unknown;
  cloud.notes.push_back({.code = "unrelated_normals", .text = std::string(unrelated) + ": estimated anew"});
  return true;
}

/// For thin parts, faces that bound solids are more reliable than neighbours.
OrientationReport judged_orientation(const PreparedCloud& cloud) {
  OrientationReport report;
  switch (cloud.face_sides) {
    case FaceSides::outward:
      report.check = OrientationCheck::oriented;
      return report;
    case FaceSides::inward:
      report.check = OrientationCheck::inward;
      return report;
    case FaceSides::unknown:
      break;
  }
  return measure_orientation(cloud.points, cloud.noise, false);
}

/// Flips consistent normals that point inward: all of faces that bound solids, others by closed parts.
void face_outward(PreparedCloud& cloud, const OrientationReport& report, Progress& progress) {
  PointSet& points = cloud.points;
  const bool mostly = report.check == OrientationCheck::inward;
  if (!mostly && report.inward < kFewInward) return;
  std::size_t flipped = points.size();
  if (cloud.face_sides != FaceSides::unknown)
    for (Vec3f& n : points.normals) n = -n;
  else
    flipped = flip_inward_parts(points, *cloud.noise, mostly, progress);
  if (flipped == points.size())
    cloud.notes.push_back({.code = "normals_flipped", .text = "the normals point inward: flipped"});
  else if (flipped > 0)
    cloud.notes.push_back(
        {.code = "normals_flipped", .text = counted(flipped, "normal") + " flipped: they pointed into closed parts"});
}

void prepare_normals(PreparedCloud& cloud, const CloudPreparation& use, Progress& progress) {
  PointSet& points = cloud.points;
  if (use.normals == NormalUse::as_given) {
    if (use.orient_by != OrientBy::automatic)
      throw ArgumentError("`orient_by` changes normals: it has no effect with `normals = given`");
    if (!points.has_normals()) throw DataError("there are no given normals");
    return;
  }
  if (use.normals == NormalUse::estimate) points.normals.clear(), cloud.face_sides = FaceSides::unknown;
  progress.begin("check normals");
  cloud.noise = estimate_noise(points);
  const OrientationReport report = judged_orientation(cloud);
  const OrientationCheck check = report.check;
  const bool consistent = check == OrientationCheck::oriented || check == OrientationCheck::inward;
  if (consistent && use.orient_by == OrientBy::automatic) {
    if (!look_at_sensors(cloud, progress)) face_outward(cloud, report, progress);
    return;
  }
  const KdTree tree(points.positions);
  if (check == OrientationCheck::missing)
    estimate_missing_normals(cloud, tree, progress);
  else if (check == OrientationCheck::unoriented && !replace_unrelated_normals(cloud, report, tree, progress) &&
           use.orient_by == OrientBy::automatic)
    cloud.notes.push_back(
        {.code = "normals_oriented", .text = "the normals are not oriented consistently: oriented anew"});
  progress.begin("orient normals");
  OrientationOptions orientation;
  orientation.noise = cloud.noise;
  orientation.by = use.orient_by;
  cloud.oriented_by = orient_normals(points, tree, orientation, progress);
}

/// Number of samples of all scans together for detecting misalignment, and least number per scan.
constexpr std::size_t kCheckedSamples = 1500, kFewestCheckedSamples = 60;

std::string scan_called(const PointSet& points, std::size_t scan) {
  return scan < points.scan_names.size() ? points.scan_names[scan] : "scan " + std::to_string(scan + 1);
}

/// Reports misaligned scans, or aligns them. Returns whether they were moved.
bool align_scans(PreparedCloud& cloud, bool move, Progress& progress) {
  PointSet& points = cloud.points;
  if (points.scan_of_point.size() != points.size() || !has_several_scans(points)) {
    if (move) cloud.notes.push_back({.code = "not_aligned", .text = "there is only one scan: nothing to align"});
    return false;
  }
  progress.begin(move ? "align scans" : "compare scans");
  ScanAlignmentOptions options;
  if (!move) {
    const std::size_t scans = std::max(points.scan_names.size(), points.scanners.size());
    options.samples =
        std::clamp(kCheckedSamples / std::max<std::size_t>(scans, 1), kFewestCheckedSamples, kCheckedSamples / 2);
    options.rounds = 5;
  }
  ScanAlignment found;
  try {
    found = find_scan_motions(points, options, progress);
  } catch (const DataError&) {
    if (move) throw;
    return false;
  }
  const auto words = [&](double length) { return fmt::format("{:.3g}", cloud.frame.to_input(length)); };
  const auto off = [&](double length, std::size_t scan) {
    return words(length) + " (noise " + words(found.noise) + "), most of all " + scan_called(points, scan);
  };
  const std::size_t moved = found.most_moved(), farthest = found.farthest_off();
  if (found.warped())
    cloud.notes.push_back({.code = "scans_warped",
                           .text = "scans disagree by " + off(found.deviations[farthest], farthest) +
                                   ", which no rigid motion corrects: they are warped"});
  if (!move) {
    if (found.disagree())
      cloud.notes.push_back(with_remedy(remedy("scans_disagree", "align"),
                                        "scans disagree by up to " + off(found.displacements[moved], moved)));
    return false;
  }
  if (found.rounds == 0) {
    cloud.notes.push_back({.code = "not_aligned", .text = "no two scans overlap: nothing to align"});
    return false;
  }
  if (found.displacements[moved] <= 0) {
    cloud.alignment = "no scan was moved";
    return false;
  }
  cloud.alignment = "scans aligned in " + counted(static_cast<std::uint64_t>(found.rounds), "round") +
                    ": moved by up to " + off(found.displacements[moved], moved);
  move_scans(points, found.motions);
  return true;
}

}  // namespace

PreparedCloud prepare_positions(PointSet points, FaceUse faces, Progress& progress) {
  PreparedCloud result;
  progress.begin("check samples");
  clean(points, result.notes);
  result.closed_faces = faces != FaceUse::ignore && !points.triangles.empty() && faces_are_closed(points);
  result.face_sides = use_faces(points, faces, result.notes);
  check_shape(points, 1, faces == FaceUse::vertices && !points.triangles.empty());
  const Vec3f size = bounds(points).size();
  result.frame = frame_for(points.origin, static_cast<double>(std::max({size.x, size.y, size.z})));
  result.frame.reference = points.reference;
  move_from_input(points, result.frame);
  result.points = std::move(points);
  return result;
}

namespace {

/// Share of outliers from which they are clutter. Fewer have little weight in fits, and clean or noisy clouds have up
/// to 0.16 % of samples that look like outliers. In later rounds, share that ends the search.
constexpr double kClutter = 0.003, kLittleClutter = 0.001;
/// Rounds of the search: where clutter is as dense as the surface, outliers of one round hide those of the next.
constexpr int kClutterRounds = 4;
/// Above twice this number of samples, so many decide whether there is clutter.
constexpr std::size_t kPilotSamples = 100000;

/// Whether clutter could be part of the scene: surveys and depth frames also see twigs, wires and grass.
bool sees_thin_things(const PointSet& points) {
  if (points.of_faces || !points.grid_normals.empty()) return true;
  return is_height_field(measure_height_field(points, estimate_noise(points)), is_survey_from_above(points));
}

double outlier_share(const PointSet& points) {
  Progress silent;
  const std::vector<std::uint8_t> mask = find_outliers(points, {}, silent);
  return static_cast<double>(std::count(mask.begin(), mask.end(), std::uint8_t{1})) / static_cast<double>(mask.size());
}

/// Whether every so many-th sample shows clutter; always for small clouds.
bool pilot_shows_clutter(const PointSet& points) {
  const std::size_t step = points.size() / kPilotSamples;
  if (step < 2) return true;
  PointSet some;
  for (std::size_t i = 0; i < points.size(); i += step) some.positions.push_back(points.positions[i]);
  return outlier_share(some) >= 0.5 * kClutter;
}

}  // namespace

void leave_out_outliers(PreparedCloud& cloud, std::optional<bool> asked, ClutterUse clutter, Progress& progress) {
  if (!asked.value_or(clutter == ClutterUse::leave_out)) return;
  PointSet& points = cloud.points;
  progress.begin("find outliers");
  if (!asked && !pilot_shows_clutter(points)) return;
  std::size_t left_out = 0;
  for (int round = 0; round < kClutterRounds; ++round) {
    const std::vector<std::uint8_t> outliers = find_outliers(points, {}, progress);
    const auto count = static_cast<std::size_t>(std::count(outliers.begin(), outliers.end(), std::uint8_t{1}));
    const double share = static_cast<double>(count) / static_cast<double>(points.size());
    const double least = round > 0 ? kLittleClutter : asked ? 0 : kClutter;
    if (count == 0 || share < least) break;
    if (!asked && round == 0 && sees_thin_things(points)) return;
    remove_samples(points, outliers);
    left_out += count;
    if (round == 0 && share < kClutter) break;
  }
  if (left_out == 0) return;
  check_shape(points, cloud.frame.to_input(1.0));
  std::string text = counted(left_out, "sample") + " left out: belong to no surface";
  cloud.notes.push_back(asked ? Note{.code = "outliers", .text = std::move(text)}
                              : with_remedy(remedy("clutter", "remove_outliers"), std::move(text)));
}

PreparedCloud prepare_cloud(PointSet points, const CloudPreparation& use, Progress& progress, ClutterUse clutter) {
  std::vector<Note> notes;
  if (use.classes)
    notes = select_classes(points, *use.classes, progress);
  else if (clutter == ClutterUse::leave_out)
    notes = leave_out_vegetation(points), add_notes(notes, suggest_ground(points));
  PreparedCloud result = prepare_positions(std::move(points), use.faces, progress);
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
  leave_out_outliers(result, use.remove_outliers, clutter, progress);
  prepare_normals(result, use, progress);
  if (align_scans(result, use.align, progress)) {
    result.noise.reset(), result.spacing.reset();
    // Normals estimated from misaligned scans averaged over adjacent surfaces.
    if (result.estimated_normals) {
      result.points.normals.clear();
      prepare_normals(result, use, progress);
    }
  }
  return result;
}

void sharpen_estimated_normals(PreparedCloud& cloud, Progress& progress) {
  if (!cloud.estimated_normals) return;
  progress.begin("denoise normals");
  denoise_normals(cloud.points, {.spacing = cloud.spacing, .noise = cloud.noise}, progress);
}

}  // namespace sansmesh::inline v1
