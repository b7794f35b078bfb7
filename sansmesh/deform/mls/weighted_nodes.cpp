#include "sansmesh/deform/mls/weighted_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/simd_targets.h"
// After simd_targets.h, which defines the instruction sets of the library.
#include "sansmesh/deform/mls/weight_power-inl.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::size_t kDetourPoints = 17;  // points along a segment at which detours are computed
/// Gauss–Legendre rule of 12 nodes on −1..1: its positive half.
constexpr std::size_t kHalfRule = 6;
constexpr std::array<double, kHalfRule> kRuleAt{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                                                0.7699026741943047, 0.9041172563704749, 0.9815606342467192};
constexpr std::array<double, kHalfRule> kRuleWeight{0.2491470458134028, 0.2334925365383548, 0.2031674267230659,
                                                    0.1600783285433462, 0.1069393259953184, 0.0471753363865118};
/// Length of the panels that one rule covers, for alpha up to 1; beyond, peaks are narrower by the square root of
/// alpha.
constexpr double kPanel = 2;
constexpr std::size_t kMostPanels = 4096;  // above the number for the longest segment at the smallest distance
/// Upper limit of the weight of directions at their own handle, in units of 1 / reach^(2 alpha): beyond it they would
/// suppress the other handles' contribution to the rotation.
constexpr double kMostOfDirection = 1e8;

/// Points closer to a segment than this fraction of its length are on it: weights differ so much there that rounding
/// would determine everything but the position.
double on_segment(double alpha) { return alpha <= 2 ? 1e-15 : 1e-13 * std::pow(10.0, 0.6 * (alpha - 3)); }

struct NearSegment {
  double at = 0;      ///< fraction of the line's point nearest to x, not clamped
  double square = 0;  ///< squared distance from the line
};
NearSegment near_line(const DeformHandle& h, const Vec3& x) {
  const Vec3 from = x - h.q;
  NearSegment near;
  near.at = dot(from, h.along_q) / squared_norm(h.along_q);
  near.square = squared_norm(from - h.along_q * near.at);
  return near;
}

/// Linear interpolation of detours at equidistant points of a segment.
Detour mixed(const std::array<Detour, kDetourPoints>& detours, double t) {
  const double at = t * (kDetourPoints - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), kDetourPoints - 2);
  const double f = at - static_cast<double>(k);
  const Detour &a = detours[k], &b = detours[k + 1];
  return {a.extra * (1 - f) + b.extra * f, a.gradient * (1 - f) + b.gradient * f};
}

/// Data shared by all nodes of a handle.
struct NodeMaker {
  const DeformSetup& setup;
  std::span<const std::shared_ptr<const Occluder>> cuts;
  const Vec3& x;
  double unit;  ///< squared distance at which weights are 1
  NodesFrom& found;

  /// `square` is the squared distance, raised slightly if close to 0.
  void add(const DeformHandle& h, const Vec3& q, const Vec3& p, double share, double square, const Detour& detour) {
    const double alpha = setup.options.alpha;
    const Vec3 from = x - q;
    double damped = 1;
    Vec3 damping_slope;
    if (detour.extra > 0) {
      const double d = std::sqrt(square), e = setup.options.damping * detour.extra, sum = d + e;
      damped = d / sum;
      damping_slope = (from * (e / d) - detour.gradient * (setup.options.damping * d)) / (sum * sum);
    }
    const auto node = [&](const Vec3& at, const Vec3& comes_from, double part, double distance2) {
      const double w = part * share * h.weight * weight_power(unit / distance2, alpha);
      WeightedNode n{at, comes_from, w * damped, {}};
      n.slope = from * (-2 * alpha * n.weight / distance2) + damping_slope * w;
      found.nodes.push_back(n);
    };
    node(q, p, 1, square);
    if (h.directions.empty()) return;
    const double soft = h.reach * h.reach * std::pow(kMostOfDirection, -1 / alpha);
    for (const TurnedDirection& d : h.directions)
      for (const double side : {-1.0, 1.0})
        node(q + d.after * (side * h.reach), p + d.before * (side * h.reach), 0.5, square + soft);
  }

  void add_point(const DeformHandle& h, const Detour& detour) {
    const double square = squared_norm(x - h.q);
    if (square <= std::pow(rounding_of(x, h.q), 2)) found.held = h.p;
    add(h, h.q, h.p, 1, std::max(square, setup.floor_square), detour);
  }

  // With t = t0 + (h / L) sinh s, h the distance from the line, the weight (h² + L² (t − t0)²)^−alpha dt and its
  // moments are smooth functions of s whose poles are π/2 away from the real line for any x.
  void add_segment(const DeformHandle& h, std::vector<Detour>& scratch) {
    const double length = norm(h.along_q);
    NearSegment near = near_line(h, x);
    const double clamped = std::clamp(near.at, 0.0, 1.0);
    const Vec3 nearest = h.q + h.along_q * clamped;
    if (norm(x - nearest) <= std::max(2 * rounding_of(x, nearest), on_segment(setup.options.alpha) * length))
      found.held = h.p + h.along_p * clamped;
    near.square = std::max(near.square, std::pow(on_segment(setup.options.alpha) * length, 2));
    const double ratio = std::sqrt(near.square) / length;
    const double first = std::asinh(-near.at / ratio), last = std::asinh((1 - near.at) / ratio);
    const auto panels = index_in<std::size_t>(
        std::ceil((last - first) * std::sqrt(std::max(1.0, setup.options.alpha)) / kPanel), 1, kMostPanels);
    const double half = (last - first) / 2 / static_cast<double>(panels);
    // Detours from a few points, the same for all x, because cuts may cache data per point.
    std::array<Detour, kDetourPoints> detours;
    if (!cuts.empty())
      for (std::size_t k = 0; k < kDetourPoints; ++k)
        add_detours(cuts, h.q + h.along_q * (static_cast<double>(k) / (kDetourPoints - 1)), {&x, 1}, {&detours[k], 1},
                    scratch);
    for (std::size_t panel = 0; panel < panels; ++panel) {
      const double middle = first + half * static_cast<double>(2 * panel + 1);
      for (std::size_t k = 0; k < 2 * kHalfRule; ++k) {
        const double side = k < kHalfRule ? -1 : 1;
        const std::size_t r = k < kHalfRule ? kHalfRule - 1 - k : k - kHalfRule;
        const double s = middle + side * half * kRuleAt[r];
        const double offset = ratio * std::sinh(s), t = std::clamp(near.at + offset, 0.0, 1.0);
        const Vec3 q = h.q + h.along_q * t;
        const Detour detour = cuts.empty() ? Detour{} : mixed(detours, t);
        add(h, q, h.p + h.along_p * t, kRuleWeight[r] * half * ratio * std::cosh(s),
            near.square + offset * offset * length * length, detour);
      }
    }
  }
};

}  // namespace

HWY_ATTR double weight_power(double base, double alpha) {
  using One = hwy::HWY_NAMESPACE::CappedTag<double, 1>;
  return hwy::HWY_NAMESPACE::GetLane(HWY_NAMESPACE::WeightPower(hwy::HWY_NAMESPACE::Set(One(), base), alpha));
}

double rounding_of(const Vec3& x, const Vec3& q) {
  return 2 * std::numeric_limits<double>::epsilon() *
         std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z), std::abs(q.x), std::abs(q.y), std::abs(q.z)});
}

void add_detours(std::span<const std::shared_ptr<const Occluder>> cuts, const Vec3& from, std::span<const Vec3> x,
                 std::span<Detour> sums, std::vector<Detour>& scratch) {
  scratch.resize(x.size());
  for (const auto& cut : cuts) {
    cut->detours(from, x, scratch);
    for (std::size_t i = 0; i < x.size(); ++i)
      sums[i].extra += scratch[i].extra, sums[i].gradient += scratch[i].gradient;
  }
}

void gather_nodes(const DeformSetup& setup, std::span<const std::shared_ptr<const Occluder>> cuts,
                  std::span<const Detour> detours, const Vec3& x, NodesFrom& found) {
  found.nodes.clear(), found.held.reset();
  double unit = std::numeric_limits<double>::infinity();
  for (const DeformHandle& h : setup.handles) {
    Vec3 q = h.q;
    if (h.segment) q += h.along_q * std::clamp(near_line(h, x).at, 0.0, 1.0);
    unit = std::min(unit, squared_norm(x - q));
  }
  NodeMaker make{setup, cuts, x, std::max(unit, setup.floor_square), found};
  std::vector<Detour> scratch;
  for (std::size_t i = 0; i < setup.handles.size(); ++i) {
    const DeformHandle& h = setup.handles[i];
    if (h.segment) {
      make.add_segment(h, scratch);
    } else {
      make.add_point(h, detours.empty() ? Detour{} : detours[i]);
    }
  }
  found.heaviest = 0;
  for (std::size_t i = 1; i < found.nodes.size(); ++i)
    if (found.nodes[i].weight > found.nodes[found.heaviest].weight) found.heaviest = i;
}

}  // namespace sansmesh::inline v1::detail
