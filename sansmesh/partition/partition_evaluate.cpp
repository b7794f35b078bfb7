// Batches of points against the supports that reach them: gather supports with the box tree, then SIMD over points.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/partition_evaluate.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/partition_state.h"
#include "sansmesh/partition/sample_tree.h"

#ifndef SANSMESH_PARTITION_EVALUATE_ONCE
#define SANSMESH_PARTITION_EVALUATE_ONCE
namespace sansmesh {
/// Up to kTile points and the sums over supports at each: structure of arrays, aligned for the widest vectors.
struct EvaluationTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) float x[kTile], y[kTile], z[kTile];
  alignas(64) float weight[kTile], value[kTile];      // Σ θ, Σ θ f
  alignas(64) float gx[kTile], gy[kTile], gz[kTile];  // Σ (θ ∇f + f ∇θ)
  alignas(64) float wx[kTile], wy[kTile], wz[kTile];  // Σ ∇θ
};
}  // namespace sansmesh
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Value of one local function (and gradient if kGradient) at offsets d from its centre.
template <bool kGradient, class D, class V = hn::Vec<D>>
HWY_INLINE void Local(D d, const LocalFunction& f, V dx, V dy, V dz, V& value, V& gx, V& gy, V& gz) {
  const auto inv = hn::Set(d, 1.0f / f.scale);
  dx = hn::Mul(dx, inv), dy = hn::Mul(dy, inv), dz = hn::Mul(dz, inv);
  const auto along = [&](const Vec3f& a) HWY_ATTR {
    return hn::MulAdd(dx, hn::Set(d, a.x), hn::MulAdd(dy, hn::Set(d, a.y), hn::Mul(dz, hn::Set(d, a.z))));
  };
  const V u = along(f.xi), v = along(f.eta), w = along(f.nu);
  const float* c = f.coefficient.data();
  const auto K = [&](int i) HWY_ATTR { return hn::Set(d, c[i]); };
  // g = a0(v) + u (a1(v) + u (a2(v) + …)): Horner in u of Horners in v.
  V g, gu = hn::Zero(d), gv = hn::Zero(d);
  const auto mad = [](V a, V b, V e) HWY_ATTR { return hn::MulAdd(a, b, e); };
  if (f.degree <= 2) {
    const V a0 = mad(v, mad(v, K(5), K(2)), K(0));
    const V a1 = mad(v, K(4), K(1));
    g = mad(u, mad(u, K(3), a1), a0);
    if (kGradient) {
      gu = mad(u, hn::Set(d, 2 * c[3]), a1);
      gv = mad(u, K(4), mad(v, hn::Set(d, 2 * c[5]), K(2)));
    }
  } else {
    const V a0 = mad(v, mad(v, mad(v, mad(v, K(14), K(9)), K(5)), K(2)), K(0));
    const V a1 = mad(v, mad(v, mad(v, K(13), K(8)), K(4)), K(1));
    const V a2 = mad(v, mad(v, K(12), K(7)), K(3));
    const V a3 = mad(v, K(11), K(6));
    g = mad(u, mad(u, mad(u, mad(u, K(10), a3), a2), a1), a0);
    if (kGradient) {
      const auto two = hn::Set(d, 2.0f), three = hn::Set(d, 3.0f);
      gu = mad(u, mad(u, mad(u, hn::Set(d, 4 * c[10]), hn::Mul(three, a3)), hn::Mul(two, a2)), a1);
      const V b0 = mad(v, mad(v, mad(v, hn::Set(d, 4 * c[14]), hn::Set(d, 3 * c[9])), hn::Set(d, 2 * c[5])), K(2));
      const V b1 = mad(v, mad(v, hn::Set(d, 3 * c[13]), hn::Set(d, 2 * c[8])), K(4));
      const V b2 = mad(v, hn::Set(d, 2 * c[12]), K(7));
      gv = mad(u, mad(u, mad(u, K(11), b2), b1), b0);
    }
  }
  value = hn::Mul(hn::Sub(w, g), hn::Set(d, f.scale));
  if (kGradient) {
    const auto back = [&](float n, float x, float e) HWY_ATTR {
      return hn::NegMulAdd(gu, hn::Set(d, x), hn::NegMulAdd(gv, hn::Set(d, e), hn::Set(d, n)));
    };
    gx = back(f.nu.x, f.xi.x, f.eta.x);
    gy = back(f.nu.y, f.xi.y, f.eta.y);
    gz = back(f.nu.z, f.xi.z, f.eta.z);
  }
}

template <bool kGradient>
void SumSupportsT(const LocalFunction* functions, const std::uint32_t* list, std::size_t count, std::size_t n,
                  EvaluationTile& tile) {
  const hn::ScalableTag<float> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (std::size_t i = 0; i < n; i += lanes) {
    const V x = hn::Load(d, tile.x + i), y = hn::Load(d, tile.y + i), z = hn::Load(d, tile.z + i);
    V weight = zero, value = zero, gx = zero, gy = zero, gz = zero, wx = zero, wy = zero, wz = zero;
    for (std::size_t s = 0; s < count; ++s) {
      const LocalFunction* f = functions + list[s];
      const V dx = hn::Sub(x, hn::Set(d, f->center.x)), dy = hn::Sub(y, hn::Set(d, f->center.y)),
              dz = hn::Sub(z, hn::Set(d, f->center.z));
      const float inverse = 1.0f / (f->radius * f->radius);
      const V t = hn::Mul(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), hn::Set(d, inverse));
      const auto in = hn::Lt(t, one);
      if (hn::AllFalse(d, in)) continue;
      const V q = hn::IfThenElseZero(in, hn::Sub(one, t));
      const V q2 = hn::Mul(q, q);
      const V theta = hn::Mul(q2, q2);
      V fv, fx = zero, fy = zero, fz = zero;
      Local<kGradient>(d, *f, dx, dy, dz, fv, fx, fy, fz);
      for (const LocalFunction* g = f; g->next != 0;) {
        const bool convex = g->convex != 0;
        g = functions + (g->next - 1);
        V hv, hx = zero, hy = zero, hz = zero;
        Local<kGradient>(d, *g, dx, dy, dz, hv, hx, hy, hz);
        const auto take = convex ? hn::Gt(hv, fv) : hn::Lt(hv, fv);
        fv = hn::IfThenElse(take, hv, fv);
        if (kGradient)
          fx = hn::IfThenElse(take, hx, fx), fy = hn::IfThenElse(take, hy, fy), fz = hn::IfThenElse(take, hz, fz);
      }
      weight = hn::Add(weight, theta);
      value = hn::MulAdd(theta, fv, value);
      if (kGradient) {
        // ∇θ = −8 (1 − t)³ d / R²
        const V slope = hn::Mul(hn::Mul(q2, q), hn::Set(d, -8.0f * inverse));
        const V tx = hn::Mul(slope, dx), ty = hn::Mul(slope, dy), tz = hn::Mul(slope, dz);
        wx = hn::Add(wx, tx), wy = hn::Add(wy, ty), wz = hn::Add(wz, tz);
        gx = hn::MulAdd(theta, fx, hn::MulAdd(fv, tx, gx));
        gy = hn::MulAdd(theta, fy, hn::MulAdd(fv, ty, gy));
        gz = hn::MulAdd(theta, fz, hn::MulAdd(fv, tz, gz));
      }
    }
    hn::Store(weight, d, tile.weight + i), hn::Store(value, d, tile.value + i);
    if (kGradient) {
      hn::Store(gx, d, tile.gx + i), hn::Store(gy, d, tile.gy + i), hn::Store(gz, d, tile.gz + i);
      hn::Store(wx, d, tile.wx + i), hn::Store(wy, d, tile.wy + i), hn::Store(wz, d, tile.wz + i);
    }
  }
}

void SumSupports(const LocalFunction* functions, const std::uint32_t* list, std::size_t count, std::size_t n,
                 bool gradient, EvaluationTile& tile) {
  if (gradient) {
    SumSupportsT<true>(functions, list, count, n, tile);
  } else {
    SumSupportsT<false>(functions, list, count, n, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh {
HWY_EXPORT(SumSupports);

void SupportTree::build(std::span<const LocalFunction> functions) {
  levels.assign(1, {});
  levels[0].reserve(functions.size());
  for (const LocalFunction& f : functions) {
    const Vec3f r{f.radius, f.radius, f.radius};
    levels[0].push_back({f.center - r, f.center + r});
  }
  while (levels.back().size() > 1) {
    const auto& below = levels.back();
    std::vector<Box3f> above((below.size() + 7) / 8);
    for (std::size_t i = 0; i < below.size(); ++i) above[i / 8].extend(below[i]);
    levels.push_back(std::move(above));
  }
}

bool SupportTree::query(const Box3f& box, std::size_t most, std::vector<std::uint32_t>& found) const {
  const auto meets = [&](const Box3f& b) {
    return b.lower.x <= box.upper.x && b.upper.x >= box.lower.x && b.lower.y <= box.upper.y &&
           b.upper.y >= box.lower.y && b.lower.z <= box.upper.z && b.upper.z >= box.lower.z;
  };
  struct Item {
    std::uint32_t level, index;
  };
  Item stack[128];
  std::size_t top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  while (top > 0) {
    const Item item = stack[--top];
    if (!meets(levels[item.level][item.index])) continue;
    if (item.level == 0) {
      if (found.size() == most) return false;
      found.push_back(item.index);
      continue;
    }
    const std::size_t count = levels[item.level - 1].size();
    const std::uint32_t first = item.index * 8;
    const auto last = static_cast<std::uint32_t>(std::min<std::size_t>(first + 8, count));
    for (std::uint32_t k = last; k-- > first;) stack[top++] = {item.level - 1, k};
  }
  return true;
}

PartitionOfUnity::PartitionOfUnity(PartitionData data) : state_(std::make_shared<State>()) {
  state_->data = std::move(data);
  const PartitionData& d = state_->data;
  state_->tree.build(d.functions.view().first(d.supports.size()));
  // Each support's surface patch within its own block: together they tile the surface, and decide inside and outside
  // where no support reaches.
  std::vector<OrientedPatch> patches(d.supports.size());
  parallel_for(0, patches.size(), 8192, [&](std::size_t i) {
    patches[i] = {d.supports[i].foot, d.functions[i].nu * d.supports[i].area};
  });
  state_->sign = GlobalSign(patches, d.edge);
}

Box3 PartitionOfUnity::bounds() const {
  const Vec3 lower = state_->data.origin + Vec3(state_->data.lower);
  const double e = state_->data.edge;
  return {lower, lower + Vec3{e, e, e}};
}
const PartitionData& PartitionOfUnity::data() const { return state_->data; }

namespace {

// Where the supports' weights fade below this, the far field takes over, smoothly.
constexpr float kFade = 0.05f;

void evaluate_tile(const PartitionOfUnity::State& s, std::span<const Vec3f> x, std::span<float> values,
                   std::span<Vec3f> gradients, std::vector<std::uint32_t>& list, EvaluationTile& tile) {
  Box3f box;
  for (const Vec3f& p : x) box.extend(p);
  list.clear();
  // Lists longer than this are a sign of points too far apart to share one.
  const std::size_t most = x.size() > 8 ? 96 : x.size() > 1 ? 1024 : s.data.supports.size();
  if (!s.tree.query(box, most, list)) {
    const std::size_t half = x.size() / 2;
    const bool g = !gradients.empty();
    evaluate_tile(s, x.first(half), values.first(half), g ? gradients.first(half) : gradients, list, tile);
    evaluate_tile(s, x.subspan(half), values.subspan(half), g ? gradients.subspan(half) : gradients, list, tile);
    return;
  }
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < EvaluationTile::kTile; ++i) {
    const Vec3f& p = x[std::min(i, n - 1)];
    tile.x[i] = p.x, tile.y[i] = p.y, tile.z[i] = p.z;
  }
  HWY_DYNAMIC_DISPATCH(SumSupports)
  (s.data.functions.data(), list.data(), list.size(), n, !gradients.empty(), tile);

  Vec3f far_x[EvaluationTile::kTile];
  std::size_t far_i[EvaluationTile::kTile], far_count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float w = tile.weight[i];
    if (w > 0) {
      values[i] = tile.value[i] / w;
      if (!gradients.empty()) {
        gradients[i] = Vec3f{tile.gx[i] - values[i] * tile.wx[i], tile.gy[i] - values[i] * tile.wy[i],
                             tile.gz[i] - values[i] * tile.wz[i]} *
                       (1 / w);
      }
    }
    if (w < kFade) {
      far_x[far_count] = x[i];
      far_i[far_count++] = i;
    }
  }
  if (far_count == 0) return;
  float far_values[EvaluationTile::kTile];
  const float step = 1e-4f * s.data.edge;
  s.sign.signed_distance(std::span<const Vec3f>(far_x, far_count), std::span<float>(far_values, far_count));
  float stepped[3][EvaluationTile::kTile];
  if (!gradients.empty()) {
    for (int k = 0; k < 3; ++k) {
      Vec3f moved[EvaluationTile::kTile];
      for (std::size_t j = 0; j < far_count; ++j) moved[j] = far_x[j], moved[j][static_cast<std::size_t>(k)] += step;
      s.sign.signed_distance(std::span<const Vec3f>(moved, far_count), std::span<float>(stepped[k], far_count));
    }
  }
  for (std::size_t j = 0; j < far_count; ++j) {
    const std::size_t i = far_i[j];
    const float w = tile.weight[i];
    const float t = w / kFade, a = t * t * (3 - 2 * t);
    const float near = w > 0 ? values[i] : far_values[j];
    values[i] = far_values[j] + a * (near - far_values[j]);
    if (gradients.empty()) continue;
    const Vec3f far_gradient{(stepped[0][j] - far_values[j]) / step, (stepped[1][j] - far_values[j]) / step,
                             (stepped[2][j] - far_values[j]) / step};
    if (w > 0) {
      const Vec3f slope = Vec3f{tile.wx[i], tile.wy[i], tile.wz[i]} * (6 * t * (1 - t) / kFade);
      gradients[i] = far_gradient + (gradients[i] - far_gradient) * a + slope * (near - far_values[j]);
    } else {
      gradients[i] = far_gradient;
    }
  }
}

}  // namespace

void PartitionOfUnity::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  const State& s = *state_;
  const PartitionData& data = s.data;
  const std::size_t n = x.size();
  constexpr std::size_t kTile = EvaluationTile::kTile;
  const auto local = [&](std::size_t i) { return Vec3f(x[i] - data.origin); };

  // Neighbours in space must be neighbours in a tile. Input that is already ordered that way is taken as it is.
  std::vector<std::uint32_t> order;
  const auto code = [&](std::size_t i) {
    const Vec3f p = (local(i) - data.lower) * (1024.0f / data.edge);
    const auto clamp = [](float v) { return static_cast<std::uint32_t>(v > 0 ? std::min(v, 1023.0f) : 0); };
    return morton_code(clamp(p.x), clamp(p.y), clamp(p.z));
  };
  if (n > kTile) {
    std::size_t jumps = 0;
    for (std::size_t i = 0; i + 17 < n; i += 16) jumps += code(i) >> 9 != code(i + 1) >> 9;
    if (jumps * 16 > n / 4) {
      std::vector<KeyIndex> keys(n);
      parallel_for(0, n, 8192, [&](std::size_t i) { keys[i] = {code(i), static_cast<unsigned>(i)}; });
      parallel_sort(keys);
      order.resize(n);
      for (std::size_t i = 0; i < n; ++i) order[i] = keys[i].index;
    }
  }
  const auto at = [&](std::size_t i) { return order.empty() ? i : order[i]; };
  parallel_ranges(0, (n + kTile - 1) / kTile, 16, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> list;
    EvaluationTile tile;
    Vec3f px[kTile], gradient[kTile];
    float value[kTile];
    for (std::size_t t = first; t < last; ++t) {
      const std::size_t base = t * kTile, m = std::min(kTile, n - base);
      for (std::size_t i = 0; i < m; ++i) px[i] = local(at(base + i));
      evaluate_tile(s, {px, m}, {value, m}, gradients.empty() ? std::span<Vec3f>{} : std::span<Vec3f>(gradient, m),
                    list, tile);
      for (std::size_t i = 0; i < m; ++i) {
        values[at(base + i)] = value[i];
        if (!gradients.empty()) gradients[at(base + i)] = Vec3(gradient[i]);
      }
    }
  });
}

std::vector<Vec3> PartitionOfUnity::seeds() const {
  const PartitionData& d = state_->data;
  std::vector<Vec3> result(d.supports.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = d.origin + Vec3(d.supports[i].foot);
  return result;
}

BlockTree PartitionOfUnity::mesh_blocks(double mesh_error, int deepest) const {
  const PartitionData& s = state_->data;
  BlockTree tree(s.origin + Vec3(s.lower), s.edge);
  struct Item {
    std::size_t block;
    int level;
    std::uint32_t cell;  // in flatness[level]
  };
  const int last = static_cast<int>(s.flatness.size()) - 1;
  std::vector<Item> stack{{0, 0, 0}};
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const PartitionData::Flatness& here = s.flatness[static_cast<std::size_t>(item.level)];
    if (here.gap[item.cell] <= mesh_error || item.level >= deepest) continue;
    const std::size_t first = tree.subdivide(item.block);
    if (item.level == last) continue;  // the samples say nothing about finer scales
    const PartitionData::Flatness& below = s.flatness[static_cast<std::size_t>(item.level) + 1];
    for (std::uint32_t c = here.child[item.cell]; c < here.child[item.cell + 1]; ++c)
      stack.push_back({first + (below.code[c] & 7), item.level + 1, c});
  }
  return tree;
}

}  // namespace sansmesh
#endif
