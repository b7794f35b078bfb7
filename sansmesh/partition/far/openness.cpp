#include "sansmesh/partition/far/openness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/assemble.h"
#include "sansmesh/partition/far/sheets.h"
#include "sansmesh/partition/far/support_patches.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Depths behind the surface at which the winding number is evaluated, in radii of a disc of the patch's area: small
/// enough for thin walls, and large enough for patches to act as a surface. The largest number counts.
constexpr std::array<float, 3> kDepths{0.5f, 1.0f, 2.0f};
/// Least decrease of the winding number across a sheet.
constexpr double kLeastJump = 0.25;
/// Largest number of sampled patches of a sheet: with more, every so many-th along the Morton curve, which gives the
/// mean to a few thousandths.
constexpr std::size_t kLookers = 2048;
/// Sheets with less of the largest one's area, those of stray samples, and those with so few samples that they may be
/// poorly sampled parts of another one, follow the others.
constexpr double kSmallSheet = 0.02;
constexpr std::size_t kFewSamples = 64;

/// Excess of the solid angle of a disc, seen from `depth` radii behind it, over that of the far field, divided by 4π:
/// the correction for a close patch, which is not a point.
float own_disc(float depth) {
  const float pi = std::numbers::pi_v<float>, r2 = depth * depth + 0.25f * pi;  // softened there
  return 0.5f * (1 - depth / std::sqrt(depth * depth + 1)) - depth / (4 * r2 * std::sqrt(r2));
}

/// Winding numbers on both sides of a patch, at the depth with the largest number behind it.
struct Sides {
  float behind = -1, before = 0;
};

std::vector<Sides> winding_sides(const GlobalSign& sign, std::span<const OrientedPatch> patches) {
  std::vector<Sides> sides(patches.size());
  parallel_ranges(0, patches.size(), 256, [&](std::size_t first, std::size_t last) {
    std::vector<Vec3f> x(2 * (last - first));
    std::vector<float> w(x.size());
    for (const float depth : kDepths) {
      for (std::size_t i = first; i < last; ++i) {
        const float area = norm(patches[i].area);
        const float distance = depth * std::sqrt(area / std::numbers::pi_v<float>);
        const Vec3f step = area > 0 ? patches[i].area * (distance / area) : Vec3f{};
        x[2 * (i - first)] = patches[i].position - step;
        x[2 * (i - first) + 1] = patches[i].position + step;
      }
      sign.winding_number(x, w);
      for (std::size_t i = first; i < last; ++i) {
        const Sides at{w[2 * (i - first)] + own_disc(depth), w[2 * (i - first) + 1] - own_disc(depth)};
        if (at.behind > sides[i].behind) sides[i] = at;
      }
    }
  });
  return sides;
}

/// Mean over the patches, weighted by their areas, of the winding number behind a complete surface. Across it the
/// number falls by 1, and by less where patches are missing, because cells that hardly touch the surface have no
/// samples.
double mean_behind(const GlobalSign& sign, std::span<const OrientedPatch> sheet) {
  const std::size_t stride = (sheet.size() + kLookers - 1) / kLookers;
  std::vector<OrientedPatch> patches;
  for (std::size_t i = 0; i < sheet.size(); i += stride) patches.push_back(sheet[i]);
  const std::vector<Sides> sides = winding_sides(sign, patches);
  double behind = 0, jump = 0, area = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const double a = static_cast<double>(norm(patches[i].area));
    behind += a * static_cast<double>(sides[i].behind);
    jump += a * static_cast<double>(sides[i].behind - sides[i].before), area += a;
  }
  return jump > kLeastJump * area ? behind / jump : 0;
}

/// Range of that number in which it is computed again from the samples: patches of cells that are wider than a thin
/// sheet leave out part of it, and close bowls come near a closed surface.
constexpr double kUncertain = 0.6, kCertain = 0.97;
/// Neighbours for the area that a sample represents.
constexpr std::size_t kNeighbours = 12;
/// Depth behind the surface, in local spacings of the samples: closer, single samples act instead of a surface.
constexpr float kSampleDepth = 1;

/// Patches of a sheet's samples. Neighbours that face away are on another sheet. A sample on a border represents no
/// more than its neighbours, although these are on one side of it only.
std::vector<OrientedPatch> sample_patches(std::span<const Vec3f> positions, std::span<const Vec3f> normals) {
  const KdTree tree(positions);
  std::vector<OrientedPatch> patches(tree.size());
  std::vector<float> area(tree.size());
  tree.for_each_nearest(kNeighbours, [&](std::uint32_t slot, std::span<const Neighbour> found) {
    float beside = 0;
    for (const Neighbour& other : found)
      beside += dot(normals[tree.order()[other.index]], normals[tree.order()[slot]]) > 0;
    const float disc = std::numbers::pi_v<float> * found.back().squared_distance / std::max(1.0f, beside - 0.5f);
    area[slot] = std::isfinite(disc) ? disc : 0;
  });
  tree.for_each_nearest(kNeighbours, [&](std::uint32_t slot, std::span<const Neighbour> found) {
    std::array<float, kNeighbours> around;
    for (std::size_t k = 0; k < found.size(); ++k) around[k] = area[found[k].index];
    const float usual = nth_smallest(std::span(around).first(found.size()), kNeighbours / 3);
    patches[slot] = {tree.position(slot), normals[tree.order()[slot]] * std::min(area[slot], usual)};
  });
  return patches;
}

/// mean_behind of a sheet from its samples.
double mean_behind_samples(const GlobalSign& sign, std::span<const OrientedPatch> samples) {
  const std::size_t stride = (samples.size() + kLookers - 1) / kLookers, n = (samples.size() + stride - 1) / stride;
  std::vector<double> behind(n), jump(n), area(n);
  parallel_ranges(0, n, 256, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const OrientedPatch& patch = samples[i * stride];
      const float size = norm(patch.area);
      if (!(size > 0)) continue;
      const Vec3f step = patch.area * (kSampleDepth * std::sqrt(size) / size);
      const std::array<Vec3f, 2> x{patch.position - step, patch.position + step};
      std::array<float, 2> w;
      sign.winding_number(x, w);
      behind[i] = static_cast<double>(w[0]), jump[i] = static_cast<double>(w[0] - w[1]);
      area[i] = static_cast<double>(size);
    }
  });
  double all_behind = 0, all_jump = 0, all = 0;
  for (std::size_t i = 0; i < n; ++i) all_behind += area[i] * behind[i], all_jump += area[i] * jump[i], all += area[i];
  // Samples this close act less than a surface, alike on both sides: the mean of the sides is that of the others.
  return all_jump > kLeastJump * all ? 0.5 + (all_behind - 0.5 * all_jump) / all : 0;
}

/// mean_behind of one sheet from the samples in the blocks of its supports, if there are enough.
std::optional<double> mean_behind_samples(const Sheets& sheets, std::size_t sheet, std::span<const Vec3f> samples,
                                          std::span<const Vec3f> normals, float unit) {
  std::vector<Vec3f> positions, directions;
  for (std::size_t i = 0; i < sheets.of_support.size(); ++i)
    if (sheets.of_support[i] == sheet)
      for (std::uint32_t j = sheets.first[i]; j < sheets.first[i] + sheets.count[i]; ++j)
        positions.push_back(samples[j]), directions.push_back(normals[j]);
  if (positions.size() < kNeighbours) return std::nullopt;
  const std::vector<OrientedPatch> patches = sample_patches(positions, directions);
  return mean_behind_samples(GlobalSign(patches, unit), patches);
}

}  // namespace

void decide_open(std::optional<bool> open, std::span<const Vec3f> samples, std::span<const Vec3f> normals,
                 PartitionData& data) {
  const std::size_t n = data.supports.size();
  std::vector<OrientedPatch> patches = support_patches(data);
  for (OrientedPatch& p : patches) p.least = 0;
  const Sheets sheets = find_sheets(data, samples);
  std::vector<std::vector<OrientedPatch>> of_sheet(sheets.size());
  std::vector<std::size_t> count(sheets.size());
  for (std::size_t i = 0; i < n; ++i)
    if (const std::uint32_t k = sheets.of_support[i]; k != Sheets::kNone)
      of_sheet[k].push_back(patches[i]), count[k] += sheets.count[i];
  std::vector<std::uint8_t> judged(sheets.size());
  for (std::size_t k = 0; k < sheets.size(); ++k)
    judged[k] = k == 0 || (sheets.area[k] >= kSmallSheet * sheets.area[0] && sheets.evidence[k] >= kLeastEvidence &&
                           count[k] >= kFewSamples);

  // A sheet is closed alone (an object above a floor, which would reduce the sum of all), or together with others that
  // are closed: a floor is not informative about the one below. Therefore open sheets are removed until nothing
  // changes.
  std::vector<double> behind(sheets.size()), alone(sheets.size());
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    if (!judged[k]) continue;
    alone[k] = mean_behind(GlobalSign(of_sheet[k], data.edge), of_sheet[k]);
    if (!open && alone[k] >= kUncertain && alone[k] <= kCertain)
      alone[k] = mean_behind_samples(sheets, k, samples, normals, data.edge).value_or(alone[k]);
  }
  std::vector<std::uint8_t> is_open(sheets.size(), 0);
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    behind[k] = alone[k];
    is_open[k] = judged[k] && sheets.size() == 1 && alone[k] < kClosedBehind;  // there are no others
  }
  const auto asks = [&](std::size_t k) { return judged[k] && !is_open[k] && alone[k] < kClosedBehind; };
  bool changed = false;
  for (std::size_t k = 0; k < sheets.size(); ++k) changed |= asks(k);
  while (changed) {
    std::vector<OrientedPatch> lent;
    for (std::size_t k = 0; k < sheets.size(); ++k)
      if (!is_open[k]) lent.insert(lent.end(), of_sheet[k].begin(), of_sheet[k].end());
    const GlobalSign together(lent, data.edge);
    changed = false;
    for (std::size_t k = 0; k < sheets.size(); ++k) {
      if (!asks(k)) continue;
      behind[k] = std::max(alone[k], mean_behind(together, of_sheet[k]));
      if (behind[k] < kClosedBehind) is_open[k] = changed = true;
    }
  }
  double area_behind = 0, area = 0, open_area = 0;
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    if (!judged[k]) continue;
    is_open[k] = open.value_or(is_open[k] != 0);
    area += sheets.area[k], area_behind += behind[k] * sheets.area[k];
    if (is_open[k]) open_area += sheets.area[k];
  }
  for (std::size_t k = 0; k < sheets.size(); ++k)
    if (!judged[k]) is_open[k] = 2 * open_area > area;
  data.report.mean_winding_number = area > 0 ? area_behind / area : 1;
  std::vector<Support> supports(data.supports.view().begin(), data.supports.view().end());
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t k = sheets.of_support[i];
    supports[i].open = k == Sheets::kNone ? 2 * open_area > area : is_open[k];
  }
  data.supports = std::move(supports);
  sum_up(data);
}

}  // namespace sansmesh::inline v1
