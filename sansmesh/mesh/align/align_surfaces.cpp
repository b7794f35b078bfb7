#include "sansmesh/mesh/align/align_surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/align/align_difference.h"
#include "sansmesh/mesh/align/align_fit.h"
#include "sansmesh/mesh/align/align_search.h"
#include "sansmesh/mesh/align/align_side.h"

namespace sansmesh::inline v1 {
namespace {

using detail::AlignSide;
using detail::FitResult;
using detail::FoundPose;
using detail::OrientedPoints;
using detail::Pose;
using detail::PoseFitOptions;
using detail::SearchSamples;

/// Both surfaces lie on each other to this share: no need to look elsewhere.
constexpr double kSurelyThere = 0.8;
/// Poses that fit as well as the best, to this share of its score, and differ by so much: radians, and of the size.
constexpr double kAsGood = 0.98, kOtherAngle = 0.2, kOtherPlace = 0.1;
constexpr std::size_t kComparedPoses = 6, kOnTheWay = 3000, kOfComparison = 1500;
/// Poses with less than this part of the best score are not looked at closely.
constexpr double kWorthALook = 0.85;
/// Distances that count at last: so many standard deviations, and at least this part of the size.
constexpr double kReachOverDeviation = 4, kDeviationOfMedian = 1.4826, kLeastReach = 0.002;
constexpr double kStepOverMedian = 0.005;
constexpr double kLeastOverlap = 0.2;
/// Points of a fixed cloud that are enough: at least, and for each sample.
constexpr std::size_t kFixedPoints = 150000, kFixedOfSample = 8;
/// Another shape: so far from the surface (part of the size), seen at samples within so many spacings, at such a share
/// of them. A mirror image fits where it differs in less than a third of that.
constexpr double kLeastDifference = 0.003, kDifferenceReach = 0.1, kMirroredShare = 1.0 / 3;
/// With distances that count up to more than this part of the size, everything lies on everything.
constexpr double kWidestReach = 0.15;

std::vector<std::uint32_t> chosen_of(std::size_t n, std::size_t most) {
  const std::size_t count = std::min(n, most);
  std::vector<std::uint32_t> chosen(count);
  for (std::size_t k = 0; k < count; ++k) chosen[k] = static_cast<std::uint32_t>(k * n / count);
  return chosen;
}

OrientedPoints samples_of(const AlignSide& side, std::size_t most) {
  const OrientedPoints& all =
      side.is_mesh || side.all.size() <= side.dense.size() || most <= side.dense.size() ? side.dense : side.all;
  OrientedPoints some;
  for (const std::uint32_t i : chosen_of(all.size(), most)) some.x.push_back(all.x[i]), some.n.push_back(all.n[i]);
  return some;
}

/// What is left between samples and the surface, as far as they lie on it.
std::vector<double> left_between(const OrientedPoints& samples, const detail::WholeSurface& fixed, const Pose& pose,
                                 double reach, bool signs) {
  std::vector<double> left;
  for (const auto& d : detail::distances_to(samples, fixed, pose, reach, signs, false))
    if (d && *d <= reach) left.push_back(*d);
  return left;
}

/// To the surface itself, first with few samples, then with all.
FitResult fit_closely(const OrientedPoints& few, const OrientedPoints& many, const detail::WholeSurface& fixed,
                      const Pose& start, double reach, const SurfaceAlignmentOptions& options, bool signs) {
  PoseFitOptions fit;
  fit.iterations = options.iterations;
  fit.reach = reach;
  fit.least_reach = kLeastReach;
  fit.scale = options.find_scale;
  fit.signs = signs;
  fit.last_step = 1e-4;
  FitResult rough = detail::fit_pose(few, fixed, start, fit);
  std::vector<double> left = left_between(few, fixed, rough.pose, rough.reach, signs);
  fit.reach = fit.least_reach = std::max(kLeastReach, kReachOverDeviation * kDeviationOfMedian * median(left));
  // Smaller steps than the noise of the samples tells are none.
  fit.last_step = std::max(1e-7, kStepOverMedian * median(left));
  FitResult close = detail::fit_pose(many, fixed, rough.pose, fit);
  close.iterations += rough.iterations;
  return close;
}

}  // namespace

double SimilarityMotion::angle() const {
  const Vec3 w{y.z - z.y, z.x - x.z, x.y - y.x};
  return std::atan2(norm(w), x.x + y.y + z.z - 1) * 180 / std::numbers::pi;
}

Vec3 SimilarityMotion::axis() const {
  const Vec3 w{y.z - z.y, z.x - x.z, x.y - y.x};
  if (norm(w) > 1e-9) return normalized(w);
  // Half a turn, or none: the column of R + 1 that is longest.
  const Vec3 columns[] = {x + Vec3{1, 0, 0}, y + Vec3{0, 1, 0}, z + Vec3{0, 0, 1}};
  return normalized(*std::max_element(std::begin(columns), std::end(columns),
                                      [](const Vec3& a, const Vec3& b) { return squared_norm(a) < squared_norm(b); }));
}

AffineMap SimilarityMotion::map() const {
  AffineMap map{x * scale, y * scale, z * scale, {}};
  map.shift = to - map.turn(from);
  return map;
}

const OptionSchema& SurfaceAlignmentOptions::schema() {
  using O = SurfaceAlignmentOptions;
  static constexpr std::string_view starts[] = {"auto", "here", "anywhere"};
  static constexpr OptionRow rows[] = {
      option<&O::start>({.text =
                             "Where the search starts: here, as it lies; anywhere, every way round; auto, here, and "
                             "anywhere if that does not lead to a good fit",
                         .unit = "choice",
                         .choices = starts,
                         .name = "from"}),
      option<&O::find_scale>({.text = "Find one factor for all lengths, too", .old_name = "scale"}),
      option<&O::samples>(
          {.text = "Samples of what moves that are compared", .range = {100, 10'000'000}, .name = "align_samples"}),
      option<&O::iterations>({.text = "Steps of a search at most", .range = {1, 1000}, .name = "align_iterations"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void SurfaceAlignmentOptions::validate() const { validate_options(*this); }

namespace {

TriangleMesh mirror_image(TriangleMesh mesh) {
  mesh.origin.x = -mesh.origin.x;
  for (Vec3f& v : mesh.vertices) v.x = -v.x;
  for (Vec3f& n : mesh.normals) n.x = -n.x;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

SurfaceAlignment align(const TriangleMesh& moving_mesh, const TriangleMesh& fixed_mesh,
                       const SurfaceAlignmentOptions& options, Progress& progress) {
  progress.begin("prepare");
  Vec3 moving_origin, fixed_origin;
  double moving_size = 0, fixed_size = 0;
  detail::measure_side(moving_mesh, "moving", moving_origin, moving_size);
  detail::measure_side(fixed_mesh, "fixed", fixed_origin, fixed_size);
  // Of very different sizes: the scale is part of the units, so that both are about 1 large.
  const double moving_unit = options.find_scale ? moving_size : fixed_size;
  // Of what moves no more points are compared; of the fixed side the tangent planes are means over some.
  const AlignSide moving =
      detail::prepare_side(moving_mesh, moving_origin, moving_unit, options.samples, "moving", progress);
  const AlignSide fixed =
      detail::prepare_side(fixed_mesh, fixed_origin, fixed_size,
                           std::max(kFixedPoints, kFixedOfSample * options.samples), "fixed", progress);
  const bool signs = moving.has_sides && fixed.has_sides;
  const SearchSamples coarse = detail::search_samples(moving, fixed);
  const detail::WholeSurface surface(fixed.mesh, fixed.all, coarse.spacing);
  const detail::WholeSurface back(moving.mesh, moving.dense, coarse.spacing);
  const OrientedPoints few = samples_of(moving, std::min(options.samples, kOnTheWay)),
                       many = samples_of(moving, options.samples);

  Pose start;
  start.scale = moving_unit / fixed_size;
  start.shift = (moving_origin - fixed_origin) / fixed_size;
  const double fine = coarse.spacing;
  const OrientedPoints few_fixed = samples_of(fixed, kOnTheWay);
  const auto score = [&](const Pose& pose) {
    return (detail::share_on(few, surface, pose, fine, signs) +
            detail::share_back(few_fixed, back, pose, fine, signs)) /
           2;
  };

  SurfaceAlignment result;
  std::optional<FitResult> best;
  double best_score = -1;
  if (options.start != AlignStart::anywhere) {
    progress.begin("fit");
    best = fit_closely(few, many, surface, start, 0, options, signs);
    best_score = score(best->pose);
  }
  if (options.start == AlignStart::anywhere || (options.start == AlignStart::automatic && best_score < kSurelyThere)) {
    result.searched = true;
    const std::vector<FoundPose> poses = detail::search_poses(moving, fixed, coarse, options.find_scale, progress);
    progress.begin("fit", kComparedPoses);
    std::vector<std::pair<FitResult, double>> tried;
    PoseFitOptions fit;
    fit.iterations = std::min(options.iterations, 30);
    fit.reach = 2 * coarse.spacing;
    fit.least_reach = kLeastReach;
    fit.scale = options.find_scale;
    fit.signs = signs;
    fit.last_step = 1e-4;
    const OrientedPoints fewer = samples_of(moving, std::min(options.samples, kOfComparison));
    for (std::size_t k = 0; k < std::min(poses.size(), kComparedPoses); ++k) {
      if (poses[k].score < kWorthALook * poses[0].score) break;
      const FitResult f = detail::fit_pose(fewer, surface, poses[k].pose, fit);
      tried.emplace_back(f, score(f.pose));
      progress.advance();
    }
    std::stable_sort(tried.begin(), tried.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    if (!tried.empty() && tried[0].second > best_score * (best ? 1.02 : 1)) {
      best_score = tried[0].second;
      best = fit_closely(few, many, surface, tried[0].first.pose, 2 * coarse.spacing, options, signs);
      result.start = AlignStart::anywhere;
    }
    std::vector<Pose> others;
    for (const auto& [f, s] : tried) {
      if (!best || s < kAsGood * best_score ||
          detail::nearly_same(f.pose, best->pose, moving, kOtherAngle, kOtherPlace))
        continue;
      if (std::any_of(others.begin(), others.end(),
                      [&](const Pose& o) { return detail::nearly_same(o, f.pose, moving, kOtherAngle, kOtherPlace); }))
        continue;
      others.push_back(f.pose);
      result.alternative_angles.push_back(detail::angle_between(f.pose, best->pose) * 180 / std::numbers::pi);
    }
    result.alternatives = others.size();
  }
  if (!best) best.emplace().pose = start;

  progress.begin("residuals");
  const Pose& pose = best->pose;
  result.iterations = best->iterations;
  result.samples = many.size();
  result.reach = best->reach * fixed_size;
  std::vector<double> left = left_between(many, surface, pose, best->reach, signs);
  if (!left.empty()) {
    double squares = 0;
    for (const double d : left) squares += d * d;
    std::sort(left.begin(), left.end());
    result.rms = std::sqrt(squares / static_cast<double>(left.size())) * fixed_size;
    result.median = left[left.size() / 2] * fixed_size;
    result.p95 = left[left.size() * 95 / 100] * fixed_size;
  }
  const detail::ShapeDifference difference =
      detail::shape_difference(many, surface, pose, coarse.spacing, kDifferenceReach, kLeastDifference, signs);
  result.differing = difference.share;
  result.differing_by = difference.offset * fixed_size;
  result.overlap = static_cast<double>(left.size()) / static_cast<double>(std::max<std::size_t>(many.size(), 1));
  std::vector<double> before;
  for (const auto& d : detail::distances_to(few, surface, start, 0, signs, true))
    if (d) before.push_back(*d);
  result.median_before = median(before) * fixed_size;
  double moved = 0;
  for (const Vec3& p : few.x) moved += squared_norm(pose(p) - start(p));
  result.moved = std::sqrt(moved / static_cast<double>(std::max<std::size_t>(few.size(), 1))) * fixed_size;
  for (const double t : best->told) result.free_motions += t < detail::kToldShare;
  result.found = result.overlap >= kLeastOverlap && best->reach <= kWidestReach;
  result.size_ratio = moving_size / fixed_size;

  SimilarityMotion& m = result.motion;
  m.x = pose.x, m.y = pose.y, m.z = pose.z;
  m.scale = options.find_scale ? pose.scale * fixed_size / moving_unit : 1;
  m.from = moving_origin;
  m.to = fixed_origin + pose.shift * fixed_size;
  return result;
}

}  // namespace

SurfaceAlignment align_surfaces(const TriangleMesh& moving, const TriangleMesh& fixed,
                                const SurfaceAlignmentOptions& options, Progress& progress) {
  options.validate();
  SurfaceAlignment result = align(moving, fixed, options, progress);
  // Mirrored parts hide behind a fit that is not bad: symmetric shapes are nearly their own mirror images.
  if (result.found && result.differing > kOtherShape && options.start != AlignStart::as_it_lies) {
    SurfaceAlignmentOptions anywhere = options;
    anywhere.start = AlignStart::anywhere;
    const SurfaceAlignment mirrored = align(mirror_image(moving), fixed, anywhere, progress);
    result.mirror_image_fits =
        mirrored.found && mirrored.differing < kMirroredShare * result.differing && mirrored.overlap > result.overlap;
  }
  progress.finish();
  return result;
}

namespace {

constexpr std::string_view kStartWords[] = {"automatic", "here", "anywhere"};

constexpr ReportRow kSurfaceAlignmentRows[] = {
    reported<[](const SurfaceAlignment& r) { return r.motion.angle(); }>(
        {.name = "angle_deg", .text = "Angle of the rotation", .unit = "degrees"}),
    reported<[](const SurfaceAlignment& r) { return r.motion.axis(); }>(
        {.name = "axis", .text = "Axis of the rotation"}),
    reported<[](const SurfaceAlignment& r) { return r.motion.scale; }>(
        {.name = "scale", .text = "Factor of all lengths", .unit = "factor"}),
    reported<[](const SurfaceAlignment& r) { return r.motion.to - r.motion.from; }>(
        {.name = "shift_of_middle", .text = "Where the middle went", .unit = "length"}),
    reported<&SurfaceAlignment::moved>(
        {.name = "moved_rms", .text = "How far all of it was moved, root mean square", .unit = "length"}),
    reported<&SurfaceAlignment::rms>({.text = "Root mean square of the distances after", .unit = "length"}),
    reported<&SurfaceAlignment::median>({.text = "Half of the distances are below this after", .unit = "length"}),
    reported<&SurfaceAlignment::p95>({.text = "95 % of the distances are below this after", .unit = "length"}),
    reported<&SurfaceAlignment::median_before>(
        {.text = "Half of the distances were below this before", .unit = "length"}),
    reported<&SurfaceAlignment::overlap>(
        {.text = "Share of the samples that lie on the fixed surface", .unit = "share"}),
    reported<&SurfaceAlignment::reach>({.text = "Distance within which they do", .unit = "length"}),
    reported<&SurfaceAlignment::differing>(
        {.name = "differing_share", .text = "Share of the samples at which the shapes differ", .unit = "share"}),
    reported<&SurfaceAlignment::differing_by>({.text = "Median of that difference", .unit = "length"}),
    reported<&SurfaceAlignment::mirror_image_fits>({.text = "Whether the mirror image fits instead"}),
    reported<&SurfaceAlignment::samples>({.text = "Samples that were compared"}),
    reported<&SurfaceAlignment::iterations>({.text = "Steps of the last search", .unit = "steps"}),
    reported<&SurfaceAlignment::start>({.name = "from", .text = "Where the search began", .choices = kStartWords}),
    reported<[](const SurfaceAlignment& r) { return told_if(r.searched, r.alternatives); }>(
        {.name = "alternatives", .text = "Other poses that fit as well; nothing where they were not looked for"}),
    reported<&SurfaceAlignment::alternative_angles>(
        {.name = "alternative_angles_deg", .text = "Angles to these", .unit = "degrees"}),
    reported<&SurfaceAlignment::free_motions>({.text = "Motions that the surfaces do not tell"})};

}  // namespace

const ReportSchema& SurfaceAlignment::schema() {
  static constexpr ReportSchema schema{kSurfaceAlignmentRows};
  return schema;
}

}  // namespace sansmesh::inline v1
