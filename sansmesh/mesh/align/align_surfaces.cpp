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
using detail::PoseFitOptions;
using detail::SearchSamples;

/// Overlap of both surfaces above which no global search is needed.
constexpr double kSurelyThere = 0.8;
/// Alternative poses: least score relative to the best, and least difference in angle (radians) and position (in
/// sizes).
constexpr double kAsGood = 0.98, kOtherAngle = 0.2, kOtherPosition = 0.1;
constexpr std::size_t kComparedPoses = 6, kOnTheWay = 3000, kOfComparison = 1500;
/// Poses below this fraction of the best score are not refined.
constexpr double kWorthALook = 0.85;
/// Final reach: in standard deviations, and least in sizes.
constexpr double kReachOverDeviation = 4, kLeastReach = 0.002;
constexpr double kStepOverMedian = 0.005;
constexpr double kLeastOverlap = 0.2;
/// Points of a fixed cloud: least number, and number per sample.
constexpr std::size_t kFixedPoints = 150000, kFixedOfSample = 8;
/// Different shape: least distance from the surface (in sizes) and radius of the comparison (in sizes). A mirror image
/// fits if it differs in less than this fraction of the samples.
constexpr double kLeastDifference = 0.003, kDifferenceReach = 0.1, kMirroredShare = 1.0 / 3;
/// With a larger reach (in sizes) everything matches everything.
constexpr double kWidestReach = 0.15;

OrientedPoints samples_of(const AlignSide& side, std::size_t most) {
  const OrientedPoints& all =
      side.is_mesh || side.all.size() <= side.dense.size() || most <= side.dense.size() ? side.dense : side.all;
  return all.some(most);
}

/// Remaining distances of the samples on the surface.
std::vector<double> left_between(const OrientedPoints& samples, const detail::WholeSurface& fixed,
                                 const Similarity& pose, double reach, bool signs) {
  std::vector<double> left;
  for (const auto& d : detail::distances_to(samples, fixed, pose, reach, signs, false))
    if (d && *d <= reach) left.push_back(*d);
  return left;
}

/// Fits to the surface itself, first with few samples, then with all.
FitResult fit_closely(const OrientedPoints& few, const OrientedPoints& many, const detail::WholeSurface& fixed,
                      const Similarity& start, double reach, const SurfaceAlignmentOptions& options, bool signs) {
  PoseFitOptions fit;
  fit.iterations = options.iterations;
  fit.reach = reach;
  fit.least_reach = kLeastReach;
  fit.scale = options.find_scale;
  fit.signs = signs;
  fit.last_step = 1e-4;
  FitResult rough = detail::fit_pose(few, fixed, start, fit);
  std::vector<double> left = left_between(few, fixed, rough.pose, rough.reach, signs);
  fit.reach = fit.least_reach = std::max(kLeastReach, kReachOverDeviation * kDeviationOverMedian * median(left));
  // Steps below the noise of the samples are insignificant.
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
  // Half a turn, or none: the longest column of R + 1.
  const Vec3 columns[] = {x + Vec3{1, 0, 0}, y + Vec3{0, 1, 0}, z + Vec3{0, 0, 1}};
  return normalized(*std::max_element(std::begin(columns), std::end(columns),
                                      [](const Vec3& a, const Vec3& b) { return squared_norm(a) < squared_norm(b); }));
}

AffineMap SimilarityMotion::map() const {
  AffineMap map{x * scale, y * scale, z * scale, {}};
  map.shift = to - map.linear(from);
  return map;
}

const OptionSchema& SurfaceAlignmentOptions::schema() {
  using O = SurfaceAlignmentOptions;
  static constexpr std::string_view starts[] = {"auto", "here", "anywhere"};
  static constexpr OptionRow rows[] = {
      option<&O::start>({.text = "Start of the search: here, the given pose; anywhere, all rotations; auto, here, and "
                                 "anywhere if the fit is poor",
                         .unit = "choice",
                         .choices = starts,
                         .name = "from"}),
      option<&O::find_scale>({.text = "Also estimate a uniform scale", .old_name = "scale"}),
      option<&O::samples>({.text = "Samples of the moving surface that are compared",
                           .range = {100, 10'000'000},
                           .name = "align_samples"}),
      option<&O::iterations>(
          {.text = "Largest number of steps of a search", .range = {1, 1000}, .name = "align_iterations"})};
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

/// Alignment of two surfaces in local coordinates, in which both have a size of about 1.
class SurfaceFit {
 public:
  SurfaceFit(const TriangleMesh& moving, const TriangleMesh& fixed, const SurfaceAlignmentOptions& options,
             Progress& progress)
      : options_(options),
        progress_(progress),
        moving_frame_(detail::measure_side(moving, "moving")),
        fixed_frame_(detail::measure_side(fixed, "fixed")),
        // For very different sizes the scale becomes part of the units.
        moving_unit_(options.find_scale ? moving_frame_.unit : fixed_frame_.unit),
        // The moving surface needs no more points than are compared; tangent planes of the fixed one average several.
        moving_(
            detail::prepare_side(moving, {moving_frame_.origin, moving_unit_}, options.samples, "moving", progress)),
        fixed_(detail::prepare_side(fixed, fixed_frame_, std::max(kFixedPoints, kFixedOfSample * options.samples),
                                    "fixed", progress)),
        signs_(moving_.has_sides && fixed_.has_sides),
        coarse_(detail::search_samples(moving_, fixed_)),
        surface_(fixed_.mesh, fixed_.all, coarse_.spacing),
        back_(moving_.mesh, moving_.dense, coarse_.spacing),
        few_(samples_of(moving_, std::min(options.samples, kOnTheWay))),
        many_(samples_of(moving_, options.samples)),
        few_fixed_(samples_of(fixed_, kOnTheWay)) {
    start_.scale = moving_unit_ / fixed_frame_.unit;
    start_.translation = (moving_frame_.origin - fixed_frame_.origin) / fixed_frame_.unit;
  }

  SurfaceAlignment run() {
    SurfaceAlignment result;
    if (options_.start != AlignStart::anywhere) {
      progress_.begin("fit");
      best_ = fit_closely(few_, many_, surface_, start_, 0, options_, signs_);
      best_score_ = score(best_->pose);
    }
    if (options_.start == AlignStart::anywhere ||
        (options_.start == AlignStart::automatic && best_score_ < kSurelyThere))
      search(result);
    if (!best_) best_.emplace().pose = start_;
    progress_.begin("residuals");
    measure(result);
    const Similarity& pose = best_->pose;
    SimilarityMotion& m = result.motion;
    m.x = pose.columns[0], m.y = pose.columns[1], m.z = pose.columns[2];
    m.scale = options_.find_scale ? pose.scale * fixed_frame_.unit / moving_unit_ : 1;
    m.from = moving_frame_.origin;
    m.to = fixed_frame_.origin + pose.translation * fixed_frame_.unit;
    return result;
  }

 private:
  double score(const Similarity& pose) const {
    return detail::mutual_overlap(few_, surface_, few_fixed_, back_, pose, coarse_.spacing, signs_);
  }

  /// Searches all poses, and keeps the best one if it is better than that from the given pose.
  void search(SurfaceAlignment& result) {
    result.searched = true;
    const std::vector<FoundPose> poses = detail::search_poses(moving_, fixed_, coarse_, options_.find_scale, progress_);
    progress_.begin("fit", kComparedPoses);
    std::vector<std::pair<FitResult, double>> tried;
    PoseFitOptions fit;
    fit.iterations = std::min(options_.iterations, 30);
    fit.reach = 2 * coarse_.spacing;
    fit.least_reach = kLeastReach;
    fit.scale = options_.find_scale;
    fit.signs = signs_;
    fit.last_step = 1e-4;
    const OrientedPoints fewer = samples_of(moving_, std::min(options_.samples, kOfComparison));
    for (std::size_t k = 0; k < std::min(poses.size(), kComparedPoses); ++k) {
      if (poses[k].score < kWorthALook * poses[0].score) break;
      const FitResult f = detail::fit_pose(fewer, surface_, poses[k].pose, fit);
      tried.emplace_back(f, score(f.pose));
      progress_.advance();
    }
    std::stable_sort(tried.begin(), tried.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    if (!tried.empty() && tried[0].second > best_score_ * (best_ ? 1.02 : 1)) {
      best_score_ = tried[0].second;
      best_ = fit_closely(few_, many_, surface_, tried[0].first.pose, 2 * coarse_.spacing, options_, signs_);
      result.start = AlignStart::anywhere;
    }
    if (!best_) return;
    std::vector<Similarity> known{best_->pose};
    for (const auto& [f, s] : tried) {
      const auto same = [&](const Similarity& o) {
        return detail::nearly_same(o, f.pose, moving_, kOtherAngle, kOtherPosition);
      };
      if (s < kAsGood * best_score_ || std::any_of(known.begin(), known.end(), same)) continue;
      known.push_back(f.pose);
      result.alternative_angles.push_back(angle_between(f.pose, best_->pose) * 180 / std::numbers::pi);
    }
    result.alternatives = result.alternative_angles.size();
  }

  /// Quality of the best pose.
  void measure(SurfaceAlignment& result) const {
    const Similarity& pose = best_->pose;
    const double size = fixed_frame_.unit;
    result.iterations = best_->iterations;
    result.samples = many_.size();
    result.reach = best_->reach * size;
    std::vector<double> left = left_between(many_, surface_, pose, best_->reach, signs_);
    if (!left.empty()) {
      double squares = 0;
      for (const double d : left) squares += d * d;
      std::sort(left.begin(), left.end());
      result.rms = std::sqrt(squares / static_cast<double>(left.size())) * size;
      result.median = left[left.size() / 2] * size;
      result.p95 = left[left.size() * 95 / 100] * size;
    }
    const detail::ShapeDifference difference =
        detail::shape_difference(many_, surface_, pose, coarse_.spacing, kDifferenceReach, kLeastDifference, signs_);
    result.differing = difference.share;
    result.differing_by = difference.offset * size;
    result.overlap = static_cast<double>(left.size()) / static_cast<double>(std::max<std::size_t>(many_.size(), 1));
    std::vector<double> before;
    for (const auto& d : detail::distances_to(few_, surface_, start_, 0, signs_, true))
      if (d) before.push_back(*d);
    result.median_before = median(before) * size;
    double moved = 0;
    for (const Vec3& p : few_.x) moved += squared_norm(pose(p) - start_(p));
    result.moved = std::sqrt(moved / static_cast<double>(std::max<std::size_t>(few_.size(), 1))) * size;
    for (const double t : best_->determined) result.free_motions += t < detail::kDeterminedShare;
    result.found = result.overlap >= kLeastOverlap && best_->reach <= kWidestReach;
    result.size_ratio = moving_frame_.unit / size;
  }

  const SurfaceAlignmentOptions& options_;
  Progress& progress_;
  LocalFrame moving_frame_, fixed_frame_;  ///< the unit is the size
  double moving_unit_;
  AlignSide moving_, fixed_;
  bool signs_;
  SearchSamples coarse_;
  detail::WholeSurface surface_, back_;
  OrientedPoints few_, many_, few_fixed_;
  Similarity start_;  ///< given pose
  std::optional<FitResult> best_;
  double best_score_ = -1;
};

SurfaceAlignment align(const TriangleMesh& moving, const TriangleMesh& fixed, const SurfaceAlignmentOptions& options,
                       Progress& progress) {
  progress.begin("prepare");
  return SurfaceFit(moving, fixed, options, progress).run();
}

}  // namespace

SurfaceAlignment align_surfaces(const TriangleMesh& moving, const TriangleMesh& fixed,
                                const SurfaceAlignmentOptions& options, Progress& progress) {
  options.validate();
  SurfaceAlignment result = align(moving, fixed, options, progress);
  // A mirrored part may fit moderately, as symmetric shapes nearly equal their mirror images.
  if (result.found && result.differing > kOtherShape && options.start != AlignStart::given_pose) {
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
        {.name = "scale", .text = "Uniform scale", .unit = "factor"}),
    reported<[](const SurfaceAlignment& r) { return r.motion.to - r.motion.from; }>(
        {.name = "shift_of_middle", .text = "Displacement of the centre", .unit = "length"}),
    reported<&SurfaceAlignment::moved>(
        {.name = "moved_rms", .text = "Displacement of the samples, root mean square", .unit = "length"}),
    reported<&SurfaceAlignment::rms>({.text = "Root mean square distance after alignment", .unit = "length"}),
    reported<&SurfaceAlignment::median>({.text = "Median distance after alignment", .unit = "length"}),
    reported<&SurfaceAlignment::p95>({.text = "95 % quantile of the distances after alignment", .unit = "length"}),
    reported<&SurfaceAlignment::median_before>({.text = "Median distance before alignment", .unit = "length"}),
    reported<&SurfaceAlignment::overlap>({.text = "Share of the samples on the fixed surface", .unit = "share"}),
    reported<&SurfaceAlignment::reach>({.text = "Largest distance of samples on the fixed surface", .unit = "length"}),
    reported<&SurfaceAlignment::differing>(
        {.name = "differing_share", .text = "Share of the samples where the shapes differ", .unit = "share"}),
    reported<&SurfaceAlignment::differing_by>({.text = "Median difference there", .unit = "length"}),
    reported<&SurfaceAlignment::mirror_image_fits>({.text = "Whether the mirror image fits instead"}),
    reported<&SurfaceAlignment::samples>({.text = "Number of compared samples"}),
    reported<&SurfaceAlignment::iterations>({.text = "Steps of the last search", .unit = "steps"}),
    reported<&SurfaceAlignment::start>({.name = "from", .text = "Start of the search", .choices = kStartWords}),
    reported<[](const SurfaceAlignment& r) { return value_if(r.searched, r.alternatives); }>(
        {.name = "alternatives", .text = "Other poses with the same fit; absent if they were not searched for"}),
    reported<&SurfaceAlignment::alternative_angles>(
        {.name = "alternative_angles_deg", .text = "Rotation angles to the other poses", .unit = "degrees"}),
    reported<&SurfaceAlignment::free_motions>({.text = "Degrees of freedom that the surfaces do not determine"})};

}  // namespace

const ReportSchema& SurfaceAlignment::schema() {
  static constexpr ReportSchema schema{kSurfaceAlignmentRows};
  return schema;
}

}  // namespace sansmesh::inline v1
