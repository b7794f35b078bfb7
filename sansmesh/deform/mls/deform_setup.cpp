#include "sansmesh/deform/mls/deform_setup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/deform/handles/handle_conflicts.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kLeastWeight = 1e-60;  // smallest weight of a handle relative to one at the point
constexpr double kOnLine = 1e-10;       // distance from a line over extent
constexpr double kInPlane = 1e-9;
/// Exponent below which segments fail: next to a segment its weight grows as distance^(1 − 2 alpha), too slowly, and at
/// 1/2 not at all.
constexpr double kLeastOfSegments = 1;
constexpr double kDependent = 1e-6;  // norm of a polynomial's part independent of the others, on the handles

std::string handle_number(std::size_t i) { return "handle " + std::to_string(i + 1); }

DeformHandle checked_handle(const Handle& h, std::size_t number) {
  const auto fail = [&](const std::string& why) { throw ArgumentError(handle_number(number) + ": " + why); };
  const auto finite = [&](const Vec3& v, const char* name) {
    if (!is_finite(v)) fail(std::string("`").append(name).append("` is not finite"));
  };
  finite(h.p, "p"), finite(h.q, "q");
  if (!(h.weight > 0) || !std::isfinite(h.weight)) fail("`weight` must be above 0, not " + std::to_string(h.weight));
  DeformHandle out;
  out.p = h.p, out.q = h.q, out.weight = h.weight;
  if (h.p_end.has_value() != h.q_end.has_value()) fail(h.p_end ? "`p_end` without `q_end`" : "`q_end` without `p_end`");
  if (h.p_end) {
    finite(*h.p_end, "p_end"), finite(*h.q_end, "q_end");
    out.along_p = *h.p_end - h.p, out.along_q = *h.q_end - h.q;
    out.segment = out.along_q != Vec3{};
    if (!out.segment && out.along_p != Vec3{})
      fail("`q_end` is at `q` though `p_end` is not at `p`: a segment cannot come from a point");
  }
  for (std::size_t k = 0; k < h.directions.size(); ++k) {
    const auto unit = [&](const Vec3& v, const char* name) {
      const double length = norm(v);
      if (!std::isfinite(length) || !(length > 0))
        fail("direction " + std::to_string(k + 1) + ": `" + name + "` has no length");
      return v / length;
    };
    out.directions.push_back({unit(h.directions[k].before, "before"), unit(h.directions[k].after, "after")});
  }
  if (h.reach && !(*h.reach > 0 && std::isfinite(*h.reach)))
    fail("`reach` must be above 0, not " + std::to_string(*h.reach));
  return out;
}

/// Half the mean distance from a handle to its nearest neighbour; for a single one half its length.
double default_reach(const std::vector<DeformHandle>& handles) {
  double sum = 0;
  std::size_t count = 0;
  for (const DeformHandle& a : handles) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const DeformHandle& b : handles)
      if (const double d = squared_norm(a.q - b.q); d > 0) nearest = std::min(nearest, d);
    if (std::isfinite(nearest)) sum += std::sqrt(nearest), ++count;
  }
  if (count > 0) return sum / static_cast<double>(count) / 2;
  const double length = norm(handles.front().along_q);
  return length > 0 ? length / 2 : 1;
}

/// Points held by the handles, before and after: for each segment as many as determine polynomials of the degree.
struct HeldPoints {
  std::vector<Vec3> p, q;
};
HeldPoints held_points(const std::vector<DeformHandle>& handles, int degree) {
  HeldPoints held;
  for (const DeformHandle& h : handles) {
    const int steps = h.segment ? degree : 0;
    for (int k = 0; k <= steps; ++k) {
      const double t = steps > 0 ? static_cast<double>(k) / steps : 0;
      held.p.push_back(h.p + h.along_p * t), held.q.push_back(h.q + h.along_q * t);
    }
    for (const TurnedDirection& d : h.directions)
      for (const double side : {-1.0, 1.0})
        held.p.push_back(h.p + d.before * (side * h.reach)), held.q.push_back(h.q + d.after * (side * h.reach));
  }
  return held;
}

double extent_of(const std::vector<Vec3>& positions) {
  Box3 box;
  for (const Vec3& x : positions) box.extend(x);
  return box.diagonal();
}

/// The direction of the line through all points; zero if they coincide.
std::optional<Vec3> line_of(const std::vector<Vec3>& positions) {
  const auto farther = [&](const Vec3& a, const Vec3& b) {
    return squared_norm(a - positions[0]) < squared_norm(b - positions[0]);
  };
  const Vec3 direction = normalized(*std::max_element(positions.begin(), positions.end(), farther) - positions[0]);
  const double tolerance = kOnLine * extent_of(positions);
  for (const Vec3& x : positions)
    if (norm(cross(x - positions[0], direction)) > tolerance) return std::nullopt;
  return direction;
}

bool in_a_plane(const std::vector<Vec3>& positions) {
  const std::optional<Vec3> line = line_of(positions);
  if (line) return true;
  // The normal of the widest triangle with the longest side from the first point.
  Vec3 far = positions[0], normal;
  for (const Vec3& x : positions)
    if (squared_norm(x - positions[0]) > squared_norm(far - positions[0])) far = x;
  for (const Vec3& x : positions) {
    const Vec3 n = cross(far - positions[0], x - positions[0]);
    if (squared_norm(n) > squared_norm(normal)) normal = n;
  }
  normal = normalized(normal);
  const double tolerance = kInPlane * extent_of(positions);
  return std::all_of(positions.begin(), positions.end(),
                     [&](const Vec3& x) { return std::abs(dot(x - positions[0], normal)) <= tolerance; });
}

/// Whether 0 is the only polynomial of the space that is constant on all points.
bool determined(const std::vector<Vec3>& positions, const PolynomialTerms& terms) {
  const std::size_t n = positions.size();
  if (n <= terms.count) return false;
  Vec3 center;
  for (const Vec3& x : positions) center += x / static_cast<double>(n);
  const double extent = extent_of(positions);
  std::vector<std::vector<double>> columns(terms.count, std::vector<double>(n));
  std::array<double, kMostMonomials> values{};
  for (std::size_t i = 0; i < n; ++i) {
    evaluate_terms(terms, (positions[i] - center) / extent, values.data(), nullptr);
    for (std::size_t j = 0; j < terms.count; ++j) columns[j][i] = values[j];
  }
  for (std::size_t j = 0; j < terms.count; ++j) {
    std::vector<double>& c = columns[j];
    const double size = std::sqrt(std::inner_product(c.begin(), c.end(), c.begin(), 0.0));
    for (int twice = 0; twice < 2; ++twice) {
      const double mean = std::accumulate(c.begin(), c.end(), 0.0) / static_cast<double>(n);
      for (double& v : c) v -= mean;
      for (std::size_t l = 0; l < j; ++l) {
        const double share = std::inner_product(c.begin(), c.end(), columns[l].begin(), 0.0);
        for (std::size_t i = 0; i < n; ++i) c[i] -= share * columns[l][i];
      }
    }
    const double left = std::sqrt(std::inner_product(c.begin(), c.end(), c.begin(), 0.0));
    if (!(left > kDependent * size)) return false;
    for (double& v : c) v /= left;
  }
  return true;
}

void check_affine(const HeldPoints& held, std::size_t handles) {
  const std::string remedy = ": add handles off it, or use the kind `rigid`, which takes any";
  if (held.q.size() < 4)
    throw ArgumentError("the kind `affine` needs at least 4 handles that are not coplanar, not " +
                        std::to_string(handles) + ": add some, or use the kind `rigid`, which takes any number");
  if (line_of(held.q))
    throw ArgumentError(
        "the kind `affine` needs handles that are not coplanar, and the targets of these are collinear" + remedy);
  if (in_a_plane(held.q))
    throw ArgumentError("the kind `affine` needs handles that are not coplanar, and the targets of these are coplanar" +
                        remedy);
}

PolynomialTerms nonlinear_terms(const HeldPoints& held, std::size_t handles, int degree) {
  const std::size_t needed = degree == 2 ? 9 : 19;
  const std::string kind = "the kind `nonlinear` of `degree` " + std::to_string(degree);
  const std::string other = degree == 3 ? "`degree` 2 (at least 9)" : "the kind `rigid`, which takes any number";
  if (held.q.size() < needed)
    throw ArgumentError(kind + " needs at least " + std::to_string(needed) +
                        " handles in general position (a segment counts as " + std::to_string(degree + 1) +
                        ", a direction as 2), not " + std::to_string(handles) + ": add some, or use " + other);
  const auto full = polynomial_terms(degree == 2 ? PolynomialSpace::quadratic : PolynomialSpace::cubic);
  if (determined(held.q, full)) return full;
  const auto harmonic =
      polynomial_terms(degree == 2 ? PolynomialSpace::harmonic_quadratic : PolynomialSpace::harmonic_cubic);
  if (determined(held.q, harmonic)) return harmonic;
  const bool flat = in_a_plane(held.q);
  throw ArgumentError(kind + " needs handles in general position, and the targets of these are on " +
                      (flat ? "a plane" : "a surface of that degree") + ": add handles off it, or use " +
                      (degree == 3 ? "`degree` 2 or the kind `rigid`" : "the kind `rigid`"));
}

}  // namespace

DeformSetup set_up_deformation(const std::vector<Handle>& handles, const MlsDeformationOptions& options) {
  options.validate();
  if (handles.empty()) throw ArgumentError("a deformation needs at least one handle");
  DeformSetup setup;
  setup.options = options;
  bool reach_wanted = false;
  for (std::size_t i = 0; i < handles.size(); ++i) {
    setup.handles.push_back(checked_handle(handles[i], i));
    const DeformHandle& h = setup.handles.back();
    if (h.segment || !h.directions.empty()) setup.plain = false;
    if (h.segment && options.alpha < kLeastOfSegments)
      throw ArgumentError(handle_number(i) + " is a segment, which needs an `alpha` of at least 1");
    reach_wanted = reach_wanted || (!h.directions.empty() && !handles[i].reach);
  }
  const double reach = reach_wanted ? default_reach(setup.handles) : 0;
  for (std::size_t i = 0; i < handles.size(); ++i) setup.handles[i].reach = handles[i].reach.value_or(reach);

  const bool polynomial = options.kind == DeformationKind::nonlinear;
  const HeldPoints held = held_points(setup.handles, polynomial ? options.degree : 1);
  if (const double extent = extent_of(held.q); extent > 0) setup.extent = extent;
  if (!std::isfinite(setup.extent) || !std::isfinite(extent_of(held.p)))
    throw ArgumentError("handles are too far apart for double precision");
  check_handle_conflicts(setup.handles, 1e-13 * setup.extent, 1e-9 * std::max(extent_of(held.p), setup.extent));
  setup.floor_square = setup.extent * setup.extent * std::pow(kLeastWeight, 1 / options.alpha);

  switch (options.kind) {
    case DeformationKind::affine:
      check_affine(held, handles.size());
      setup.terms = polynomial_terms(PolynomialSpace::linear);
      break;
    case DeformationKind::nonlinear:
      setup.terms = nonlinear_terms(held, handles.size(), options.degree);
      break;
    case DeformationKind::similarity:
    case DeformationKind::rigid:
      if (const auto after = line_of(held.q)) {
        setup.line = *after == Vec3{} ? HandleLine::point : HandleLine::after, setup.line_direction = *after;
      } else if (const auto before = line_of(held.p)) {
        setup.line = *before == Vec3{} ? HandleLine::point : HandleLine::before, setup.line_direction = *before;
      }
      break;
  }
  return setup;
}

}  // namespace sansmesh::inline v1::detail
