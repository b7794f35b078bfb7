#include "sansmesh/field/deformed_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMoreStretch = 1.25;  // factor of the stretch at lattice nodes
/// Blocks are halved until they are no larger than the detail, so the detail itself is rarely a block size. With this
/// factor the mean block size equals that before the deformation.
constexpr double kBlocksAbout = 1.4;
constexpr std::size_t kFieldGrain = 4096;
/// Distance of the test points in radii: every half-space that meets the ball contains one of them.
constexpr double kLookAt = 1.25;

/// Corners and face centres of a cube, on the unit ball.
constexpr std::size_t kBallPoints = 14;
std::array<Vec3, kBallPoints> ball_points() {
  std::array<Vec3, kBallPoints> p;
  const double c = 1 / std::sqrt(3.0);
  for (std::size_t i = 0; i < 8; ++i) p[i] = {i & 1 ? c : -c, i & 2 ? c : -c, i & 4 ? c : -c};
  for (std::size_t i = 0; i < 6; ++i) p[8 + i][i / 2] = i % 2 ? 1 : -1;
  return p;
}

/// Finite part of a possibly infinite box, for evaluating lengths.
Box3 finite_part(const Box3& box) {
  Box3 part;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool low = std::isfinite(box.lower[k]), high = std::isfinite(box.upper[k]);
    part.lower[k] = low ? box.lower[k] : high ? box.upper[k] - 1 : -1;
    part.upper[k] = high ? box.upper[k] : low ? box.lower[k] + 1 : 1;
  }
  return part;
}

Box3 box_after(const ScalarField& source, const SpaceMap& map, const std::optional<Box3>& near) {
  const Box3 box = source.bounds();
  if (box.empty() || (is_finite(box.lower) && is_finite(box.upper))) return preimage_box(map, box, near);
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  return {{-kEnd, -kEnd, -kEnd}, {kEnd, kEnd, kEnd}};
}

}  // namespace

struct DeformedField::Sources {
  std::vector<Vec3> source;
  std::vector<Jacobian> jacobians;
  std::vector<double> gaps;
  std::vector<Vec3> gap_gradients;
  std::vector<std::uint8_t> defined;
};

/// Results at test points around each ball: their sources, whether a cut may pass, and the range of the gaps.
struct DeformedField::Around {
  std::vector<Vec3> sources;
  std::vector<ValueRange> gaps;
  std::vector<std::uint8_t> cut, undefined;
};

DeformedField::DeformedField(std::shared_ptr<const ScalarField> source, std::shared_ptr<const SpaceMap> map,
                             std::optional<Box3> near)
    : source_(std::move(source)),
      pieces_(dynamic_cast<const PiecewiseField*>(source_.get())),
      map_(std::move(map)),
      gaps_(map_->has_gaps()),
      bounds_(box_after(*source_, *map_, near)),
      stretch_(*map_, near && !is_finite(bounds_.lower) ? *near : finite_part(bounds_)),
      nothing_(finite_part(bounds_).empty() ? 1 : finite_part(bounds_).diagonal()) {}

DeformedField::Sources DeformedField::sources(std::span<const Vec3> x, bool jacobians) const {
  Sources p;
  p.source.resize(x.size()), p.defined.resize(x.size());
  if (jacobians) p.jacobians.resize(x.size());
  if (gaps_) p.gaps.resize(x.size());
  if (gaps_ && jacobians) p.gap_gradients.resize(x.size());
  map_->map(x, {p.source, p.jacobians, p.gaps, p.gap_gradients});
  for (std::size_t i = 0; i < x.size(); ++i) {
    p.defined[i] = is_finite(p.source[i]);
    if (!p.defined[i]) p.source[i] = source_->bounds().empty() ? Vec3{} : finite_part(source_->bounds()).center();
  }
  return p;
}

void DeformedField::finish(const Sources& p, std::span<const Vec3> x, std::span<double> values,
                           std::span<Vec3> gradients, bool with_gaps) const {
  parallel_for(0, x.size(), kFieldGrain, [&](std::size_t i) {
    if (!p.defined[i]) {
      values[i] = nothing_;
      if (!gradients.empty()) gradients[i] = {};
    } else {
      Vec3 slope;
      const double s = stretch_.at(x[i], gradients.empty() ? nullptr : &slope);
      values[i] /= s;
      if (!gradients.empty()) {
        const Jacobian& j = p.jacobians[i];
        const Vec3 g = gradients[i];
        gradients[i] = Vec3{dot(j[0], g) - values[i] * slope.x, dot(j[1], g) - values[i] * slope.y,
                            dot(j[2], g) - values[i] * slope.z} /
                       s;
      }
    }
    if (!with_gaps || !gaps_ || !(p.gaps[i] > values[i])) return;
    values[i] = p.gaps[i];
    if (!gradients.empty()) gradients[i] = p.gap_gradients[i];
  });
}

void DeformedField::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  const Sources p = sources(x, !gradients.empty());
  source_->evaluate(p.source, values, gradients);
  finish(p, x, values, gradients, true);
}

void DeformedField::evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                       std::span<std::uint8_t> inside) const {
  const Sources p = sources(x, !gradients.empty());
  source_->evaluate_in_domain(p.source, values, gradients, inside);
  finish(p, x, values, gradients, true);
  for (std::size_t i = 0; i < x.size(); ++i) inside[i] = inside[i] && p.defined[i];
}

void DeformedField::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  const Sources p = sources(x, false);
  const std::size_t n = x.size();
  std::vector<MapStretch::Range> stretch(n);
  for (std::size_t i = 0; i < n; ++i) {
    stretch[i] = stretch_.around(x[i], gaps_ ? kLookAt * radius : radius);
    stretch[i].most *= kMoreStretch, stretch[i].least /= kMoreStretch;
  }
  Around around;
  if (gaps_) around = look_around(x, radius, p, stretch);
  // The sources of a ball are in balls around the sources of these points.
  struct SourceBall {
    std::size_t of;
    Vec3 middle;
    int size;  // in quarters of octaves: balls of similar size are queried together
  };
  std::vector<SourceBall> balls;
  const auto add = [&](std::size_t i, const Vec3& middle, double times) {
    balls.push_back({i, middle, whole_part<int>(std::ceil(4 * std::log2(times * stretch[i].most)))});
  };
  for (std::size_t i = 0; i < n; ++i) {
    add(i, p.source[i], 1);
    // The map jumps across a cut; a test point beside it is connected with each point on its side by a straight line.
    if (gaps_ && around.cut[i])
      for (std::size_t k = 0; k < kBallPoints; ++k) add(i, around.sources[kBallPoints * i + k], 1 + kLookAt);
    found[i] = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  }
  std::stable_sort(balls.begin(), balls.end(),
                   [](const SourceBall& a, const SourceBall& b) { return a.size < b.size; });
  std::vector<Vec3> y;
  std::vector<ValueRange> part;
  for (std::size_t first = 0, last = 0; first < balls.size(); first = last) {
    y.clear();
    for (last = first; last < balls.size() && balls[last].size == balls[first].size; ++last)
      y.push_back(balls[last].middle);
    part.resize(y.size());
    source_->ranges(y, radius * std::exp2(balls[first].size / 4.0), part);
    for (std::size_t k = 0; k < y.size(); ++k) {
      const std::size_t i = balls[first + k].of;
      const auto& [least, most] = stretch[i];
      found[i].least = std::min(found[i].least, part[k].least / (part[k].least < 0 ? least : most));
      found[i].most = std::max(found[i].most, part[k].most / (part[k].most > 0 ? least : most));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    // Outside the domain of the map nothing is known about the neighbourhood.
    if (!p.defined[i] || (gaps_ && around.undefined[i])) found[i] = {-nothing_, nothing_};
    if (!gaps_) continue;
    const ValueRange& gap = around.gaps[i];
    if (gap.most > -nothing_) found[i] = {std::max(found[i].least, gap.least), std::max(found[i].most, gap.most)};
  }
}

DeformedField::Around DeformedField::look_around(std::span<const Vec3> x, double radius, const Sources& p,
                                                 std::span<const MapStretch::Range> stretch) const {
  static const std::array<Vec3, kBallPoints> kBall = ball_points();
  const std::size_t n = x.size();
  std::vector<Vec3> beside;
  beside.reserve(kBallPoints * n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Vec3& d : kBall) beside.push_back(x[i] + d * (kLookAt * radius));
  Around a;
  a.sources.resize(beside.size()), a.gaps.resize(n), a.cut.resize(n), a.undefined.resize(n);
  std::vector<double> gaps(beside.size());
  map_->map(beside, {a.sources, {}, gaps, {}});
  const double change = kAssumedSlope * radius;
  for (std::size_t i = 0; i < n; ++i) {
    double least = p.gaps[i], most = p.gaps[i];
    const double farthest = kLookAt * radius * stretch[i].most;
    for (std::size_t k = 0; k < kBallPoints; ++k) {
      const double g = gaps[kBallPoints * i + k];
      least = std::min(least, g), most = std::max(most, g);
      Vec3& source = a.sources[kBallPoints * i + k];
      if (!is_finite(source)) a.undefined[i] = 1, source = p.source[i];
      if (norm(source - p.source[i]) > farthest) a.cut[i] = 1;
    }
    a.gaps[i] = {least - change, most + change};
    if (most + change > 0) a.cut[i] = 1;
  }
  return a;
}

void DeformedField::active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const {
  const Sources p = sources(x, false);
  if (pieces_)
    pieces_->active(p.source, piece);
  else
    std::fill_n(piece.begin(), x.size(), 0u);
  if (!gaps_) return;
  std::vector<double> values(x.size());
  source_->evaluate(p.source, values);
  finish(p, x, values, {}, false);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (p.gaps[i] > values[i]) piece[i] = source_pieces();
}

void DeformedField::evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                                   std::span<Vec3> gradients) const {
  const Sources p = sources(x, !gradients.empty());
  if (piece == source_pieces()) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = std::max(p.gaps[i], -nothing_);
      if (!gradients.empty()) gradients[i] = p.gap_gradients[i];
    }
    return;
  }
  if (pieces_)
    pieces_->evaluate_piece(piece, p.source, values, gradients);
  else
    source_->evaluate(p.source, values, gradients);
  finish(p, x, values, gradients, false);
}

double DeformedField::thickness() const {
  return pieces_ ? pieces_->thickness() / stretch_.range().most : std::numeric_limits<double>::infinity();
}

void DeformedField::survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
                           std::span<Surroundings> around) const {
  const Sources p = sources(x, false);
  const double most = kMoreStretch * stretch_.range().most;
  if (pieces_)
    pieces_->survey(p.source, {reach.detail * most, reach.alone * most}, values, around);
  else
    PiecewiseField::survey(x, reach, values, around);
  if (pieces_) finish(p, x, values, {}, true);
  for (std::size_t i = 0; i < x.size(); ++i) {
    Surroundings& a = around[i];
    // A single piece has no neighbours.
    if (!pieces_) a.alone = std::numeric_limits<double>::infinity();
    a.alone /= kMoreStretch * stretch_.around(x[i], reach.alone).most;
    a.detail *= kBlocksAbout / stretch_.at(x[i]);
    if (!p.defined[i]) a = {};
    if (gaps_ && std::isfinite(p.gaps[i])) a.alone = std::min(a.alone, std::abs(p.gaps[i] - values[i]) / kAssumedSlope);
  }
}

}  // namespace sansmesh::inline v1
