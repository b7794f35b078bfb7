#include "sansmesh/surface/published_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr int kMostUnknowns = 15;  // degree 4
/// A pivot below this share of its diagonal marks an unknown that the samples do not determine.
constexpr double kDetermined = 1e-9;
/// Diffusion: Δt = 1. The hard function takes kFullSteps such steps, then ever shorter ones: if it jumps across the
/// rest position there is none, and the steps converge to the jump.
constexpr int kFullSteps = 24, kMostDiffusion = 1000;
constexpr double kAtRestOfWidth = 1e-7;

/// A foot moves by up to this many widths. Samples within the root of these squared radii (in units of the ends of the
/// weights, 1 and 12) may come into reach: 2 + ½ and √12 + ½ widths.
constexpr double kNearStep = 0.5, kNearCompact = 1.5625, kNearGaussian = 15.8;

/// Normal equations of a few unknowns; symmetric, only the lower triangle is used.
struct Normals {
  std::array<std::array<double, kMostUnknowns>, kMostUnknowns> a{};
  std::array<double, kMostUnknowns> b{};
  std::size_t n = 0;

  explicit Normals(std::size_t unknowns) : n(unknowns) {}
  void add(const double* row, double weight, double value) {
    for (std::size_t i = 0; i < n; ++i) {
      const double w = weight * row[i];
      for (std::size_t k = 0; k <= i; ++k) a[i][k] += w * row[k];
      b[i] += w * value;
    }
  }
  /// Replaces b by the solution (Cholesky); false if it is not determined.
  bool solve() {
    for (std::size_t j = 0; j < n; ++j) {
      double pivot = a[j][j];
      for (std::size_t k = 0; k < j; ++k) pivot -= a[j][k] * a[j][k];
      if (!(pivot > kDetermined * a[j][j])) return false;
      a[j][j] = std::sqrt(pivot);
      for (std::size_t i = j + 1; i < n; ++i) {
        for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
        a[i][j] /= a[j][j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
      b[i] /= a[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
      b[i] /= a[i][i];
    }
    return true;
  }
};

/// Direction of the surface next to x, like NearNormals of the kernels.
Vec3 facing_at(std::span<const WeighedSample> samples, std::span<const double> areas, const Vec3& x) {
  Vec3 mean, nearest;
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double w = samples[i].weight(squared_norm(samples[i].x - x)) / areas[i];
    const double narrow = w * w * w * w * areas[i];
    mean += samples[i].n * narrow, sum += narrow;
    if (narrow > largest) largest = narrow, nearest = samples[i].n;
  }
  mean = sum > 0 ? mean / sum : mean;
  return squared_norm(mean) > 0.25 ? normalized(mean) : nearest;
}

struct MeanPlane {
  Vec3 mean, normal;
  Symmetric3 covariance;
  double weights = 0, width = 0;
};

MeanPlane mean_plane(std::span<const WeighedSample> samples, const Vec3& x) {
  MeanPlane plane;
  double squares = 0;
  for (const WeighedSample& s : samples) {
    const double w = s.weight(squared_norm(s.x - x));
    if (!(w > 0)) continue;
    plane.weights += w;
    plane.mean += (s.x - x) * w, plane.normal += s.n * w;
    squares += w * (s.gaussian ? 1 : 0.25) / s.inverse_width;
  }
  if (!(plane.weights > 0)) return plane;
  plane.mean = plane.mean / plane.weights;
  plane.width = std::sqrt(squares / plane.weights);
  for (const WeighedSample& s : samples) {
    const double w = s.weight(squared_norm(s.x - x));
    if (w > 0) plane.covariance.add(s.x - x - plane.mean, w);
  }
  plane.mean += x;
  plane.normal = normalized(plane.normal);
  return plane;
}

Vec3 least_squares_normal(const MeanPlane& plane) {
  const Vec3 n = principal_axes(plane.covariance).axes[0];
  return dot(n, plane.normal) < 0 ? -n : n;
}

struct Foot {
  Vec3 p, n;
  double xx = 0, xy = 0, yy = 0;
};

/// Foot point on a polynomial over a plane, with its normal and second derivatives in the frame of that normal.
Foot foot_on(const PlanePolynomial& g, const Vec3& q, const Vec3& normal) {
  Vec3 t, b, t2, b2;
  tangent_frame(normal, t, b);
  Foot foot;
  foot.p = q + normal * g.value;
  foot.n = normalized(normal - t * g.u - b * g.v);
  tangent_frame(foot.n, t2, b2);
  const double steep = 1 / std::sqrt(1 + g.u * g.u + g.v * g.v);
  const auto form = [&](const Vec3& x, const Vec3& y) {
    return steep * (g.uu * dot(t, x) * dot(t, y) + g.uv * (dot(t, x) * dot(b, y) + dot(b, x) * dot(t, y)) +
                    g.vv * dot(b, x) * dot(b, y));
  };
  foot.xx = form(t2, t2), foot.xy = form(t2, b2), foot.yy = form(b2, b2);
  return foot;
}

double diffusion_function(const ProjectionKernel& kernel, double curvature, double most) {
  if (!kernel.diffusion || curvature <= most) return 1;
  if (kernel.hard) return 0;
  const double excess = curvature - most;
  return most * most / (most * most + 10 * excess * excess);
}

Foot project(const ProjectionKernel& kernel, std::span<const WeighedSample> samples, const Vec3& r) {
  MeanPlane plane = mean_plane(samples, r);
  if (kernel.method == ProjectionMethod::curvature) {
    const Vec3 n = plane.normal;
    const Vec3 q = r + n * dot(n, plane.mean - r);
    const Vec3 p = diffuse(samples, kernel, q, n, plane.width, kernel.flow == SurfaceFlow::normal);
    const Vec3 chi = fit_directional_curvatures(samples, p, n, kernel.tau, plane.width);
    return {p, n, chi.x + chi.y, chi.z, chi.x - chi.y};
  }
  Vec3 n = least_squares_normal(plane);
  double t = dot(n, plane.mean - r);
  if (kernel.method == ProjectionMethod::levin) {
    for (int k = 0; k < kLevinSteps; ++k) {
      const MeanPlane next = mean_plane(samples, r + n * t);
      if (!(next.weights > 0)) break;
      plane = next;
      n = least_squares_normal(plane);
      t = dot(n, plane.mean - r);
    }
    if (kernel.nonlinear) {
      // The minimum is near the end of the iteration: samples that cannot reach it are skipped in each step.
      std::vector<WeighedSample> near;
      for (const WeighedSample& s : samples)
        if (squared_norm(s.x - r - n * t) * s.inverse_width < (kernel.gaussian ? kNearGaussian : kNearCompact))
          near.push_back(s);
      LevinPlane best = least_levin_plane(near, r, {n, t, 0}, plane.width);
      if (norm(best.normal * best.offset - n * t) > kNearStep * plane.width)
        best = least_levin_plane(samples, r, {n, t, 0}, plane.width);
      n = best.normal, t = best.offset;
    }
  }
  const Vec3 q = r + n * t;
  return foot_on(fit_polynomial(samples, q, n, kernel.degree, kernel.incomplete, plane.width), q, n);
}

}  // namespace

PlanePolynomial fit_polynomial(std::span<const WeighedSample> samples, const Vec3& q, const Vec3& normal, int degree,
                               bool incomplete, double width) {
  Vec3 t, b;
  tangent_frame(normal, t, b);
  PlanePolynomial g;
  for (; degree >= 0; --degree) {
    const auto unknowns = incomplete ? std::size_t{4} : static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
    Normals equations(unknowns);
    for (const WeighedSample& s : samples) {
      const Vec3 d = s.x - q;
      const double w = s.weight(squared_norm(d));
      if (!(w > 0)) continue;
      const double u = dot(d, t) / width, v = dot(d, b) / width;
      std::array<double, kMostUnknowns> row{1, u, v, u * u, u * v, v * v};
      if (incomplete) row = {1, u * u, u * v, v * v};
      // Degree by degree: all terms of the previous one times u, and its last one times v.
      for (std::size_t first = 3, size = 3, to = 6; to < unknowns; first += size, ++size) {
        for (std::size_t k = 0; k < size; ++k) row[to++] = u * row[first + k];
        row[to++] = v * row[first + size - 1];
      }
      equations.add(row.data(), w, dot(d, normal) / width);
    }
    if (!equations.solve()) {
      incomplete = false;  // without its squares it is a constant
      if (unknowns == 4) degree = 1;
      continue;
    }
    const auto& c = equations.b;
    g.degree = degree, g.value = c[0] * width;
    if (incomplete) {
      g.uu = 2 * c[1] / width, g.uv = c[2] / width, g.vv = 2 * c[3] / width;
      return g;
    }
    if (degree >= 1) g.u = c[1], g.v = c[2];
    if (degree >= 2) g.uu = 2 * c[3] / width, g.uv = c[4] / width, g.vv = 2 * c[5] / width;
    return g;
  }
  return g;
}

Vec3 diffuse(std::span<const WeighedSample> samples, const ProjectionKernel& kernel, const Vec3& q, const Vec3& normal,
             double width, bool along) {
  const double most = static_cast<double>(kernel.threshold) / width;
  Vec3 x = q;
  for (int k = 0; k < kMostDiffusion; ++k) {
    Vec3 sum;
    double weights = 0;
    for (const WeighedSample& s : samples) {
      const Vec3 d = s.x - x;
      const double square = squared_norm(d), w = s.weight(square);
      if (!(w > 0)) continue;
      weights += w;
      const double curvature = square > 0 ? 2 * std::abs(dot(normal, d)) / square : 0;
      sum += d * (w * diffusion_function(kernel, curvature, most));
    }
    if (!(weights > 0)) break;
    Vec3 step = sum / weights;
    if (along) step = normal * dot(normal, step);
    if (kernel.diffusion && kernel.hard && k >= kFullSteps) step *= static_cast<double>(kFullSteps) / (k + 1);
    x += step;
    if (norm(step) <= kAtRestOfWidth * width) break;
  }
  return x;
}

Vec3 fit_directional_curvatures(std::span<const WeighedSample> samples, const Vec3& p, const Vec3& normal, int tau,
                                double width) {
  Vec3 t, b;
  tangent_frame(normal, t, b);
  Normals equations(3);
  for (const WeighedSample& s : samples) {
    const Vec3 d = s.x - p;
    const double square = squared_norm(d), w = s.weight(square);
    const double u = dot(d, t), v = dot(d, b), flat = u * u + v * v;
    if (!(w > 0) || !(flat > 0)) continue;
    const double row[3] = {1, (u * u - v * v) / flat, 2 * u * v / flat};
    equations.add(row, w * std::pow(square / (width * width), tau), 2 * dot(normal, d) / square * width);
  }
  if (!equations.solve()) return {};
  return Vec3{equations.b[0], equations.b[1], equations.b[2]} / width;
}

void project_group_as_published(const ProjectionKernel& kernel, std::span<const Candidate> candidates,
                                const PointGroup& group, GroupFeet& out) {
  std::vector<WeighedSample> samples;
  std::vector<double> areas;
  for (std::size_t k = 0; k < kGroup; ++k) {
    const Vec3 r{group.x[k], group.y[k], group.z[k]};
    out.inside[k] = -1;
    if (k >= group.count) continue;
    samples.clear(), areas.clear();
    double inside = -1;
    for (const Candidate& c : candidates) {
      WeighedSample s{{c.x, c.y, c.z}, {c.nx, c.ny, c.nz}, c.weight, c.inverse_support, kernel.gaussian};
      const double square = squared_norm(s.x - r);
      if (s.weight(square) > 0) inside = std::max(inside, 1 - square * static_cast<double>(c.inverse_reach));
      samples.push_back(s);
      areas.push_back(s.factor);
    }
    if (!(inside > 0)) continue;
    if (kernel.sheets) {
      const Vec3 facing = facing_at(samples, areas, r);
      for (WeighedSample& s : samples) s.factor *= std::clamp(1 + 2 * dot(facing, s.n), 0.0, 1.0);
    }
    const Foot foot = project(kernel, samples, r);
    const Vec3f p(foot.p), n(foot.n);
    out.x[k] = p.x, out.y[k] = p.y, out.z[k] = p.z;
    out.nx[k] = n.x, out.ny[k] = n.y, out.nz[k] = n.z;
    out.xx[k] = static_cast<float>(foot.xx), out.xy[k] = static_cast<float>(foot.xy);
    out.yy[k] = static_cast<float>(foot.yy);
    out.inside[k] = static_cast<float>(inside);
  }
}

}  // namespace sansmesh::inline v1::detail
