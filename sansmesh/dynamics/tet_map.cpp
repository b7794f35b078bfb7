#include "sansmesh/dynamics/tet_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/tet_geometry.h"
#include "sansmesh/error.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/search/space_order.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMapRange = 512;  ///< points per task
constexpr double kOnFace = 1e-12;       ///< a barycentric coordinate above −kOnFace counts as not negative

Box3f float_box(const Box3& box, const Vec3& origin) {
  const Vec3 lower = box.lower - origin, upper = box.upper - origin;
  Box3f around{Vec3f(lower), Vec3f(upper)};
  constexpr float kEnd = std::numeric_limits<float>::infinity();
  // Two steps outward: one for the rounding of the box, one for that of a point in it.
  for (std::size_t k = 0; k < 3; ++k) {
    for (int step = 0; step < 2; ++step) {
      around.lower[k] = std::nextafter(around.lower[k], -kEnd), around.upper[k] = std::nextafter(around.upper[k], kEnd);
    }
  }
  return around;
}

/// Bit mask of the children whose boxes contain q.
std::uint32_t holding(const BoxNode& node, const Vec3f& q) {
  std::uint32_t found = 0;
  for (std::size_t c = 0; c < kTreeWidth; ++c) {
    const bool inside = (node.lower[0][c] <= q.x) & (node.upper[0][c] >= q.x) & (node.lower[1][c] <= q.y) &
                        (node.upper[1][c] >= q.y) & (node.lower[2][c] <= q.z) & (node.upper[2][c] >= q.z);
    found |= static_cast<std::uint32_t>(inside) << c;
  }
  return found;
}

bool overlap(const BoxNode& node, std::size_t c, const Box3f& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(node.lower[k][c] <= box.upper[k] && node.upper[k][c] >= box.lower[k])) return false;
  }
  return true;
}

bool within(const BoxNode& node, std::size_t c, const Box3f& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(node.lower[k][c] >= box.lower[k] && node.upper[k][c] <= box.upper[k])) return false;
  }
  return true;
}

}  // namespace

struct TetMap::State {
  /// The affine map of a tetrahedron and its domain.
  struct Affine {
    Vec3 corner;                    ///< in `from`
    std::array<Vec3, 3> gradients;  ///< gradients of the barycentric coordinates of corners 1 to 3
    Vec3 image;                     ///< image of the corner
    Jacobian jacobian;
    Box3 from, to;  ///< bounds of its corners
    std::uint32_t number = kNowhere;
  };
  Vec3 origin;
  std::vector<Affine> affines;            ///< in spatial order
  BoxLevels levels;                       ///< over `from`, relative to the origin
  std::vector<std::vector<Box3>> images;  ///< bounds of the images below each lane of the levels

  const Affine* find(const Vec3& x) const;
  void look(std::size_t level, std::size_t node, const Vec3& x, const Vec3f& q, const Affine*& best) const;
  void gather(std::size_t level, std::size_t node, const Box3& box, const Box3f& around, Box3& found) const;
};

void TetMap::State::look(std::size_t level, std::size_t node, const Vec3& x, const Vec3f& q,
                         const Affine*& best) const {
  for (std::uint32_t hits = holding(levels[level][node], q); hits; hits &= hits - 1) {
    const std::size_t child = node * kTreeWidth + static_cast<std::size_t>(std::countr_zero(hits));
    if (level > 0) {
      look(level - 1, child, x, q, best);
      continue;
    }
    const Affine& a = affines[child];
    if (best && best->number < a.number) continue;
    const Vec3 d = x - a.corner;
    const double u = dot(a.gradients[0], d), v = dot(a.gradients[1], d), w = dot(a.gradients[2], d);
    if (u >= -kOnFace && v >= -kOnFace && w >= -kOnFace && u + v + w <= 1 + kOnFace) best = &a;
  }
}

const TetMap::State::Affine* TetMap::State::find(const Vec3& x) const {
  const Affine* best = nullptr;
  if (is_finite(x)) look(levels.size() - 1, 0, x, Vec3f(x - origin), best);
  return best;
}

void TetMap::State::gather(std::size_t level, std::size_t node, const Box3& box, const Box3f& around,
                           Box3& found) const {
  const BoxNode& lanes = levels[level][node];
  for (std::size_t c = 0; c < kTreeWidth; ++c) {
    const std::size_t child = node * kTreeWidth + c;
    if (!overlap(lanes, c, around) || child >= images[level].size()) continue;
    if (within(lanes, c, around)) {
      found.extend(images[level][child]);
    } else if (level > 0) {
      gather(level - 1, child, box, around, found);
    } else {
      // Image of the intersection of the box and the tetrahedron's bounds, clipped to the tetrahedron's image.
      const Affine& a = affines[child];
      const Box3 part = common_part(box, a.from);
      if (part.empty()) continue;
      Box3 image;
      for (int k = 0; k < 8; ++k) {
        const Vec3 d = box_corner(part, k) - a.corner;
        image.extend(a.image + a.jacobian[0] * d.x + a.jacobian[1] * d.y + a.jacobian[2] * d.z);
      }
      found.extend(common_part(image, a.to));
    }
  }
}

TetMap::TetMap(std::span<const Tet> tets, std::span<const Vec3> from, std::span<const Vec3> to) {
  check_argument(from.size() == to.size(), "`from` and `to` must have equal numbers of positions");
  auto state = std::make_unique<State>();
  std::vector<Vec3> centers(tets.size());
  Box3 whole;
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (const std::uint32_t v : tets[t]) {
      check_argument(v < from.size(), "a tetrahedron has a vertex without a position");
      centers[t] += from[v] * 0.25;
      if (is_finite(from[v])) whole.extend(from[v]);
    }
    if (!is_finite(centers[t])) throw DataError("tetrahedra have positions that are not finite");
  }
  if (!whole.empty()) state->origin = whole.center();
  for (const std::uint32_t t : space_order(centers)) {
    const Tet& c = tets[t];
    const TetGradients shape = tet_gradients(c, from);
    const double size = norm(from[c[1]] - from[c[0]]) * norm(from[c[2]] - from[c[0]]) * norm(from[c[3]] - from[c[0]]);
    if (!(std::abs(6 * shape.volume) > 1e-14 * size)) continue;
    State::Affine affine;
    affine.corner = from[c[0]], affine.image = to[c[0]], affine.number = t;
    affine.gradients = shape.of;
    const Matrix3 j = tet_jacobian(c, shape.of, to);
    affine.jacobian = {j.a, j.b, j.c};
    for (const std::uint32_t v : c) affine.from.extend(from[v]), affine.to.extend(to[v]);
    state->affines.push_back(affine);
  }
  if (state->affines.empty()) throw DataError("no tetrahedron has a volume: nothing can be mapped by them");

  std::vector<Box3f> boxes;
  std::vector<Box3> below;
  for (const State::Affine& a : state->affines) {
    boxes.push_back(float_box(a.from, state->origin));
    below.push_back(a.to);
  }
  state->levels = box_levels(std::move(boxes));
  for (std::size_t level = 0; level < state->levels.size(); ++level) {
    std::vector<Box3> above((below.size() + kTreeWidth - 1) / kTreeWidth);
    for (std::size_t k = 0; k < below.size(); ++k) above[k / kTreeWidth].extend(below[k]);
    state->images.push_back(std::exchange(below, std::move(above)));
  }
  state_ = std::move(state);
}

TetMap::~TetMap() = default;

void TetMap::map(std::span<const Vec3> x, const MappedPoints& wanted) const {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr Vec3 kNone{kNaN, kNaN, kNaN};
  parallel_for(0, x.size(), kMapRange, [&](std::size_t i) {
    const State::Affine* a = state_->find(x[i]);
    if (!wanted.positions.empty()) {
      if (a) {
        const Vec3 d = x[i] - a->corner;
        wanted.positions[i] = a->image + a->jacobian[0] * d.x + a->jacobian[1] * d.y + a->jacobian[2] * d.z;
      } else {
        wanted.positions[i] = kNone;
      }
    }
    if (!wanted.jacobians.empty()) wanted.jacobians[i] = a ? a->jacobian : Jacobian{kNone, kNone, kNone};
  });
  std::fill(wanted.gaps.begin(), wanted.gaps.end(), -std::numeric_limits<double>::infinity());
  std::fill(wanted.gap_gradients.begin(), wanted.gap_gradients.end(), Vec3{});
}

void TetMap::images(std::span<const Box3> boxes, std::span<Box3> found) const {
  parallel_for(0, boxes.size(), 16, [&](std::size_t i) {
    found[i] = {};
    const State& s = *state_;
    if (!boxes[i].empty()) s.gather(s.levels.size() - 1, 0, boxes[i], float_box(boxes[i], s.origin), found[i]);
  });
}

void TetMap::find(std::span<const Vec3> x, std::span<std::uint32_t> tets) const {
  parallel_for(0, x.size(), kMapRange, [&](std::size_t i) {
    const State::Affine* a = state_->find(x[i]);
    tets[i] = a ? a->number : kNowhere;
  });
}

}  // namespace sansmesh::inline v1
