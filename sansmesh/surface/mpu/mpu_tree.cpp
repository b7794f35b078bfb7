#include "sansmesh/surface/mpu/mpu_tree.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/mpu/piecewise_shape.h"
#include "sansmesh/surface/mpu/shape_fits.h"
#include "sansmesh/surface/mpu/spline_weight.h"

namespace sansmesh::inline v1 {
namespace {

/// Radius of a ball over the diagonal of its cell; margin of an enlarged ball beyond the last of the samples that it
/// needs.
constexpr double kBall = 0.75, kEnlarge = 0.1;
/// Cells with more samples than this may be divided and are not searched for edges.
constexpr std::size_t kManySamples = 2 * kLeastSamples;
/// Number of samples that must agree on the side of a point.
constexpr std::size_t kNearest = 6;
/// Cells with more samples than this are first fitted to a part of them, and divided if that fit fails.
constexpr std::size_t kTrial = 1000;
/// Weight of samples at the rim of a ball, so that no ball has zero weight.
constexpr double kLeastWeight = 1e-6;
/// Edge of the cube over the longest side of the samples' box.
constexpr double kRoom = 1.1;

struct CellFit {
  bool divided = false;
  LocalShape shape;
  LeafShape kind = LeafShape::heights;
  std::uint32_t samples = 0;
};

/// Buffers of the fits of one thread.
struct FitWork {
  std::vector<Neighbour> found;
  std::vector<Vec3> positions, normals;
  std::vector<double> weights;
  std::vector<DistanceConstraint> constraints;

  BallSamples samples() const { return {positions, normals, weights}; }
};

class CellFitter {
 public:
  CellFitter(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double error, bool sharp)
      : tree_(positions), positions_(positions), normals_(normals), error_(error), sharp_(sharp) {}

  /// Fits the cube with this centre and edge. `may_divide`: whether deeper levels are allowed.
  CellFit fit(const Vec3& center, double edge, bool may_divide, FitWork& work) const;

 private:
  double enlarged(const Vec3& center, double radius, FitWork& work) const;
  void take(const Vec3& center, double radius, std::size_t stride, FitWork& work) const;
  void find_constraints(const Vec3& center, double edge, FitWork& work) const;
  bool fit_many(const Vec3& center, double edge, double radius, FitWork& work, CellFit& fit) const;
  void fit_few(bool none, FitWork& work, CellFit& fit) const;

  KdTree tree_;
  std::span<const Vec3f> positions_, normals_;
  double error_;
  bool sharp_;
};

/// Finds the least number of nearest samples, and the radius of a ball with exactly these: a larger ball at the centre
/// of a sphere would hold all others, too.
double CellFitter::enlarged(const Vec3& center, double radius, FitWork& work) const {
  work.found.resize(kLeastSamples);
  work.found.resize(tree_.nearest(Vec3f(center), work.found));
  const double needed = std::sqrt(static_cast<double>(work.found.back().squared_distance));
  return std::max(radius, (1 + kEnlarge) * needed);
}

/// Takes every `stride`-th of the found samples.
void CellFitter::take(const Vec3& center, double radius, std::size_t stride, FitWork& work) const {
  work.positions.clear(), work.normals.clear(), work.weights.clear();
  for (std::size_t k = 0; k < work.found.size(); k += stride) {
    const std::uint32_t i = work.found[k].index;
    work.positions.push_back(Vec3(positions_[i]) - center);
    work.normals.emplace_back(normals_[i]);
    work.weights.push_back(std::max(kLeastWeight, spline_weight(norm(work.positions.back()) / radius)));
  }
}

/// Finds those corners and centre of the cell for which the nearest samples agree on the side.
void CellFitter::find_constraints(const Vec3& center, double edge, FitWork& work) const {
  work.constraints.clear();
  for (unsigned k = 0; k < 9; ++k) {
    const double h = edge / 2;
    const Vec3 x = k == 8 ? Vec3{} : Vec3{k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h};
    std::array<Neighbour, kNearest> near;
    const std::size_t n = tree_.nearest(Vec3f(center + x), near);
    double sum = 0;
    std::size_t outside = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double d = dot(center + x - Vec3(positions_[near[i].index]), Vec3(normals_[near[i].index]));
      sum += d, outside += d > 0;
    }
    if (n > 0 && (outside == 0 || outside == n)) work.constraints.push_back({x, sum / static_cast<double>(n)});
  }
}

Vec3 mean_normal(const FitWork& work) {
  Vec3 sum;
  for (std::size_t i = 0; i < work.normals.size(); ++i) sum += work.normals[i] * work.weights[i];
  const double length = norm(sum);
  return length > 0 ? sum / length : work.normals.front();
}

/// Fits one quadric; false if there is none.
bool CellFitter::fit_many(const Vec3& center, double edge, double radius, FitWork& work, CellFit& fit) const {
  const Vec3 up = mean_normal(work);
  const bool turned =
      std::any_of(work.normals.begin(), work.normals.end(), [&](const Vec3& n) { return dot(n, up) <= 0; });
  fit.kind = turned ? LeafShape::general : LeafShape::heights;
  fit.shape.combination = {};
  if (turned) find_constraints(center, edge, work);
  if (turned && work.constraints.empty()) {
    fit.shape.pieces[0] = height_quadric(work.samples(), up, 1);
    return false;
  }
  fit.shape.pieces[0] =
      turned ? general_quadric(work.samples(), work.constraints, radius) : height_quadric(work.samples(), up, 2);
  return true;
}

/// Fits heights, and if these are not sufficient, faces that meet.
void CellFitter::fit_few(bool none, FitWork& work, CellFit& fit) const {
  const int degree = none ? 1 : 2;
  fit.kind = LeafShape::heights;
  fit.shape.combination = {};
  fit.shape.pieces[0] = height_quadric(work.samples(), mean_normal(work), degree);
  if (!sharp_) return;
  const double error = shape_error(fit.shape, work.positions);
  if (error <= error_) return;
  const auto faces = piecewise_shape(work.samples(), degree);
  if (!faces || shape_error(*faces, work.positions) >= error) return;
  fit.shape = *faces;
  fit.kind = faces->combination.pieces == 2 ? LeafShape::edge : LeafShape::corner;
}

CellFit CellFitter::fit(const Vec3& center, double edge, bool may_divide, FitWork& work) const {
  CellFit fit;
  double radius = kBall * std::sqrt(3.0) * edge;
  tree_.within_by_slot(Vec3f(center), static_cast<float>(radius), work.found);
  fit.samples = static_cast<std::uint32_t>(std::min<std::size_t>(work.found.size(), 0xffffffffu));
  // A cell with too few samples has none to gain in smaller balls: it is not divided.
  const bool enough = work.found.size() >= kLeastSamples;
  if (!enough) radius = enlarged(center, radius, work);
  const std::size_t count = work.found.size();
  if (count <= kManySamples) {
    take(center, radius, 1, work);
    fit_few(fit.samples == 0, work, fit);
    fit.divided = enough && may_divide && shape_error(fit.shape, work.positions) > error_;
    return fit;
  }
  const auto tried = [&](std::size_t stride) {
    take(center, radius, stride, work);
    const bool fitted = fit_many(center, edge, radius, work, fit);
    return fitted && shape_error(fit.shape, work.positions) <= error_;
  };
  if (count > 2 * kTrial && enough && may_divide && !tried(count / kTrial)) {
    fit.divided = true;
    return fit;
  }
  fit.divided = !tried(1) && enough && may_divide;
  return fit;
}

/// Writes the leaves in the order of the curve.
void number_leaves(const std::vector<CellFit>& fits, MpuTree& tree) {
  tree.leaf_of.resize(tree.cells.size());
  for (const std::uint32_t cell : tree.cells.leaves()) {
    const CellFit& fit = fits[cell];
    MpuLeaf leaf;
    leaf.center = tree.cells.block_center(cell);
    leaf.edge = tree.cells.block_edge(cell);
    leaf.radius = kBall * std::sqrt(3.0) * leaf.edge;
    leaf.first_piece = static_cast<std::uint32_t>(tree.pieces.size());
    leaf.samples = fit.samples;
    leaf.combination = fit.shape.combination;
    leaf.shape = fit.kind;
    leaf.level = tree.cells[cell].level;
    for (std::size_t k = 0; k < leaf.combination.pieces; ++k) tree.pieces.push_back(fit.shape.pieces[k]);
    tree.leaf_of[cell] = static_cast<std::uint32_t>(tree.leaves.size());
    tree.leaves.push_back(leaf);
  }
}

}  // namespace

std::size_t MpuTree::leaf_at(const Vec3& x) const {
  std::array<double, 3> t{};  // in cells of the level
  for (std::size_t k = 0; k < 3; ++k) t[k] = std::clamp((x[k] - cells.lower()[k]) / cells.edge(), 0.0, 1 - 1e-15);
  std::size_t cell = 0;
  while (!cells.is_leaf(cell)) {
    std::size_t child = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      t[k] *= 2;
      if (t[k] >= 1) t[k] -= 1, child += std::size_t{1} << k;
    }
    cell = static_cast<std::size_t>(cells[cell].first_child) + child;
  }
  return leaf_of[cell];
}

MpuTree fit_mpu_tree(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double error, int max_depth,
                     bool sharp, Progress& progress) {
  Box3 box;
  for (const Vec3f& p : positions) box.extend(Vec3(p));
  const Vec3 size = box.empty() ? Vec3{} : box.size();
  const double edge = kRoom * std::max({size.x, size.y, size.z});
  if (!(edge > 0)) throw DataError("all samples coincide: there is no surface");
  MpuTree tree{BlockTree(box.center() - Vec3{edge, edge, edge} * 0.5, edge), {}, {}, {}};
  const CellFitter fitter(positions, normals, error, sharp);
  std::vector<std::uint32_t> level{0};
  std::vector<CellFit> fits(1);
  progress.begin("fit octree");
  for (int depth = 0; !level.empty(); ++depth) {
    parallel_ranges(0, level.size(), 32, [&](std::size_t first, std::size_t last) {
      FitWork work;
      for (std::size_t i = first; i < last; ++i)
        fits[level[i]] =
            fitter.fit(tree.cells.block_center(level[i]), tree.cells.block_edge(level[i]), depth < max_depth, work);
      progress.check();
    });
    std::erase_if(level, [&](std::uint32_t cell) { return !fits[cell].divided; });
    level = tree.cells.subdivide_all(level);
    fits.resize(tree.cells.size());
  }
  number_leaves(fits, tree);
  return tree;
}

}  // namespace sansmesh::inline v1
