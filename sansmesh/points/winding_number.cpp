#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/points/winding_number.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/points/cell_sort.h"
#include "sansmesh/points/winding_number.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Only operations that IEEE 754 rounds exactly, and no fused ones: every instruction set gives the same bits.
using Tag = hn::ScalableTag<float>;
using V = hn::Vec<Tag>;
HWY_INLINE V Dot3(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

/// Adds the sources to the sums of `n` points, which are padded to whole vectors. sums: w, and with gradients ∇w.
template <bool kGradient>
HWY_INLINE void Sum(const WindingNumber::NearSource* near, const std::pair<std::uint32_t, std::uint32_t>* ranges,
                    std::size_t range_count, const WindingNumber::FarSource* far, const std::uint32_t* groups,
                    std::size_t group_count, std::size_t n, const float* const* x, float* const* sums) {
  const Tag d;
  const auto set = [d](float v) { return hn::Set(d, v); };
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const V px = hn::LoadU(d, x[0] + i), py = hn::LoadU(d, x[1] + i), pz = hn::LoadU(d, x[2] + i);
    V w = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    for (std::size_t r = 0; r < range_count; ++r)
      for (std::uint32_t s = ranges[r].first; s < ranges[r].second; ++s) {
        const WindingNumber::NearSource& p = near[s];
        const V dx = hn::Sub(set(p.position[0]), px), dy = hn::Sub(set(p.position[1]), py),
                dz = hn::Sub(set(p.position[2]), pz);
        const V nx = set(p.dipole[0]), ny = set(p.dipole[1]), nz = set(p.dipole[2]);
        const V r2 = Dot3(dx, dy, dz, dx, dy, dz), dot = Dot3(dx, dy, dz, nx, ny, nz);
        const V s2 = hn::Mul(r2, set(p.inverse2));
        const auto inside = hn::Lt(s2, set(1.0f));
        const V inverse = hn::Div(set(1.0f), hn::Sqrt(hn::Max(r2, set(1e-20f))));
        const V inverse2 = hn::Mul(inverse, inverse);
        const V ball = hn::Mul(hn::Sub(set(2.5f), hn::Mul(set(1.5f), s2)), set(p.inverse3));
        const V f = hn::IfThenElse(inside, ball, hn::Mul(inverse2, inverse));
        w = hn::Add(w, hn::Mul(dot, f));
        if constexpr (kGradient) {
          // f'(r) / r = −3 f⁎ / r⁎² with the far or the ball's constants.
          const V slope = hn::Mul(hn::Mul(set(3.0f), dot),
                                  hn::IfThenElse(inside, set(p.inverse2 * p.inverse3), hn::Mul(f, inverse2)));
          gx = hn::Add(gx, hn::Sub(hn::Mul(slope, dx), hn::Mul(f, nx)));
          gy = hn::Add(gy, hn::Sub(hn::Mul(slope, dy), hn::Mul(f, ny)));
          gz = hn::Add(gz, hn::Sub(hn::Mul(slope, dz), hn::Mul(f, nz)));
        }
      }
    for (std::size_t g = 0; g < group_count; ++g) {
      const WindingNumber::FarSource& p = far[groups[g]];
      const V dx = hn::Sub(set(p.position[0]), px), dy = hn::Sub(set(p.position[1]), py),
              dz = hn::Sub(set(p.position[2]), pz);
      const V inverse = hn::Div(set(1.0f), hn::Sqrt(hn::Max(Dot3(dx, dy, dz, dx, dy, dz), set(1e-20f))));
      const V ex = hn::Mul(dx, inverse), ey = hn::Mul(dy, inverse), ez = hn::Mul(dz, inverse);
      // first = N·e, second = eᵀMe, third = S(e, e, e) with their derivatives by e (M and S symmetric).
      const V nx = set(p.dipole[0]), ny = set(p.dipole[1]), nz = set(p.dipole[2]);
      const V first = Dot3(ex, ey, ez, nx, ny, nz);
      const V mxy = set(p.second[3]), mxz = set(p.second[4]), myz = set(p.second[5]);
      const V mx = Dot3(ex, ey, ez, set(p.second[0]), mxy, mxz), my = Dot3(ex, ey, ez, mxy, set(p.second[1]), myz),
              mz = Dot3(ex, ey, ez, mxz, myz, set(p.second[2]));
      const V second = Dot3(ex, ey, ez, mx, my, mz);
      const V xx = hn::Mul(ex, ex), yy = hn::Mul(ey, ey), zz = hn::Mul(ez, ez);
      const V xy = hn::Mul(ex, hn::Add(ey, ey)), xz = hn::Mul(ex, hn::Add(ez, ez)), yz = hn::Mul(ey, hn::Add(ez, ez));
      const V xxy = set(p.third[3]), xxz = set(p.third[4]), xyy = set(p.third[5]), yyz = set(p.third[6]),
              xzz = set(p.third[7]), yzz = set(p.third[8]), xyz = set(p.third[9]);
      const V sx = hn::Add(Dot3(xx, yy, zz, set(p.third[0]), xyy, xzz), Dot3(xy, xz, yz, xxy, xxz, xyz));
      const V sy = hn::Add(Dot3(xx, yy, zz, xxy, set(p.third[1]), yzz), Dot3(xy, xz, yz, xyy, xyz, yyz));
      const V sz = hn::Add(Dot3(xx, yy, zz, xxz, yyz, set(p.third[2])), Dot3(xy, xz, yz, xyz, xzz, yzz));
      const V third = Dot3(ex, ey, ez, sx, sy, sz);
      // w += (first + (second + third / r) / r) / r².
      const V inverse2 = hn::Mul(inverse, inverse);
      w = hn::Add(w, hn::Mul(inverse2, hn::Add(first, hn::Mul(inverse, hn::Add(second, hn::Mul(inverse, third))))));
      if constexpr (kGradient) {
        const V inverse3 = hn::Mul(inverse2, inverse);
        const V radial =
            hn::Add(hn::Mul(set(3.0f), first),
                    hn::Mul(inverse, hn::Add(hn::Mul(set(5.0f), second), hn::Mul(hn::Mul(set(7.0f), inverse), third))));
        const auto add = [&](V& sum, V e, V n1, V m, V s) {
          const V across =
              hn::Add(n1, hn::Mul(inverse, hn::Add(hn::Add(m, m), hn::Mul(hn::Mul(set(3.0f), inverse), s))));
          sum = hn::Add(sum, hn::Mul(inverse3, hn::Sub(hn::Mul(radial, e), across)));
        };
        add(gx, ex, nx, mx, sx), add(gy, ey, ny, my, sy), add(gz, ez, nz, mz, sz);
      }
    }
    hn::StoreU(w, d, sums[0] + i);
    if constexpr (kGradient)
      hn::StoreU(gx, d, sums[1] + i), hn::StoreU(gy, d, sums[2] + i), hn::StoreU(gz, d, sums[3] + i);
  }
}

void SumSources(const WindingNumber::NearSource* near, const std::pair<std::uint32_t, std::uint32_t>* ranges,
                std::size_t range_count, const WindingNumber::FarSource* far, const std::uint32_t* groups,
                std::size_t group_count, std::size_t n, const float* const* x, float* const* sums, bool gradients) {
  if (gradients)
    Sum<true>(near, ranges, range_count, far, groups, group_count, n, x, sums);
  else
    Sum<false>(near, ranges, range_count, far, groups, group_count, n, x, sums);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh {
namespace detail {
HWY_EXPORT(SumSources);

void sum_sources(const WindingNumber::NearSource* near, const std::pair<std::uint32_t, std::uint32_t>* ranges,
                 std::size_t range_count, const WindingNumber::FarSource* far, const std::uint32_t* groups,
                 std::size_t group_count, std::size_t n, const float* const* x, float* const* sums, bool gradients) {
  HWY_DYNAMIC_DISPATCH(SumSources)(near, ranges, range_count, far, groups, group_count, n, x, sums, gradients);
}
}  // namespace detail
namespace {

constexpr std::uint32_t kLeafPatches = 6;
// Radius of a patch's blur as a multiple of its size: neighbouring patches just merge into one smooth layer.
constexpr double kBlur = 0.8;
// A group counts as one beyond this multiple of its radius, measured from its farthest patch to the nearest point.
constexpr float kOpening = 3.0f;
// Blocks cover this multiple of the patches' ball; points outside of it are blocks of their own.
constexpr float kBlocksReach = 1.25f;
constexpr std::size_t kLanes = 16;  // points of a block are padded to a multiple of this: the widest vector in floats
constexpr std::size_t kBatch = 256;

bool usable(const OrientedPatches& p, std::size_t i) {
  return is_finite(p.positions[i]) && is_finite(p.normals[i]) && p.areas[i] > 0 && std::isfinite(p.areas[i]) &&
         p.sizes[i] > 0 && std::isfinite(p.sizes[i]);
}

/// Moments Σ a nᵢ, Σ a nᵢ uⱼ, Σ a nᵢ uⱼ uₖ of patches about a centre, u = position − centre.
struct Moments {
  Vec3 n;
  double m[3][3] = {};
  double t[3][3][3] = {};

  void add(const Vec3& dipole, const Vec3& u) {
    n += dipole;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        m[i][j] += dipole[i] * u[j];
        for (std::size_t k = 0; k < 3; ++k) t[i][j][k] += dipole[i] * u[j] * u[k];
      }
  }
};

/// 1/r is harmonic: only the symmetric traceless part of each moment is seen from outside.
WindingNumber::FarSource far_source(const Moments& all, const Vec3& center) {
  WindingNumber::FarSource far{};
  for (std::size_t i = 0; i < 3; ++i) {
    far.position[i] = static_cast<float>(center[i]);
    far.dipole[i] = static_cast<float>(all.n[i]);
  }
  double m[3][3], s[3][3][3];
  const double third = (all.m[0][0] + all.m[1][1] + all.m[2][2]) / 3;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      m[i][j] = -3 * (0.5 * (all.m[i][j] + all.m[j][i]) - (i == j ? third : 0));
      for (std::size_t k = 0; k < 3; ++k) s[i][j][k] = (all.t[i][j][k] + all.t[j][i][k] + all.t[k][i][j]) / 3;
    }
  const Vec3 trace{s[0][0][0] + s[1][1][0] + s[2][2][0], s[0][0][1] + s[1][1][1] + s[2][2][1],
                   s[0][0][2] + s[1][1][2] + s[2][2][2]};
  constexpr std::size_t kSecond[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  constexpr std::size_t kThird[10][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 0, 1}, {0, 0, 2},
                                         {0, 1, 1}, {1, 1, 2}, {0, 2, 2}, {1, 2, 2}, {0, 1, 2}};
  for (std::size_t e = 0; e < 6; ++e) far.second[e] = static_cast<float>(m[kSecond[e][0]][kSecond[e][1]]);
  for (std::size_t e = 0; e < 10; ++e) {
    const auto [i, j, k] = kThird[e];
    const double traces = (i == j ? trace[k] : 0) + (i == k ? trace[j] : 0) + (j == k ? trace[i] : 0);
    far.third[e] = static_cast<float>(7.5 * (s[i][j][k] - traces / 5));
  }
  return far;
}

}  // namespace

/// k-d tree with the longest side of the box halved by count; nodes in depth-first order.
struct WindingNumber::Builder {
  struct Item {
    Vec3 position, dipole;  // area · normal
    double blur;
  };
  std::vector<Item> items;
  WindingNumber& out;

  void node(std::uint32_t first, std::uint32_t last) {
    const auto self = static_cast<std::uint32_t>(out.nodes_.size());
    out.nodes_.push_back({{}, 0, first, last, 0});
    out.far_.emplace_back();
    Box3 box;
    Vec3 center;
    double weight = 0;
    for (std::uint32_t i = first; i < last; ++i) {
      const double area = norm(items[i].dipole);
      box.extend(items[i].position);
      center += items[i].position * area;
      weight += area;
    }
    center = Vec3(Vec3f(weight > 0 ? center / weight : box.center()));  // the moments belong to the rounded centre
    Moments moments;
    double radius = 0;
    for (std::uint32_t i = first; i < last; ++i) {
      moments.add(items[i].dipole * (0.25 / std::numbers::pi), items[i].position - center);
      radius = std::max(radius, norm(items[i].position - center) + 0.5 * items[i].blur);
    }
    out.far_[self] = far_source(moments, center);
    out.nodes_[self].center = Vec3f(center);
    out.nodes_[self].radius = static_cast<float>(radius);
    if (last - first <= kLeafPatches) return;
    const Vec3 size = box.size();
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(items.begin() + first, items.begin() + middle, items.begin() + last,
                     [axis](const Item& a, const Item& b) { return a.position[axis] < b.position[axis]; });
    node(first, middle);
    out.nodes_[self].right = static_cast<std::uint32_t>(out.nodes_.size());
    node(middle, last);
  }
};

/// What the points of a block are summed over, and room for their sums.
struct WindingNumber::Block {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> near;
  std::vector<std::uint32_t> far;
  std::vector<std::uint32_t> stack;
  std::array<std::array<float, kBatch>, 3> x;
  std::array<std::array<float, kBatch>, 4> sums;
};

WindingNumber::WindingNumber(const OrientedPatches& patches) {
  Box3 box;
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (usable(patches, i)) box.extend(Vec3(patches.positions[i]));
  if (box.empty()) return;
  center_ = box.center();
  scale_ = 0.5 * box.diagonal();
  if (!(scale_ > 0)) scale_ = patches.sizes[0];

  Builder builder{{}, *this};
  double log_size = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (!usable(patches, i)) continue;
    builder.items.push_back({Vec3(Vec3f((Vec3(patches.positions[i]) - center_) / scale_)),
                             Vec3(patches.normals[i]) * (patches.areas[i] / (scale_ * scale_)),
                             kBlur * patches.sizes[i] / scale_});
    log_size += std::log(patches.sizes[i] / scale_);
  }
  const auto n = static_cast<std::uint32_t>(builder.items.size());
  builder.node(0, n);
  near_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto& [position, dipole, blur] = builder.items[i];
    NearSource& p = near_[i];
    for (std::size_t k = 0; k < 3; ++k) {
      p.position[k] = static_cast<float>(position[k]);
      p.dipole[k] = static_cast<float>(dipole[k] * (0.25 / std::numbers::pi));
    }
    p.inverse2 = static_cast<float>(1 / (blur * blur));
    p.inverse3 = static_cast<float>(1 / (blur * blur * blur));
  }
  block_edge_ = static_cast<float>(std::clamp(3 * std::exp(log_size / n), 1.0 / 64, 0.25));
}

void WindingNumber::collect(const Vec3f& center, float radius, Block& block) const {
  block.near.clear();
  block.far.clear();
  block.stack.assign(1, 0);
  while (!block.stack.empty()) {
    const std::uint32_t index = block.stack.back();
    block.stack.pop_back();
    const Node& node = nodes_[index];
    const float distance = norm(node.center - center) - radius;
    // Few patches cost less one by one than as a group.
    if (distance > kOpening * node.radius && node.last - node.first > 2) {
      block.far.push_back(index);
    } else if (node.right == 0) {
      if (!block.near.empty() && block.near.back().second == node.first)
        block.near.back().second = node.last;
      else
        block.near.emplace_back(node.first, node.last);
    } else {
      block.stack.push_back(node.right);
      block.stack.push_back(index + 1);
    }
  }
}

void WindingNumber::evaluate(std::span<const Vec3f> x, std::span<float> w, std::span<Vec3f> gradients) const {
  if (w.size() != x.size() || (!gradients.empty() && gradients.size() != x.size()))
    throw ArgumentError("WindingNumber::evaluate: " + std::to_string(x.size()) + " points, but room for " +
                        std::to_string(w.size()) + " values and " + std::to_string(gradients.size()) + " gradients");
  std::fill(w.begin(), w.end(), 0.0f);
  std::fill(gradients.begin(), gradients.end(), Vec3f{});
  if (empty()) return;

  const int blocks = static_cast<int>(std::ceil(2 * kBlocksReach / block_edge_));
  int bits = 1;
  while (1 << bits < blocks) ++bits;
  const std::uint64_t alone = std::uint64_t{1} << 3 * bits, nowhere = alone + 1;
  const double to_unit = 1 / scale_;
  const auto unit = [&](std::size_t i) { return Vec3f((Vec3(x[i]) - center_) * to_unit); };
  std::vector<KeyIndex> order(x.size());
  parallel_for(0, x.size(), 1 << 14, [&](std::size_t i) {
    const Vec3f p = unit(i);
    std::uint64_t key = nowhere;
    if (is_finite(p)) {
      const bool covered = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < kBlocksReach;
      const auto block = [&](float v) { return static_cast<std::uint64_t>((v + kBlocksReach) / block_edge_); };
      key = covered ? detail::morton_key(block(p.x), block(p.y), block(p.z)) : alone;
    }
    order[i] = {key, static_cast<unsigned>(i)};
  });
  detail::sort_by_key(order, 3 * bits + 1);
  while (!order.empty() && order.back().key == nowhere) order.pop_back();
  std::vector<std::uint32_t> starts;
  for (std::uint32_t i = 0; i < order.size(); ++i)
    if (i == 0 || order[i].key != order[i - 1].key || order[i].key == alone) starts.push_back(i);
  if (starts.empty()) return;
  starts.push_back(static_cast<std::uint32_t>(order.size()));

  parallel_ranges(0, starts.size() - 1, 8, [&](std::size_t first, std::size_t last) {
    Block block;
    const float* const points[3] = {block.x[0].data(), block.x[1].data(), block.x[2].data()};
    float* const sums[4] = {block.sums[0].data(), block.sums[1].data(), block.sums[2].data(), block.sums[3].data()};
    for (std::size_t b = first; b < last; ++b) {
      const std::uint64_t key = order[starts[b]].key;
      if (key == alone) {
        collect(unit(order[starts[b]].index), 0, block);
      } else {
        const auto middle = [&](std::uint64_t k) {
          return (static_cast<float>(detail::gather_bits(k)) + 0.5f) * block_edge_ - kBlocksReach;
        };
        collect({middle(key), middle(key >> 1), middle(key >> 2)}, 0.8661f * block_edge_, block);
      }
      for (std::size_t begin = starts[b]; begin < starts[b + 1]; begin += kBatch) {
        const std::size_t n = std::min<std::size_t>(kBatch, starts[b + 1] - begin);
        for (std::size_t i = 0; i < (n + kLanes - 1) / kLanes * kLanes; ++i) {
          const Vec3f p = unit(order[begin + std::min(i, n - 1)].index);
          for (std::size_t k = 0; k < 3; ++k) block.x[k][i] = p[k];
        }
        detail::sum_sources(near_.data(), block.near.data(), block.near.size(), far_.data(), block.far.data(),
                            block.far.size(), n, points, sums, !gradients.empty());
        for (std::size_t i = 0; i < n; ++i) {
          const std::uint32_t at = order[begin + i].index;
          w[at] = block.sums[0][i];
          if (!gradients.empty())
            gradients[at] = Vec3f(Vec3{block.sums[1][i], block.sums[2][i], block.sums[3][i]} * to_unit);
        }
      }
    }
  });
}

double winding_number_direct(const OrientedPatches& patches, const Vec3& x) {
  double w = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (!usable(patches, i)) continue;
    const Vec3 d = Vec3(patches.positions[i]) - x;
    const double r = norm(d), blur = kBlur * patches.sizes[i], s = r / blur;
    const double f = s < 1 ? (2.5 - 1.5 * s * s) / (blur * blur * blur) : 1 / (r * r * r);
    w += patches.areas[i] * dot(d, Vec3(patches.normals[i])) * f;
  }
  return w / (4 * std::numbers::pi);
}

}  // namespace sansmesh
#endif
