#include "sansmesh/model/sample_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/image.h"
#include "sansmesh/points/sampling/poisson_discs.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kBatch = 1024;
/// Ratio of candidate points around the samples to requested points.
constexpr double kSpare = 5;
/// Fraction of a ball's radius within which candidates are placed: no holes between random samples, and not far beyond
/// borders.
constexpr double kCore = 0.65;
/// A point is too far if it would move by more than these numbers of spacings and standard deviations of the noise.
constexpr double kFarInSpacings = 3, kFarInNoise = 5;
/// Upper limit of the local spacing in this test, over the median: isolated samples have no surface nearby.
constexpr double kWidest = 2;
/// Largest number of samples used to choose the surface.
constexpr std::size_t kJudged = 20000;
/// A surface that moves the samples by at most this much (ratio of squares to the noise) only removes noise.
constexpr double kOnlyNoise = 2;
constexpr double kGoldenAngle = 2.399963229728653;

struct Foot {
  Vec3 position, normal;
  bool found = false;
};

/// Descends along the gradient until a step is short. A gradient is valid for about a spacing; longer steps would throw
/// points past the creases of thin parts.
void descend(const ScalarField& field, std::span<const Vec3> x, double tolerance, double longest_step, int steps,
             std::span<Foot> feet) {
  std::vector<Vec3> at(x.begin(), x.end()), g(x.size());
  std::vector<double> f(x.size());
  std::vector<std::uint8_t> inside(x.size());
  for (int k = 0; k <= steps; ++k) {
    field.evaluate_in_domain(at, f, g, inside);
    double longest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double slope2 = squared_norm(g[i]);
      Vec3 move = slope2 > 1e-6 ? g[i] * (-f[i] / slope2) : Vec3{};
      if (const double length = norm(move); length > longest_step) move *= longest_step / length;
      feet[i] = {at[i], normalized(g[i]), inside[i] != 0 && slope2 > 1e-6};
      if (k < steps && feet[i].found) at[i] += move, longest = std::max(longest, norm(move));
    }
    if (longest <= tolerance) break;
  }
}

/// Projects all of x onto the surface, in parallel.
std::vector<Foot> feet_of(const SurfaceModel& model, std::span<const Vec3> x, const ProjectToSurface& options,
                          Progress& progress) {
  const double tolerance = model.frame().from_input(options.tolerance * model.report().spacing);
  const double longest_step = model.frame().from_input(std::max(model.report().spacing, 2 * model.report().noise));
  std::vector<Foot> feet(x.size());
  const std::size_t batches = (x.size() + kBatch - 1) / kBatch;
  const ScalarField* const field = model.projection() ? nullptr : &model.field(progress);
  progress.begin("project", batches);
  parallel_for(0, batches, 1, [&](std::size_t b) {
    const std::size_t first = b * kBatch, count = std::min(kBatch, x.size() - first);
    const auto part = x.subspan(first, count);
    const auto out = std::span<Foot>(feet).subspan(first, count);
    if (model.projection()) {
      std::vector<FootPoint> found(count);
      project_to_fixed_point(*model.projection(), part, tolerance, options.most_steps, found);
      for (std::size_t i = 0; i < count; ++i) out[i] = {found[i].position, found[i].normal, found[i].defined};
    } else {
      descend(*field, part, tolerance, longest_step, options.most_steps, out);
    }
    progress.advance();
  });
  progress.finish();
  if (model.normals() == nullptr) return feet;
  std::vector<Vec3> at(x.size()), normals(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) at[i] = feet[i].position, normals[i] = feet[i].normal;
  model.normals()->refine(at, normals);
  for (std::size_t i = 0; i < x.size(); ++i) feet[i].normal = normals[i];
  return feet;
}

/// Marks feet that are farther from their points, or from all samples, than noise explains.
std::vector<std::uint8_t> far_off(const SurfaceModel& model, std::span<const Vec3> x, std::span<const Foot> feet) {
  const double spacing = model.frame().from_input(model.report().spacing);
  const double noise = model.frame().from_input(model.report().noise);
  const KdTree tree(model.points().positions);
  std::vector<std::uint8_t> far(x.size());
  parallel_for(0, x.size(), kBatch, [&](std::size_t i) {
    if (!feet[i].found) return;
    std::array<Neighbour, kLocalNeighbours> near;
    const std::size_t n = tree.nearest(Vec3f(feet[i].position), near);
    if (n == 0) return;
    const double local = std::clamp(local_spacing(static_cast<double>(near[n - 1].squared_distance), spacing), spacing,
                                    kWidest * spacing);
    const double most = kFarInSpacings * local + kFarInNoise * noise;
    far[i] = squared_norm(feet[i].position - x[i]) > most * most ||
             static_cast<double>(near[0].squared_distance) > most * most;
  });
  return far;
}

}  // namespace

SurfaceModel make_recommended_surface(PreparedCloud cloud, Progress& progress) {
  const NoiseEstimate estimate = measure_noise(cloud.points);
  // An unknown deviation, possibly shape, does not count as noise.
  const double noise = estimate.known ? estimate.deviation : 0;
  const std::size_t all = cloud.points.size(), every = 1 + (all - 1) / kJudged;
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < all; i += every) x.push_back(Vec3(cloud.points.positions[i]));
  PreparedCloud again = cloud;
  SurfaceOptions options;
  options.method = kPartitionSurface;
  SurfaceModel smooth = make_surface_model(std::move(cloud), options, progress);
  const std::vector<Foot> to_smooth = feet_of(smooth, x, {}, progress);
  std::vector<std::uint8_t> skip = far_off(smooth, x, to_smooth);
  double moved = 0, known = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    skip[i] = skip[i] || !to_smooth[i].found;
    if (skip[i]) continue;
    moved += squared_norm(to_smooth[i].position - x[i]), ++known;
  }
  if (known > 0 && moved <= kOnlyNoise * noise * noise * known) return smooth;
  options.method = "curvature";
  SurfaceModel close = make_surface_model(std::move(again), options, progress);
  const std::vector<Foot> to_close = feet_of(close, x, {}, progress);
  double nearer = 0, both = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (skip[i] || !to_close[i].found) continue;
    nearer += squared_norm(to_smooth[i].position - x[i]) - squared_norm(to_close[i].position - x[i]), ++both;
  }
  return nearer > noise * noise * both ? std::move(close) : std::move(smooth);
}

const OptionSchema& ProjectToSurface::schema() {
  using O = ProjectToSurface;
  static constexpr OptionRow rows[] = {
      option<&O::most_steps>({.text = "Largest number of steps per point", .range = {1, 1000}, .old_name = "steps"}),
      option<&O::tolerance>({.text = "A point stops after a step shorter than this, over the spacing",
                             .unit = "ratio",
                             .range = {1e-6, 1}})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void ProjectToSurface::validate() const { validate_options(*this); }

PointSet project_points(const PointSet& points, const SurfaceModel& model, const ProjectToSurface& options,
                        Progress& progress, SurfaceProjection* report) {
  options.validate();
  const LocalFrame& frame = model.frame();
  std::vector<Vec3> x(points.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = frame.from_input(points.origin, points.positions[i]);
  const std::vector<Foot> feet = feet_of(model, x, options, progress);
  const std::vector<std::uint8_t> far = far_off(model, x, feet);

  PointSet result = points;
  result.triangles.clear();
  result.triangle_attributes.clear();
  result.normals.resize(points.size());
  std::vector<std::uint8_t> gone(points.size(), 0);
  SurfaceProjection local;
  SurfaceProjection& r = report ? *report : local;
  r = {};
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!feet[i].found || far[i]) {
      gone[i] = 1;
      ++r.left_out;
      continue;
    }
    const double move = frame.to_input(norm(feet[i].position - x[i]));
    r.mean_move += move;
    r.rms_move += move * move;
    r.largest_move = std::max(r.largest_move, move);
    result.positions[i] = Vec3f(frame.to_input(feet[i].position) - points.origin);
    result.normals[i] = Vec3f(feet[i].normal);
    ++r.projected;
  }
  if (r.projected > 0) {
    r.mean_move /= static_cast<double>(r.projected);
    r.rms_move = std::sqrt(r.rms_move / static_cast<double>(r.projected));
  }
  remove_samples(result, gone);
  return result;
}

PointSet resample_surface(const SurfaceModel& model, std::size_t count, const ProjectToSurface& options,
                          Progress& progress, SurfaceProjection* report) {
  options.validate();
  if (count == 0) throw ArgumentError("the number of points must be at least 1");
  // Candidates on a spiral around each sample, within its ball's core, that cover the surface several times.
  const BallUnion& balls = model.balls();
  const std::size_t samples = balls.centers.size();
  std::vector<Vec3> centers(balls.centers.begin(), balls.centers.end());
  const std::vector<Foot> roots = feet_of(model, centers, options, progress);
  // In proportion to the areas of the balls: where samples are sparse, each needs more candidates.
  double squares = 0;
  for (std::size_t i = 0; i < samples; ++i)
    if (roots[i].found) squares += static_cast<double>(balls.radii[i]) * static_cast<double>(balls.radii[i]);
  const double all = kSpare * static_cast<double>(count), per_square = all / squares;
  const std::size_t most = 1 + whole_part<std::size_t>(all);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < samples; ++i) {
    if (!roots[i].found) continue;
    Vec3 t, b;
    tangent_frame(roots[i].normal, t, b);
    const double ball = static_cast<double>(balls.radii[i]), radius = kCore * ball;
    const auto around = index_in<std::size_t>(std::ceil(per_square * ball * ball), 1, most);
    for (std::size_t k = 0; k < around; ++k) {
      const double r = radius * std::sqrt(static_cast<double>(k) / static_cast<double>(around));
      const double angle = kGoldenAngle * static_cast<double>(k) + static_cast<double>(i);
      x.push_back(roots[i].position + t * (r * std::cos(angle)) + b * (r * std::sin(angle)));
    }
  }
  std::vector<Foot> feet = feet_of(model, x, options, progress);
  std::erase_if(feet, [](const Foot& f) { return !f.found; });

  // Poisson discs: finds the exclusion radius that leaves about `count` points.
  progress.begin("spread");
  const LocalFrame& frame = model.frame();
  const double area =
      static_cast<double>(model.report().samples) * std::pow(frame.from_input(model.report().spacing), 2);
  double radius = std::sqrt(0.7 * area / static_cast<double>(count) * 4 / std::numbers::pi);
  std::vector<Vec3> positions;
  positions.reserve(feet.size());
  for (const Foot& f : feet) positions.push_back(f.position);
  std::vector<std::uint32_t> kept;
  double too_small = 0, too_large = 0;  // known bounds of the radius; 0: none yet
  for (int round = 0; round < 12; ++round) {
    kept = poisson_discs(positions, radius);
    const double share = static_cast<double>(kept.size()) / static_cast<double>(count);
    if (std::abs(share - 1) < 0.03 || (share < 1 && kept.size() == feet.size())) break;
    (share > 1 ? too_small : too_large) = radius;
    if (too_small > 0 && too_large > 0)
      radius = std::sqrt(too_small * too_large);
    else
      radius *= std::sqrt(std::clamp(share, 0.3, 3.0));
  }
  PointSet result;
  std::vector<Vec3> chosen;
  for (const std::uint32_t i : kept) {
    chosen.push_back(feet[i].position);
    result.positions.push_back(Vec3f(feet[i].position));
    result.normals.push_back(Vec3f(feet[i].normal));
  }
  if (model.colors()) {
    std::vector<Vec3f> colors(chosen.size());
    model.colors()->evaluate(chosen, colors);
    for (const Vec3f& c : colors) result.colors.push_back({to_byte(c.x), to_byte(c.y), to_byte(c.z)});
  }
  move_to_input(result, frame);
  if (report) *report = {.projected = result.size()};
  progress.finish();
  return result;
}

namespace {

constexpr ReportRow kSurfaceProjectionRows[] = {
    reported<&SurfaceProjection::mean_move>(
        {.name = "moved.mean", .text = "Mean displacement of the points", .unit = "length"}),
    reported<&SurfaceProjection::rms_move>(
        {.name = "moved.rms", .text = "Displacement of the points, root mean square", .unit = "length"}),
    reported<&SurfaceProjection::largest_move>(
        {.name = "moved.largest", .text = "Largest displacement of a point", .unit = "length"}),
    reported<&SurfaceProjection::left_out>({.text = "Points too far from the samples"})};

}  // namespace

const ReportSchema& SurfaceProjection::schema() {
  static constexpr ReportSchema schema{kSurfaceProjectionRows};
  return schema;
}

}  // namespace sansmesh::inline v1
