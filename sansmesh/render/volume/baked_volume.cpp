#include "sansmesh/render/volume/baked_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/render/volume/baked_bricks.h"
#include "sansmesh/render/volume/baked_kernels.h"
#include "sansmesh/render/volume/brick_cracks.h"

namespace sansmesh::inline v1 {
namespace {

using detail::kBrickCells;

constexpr std::size_t kEnoughChecked = 50;  // one in so many check points inside is enough

/// The n-th point of an even distribution over the unit cube (Roberts' recurrence).
Vec3 spread_in_cube(std::size_t n) {
  constexpr double kG = 1.22074408460575947536;
  const auto part = [&](double step) {
    const double at = 0.5 + step * static_cast<double>(n + 1);
    return at - std::floor(at);
  };
  return {part(1 / kG), part(1 / (kG * kG)), part(1 / (kG * kG * kG))};
}

}  // namespace

BakedVolume::BakedVolume(const VolumeField& field, const BakeOptions& options, Progress& progress)
    : BakedVolume(field, options, detail::kMostBrickLevels, progress) {}

BakedVolume::BakedVolume(const VolumeField& field, const BakeOptions& options, int rounds, Progress& progress)
    : bricks_(std::make_unique<detail::BakedBricks>(field, options)) {
  progress.begin("baking");
  bricks_->add_roots(progress);
  for (int round = 0; round < rounds; ++round)
    if (!bricks_->split(progress)) break;
  detail::close_cracks(*bricks_);
  summarize();
  progress.finish();
}

/// Also measures the errors at check points and, if few of these are inside, at samples.
void BakedVolume::summarize() {
  detail::BakedBricks& s = *bricks_;
  BakeReport& report = s.report;
  s.summarize();
  std::vector<Vec3> x(detail::kBakeCheckPoints);
  const Vec3 size = s.box.size();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 u = spread_in_cube(i);
    x[i] = s.box.lower + Vec3{u.x * size.x, u.y * size.y, u.z * size.z};
  }
  std::vector<double> exact(x.size()), found(x.size());
  std::vector<std::uint8_t> inside(x.size());
  s.field->evaluate(x, {exact, {}, inside});
  report.evaluations += x.size();
  evaluate(x, {found});
  double sum = 0, most = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!inside[i]) continue;
    const double e = std::abs(exact[i] - found[i]) / s.range();
    sum += e, most = std::max(most, e), ++count;
  }
  if (count * kEnoughChecked < x.size()) {
    found.resize(s.known.size());
    evaluate(s.known, {found});
    for (std::size_t i = 0; i < s.known.size(); ++i) {
      const double e = std::abs(s.known_values[i] - found[i]) / s.range();
      sum += e, most = std::max(most, e), ++count;
    }
  }
  report.checked = count;
  report.error_mean = count > 0 ? sum / static_cast<double>(count) : 0;
  report.error_most = most;
}

BakedVolume::~BakedVolume() = default;

bool BakedVolume::refine(Progress& progress) {
  progress.begin("baking");
  const bool more = bricks_->split(progress);
  if (more) {
    detail::close_cracks(*bricks_);
    summarize();
  }
  progress.finish();
  return more;
}

const BakeReport& BakedVolume::report() const { return bricks_->report; }
Box3 BakedVolume::bounds() const { return bricks_->box; }

void BakedVolume::evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const {
  const detail::BrickTree tree = bricks_->tree();
  const detail::BakedBricks& s = *bricks_;
  constexpr std::size_t kGrain = 2048;
  parallel_ranges(0, x.size(), kGrain, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    const auto part = [&](auto span) { return span.empty() ? span : span.subspan(first, n); };
    const std::span<const Vec3> at = x.subspan(first, n);
    const std::span<double> values = part(wanted.values);
    const std::span<Vec3> gradients = part(wanted.gradients);
    if (!wanted.values.empty() || !wanted.gradients.empty()) {
      if (std::all_of(at.begin(), at.end(), [](const Vec3& p) { return is_finite(p); })) {
        detail::brick_values(tree, at, values, gradients);
      } else {
        std::vector<Vec3> cleaned(at.begin(), at.end());
        for (Vec3& p : cleaned)
          if (!is_finite(p)) p = tree.lower;
        detail::brick_values(tree, cleaned, values, gradients);
        for (std::size_t i = 0; i < n; ++i) {
          if (is_finite(at[i])) continue;
          if (!values.empty()) values[i] = 0;
          if (!gradients.empty()) gradients[i] = {};
        }
      }
    }
    if (s.value_scale != 1)
      for (double& v : values) v /= s.value_scale;
    if (s.value_scale != 1 || s.slope_scale != 1)
      for (Vec3& g : gradients) g = g / s.slope_scale / s.value_scale;
    if (wanted.inside.empty()) return;
    for (std::size_t i = first; i < last; ++i) {
      wanted.inside[i] = 0;
      if (!is_finite(x[i]) || !s.box.contains(x[i])) continue;
      if (s.whole) {
        wanted.inside[i] = 1;
        continue;
      }
      const detail::BrickPoint p = detail::brick_point(tree, x[i]);
      const detail::BakedBrick& brick = s.bricks[static_cast<std::size_t>(p.brick)];
      if (brick.inside != detail::BakedBrick::Inside::some) {
        wanted.inside[i] = brick.inside == detail::BakedBrick::Inside::all;
        continue;
      }
      const float f[3] = {p.x, p.y, p.z};
      int cell[3];
      float t[3];
      for (int k = 0; k < 3; ++k) {
        cell[k] = std::min(static_cast<int>(f[k]), kBrickCells - 1);
        t[k] = f[k] - static_cast<float>(cell[k]);
      }
      float sum = 0;
      for (int c = 0; c < 8; ++c)
        if (brick.mask[detail::node_at(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2 & 1))])
          sum += (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) * (c & 4 ? t[2] : 1 - t[2]);
      wanted.inside[i] = sum >= 0.5f;
    }
  });
}

void BakedVolume::spacing(std::span<const Vec3> x, std::span<double> found) const {
  const detail::BrickTree tree = bricks_->tree();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const detail::BrickPoint p = detail::brick_point(tree, is_finite(x[i]) ? x[i] : tree.lower);
    const detail::BakedBrick& brick = bricks_->bricks[static_cast<std::size_t>(p.brick)];
    const Vec3 e = bricks_->edges(brick.level);
    found[i] = std::max(std::min({e.x, e.y, e.z}) / kBrickCells, brick.spacing);
  }
}

void BakedVolume::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  const detail::BakedBricks& s = *bricks_;
  struct Part {
    std::int32_t branch;
    Vec3 lower;
    int level;
  };
  parallel_for(0, boxes.size(), 64, [&](std::size_t i) {
    ValueRange r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    std::vector<Part> open;
    int low[3], high[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto root_of = [&](double x) {
        return index_in<int>((x - s.box.lower[k]) / s.root[k], 0, s.counts[k] - 1);
      };
      low[k] = root_of(boxes[i].lower[k]), high[k] = root_of(boxes[i].upper[k]);
    }
    for (int c = low[2]; c <= high[2]; ++c)
      for (int b = low[1]; b <= high[1]; ++b)
        for (int a = low[0]; a <= high[0]; ++a)
          open.push_back({s.branches[static_cast<std::size_t>(a + s.counts[0] * (b + s.counts[1] * c))],
                          s.box.lower + Vec3{a * s.root.x, b * s.root.y, c * s.root.z}, 0});
    while (!open.empty()) {
      const Part part = open.back();
      open.pop_back();
      if (part.branch < 0) {
        const detail::BakedBrick& brick = s.bricks[static_cast<std::size_t>(~part.branch)];
        r.least = std::min(r.least, static_cast<double>(brick.least) / s.value_scale);
        r.most = std::max(r.most, static_cast<double>(brick.most) / s.value_scale);
        continue;
      }
      const Vec3 half = s.edges(part.level + 1);
      for (int c = 0; c < 8; ++c) {
        const Vec3 lower = part.lower + Vec3{c & 1 ? half.x : 0, c & 2 ? half.y : 0, c & 4 ? half.z : 0};
        bool apart = false;
        for (std::size_t k = 0; k < 3; ++k) {
          // Points outside the box have the values of its faces.
          const double from = std::clamp(boxes[i].lower[k], s.box.lower[k], s.box.upper[k]);
          const double to = std::clamp(boxes[i].upper[k], s.box.lower[k], s.box.upper[k]);
          apart = apart || lower[k] > to + 1e-9 * half[k] || lower[k] + half[k] < from - 1e-9 * half[k];
        }
        if (!apart) open.push_back({s.branches[static_cast<std::size_t>(part.branch + c)], lower, part.level + 1});
      }
    }
    found[i] = r;
  });
}

namespace {

constexpr ReportRow kBakeReportRows[] = {
    reported<&BakeReport::bricks>({.text = "Bricks of the baked field"}),
    reported<&BakeReport::bytes>({.text = "Memory of the bricks", .unit = "bytes"}),
    reported<&BakeReport::finished>({.text = "Whether the refinement is complete"}),
    reported<&BakeReport::checked>({.text = "Points of the error estimate"}),
    reported<&BakeReport::error_mean>({.text = "Mean error there", .unit = "share of the range"}),
    reported<&BakeReport::error_most>({.text = "Largest error there", .unit = "share of the range"})};

}  // namespace

const ReportSchema& BakeReport::schema() {
  static constexpr ReportSchema schema{kBakeReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
