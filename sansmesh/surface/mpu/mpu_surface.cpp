#include "sansmesh/surface/mpu/mpu_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/mpu/spline_weight.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFewestSamples = 9;
constexpr int kDeepestLeaf = 14;
/// Balls are stored in single precision: balls and cells are widened by this share of the cube.
constexpr double kRounding = 1e-6;
/// Balls that more leaves than this reach are too large for a bound.
constexpr std::size_t kMostLeaves = 4000;
/// Half the diagonal of a cube, over its edge.
constexpr double kHalfDiagonal = 0.8660254037844387;
/// Cubes at the rims of gaps are enlarged by this factor, because the rim may pass through a cube that is judged by its
/// centre.
constexpr double kOverlap = 2;
/// Cubes whose centres are this many half diagonals from the surface, by value and slope, are not searched.
constexpr double kFarOff = 2;
constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// Finite samples with unit normals, in an order that depends on their positions only.
struct OrderedSamples {
  std::vector<Vec3f> positions, normals;
};

OrderedSamples ordered_samples(const PointSet& points) {
  if (!points.has_normals()) throw DataError("the samples have no normals: estimate and orient them first");
  OrderedSamples given, s;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& n = points.normals[i];
    if (!is_finite(points.positions[i]) || !is_finite(n) || n == Vec3f{}) continue;
    given.positions.push_back(points.positions[i]);
    given.normals.push_back(normalized(n));
  }
  const std::size_t count = given.positions.size();
  if (count < kFewestSamples)
    throw DataError("only " + std::to_string(count) + " samples have a position and a normal: at least " +
                    std::to_string(kFewestSamples) + " are needed");
  // The tree breaks ties, for example between samples of a face of a box, by index.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const Vec3f &p = given.positions[i], &n = given.normals[i];
    return std::array{p.x, p.y, p.z, n.x, n.y, n.z};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) { return key(i) < key(j); });
  std::vector<Vec3f> positions(count);
  for (std::size_t k = 0; k < count; ++k) positions[k] = given.positions[order[k]];
  const KdTree tree(positions);
  for (const std::uint32_t k : tree.order()) {
    s.positions.push_back(positions[k]);
    s.normals.push_back(given.normals[order[k]]);
  }
  return s;
}

}  // namespace

struct MpuSurface::State {
  MpuTree tree;
  MpuReport report;
  BallTree balls;
  std::vector<std::uint32_t> first_reach;  ///< start of each leaf in `reach`; one more than there are leaves
  std::vector<std::uint32_t> reach;        ///< leaves whose balls reach the leaf

  struct Cube {
    Vec3 center;
    double edge = 0;
  };

  void find_reach();
  bool passes(const Vec3& center, double edge) const;
  void find_gaps(const MpuSurface::SampleBalls& samples, const Vec3& center, double edge,
                 std::vector<Cube>& gaps) const;
  void evaluate(const Vec3& x, double& value, Vec3* gradient) const;
  ValueRange range(const Vec3& x, double radius, std::vector<std::uint32_t>& near) const;
  Vec3 in_cube(const Vec3& x) const {
    Vec3 y;
    for (std::size_t k = 0; k < 3; ++k)
      y[k] = std::clamp(x[k], tree.cells.lower()[k], tree.cells.lower()[k] + tree.cells.edge());
    return y;
  }
};

void MpuSurface::State::find_reach() {
  const std::size_t n = tree.leaves.size();
  std::vector<Vec3f> centers(n);
  std::vector<float> radii(n);
  const double more = kRounding * tree.cells.edge();
  for (std::size_t i = 0; i < n; ++i) {
    centers[i] = Vec3f(tree.leaves[i].center - tree.cells.lower());
    radii[i] = static_cast<float>(tree.leaves[i].radius + more);
  }
  balls = BallTree(centers, radii);
  std::vector<std::vector<std::uint32_t>> found(n);
  parallel_for(0, n, 256, [&](std::size_t i) {
    const double half = tree.leaves[i].edge / 2 + more;
    const Vec3 c = tree.leaves[i].center - tree.cells.lower(), h{half, half, half};
    balls.touching({Vec3f(c - h), Vec3f(c + h)}, found[i]);
  });
  first_reach.assign(n + 1, 0);
  std::size_t total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    total += found[i].size();
    if (total > std::numeric_limits<std::uint32_t>::max())
      throw DataError("the octree has too many cells: `error` is too small");
    first_reach[i + 1] = static_cast<std::uint32_t>(total);
  }
  reach.resize(total);
  parallel_for(0, n, 1024,
               [&](std::size_t i) { std::copy(found[i].begin(), found[i].end(), reach.begin() + first_reach[i]); });
}

void MpuSurface::State::evaluate(const Vec3& x, double& value, Vec3* gradient) const {
  const std::size_t leaf = tree.leaf_at(x);
  double weight = 0, sum = 0;
  Vec3 weight_slope, sum_slope;
  for (std::uint32_t k = first_reach[leaf]; k < first_reach[leaf + 1]; ++k) {
    const MpuLeaf& l = tree.leaves[reach[k]];
    const Vec3 d = x - l.center;
    const double d2 = squared_norm(d);
    if (d2 >= l.radius * l.radius) continue;
    const double r = std::sqrt(d2) / l.radius, w = spline_weight(r);
    const QuadricPiece* pieces = &tree.pieces[l.first_piece];
    const ShapeValue v = shape_value(pieces, l.combination, d);
    weight += w, sum += w * v.value;
    if (!gradient) continue;
    const Vec3 slope = d * (spline_weight_slope(r) / (l.radius * l.radius));
    weight_slope += slope;
    sum_slope += slope * v.value + pieces[v.piece].gradient(d) * w;
  }
  value = sum / weight;
  if (gradient) *gradient = (sum_slope - weight_slope * value) / weight;
}

ValueRange MpuSurface::State::range(const Vec3& x, double radius, std::vector<std::uint32_t>& near) const {
  const Vec3 y = in_cube(x);
  const Vec3f c(y - tree.cells.lower()),
      h = Vec3f{1, 1, 1} * static_cast<float>(radius + 2 * kRounding * tree.cells.edge());
  ValueRange all{kUnknown, -kUnknown};
  if (!balls.touching({c - h, c + h}, kMostLeaves, near)) return {-kUnknown, kUnknown};
  for (const std::uint32_t i : near) {
    const MpuLeaf& l = tree.leaves[i];
    if (norm(y - l.center) >= l.radius + radius) continue;
    const ValueRange r = shape_range(&tree.pieces[l.first_piece], l.combination, y - l.center, radius);
    all = {std::min(all.least, r.least), std::max(all.most, r.most)};
  }
  // Outside of the cube values are farther from zero, by the distance to it.
  const double beyond = norm(x - y) + radius;
  bool outside = false;
  for (std::size_t k = 0; k < 3; ++k)
    outside =
        outside || x[k] - radius < tree.cells.lower()[k] || x[k] + radius > tree.cells.lower()[k] + tree.cells.edge();
  if (outside && all.least < 0) all.least -= beyond;
  if (outside && all.most > 0) all.most += beyond;
  const double rounding = 1e-12 * std::max(std::abs(all.least), std::abs(all.most));
  return {all.least - rounding, all.most + rounding};
}

Box3 MpuSurface::bounds() const { return state_->tree.cells.bounds(); }
const MpuTree& MpuSurface::tree() const { return state_->tree; }
const MpuReport& MpuSurface::report() const { return state_->report; }

void MpuSurface::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  const State& s = *state_;
  parallel_ranges(0, x.size(), 512, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Vec3* const gradient = gradients.empty() ? nullptr : &gradients[i];
      if (!is_finite(x[i])) {
        values[i] = s.tree.cells.edge();
        if (gradient) *gradient = {};
        continue;
      }
      const Vec3 y = s.in_cube(x[i]);
      s.evaluate(y, values[i], gradient);
      if (y == x[i]) continue;
      const Vec3 away = x[i] - y;
      const double sign = values[i] < 0 ? -1 : 1, distance = norm(away);
      values[i] += sign * distance;
      if (!gradient) continue;
      // The nearest point of the cube moves only along the axes in which x is within the cube.
      for (std::size_t k = 0; k < 3; ++k)
        if (away[k] != 0) (*gradient)[k] = sign * away[k] / distance;
    }
  });
}

void MpuSurface::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  parallel_ranges(0, x.size(), 64, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i)
      found[i] = is_finite(x[i]) && std::isfinite(radius) ? state_->range(x[i], radius, near)
                                                          : ValueRange{-kUnknown, kUnknown};
  });
}

/// Whether the surface may pass through the cube, by the signs at 27 points.
bool MpuSurface::State::passes(const Vec3& center, double edge) const {
  bool inside = false, outside = false;
  for (int k = 0; k < 27; ++k) {
    const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
    const Vec3 at = center + Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)} * (edge / 2);
    double value = 0;
    evaluate(at, value, nullptr);
    (value < 0 ? inside : outside) = true;
  }
  return inside && outside;
}

/// Cubes around the parts of the surface in this one outside the samples' balls: the whole cube if no ball is near,
/// else its children down to the size of the balls.
void MpuSurface::State::find_gaps(const MpuSurface::SampleBalls& samples, const Vec3& center, double edge,
                                  std::vector<Cube>& gaps) const {
  const double r = kHalfDiagonal * edge;
  const auto distance_to = [&](const Vec3& x, double& ball) {
    const auto near = samples.tree.nearest(Vec3f(x));
    ball = static_cast<double>(samples.radii[near->index]);
    return std::sqrt(static_cast<double>(near->squared_distance));
  };
  double ball = 0;
  const double distance = distance_to(center, ball);
  if (distance + r <= ball) return;
  if (distance >= ball + r) {
    if (passes(center, edge)) gaps.push_back({center, edge});
    return;
  }
  Vec3 gradient;
  double value = 0;
  evaluate(center, value, &gradient);
  const double steepness = norm(gradient);
  if (std::abs(value) > kFarOff * r * steepness) return;
  if (2 * edge <= ball) {
    const double step = steepness > 0 ? value / (steepness * steepness) : 0;
    if (distance_to(in_cube(center - gradient * step), ball) > ball) gaps.push_back({center, kOverlap * edge});
    return;
  }
  for (int k = 0; k < 8; ++k)
    find_gaps(samples, center + Vec3{k & 1 ? 0.25 : -0.25, k & 2 ? 0.25 : -0.25, k & 4 ? 0.25 : -0.25} * edge, edge / 2,
              gaps);
}

BallUnion MpuSurface::gap_balls(const SampleBalls& samples) const {
  const MpuTree& tree = state_->tree;
  std::vector<std::vector<State::Cube>> gaps(tree.leaves.size());
  parallel_for(0, tree.leaves.size(), 64,
               [&](std::size_t i) { state_->find_gaps(samples, tree.leaves[i].center, tree.leaves[i].edge, gaps[i]); });
  BallUnion balls;
  for (const std::vector<State::Cube>& of_leaf : gaps)
    for (const State::Cube& c : of_leaf) {
      balls.centers.emplace_back(c.center);
      balls.radii.push_back(static_cast<float>((kHalfDiagonal + 1e-3) * c.edge));
    }
  return balls;
}

MpuSurface make_mpu_surface(const PointSet& points, const MpuOptions& options, Progress& progress) {
  options.validate();
  progress.begin("order samples");
  const OrderedSamples samples = ordered_samples(points);
  auto state = std::make_shared<MpuSurface::State>();
  MpuReport& report = state->report;
  report.spacing = options.spacing.value_or(0);
  bool sure = true;
  if (!options.error) {
    PointSet known;
    known.positions = samples.positions, known.normals = samples.normals;
    if (!options.spacing) report.spacing = estimate_spacing(known);
    const NoiseEstimate noise = measure_noise(known);
    report.noise = noise.deviation, sure = noise.known;
  }
  report.error = options.error ? *options.error : default_mpu_error(report.spacing, sure ? report.noise : 0);
  if (!(report.error > 0)) throw DataError("all samples coincide: there is no surface");
  state->tree = fit_mpu_tree(samples.positions, samples.normals, report.error, options.max_depth.value_or(kDeepestLeaf),
                             options.sharp, progress);
  progress.begin("assign balls to cells");
  state->find_reach();
  report.leaves = state->tree.leaves.size();
  for (const MpuLeaf& l : state->tree.leaves) {
    report.depth = std::max<int>(report.depth, l.level);
    report.general += l.shape == LeafShape::general;
    report.edges += l.shape == LeafShape::edge;
    report.corners += l.shape == LeafShape::corner;
  }
  progress.finish();
  MpuSurface surface;
  surface.state_ = std::move(state);
  return surface;
}

}  // namespace sansmesh::inline v1
