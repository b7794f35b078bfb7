#include "sansmesh/points/registration/align_scans.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Least number of samples of a movable scan, and largest number of movable scans (the system is solved densely).
constexpr std::size_t kFewestOfScan = 100, kMostMovableScans = 300;
/// Neighbours that define a quadric, additional ones per spacing of noise, and their largest number.
constexpr std::size_t kOfQuadric = 24, kMostOfQuadric = 128;
constexpr double kMorePerNoise = 110;
/// Width of the Tukey weights: first and last in spacings, and least in standard deviations of the noise.
constexpr double kWidestReach = 8, kNarrowestReach = 0.5, kNoiseReach = 6;
/// Offset of the neighbours' centroid relative to their radius (0.42 at a straight border) beyond which the scan ends.
constexpr double kMostAside = 0.33;
constexpr double kLeastNormalCosine = 0.5;
/// Motions that change the distances by less than this share are poorly determined: they are damped.
constexpr double kDamping = 1e-4;
/// Samples per scan that suffice until steps are as small as this factor of the last one.
constexpr std::size_t kOnTheWay = 1000;
constexpr double kOnTheWayOverLast = 5;
/// Size of the last step, relative to the noise or the spacing.
constexpr double kLastOverNoise = 0.02, kLastOverSpacing = 0.0005;
constexpr double kTellableOverSpacing = 0.1;
/// Motions are applied only if they reduce the loss below this factor.
constexpr double kMostLossLeft = 0.9;
constexpr double kWarpedOverNoise = 2;

/// Foot of a query point on the surface of a scan.
struct ScanFoot {
  double height = 0;  ///< height of the query point over the surface along the normal
  Vec3 normal;        ///< unit normal on the side of the samples' normals
};

/// Scan with precomputed data, in its original coordinates.
struct Scan {
  std::uint16_t number = 0;
  std::vector<std::uint32_t> samples;
  std::vector<std::uint32_t> chosen;  ///< samples compared with other scans
  Box3 box;
  KdTree tree;  ///< tree of `samples`, in their order
  Vec3 centroid;
  double radius = 0;  ///< root mean square distance of the chosen samples from the centroid
  Eigen::Matrix<double, 6, 6> mass;
  double noise = 0, spacing = 0;
  std::size_t neighbours = kOfQuadric;
};

using Six = Eigen::Matrix<double, 6, 1>;

struct SurfaceScratch {
  std::vector<Neighbour> near;
  std::vector<Vec3f> offsets;
};

/// Evaluates the quadric through the samples of a scan nearest to q; nothing if the scan has no surface within `reach`.
/// `others` skips a sample at q itself; `radius` returns the distance of the farthest sample used.
std::optional<ScanFoot> surface_at(const PointSet& points, const Scan& scan, const Vec3& q, double reach, bool others,
                                   SurfaceScratch& scratch, double* radius = nullptr) {
  scratch.near.resize(scan.neighbours + (others ? 1 : 0));
  const std::size_t found = scan.tree.nearest(Vec3f(q), scratch.near);
  std::span<const Neighbour> near(scratch.near.data(), found);
  if (others && found > 0) near = near.subspan(1);
  if (near.size() < 12 || !(static_cast<double>(near[0].squared_distance) <= reach * reach)) return std::nullopt;
  if (radius) *radius = std::sqrt(static_cast<double>(near.back().squared_distance));
  scratch.offsets.clear();
  Vec3 normal_sum;
  for (const Neighbour& one : near) {
    const std::uint32_t i = scan.samples[one.index];
    scratch.offsets.push_back(Vec3f(Vec3(points.positions[i]) - q));
    normal_sum += Vec3(points.normals[i]);
  }
  const Moments m = moments(scratch.offsets);
  const PrincipalAxes frame = principal_axes(m.covariance);
  // Collinear or clustered samples define no surface.
  if (frame.values.y < 0.02 * frame.values.z || frame.values.x > 0.5 * frame.values.y) return std::nullopt;
  double widest = 0;
  for (const Vec3f& d : scratch.offsets) {
    const double u = dot(Vec3(d), frame.axes[2]), v = dot(Vec3(d), frame.axes[1]);
    widest = std::max(widest, u * u + v * v);
  }
  widest = std::sqrt(widest);
  if (!(widest > 0) || std::hypot(dot(m.mean, frame.axes[2]), dot(m.mean, frame.axes[1])) > kMostAside * widest)
    return std::nullopt;
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  Six b = Six::Zero();
  for (const Vec3f& offset : scratch.offsets) {
    const Vec3 d = Vec3(offset) / widest;
    const double u = dot(d, frame.axes[2]), v = dot(d, frame.axes[1]), r = (u * u + v * v) / 1.2;
    Six row;
    row << 1, u, v, u * u, u * v, v * v;
    a.noalias() += (1 - r) * row * row.transpose();
    b += (1 - r) * dot(d, frame.axes[0]) * row;
  }
  a.diagonal().array() += 1e-9 * static_cast<double>(near.size());
  const Six c = a.ldlt().solve(b);
  ScanFoot foot;
  foot.normal = frame.axes[0] - frame.axes[2] * c[1] - frame.axes[1] * c[2];
  const double length = norm(foot.normal);
  foot.height = -c[0] * widest / length;
  foot.normal = foot.normal / length;
  if (dot(foot.normal, normal_sum) < 0) foot.normal = -foot.normal, foot.height = -foot.height;
  if (!std::isfinite(foot.height)) return std::nullopt;
  return foot;
}

void choose_samples(const PointSet& points, std::size_t most, Scan& scan) {
  const std::size_t n = scan.samples.size(), count = std::min(n, most);
  for (std::size_t k = 0; k < count; ++k) scan.chosen.push_back(scan.samples[k * n / count]);
  for (const std::uint32_t i : scan.chosen) scan.centroid += Vec3(points.positions[i]);
  scan.centroid = scan.centroid / static_cast<double>(count);
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  double squares = 0;
  for (const std::uint32_t i : scan.chosen) {
    const Vec3 d = Vec3(points.positions[i]) - scan.centroid;
    const Eigen::Vector3d e(d.x, d.y, d.z);
    inertia += e.squaredNorm() * Eigen::Matrix3d::Identity() - e * e.transpose();
    squares += e.squaredNorm();
  }
  scan.radius = std::max(std::sqrt(squares / static_cast<double>(count)), 1e-30);
  scan.mass.setZero();
  scan.mass.topLeftCorner<3, 3>() = static_cast<double>(count) * Eigen::Matrix3d::Identity();
  scan.mass.bottomRightCorner<3, 3>() = inertia / (scan.radius * scan.radius);
}

/// Estimates the spacing and noise of a scan.
void measure_scan(const PointSet& points, Scan& scan) {
  const std::size_t count = std::min<std::size_t>(scan.chosen.size(), 400);
  std::vector<std::optional<std::array<double, 2>>> found(count);
  parallel_ranges(0, count, 32, [&](std::size_t first, std::size_t last) {
    SurfaceScratch scratch;
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 q(points.positions[scan.chosen[k * scan.chosen.size() / count]]);
      double radius = 0;
      const auto foot = surface_at(points, scan, q, 1e30, true, scratch, &radius);
      if (foot) found[k] = {std::abs(foot->height), radius};
    }
  });
  std::vector<double> heights, radii;
  for (const auto& one : found)
    if (one) heights.push_back((*one)[0]), radii.push_back((*one)[1]);
  scan.spacing = median(radii) * std::sqrt(std::numbers::pi / static_cast<double>(kOfQuadric));
  // A quadric through n samples has a variance of about 4/n of theirs at its centre.
  scan.noise = kDeviationOverMedian * median(heights) / std::sqrt(1 + 4.0 / static_cast<double>(kOfQuadric));
  if (scan.spacing > 0)
    scan.neighbours =
        std::min(kMostOfQuadric,
                 kOfQuadric + index_in<std::size_t>(kMorePerNoise * scan.noise / scan.spacing, 0, kMostOfQuadric));
}

bool box_near(const Box3& box, const Vec3& q, double reach) {
  for (std::size_t k = 0; k < 3; ++k)
    if (q[k] < box.lower[k] - reach || q[k] > box.upper[k] + reach) return false;
  return true;
}

/// A sample of scan `of` over the surface of scan `to`, with normal n there, in common coordinates.
struct Comparison {
  std::uint32_t of, to;
  double height;
  Vec3 position, normal;
};

/// Compares every `every`-th chosen sample.
std::vector<Comparison> compare(const PointSet& points, const std::vector<Scan>& scans,
                                const std::vector<Similarity>& motions, double reach, std::size_t every = 1) {
  std::vector<Comparison> all;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const std::vector<std::uint32_t>& chosen = scans[s].chosen;
    constexpr std::size_t kChunk = 64;
    const std::size_t count = (chosen.size() + every - 1) / every;
    std::vector<std::vector<Comparison>> parts((count + kChunk - 1) / kChunk);
    parallel_for(0, parts.size(), 1, [&](std::size_t c) {
      SurfaceScratch scratch;
      for (std::size_t k = c * kChunk; k < std::min(count, (c + 1) * kChunk); ++k) {
        const std::uint32_t i = chosen[k * every];
        const Vec3 p = motions[s](Vec3(points.positions[i]));
        const Vec3 n = motions[s].rotate(Vec3(points.normals[i]));
        for (std::size_t t = 0; t < scans.size(); ++t) {
          if (t == s) continue;
          const Vec3 q = motions[t].back(p);
          if (!box_near(scans[t].box, q, reach)) continue;
          const double aside = 1.5 * scans[t].spacing;
          const auto there = surface_at(points, scans[t], q, std::hypot(reach, aside), false, scratch);
          if (!there || std::abs(there->height) > reach) continue;
          const Vec3 normal = motions[t].rotate(there->normal);
          if (dot(normal, n) < kLeastNormalCosine) continue;
          parts[c].push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(t), there->height, p, normal});
        }
      }
    });
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// Mean of Tukey's loss, at most 1, over all comparisons within the widest reach.
double mean_loss(const std::vector<Comparison>& all, double width) {
  double sum = 0;
  for (const Comparison& c : all) {
    const double t = std::min(1.0, std::abs(c.height) / width);
    sum += 1 - std::pow(1 - t * t, 3);
  }
  return all.empty() ? 0 : sum / static_cast<double>(all.size());
}

/// One Gauss–Newton step; returns the largest rms displacement of a scan.
double take_step(const std::vector<Scan>& scans, const std::vector<Comparison>& all, double width,
                 std::vector<Similarity>& motions) {
  const std::size_t n = scans.size();
  std::vector<Vec3> centers(n);
  for (std::size_t s = 0; s < n; ++s) centers[s] = motions[s](scans[s].centroid);
  const auto size = static_cast<Eigen::Index>(6 * n);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
  const auto row_of = [&](const Comparison& c, std::uint32_t s, double sign) {
    const Vec3 turn = cross(c.position - centers[s], c.normal) / scans[s].radius;
    Six row;
    row << c.normal.x, c.normal.y, c.normal.z, turn.x, turn.y, turn.z;
    return Six(sign * row);
  };
  for (const Comparison& c : all) {
    const double w = tukey_weight(c.height / width);
    if (w == 0) continue;
    const Six of = row_of(c, c.of, 1), to = row_of(c, c.to, -1);
    const Eigen::Index i = 6 * static_cast<Eigen::Index>(c.of), j = 6 * static_cast<Eigen::Index>(c.to);
    a.block<6, 6>(i, i).noalias() += w * of * of.transpose();
    a.block<6, 6>(j, j).noalias() += w * to * to.transpose();
    if (i > j)
      a.block<6, 6>(i, j).noalias() += w * of * to.transpose();
    else
      a.block<6, 6>(j, i).noalias() += w * to * of.transpose();
    b.segment<6>(i) -= w * c.height * of;
    b.segment<6>(j) -= w * c.height * to;
  }
  // Damping in the metric of sample displacements keeps undetermined motions at zero, in particular the common motion
  // of all scans.
  for (std::size_t s = 0; s < n; ++s) {
    const Eigen::Index i = 6 * static_cast<Eigen::Index>(s);
    a.block<6, 6>(i, i) += kDamping * scans[s].mass;
  }
  // For coplanar scans not even this determines the rotation.
  a.diagonal().array() += 1e-12 * a.diagonal().maxCoeff();
  const Eigen::VectorXd x = a.selfadjointView<Eigen::Lower>().ldlt().solve(b);
  double most = 0;
  for (std::size_t s = 0; s < n; ++s) {
    const Six d = x.segment<6>(6 * static_cast<Eigen::Index>(s));
    if (!d.allFinite()) continue;
    most = std::max(most, std::sqrt(d.dot(scans[s].mass * d) / static_cast<double>(scans[s].chosen.size())));
    motions[s] = motions[s].moved(centers[s], Vec3{d[3], d[4], d[5]} / scans[s].radius, 1, Vec3{d[0], d[1], d[2]});
  }
  return most;
}

/// Deviations of the samples of each scan from the others, and of theirs from it, within reach.
std::vector<double> deviations_of(const std::vector<Comparison>& all, std::size_t scans, double reach) {
  std::vector<std::vector<double>> heights(scans);
  for (const Comparison& c : all)
    if (std::abs(c.height) < reach) {
      heights[c.of].push_back(std::abs(c.height));
      heights[c.to].push_back(std::abs(c.height));
    }
  std::vector<double> found(scans);
  for (std::size_t s = 0; s < scans; ++s)
    found[s] = kDeviationOverMedian * median(heights[s]) / std::sqrt(1 + 4.0 / static_cast<double>(kOfQuadric));
  return found;
}

std::size_t index_of_largest(const std::vector<double>& values) {
  return values.empty() ? 0 : static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

/// Scans whose boxes overlap that of another scan.
std::vector<Scan> scans_of(const PointSet& points) {
  std::vector<Scan> all;
  std::vector<std::size_t> counts(PointSet::kUnknownScan, 0), slot(PointSet::kUnknownScan, 0);
  for (const std::uint16_t s : points.scan_of_point)
    if (s != PointSet::kUnknownScan) ++counts[s];
  for (std::size_t s = 0; s < counts.size(); ++s) {
    if (counts[s] < kFewestOfScan) continue;
    slot[s] = all.size();
    all.emplace_back().number = static_cast<std::uint16_t>(s);
    all.back().samples.reserve(counts[s]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint16_t s = points.scan_of_point[i];
    if (s == PointSet::kUnknownScan || counts[s] < kFewestOfScan) continue;
    Scan& scan = all[slot[s]];
    scan.samples.push_back(static_cast<std::uint32_t>(i));
    scan.box.extend(Vec3(points.positions[i]));
  }
  std::vector<std::uint8_t> alone(all.size(), 1);
  for (std::size_t s = 0; s < all.size(); ++s)
    for (std::size_t t = 0; t < s; ++t) {
      const Box3 &a = all[s].box, &b = all[t].box;
      bool apart = false;
      for (std::size_t k = 0; k < 3; ++k) apart |= a.lower[k] > b.upper[k] || b.lower[k] > a.upper[k];
      if (!apart) alone[s] = alone[t] = 0;
    }
  std::vector<Scan> kept;
  for (std::size_t s = 0; s < all.size(); ++s)
    if (!alone[s]) kept.push_back(std::move(all[s]));
  return kept;
}

}  // namespace

void ScanAlignmentOptions::validate() const {
  if (samples < 20) throw ArgumentError("`samples` must be 20 or more");
  if (rounds < 1) throw ArgumentError("`rounds` must be 1 or more");
}

std::size_t ScanAlignment::most_moved() const { return index_of_largest(displacements); }

std::size_t ScanAlignment::farthest_off() const { return index_of_largest(deviations); }

bool ScanAlignment::disagree() const {
  return !displacements.empty() && displacements[most_moved()] > std::max(noise, kTellableOverSpacing * spacing);
}

bool ScanAlignment::warped() const {
  return !deviations.empty() && displacements[most_moved()] == 0 &&
         deviations[farthest_off()] > kWarpedOverNoise * std::max(noise, kTellableOverSpacing * spacing);
}

bool has_several_scans(const PointSet& points) {
  std::optional<std::uint16_t> one;
  for (const std::uint16_t s : points.scan_of_point) {
    if (s == PointSet::kUnknownScan || one == s) continue;
    if (one) return true;
    one = s;
  }
  return false;
}

ScanAlignment find_scan_motions(const PointSet& points, const ScanAlignmentOptions& options, Progress& progress) {
  options.validate();
  if (points.normals.size() != points.size()) throw ArgumentError("find_scan_motions: the points need normals");
  ScanAlignment result;
  if (points.scan_of_point.size() != points.size() || !has_several_scans(points)) return result;
  std::size_t count = 0;
  for (const std::uint16_t s : points.scan_of_point)
    if (s != PointSet::kUnknownScan) count = std::max<std::size_t>(count, s + 1u);
  result.motions.resize(count);
  result.deviations.assign(count, 0);
  result.displacements.assign(result.motions.size(), 0);
  std::vector<Scan> scans = scans_of(points);
  if (scans.size() < 2) return result;
  if (scans.size() > kMostMovableScans)
    throw DataError("more than " + std::to_string(kMostMovableScans) + " overlapping scans: too many to align");

  std::vector<double> noises, spacings;
  for (Scan& scan : scans) {
    std::vector<Vec3f> positions;
    positions.reserve(scan.samples.size());
    for (const std::uint32_t i : scan.samples) positions.push_back(points.positions[i]);
    scan.tree = KdTree(positions);
    choose_samples(points, options.samples, scan);
    measure_scan(points, scan);
    if (scan.spacing > 0) noises.push_back(scan.noise), spacings.push_back(scan.spacing);
    progress.check();
  }
  result.noise = median(noises), result.spacing = median(spacings);
  const double widest = kWidestReach * result.spacing;
  const double narrowest = std::max(kNarrowestReach * result.spacing, kNoiseReach * result.noise);

  std::vector<Similarity> motions(scans.size());
  double width = widest;
  // Few samples suffice for the first steps and for checking convergence.
  const std::size_t check_every = std::max<std::size_t>(options.samples / kOnTheWay, 1);
  std::size_t every = check_every;
  for (int round = 0; round < options.rounds; ++round) {
    progress.check();
    std::vector<Comparison> all = compare(points, scans, motions, width, every);
    if (all.empty()) break;
    const double step = take_step(scans, all, width, motions);
    result.rounds = round + 1;
    const double last = std::max(kLastOverNoise * result.noise, kLastOverSpacing * result.spacing);
    if (width <= narrowest && step < (every > 1 ? kOnTheWayOverLast * last : last)) {
      if (every == 1) break;
      every = 1;
    }
    width = std::max(narrowest, 0.5 * width);
  }
  if (result.rounds == 0) return result;
  const std::vector<Comparison> before =
      compare(points, scans, std::vector<Similarity>(scans.size()), widest, check_every);
  const std::vector<double> deviations = deviations_of(before, scans.size(), widest);
  for (std::size_t s = 0; s < scans.size(); ++s) result.deviations[scans[s].number] = deviations[s];
  const double loss_after = mean_loss(compare(points, scans, motions, widest, check_every), narrowest);
  if (!(loss_after < kMostLossLeft * mean_loss(before, narrowest))) return result;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    double squares = 0;
    for (const std::uint32_t i : scans[s].chosen) {
      const Vec3 p(points.positions[i]);
      const double across = dot(motions[s](p) - p, Vec3(points.normals[i]));
      squares += across * across;
    }
    result.motions[scans[s].number] = motions[s];
    result.displacements[scans[s].number] = std::sqrt(squares / static_cast<double>(scans[s].chosen.size()));
  }
  return result;
}

void move_scans(PointSet& points, const std::vector<Similarity>& motions) {
  const auto known = [&](std::uint16_t scan) { return scan != PointSet::kUnknownScan; };
  for (const std::uint16_t s : points.scan_of_point)
    if (known(s) && s >= motions.size()) throw ArgumentError("move_scans: every scan needs a motion");
  parallel_for(0, points.scan_of_point.size(), 16384, [&](std::size_t i) {
    if (!known(points.scan_of_point[i])) return;
    const Similarity& m = motions[points.scan_of_point[i]];
    points.positions[i] = Vec3f(m(Vec3(points.positions[i])));
    if (!points.normals.empty()) points.normals[i] = Vec3f(m.rotate(Vec3(points.normals[i])));
    if (!points.grid_normals.empty()) points.grid_normals[i] = Vec3f(m.rotate(Vec3(points.grid_normals[i])));
  });
  for (std::size_t s = 0; s < std::min(points.scanners.size(), motions.size()); ++s)
    points.scanners[s] = Vec3f(motions[s](Vec3(points.scanners[s])));
}

}  // namespace sansmesh::inline v1
