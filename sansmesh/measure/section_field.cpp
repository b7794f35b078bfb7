#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/measure/section.h"
#include "sansmesh/measure/section_curves.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTile = 32;    // nodes of a batch in each direction: neighbours evaluate fastest together
constexpr std::size_t kBatch = 256;  // crossings refined together
constexpr int kMostSteps = 60;
constexpr double kTolerance = 1e-12;  // relative to a lattice edge

struct Rectangle {
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  bool has_area() const { return u1 > u0 && v1 > v0; }
};

/// Bounding rectangle of the plane's intersection with the box: its corners are on the edges of the box.
Rectangle cut_of_box(const Box3& box, const CutPlane& plane) {
  Rectangle r;
  const auto add = [&](const Vec3& x) {
    const double u = dot(plane.u, x), v = dot(plane.v, x);
    r.u0 = std::min(r.u0, u), r.u1 = std::max(r.u1, u);
    r.v0 = std::min(r.v0, v), r.v1 = std::max(r.v1, v);
  };
  for (int i = 0; i < 8; ++i)
    for (int bit = 1; bit < 8; bit <<= 1) {
      if (i & bit) continue;
      const Vec3 a = box_corner(box, i), b = box_corner(box, i | bit);
      const double ha = plane.height(a), hb = plane.height(b);
      if (ha == 0) add(a);
      if (hb == 0) add(b);
      if ((ha < 0) != (hb < 0) && ha != hb) add(a + (b - a) * (ha / (ha - hb)));
    }
  return r;
}

/// The field's sign on a lattice in the plane.
class PlaneLattice {
 public:
  PlaneLattice(const ScalarField& field, const CutPlane& plane, const Rectangle& r, const Box3& box, int resolution)
      : plane_(plane), u0_(r.u0), v0_(r.v0), step_(std::max(r.u1 - r.u0, r.v1 - r.v0) / resolution) {
    const auto most = static_cast<std::size_t>(resolution);
    columns_ = 1 + index_in<std::size_t>(std::ceil((r.u1 - r.u0) / step_ - 1e-9), 0, most);
    rows_ = 1 + index_in<std::size_t>(std::ceil((r.v1 - r.v0) / step_ - 1e-9), 0, most);
    values_.assign(columns_ * rows_, NAN);
    // Nodes outside the box by rounding belong to it.
    const double slack = 1e-9 * step_;
    const Vec3 margin{slack, slack, slack};
    const Box3 wide{box.lower - margin, box.upper + margin};
    const std::size_t across = (columns_ + kTile - 1) / kTile, down = (rows_ + kTile - 1) / kTile;
    parallel_for(0, across * down, 1, [&](std::size_t tile) {
      const std::size_t first_i = tile % across * kTile, first_j = tile / across * kTile;
      std::vector<Vec3> x;
      std::vector<std::size_t> nodes;
      for (std::size_t j = first_j; j < std::min(rows_, first_j + kTile); ++j)
        for (std::size_t i = first_i; i < std::min(columns_, first_i + kTile); ++i) {
          const Vec3 p = at(node(i, j));
          if (!wide.contains(p)) continue;
          x.push_back(p);
          nodes.push_back(node(i, j));
        }
      if (x.empty()) return;
      std::vector<double> f(x.size());
      std::vector<std::uint8_t> inside(x.size());
      field.evaluate_in_domain(x, f, {}, inside);
      for (std::size_t k = 0; k < x.size(); ++k)
        if (inside[k]) values_[nodes[k]] = f[k];
    });
  }

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  std::size_t node(std::size_t i, std::size_t j) const { return j * columns_ + i; }
  /// NaN outside the box or the domain.
  double value(std::size_t node) const { return values_[node]; }
  std::array<double, 2> plane_coordinates(std::size_t node) const {
    const std::size_t row = node / columns_;
    return {u0_ + step_ * static_cast<double>(node % columns_), v0_ + step_ * static_cast<double>(row)};
  }
  Vec3 at(std::size_t node) const {
    const auto [u, v] = plane_coordinates(node);
    return plane_.at(u, v);
  }

 private:
  const CutPlane& plane_;
  double u0_, v0_, step_;
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<double> values_;
};

struct Crossing {
  std::size_t inner, outer;  ///< nodes
};

/// Zeros of the field on the edges, as parameters from inside (0) to outside (1).
void refine(const ScalarField& field, const PlaneLattice& lattice, std::span<const Crossing> edges,
            std::span<double> where) {
  struct Open {
    std::size_t index;
    double low = 0, high = 1, t, last = 1, before = 1;  ///< bracket, parameter, last two steps
  };
  std::vector<Open> open(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double a = lattice.value(edges[i].inner), b = lattice.value(edges[i].outer);
    open[i].index = i;
    open[i].t = where[i] = std::clamp(a / (a - b), 0.0, 1.0);
  }
  std::vector<Vec3> x, gradients;
  std::vector<double> values;
  for (int step = 0; step < kMostSteps && !open.empty(); ++step) {
    x.clear();
    for (const Open& o : open) {
      const Vec3 p = lattice.at(edges[o.index].inner), q = lattice.at(edges[o.index].outer);
      x.push_back(p + (q - p) * o.t);
    }
    values.resize(x.size()), gradients.resize(x.size());
    field.evaluate(x, values, gradients);
    std::size_t left = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      Open o = open[k];
      const Vec3 edge = lattice.at(edges[o.index].outer) - lattice.at(edges[o.index].inner);
      where[o.index] = o.t;
      if (values[k] == 0 || !std::isfinite(values[k])) continue;
      (values[k] < 0 ? o.low : o.high) = o.t;
      double next = o.t - values[k] / dot(gradients[k], edge);
      // Newton's step if it stays in the bracket and is at most half of the last but one; otherwise bisection.
      if (!(next > o.low && next < o.high && std::abs(next - o.t) < 0.5 * o.before)) next = 0.5 * (o.low + o.high);
      o.before = o.last;
      o.last = std::abs(next - o.t);
      where[o.index] = o.t = next;
      if (o.last > kTolerance) open[left++] = o;
    }
    open.resize(left);
  }
}

/// The pieces of curves in the triangles of a lattice, each between crossings of two edges.
class LatticePieces {
 public:
  explicit LatticePieces(const PlaneLattice& lattice) : lattice_(lattice) {
    for (std::size_t j = 0; j + 1 < lattice.rows(); ++j)
      for (std::size_t i = 0; i + 1 < lattice.columns(); ++i) {
        const std::size_t a = lattice.node(i, j), c = lattice.node(i + 1, j + 1);
        add_triangle({a, lattice.node(i + 1, j), c});
        add_triangle({a, c, lattice.node(i, j + 1)});
      }
  }

  const std::vector<SectionPiece>& pieces() const { return pieces_; }
  /// Edges with the ends of the pieces.
  const std::vector<Crossing>& edges() const { return edges_; }

 private:
  void add_triangle(const std::array<std::size_t, 3>& corners) {
    int inside = 0;
    for (const std::size_t node : corners) {
      if (std::isnan(lattice_.value(node))) return;
      inside += lattice_.value(node) < 0;
    }
    if (inside == 0 || inside == 3) return;
    SectionPiece piece{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t p = corners[k], q = corners[(k + 1) % 3];
      const bool p_inside = lattice_.value(p) < 0, q_inside = lattice_.value(q) < 0;
      if (p_inside && !q_inside) piece.from = crossing(p, q);
      if (!p_inside && q_inside) piece.to = crossing(q, p);
    }
    pieces_.push_back(piece);
  }

  std::uint32_t crossing(std::size_t inner, std::size_t outer) {
    // An edge is its lower node and one of three directions: right, up, diagonal.
    const std::size_t low = std::min(inner, outer), ahead = std::max(inner, outer) - low;
    const std::uint64_t key = 3 * low + (ahead == 1 ? 0 : ahead == lattice_.columns() ? 1 : 2);
    const auto [at, fresh] = known_.try_emplace(key, static_cast<std::uint32_t>(edges_.size()));
    if (fresh) edges_.push_back({inner, outer});
    return at->second;
  }

  const PlaneLattice& lattice_;
  std::vector<SectionPiece> pieces_;
  std::vector<Crossing> edges_;
  std::unordered_map<std::uint64_t, std::uint32_t> known_;
};

/// Zeros of the field on the edges, in plane coordinates.
std::vector<std::array<double, 2>> zeros(const ScalarField& field, const PlaneLattice& lattice,
                                         std::span<const Crossing> edges) {
  std::vector<double> where(edges.size());
  parallel_for(0, (edges.size() + kBatch - 1) / kBatch, 1, [&](std::size_t c) {
    const std::size_t first = c * kBatch, count = std::min(kBatch, edges.size() - first);
    refine(field, lattice, edges.subspan(first, count), std::span(where).subspan(first, count));
  });
  std::vector<std::array<double, 2>> points(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [u0, v0] = lattice.plane_coordinates(edges[i].inner);
    const auto [u1, v1] = lattice.plane_coordinates(edges[i].outer);
    points[i] = {u0 + (u1 - u0) * where[i], v0 + (v1 - v0) * where[i]};
  }
  return points;
}

}  // namespace

void FieldSectionOptions::validate() const {
  if (resolution < 2 || resolution > 4096)
    throw ArgumentError("`resolution` must lie in 2..4096, not be " + std::to_string(resolution));
  if (box && (box->empty() || !is_finite(box->lower) || !is_finite(box->upper)))
    throw ArgumentError("`box` must be finite and not empty");
}

Section section_field(const ScalarField& field, const CutPlane& plane, const FieldSectionOptions& options) {
  options.validate();
  const Box3 box = options.box ? common_part(field.bounds(), *options.box) : field.bounds();
  Section none;
  none.plane = plane;
  if (box.empty()) return none;
  const Rectangle rectangle = cut_of_box(box, plane);
  if (!rectangle.has_area()) return none;
  const PlaneLattice lattice(field, plane, rectangle, box, options.resolution);
  const LatticePieces cut(lattice);
  const std::vector<std::array<double, 2>> points = zeros(field, lattice, cut.edges());
  return make_section(plane, chain_pieces(cut.pieces(), points.size()), points);
}

std::vector<Section> section_field(const ScalarField& field, std::span<const CutPlane> planes,
                                   const FieldSectionOptions& options, Progress& progress) {
  options.validate();
  progress.begin("sections", planes.size());
  std::vector<Section> sections;
  sections.reserve(planes.size());
  for (const CutPlane& plane : planes) {
    sections.push_back(section_field(field, plane, options));
    progress.advance();
  }
  return sections;
}

}  // namespace sansmesh::inline v1
