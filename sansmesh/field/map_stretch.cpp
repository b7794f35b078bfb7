#include "sansmesh/field/map_stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/field/inverse_map.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kNodes = 33;        // along the longest side of the box
constexpr std::size_t kFacePoints = 33;   // per edge of a face
constexpr std::size_t kBoxCells = 32;     // per edge of the box
constexpr std::size_t kStretchBlock = 6;  // nodes per axis with a common range
constexpr std::size_t kFewNodes = 100;    // up to this number, nodes are visited individually
constexpr int kMostGrowth = 60;
constexpr double kGrowth = 0.2;     // growth of the box per round
constexpr double kFarthest = 1000;  // in sizes of the source
constexpr double kBetween = 1.25;   // factor for a larger stretch of the map between points

/// Whether the image of a ball of this radius around a point with image T(x) may meet the box.
bool may_meet(const Box3& box, const Vec3& image, const Jacobian& j, double radius) {
  if (!is_finite(image)) return false;
  const double reach = kBetween * largest_stretch(j) * radius;
  for (std::size_t k = 0; k < 3; ++k)
    if (!(image[k] >= box.lower[k] - reach && image[k] <= box.upper[k] + reach)) return false;
  return true;
}

Vec3 between(const Box3& box, double u, double v, double w) {
  return {box.lower.x + u * (box.upper.x - box.lower.x), box.lower.y + v * (box.upper.y - box.lower.y),
          box.lower.z + w * (box.upper.z - box.lower.z)};
}

/// Box of the inverse images of points of the source.
Box3 box_of_inverse(const SpaceMap& map, const Box3& source) {
  constexpr int kPoints = 5;
  std::vector<Vec3> targets;
  for (int l = 0; l < kPoints; ++l)
    for (int j = 0; j < kPoints; ++j)
      for (int i = 0; i < kPoints; ++i)
        targets.push_back(between(source, i / (kPoints - 1.0), j / (kPoints - 1.0), l / (kPoints - 1.0)));
  // Inverts the centre first; the other points start from its result.
  const Vec3 middle = source.center();
  const InvertedPoints first = inverse_map(map, std::span(&middle, 1), std::span(&middle, 1));
  std::vector<Vec3> starts;
  starts.reserve(targets.size());
  for (const Vec3& u : targets) starts.push_back(first.found[0] ? u + (first.positions[0] - middle) : u);
  const InvertedPoints all = inverse_map(map, targets, starts);
  Box3 box;
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (all.found[i]) box.extend(all.positions[i]);
  return box;
}

/// Faces of the box (lower x, upper x, …) with points that may map into the source.
std::array<bool, 6> faces_met(const SpaceMap& map, const Box3& box, const Box3& source) {
  std::vector<Vec3> x;
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t j = 0; j < kFacePoints; ++j)
      for (std::size_t i = 0; i < kFacePoints; ++i) {
        std::array<double, 3> t{};
        t[face / 2] = static_cast<double>(face % 2);
        t[(face / 2 + 1) % 3] = static_cast<double>(i) / (kFacePoints - 1);
        t[(face / 2 + 2) % 3] = static_cast<double>(j) / (kFacePoints - 1);
        x.push_back(between(box, t[0], t[1], t[2]));
      }
  std::vector<Vec3> image(x.size());
  std::vector<Jacobian> j(x.size());
  map.map(x, {image, j, {}, {}});
  std::array<bool, 6> met{};
  const Vec3 size = box.size();
  for (std::size_t p = 0; p < x.size(); ++p) {
    const std::size_t face = p / (kFacePoints * kFacePoints);
    const double a = size[(face / 2 + 1) % 3], b = size[(face / 2 + 2) % 3];
    const double radius = 0.5 * std::sqrt(a * a + b * b) / (kFacePoints - 1);
    met[face] = met[face] || may_meet(source, image[p], j[p], radius);
  }
  return met;
}

}  // namespace

double largest_stretch(const Jacobian& j) {
  // Largest eigenvalue of J^T J, by the roots of its cubic.
  const double a = squared_norm(j[0]), b = squared_norm(j[1]), c = squared_norm(j[2]);
  const double d = dot(j[0], j[1]), e = dot(j[1], j[2]), f = dot(j[0], j[2]);
  const double off = d * d + e * e + f * f;
  if (off == 0) return std::sqrt(std::max({a, b, c}));
  const double mean = (a + b + c) / 3, u = a - mean, v = b - mean, w = c - mean;
  const double p = std::sqrt((u * u + v * v + w * w + 2 * off) / 6);
  const double determinant = u * (v * w - e * e) - d * (d * w - e * f) + f * (d * e - v * f);
  const double r = std::clamp(determinant / (2 * p * p * p), -1.0, 1.0);
  return std::sqrt(std::max(0.0, mean + 2 * p * std::cos(std::acos(r) / 3)));
}

MapStretch::MapStretch(const SpaceMap& map, const Box3& box) : box_(box) {
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  for (std::size_t k = 0; k < 3; ++k) {
    const double cells = longest > 0 ? std::ceil(static_cast<double>(kNodes - 1) * size[k] / longest - 1e-9) : 0;
    counts_[k] = 1 + index_in<std::size_t>(cells, size[k] > 0 ? 1 : 0, kNodes);
    inverse_[k] = size[k] > 0 ? static_cast<double>(counts_[k] - 1) / size[k] : 0;
  }
  std::vector<Vec3> x;
  x.reserve(counts_[0] * counts_[1] * counts_[2]);
  const auto share = [&](std::size_t i, std::size_t k) {
    return counts_[k] > 1 ? static_cast<double>(i) / static_cast<double>(counts_[k] - 1) : 0;
  };
  for (std::size_t l = 0; l < counts_[2]; ++l)
    for (std::size_t j = 0; j < counts_[1]; ++j)
      for (std::size_t i = 0; i < counts_[0]; ++i) x.push_back(between(box, share(i, 0), share(j, 1), share(l, 2)));
  std::vector<Jacobian> jacobians(x.size());
  map.map(x, {{}, jacobians, {}, {}});
  nodes_.resize(x.size());
  std::vector<double> known;
  for (std::size_t i = 0; i < x.size(); ++i) {
    nodes_[i] = largest_stretch(jacobians[i]);
    if (nodes_[i] > 0 && std::isfinite(nodes_[i])) known.push_back(nodes_[i]);
  }
  double usual = 1;
  if (!known.empty()) {
    usual = median(known);
    all_ = {*std::min_element(known.begin(), known.end()), *std::max_element(known.begin(), known.end())};
  }
  for (double& s : nodes_)
    if (!(s > 0) || !std::isfinite(s)) s = usual;
  for (std::size_t k = 0; k < 3; ++k) blocks_[k] = (counts_[k] + kStretchBlock - 1) / kStretchBlock;
  block_ranges_.assign(blocks_[0] * blocks_[1] * blocks_[2], {std::numeric_limits<double>::infinity(), 0});
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::size_t x0 = i % counts_[0], y0 = i / counts_[0] % counts_[1], z0 = i / counts_[0] / counts_[1];
    Range& r =
        block_ranges_[x0 / kStretchBlock + blocks_[0] * (y0 / kStretchBlock + blocks_[1] * (z0 / kStretchBlock))];
    r.least = std::min(r.least, nodes_[i]), r.most = std::max(r.most, nodes_[i]);
  }
}

double MapStretch::at(const Vec3& x, Vec3* gradient) const {
  std::size_t i[3], next[3];
  double t[3];
  bool inside[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = (x[k] - box_.lower[k]) * inverse_[k], most = static_cast<double>(counts_[k] - 1);
    inside[k] = at > 0 && at < most;
    const double coordinate = inside[k] ? at : at >= most ? most : 0;  // 0 for NaN
    i[k] = std::min(static_cast<std::size_t>(coordinate), counts_[k] > 1 ? counts_[k] - 2 : 0);
    t[k] = coordinate - static_cast<double>(i[k]);
    next[k] = std::min(i[k] + 1, counts_[k] - 1);
  }
  double row[4], slope[4];
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t j = c & 1 ? next[1] : i[1], l = c & 2 ? next[2] : i[2];
    const double a = node(i[0], j, l), b = node(next[0], j, l);
    row[c] = a + t[0] * (b - a), slope[c] = b - a;
  }
  const double low = row[0] + t[1] * (row[1] - row[0]), high = row[2] + t[1] * (row[3] - row[2]);
  if (gradient) {
    const double sx0 = slope[0] + t[1] * (slope[1] - slope[0]), sx1 = slope[2] + t[1] * (slope[3] - slope[2]);
    const double sy0 = row[1] - row[0], sy1 = row[3] - row[2];
    *gradient = {inside[0] ? (sx0 + t[2] * (sx1 - sx0)) * inverse_.x : 0,
                 inside[1] ? (sy0 + t[2] * (sy1 - sy0)) * inverse_.y : 0, inside[2] ? (high - low) * inverse_.z : 0};
  }
  return low + t[2] * (high - low);
}

MapStretch::Range MapStretch::around(const Vec3& x, double radius) const {
  std::size_t first[3], last[3];
  std::size_t count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = std::floor((x[k] - radius - box_.lower[k]) * inverse_[k]) - 1;
    const double high = std::ceil((x[k] + radius - box_.lower[k]) * inverse_[k]) + 1;
    first[k] = index_in<std::size_t>(low, 0, counts_[k] - 1);
    last[k] = index_in<std::size_t>(high, 0, counts_[k] - 1);
    count *= last[k] - first[k] + 1;
  }
  Range range{std::numeric_limits<double>::infinity(), 0};
  const auto add = [&range](const Range& r) {
    range.least = std::min(range.least, r.least), range.most = std::max(range.most, r.most);
  };
  if (count > kFewNodes) {
    for (std::size_t l = first[2] / kStretchBlock; l <= last[2] / kStretchBlock; ++l)
      for (std::size_t j = first[1] / kStretchBlock; j <= last[1] / kStretchBlock; ++j)
        for (std::size_t i = first[0] / kStretchBlock; i <= last[0] / kStretchBlock; ++i)
          add(block_ranges_[i + blocks_[0] * (j + blocks_[1] * l)]);
    return range;
  }
  for (std::size_t l = first[2]; l <= last[2]; ++l)
    for (std::size_t j = first[1]; j <= last[1]; ++j)
      for (std::size_t i = first[0]; i <= last[0]; ++i) add({node(i, j, l), node(i, j, l)});
  return range;
}

Box3 preimage_box(const SpaceMap& map, const Box3& source, std::optional<Box3> near) {
  if (source.empty()) return source;
  Box3 box = near ? *near : box_of_inverse(map, source);
  if (box.empty()) box = source;
  const double least = 1e-3 * source.diagonal();
  for (std::size_t k = 0; k < 3; ++k)  // flat boxes need faces with area
    if (box.upper[k] - box.lower[k] < least) box.lower[k] -= least, box.upper[k] += least;
  for (int round = 0;; ++round) {
    const std::array<bool, 6> met = faces_met(map, box, source);
    if (std::none_of(met.begin(), met.end(), [](bool m) { return m; })) break;
    const double step = kGrowth * box.diagonal();
    for (std::size_t face = 0; face < 6; ++face)
      if (met[face]) (face % 2 ? box.upper : box.lower)[face / 2] += face % 2 ? step : -step;
    if (round == kMostGrowth || box.diagonal() > kFarthest * source.diagonal())
      throw DataError("the deformed object has no bounds: points at any distance map into the original");
  }
  // Cells that may map into the source.
  const Vec3 step = box.size() * (1.0 / kBoxCells);
  std::vector<Vec3> x;
  for (std::size_t l = 0; l < kBoxCells; ++l)
    for (std::size_t j = 0; j < kBoxCells; ++j)
      for (std::size_t i = 0; i < kBoxCells; ++i)
        x.push_back(between(box, (static_cast<double>(i) + 0.5) / kBoxCells, (static_cast<double>(j) + 0.5) / kBoxCells,
                            (static_cast<double>(l) + 0.5) / kBoxCells));
  std::vector<Vec3> image(x.size());
  std::vector<Jacobian> j(x.size());
  map.map(x, {image, j, {}, {}});
  Box3 tight;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (may_meet(source, image[i], j[i], 0.5 * norm(step))) {
      tight.extend(x[i] - step * 0.5);
      tight.extend(x[i] + step * 0.5);
    }
  // Cells crossed by a cut map differently from their centres.
  if (!tight.empty() && map.has_gaps()) tight = {tight.lower - step, tight.upper + step};
  if (tight.empty()) throw DataError("the deformed object is empty: no point maps into the original");
  return tight;
}

}  // namespace sansmesh::inline v1
