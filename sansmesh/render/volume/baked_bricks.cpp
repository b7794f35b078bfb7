#include "sansmesh/render/volume/baked_bricks.h"

#include <numeric>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/render/volume/value_histogram.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr int kRootsAlong = 2;   // along the longest side
constexpr double kFinest = 0.5;  // share of the spacing: cells as fine as this are not split
constexpr double kCoarsest = 3;  // multiple of the spacing: coarser cells could miss details, whatever their error
constexpr double kStubborn =
    0.8;  // share of its parent's error: a larger remaining error after a split indicates a jump instead of curvature
constexpr double kMissed = 1e9;  // urgency of bricks that hold samples but no point found inside
constexpr std::size_t kBrickBatch = 96;

}  // namespace

BakedBricks::BakedBricks(const VolumeField& f, const BakeOptions& o) : field(&f), options(o) {
  options.validate();
  if (f.components() != 1) throw ArgumentError("only fields of one component can be baked");
  box = f.bounds();
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper) || !(box.diagonal() > 0))
    throw DataError("the volume has no extent");
  Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  const Vec3 center = box.center();
  for (std::size_t k = 0; k < 3; ++k) size[k] = std::max(size[k], 1e-4 * longest);
  box = {center - size * 0.5, center + size * 0.5};
  for (std::size_t k = 0; k < 3; ++k) {
    counts[k] = index_in<int>(std::round(kRootsAlong * size[k] / longest), 1, kRootsAlong);
    root[k] = size[k] / counts[k];
  }
  report.least = std::numeric_limits<double>::infinity(), report.most = -report.least;
  for (std::size_t i = 0; i < options.samples.size(); ++i)
    if (is_finite(options.samples[i])) pending.push_back(i);
  slope_scale = binary_scale(1 / longest);
  known = selected_points(options.samples, kBakeCheckPoints);
  known_values.resize(known.size());
  f.evaluate(known, {known_values});
  report.evaluations += known.size();
  for (const double v : known_values) report.least = std::min(report.least, v), report.most = std::max(report.most, v);
}

void BakedBricks::add_roots(Progress& progress) {
  std::vector<BakedBrick> roots;
  for (int k = 0; k < counts[2]; ++k)
    for (int j = 0; j < counts[1]; ++j)
      for (int i = 0; i < counts[0]; ++i) {
        BakedBrick b;
        b.branch = static_cast<std::int32_t>(roots.size()), b.at = {i, j, k};
        roots.push_back(std::move(b));
      }
  branches.resize(roots.size());
  bricks.resize(roots.size());
  nodes.resize(roots.size() * kBrickSize);
  std::vector<std::size_t> slots(roots.size());
  std::iota(slots.begin(), slots.end(), std::size_t{0});
  std::vector<BakedBrick> again = roots;
  fill(roots, slots, progress);
  value_scale = binary_scale(std::max(std::abs(report.least), std::abs(report.most)));
  if (value_scale != 1) fill(again, slots, progress);
  note_sample_spacings(progress);
}

/// Passes the local spacing of samples to bricks that seem to miss the volume.
void BakedBricks::note_sample_spacings(Progress& progress) {
  progress.check();
  const BrickTree own = tree();
  std::vector<std::int32_t> in(pending.size());
  parallel_for(0, pending.size(), 4096,
               [&](std::size_t i) { in[i] = brick_point(own, options.samples[pending[i]]).brick; });
  std::vector<std::int32_t> holders;
  std::vector<Vec3> x;
  std::size_t left = 0;
  for (std::size_t i = 0; i < pending.size(); ++i) {
    const BakedBrick::Inside inside = bricks[static_cast<std::size_t>(in[i])].inside;
    if (inside == BakedBrick::Inside::all) continue;  // found, and so are all its parts
    if (inside == BakedBrick::Inside::none) holders.push_back(in[i]), x.push_back(options.samples[pending[i]]);
    pending[left++] = pending[i];
  }
  pending.resize(left);
  std::vector<double> spacings(x.size());
  field->spacing(x, spacings);
  for (std::size_t i = 0; i < x.size(); ++i) {
    double& held = bricks[static_cast<std::size_t>(holders[i])].held;
    held = std::min(held, spacings[i]);
  }
}

/// Samples bricks and stores them.
void BakedBricks::fill(std::vector<BakedBrick>& made, std::span<const std::size_t> slots, Progress& progress) {
  std::vector<Vec3> x, probes;
  std::vector<double> values, spacings;
  std::vector<Vec3> gradients;
  std::vector<std::uint8_t> inside;
  constexpr std::size_t kMiddles = static_cast<std::size_t>(kBrickCells) * kBrickCells * kBrickCells;
  constexpr std::size_t kEach = kNodesOfBrick + kMiddles;
  for (std::size_t first = 0; first < made.size(); first += kBrickBatch) {
    progress.check();
    const std::size_t last = std::min(first + kBrickBatch, made.size()), n = last - first;
    x.clear(), probes.clear();
    for (std::size_t b = first; b < last; ++b) {
      const Vec3 e = edges(made[b].level), h = e / kBrickCells;
      const Vec3 low = box.lower + Vec3{made[b].at[0] * e.x, made[b].at[1] * e.y, made[b].at[2] * e.z};
      for (int k = 0; k < kBrickNodes; ++k)
        for (int j = 0; j < kBrickNodes; ++j)
          for (int i = 0; i < kBrickNodes; ++i) x.push_back(low + Vec3{i * h.x, j * h.y, k * h.z});
      for (int k = 0; k < kBrickCells; ++k)
        for (int j = 0; j < kBrickCells; ++j)
          for (int i = 0; i < kBrickCells; ++i)
            x.push_back(low + Vec3{(i + 0.5) * h.x, (j + 0.5) * h.y, (k + 0.5) * h.z});
      for (int p = 0; p < 9; ++p) {
        const auto at = [&](int bit) { return p == 8 ? 0.5 : p >> bit & 1 ? 0.8 : 0.2; };
        probes.push_back(low + Vec3{at(0) * e.x, at(1) * e.y, at(2) * e.z});
      }
    }
    values.resize(x.size()), gradients.resize(x.size()), inside.resize(x.size()), spacings.resize(probes.size());
    field->evaluate(x, {values, gradients, inside});
    field->spacing(probes, spacings);
    report.evaluations += x.size();
    parallel_for(0, n, 4, [&](std::size_t q) {
      BakedBrick& brick = made[first + q];
      float* out = nodes.data() + slots[first + q] * kBrickSize;
      const std::size_t start = q * kEach;
      std::size_t in = 0;
      for (std::size_t v = 0; v < kNodesOfBrick; ++v) {
        const std::size_t p = start + v;
        out[4 * v] = kept_value(values[p]);
        for (std::size_t k = 0; k < 3; ++k) out[4 * v + 1 + k] = kept_slope(gradients[p][k]);
        in += inside[p] != 0;
      }
      const auto middles_in = std::any_of(inside.begin() + static_cast<std::ptrdiff_t>(start + kNodesOfBrick),
                                          inside.begin() + static_cast<std::ptrdiff_t>(start + kEach),
                                          [](std::uint8_t i) { return i != 0; });
      brick.inside = in == kNodesOfBrick      ? BakedBrick::Inside::all
                     : in == 0 && !middles_in ? BakedBrick::Inside::none
                                              : BakedBrick::Inside::some;
      if (brick.inside == BakedBrick::Inside::some)
        brick.mask.assign(inside.begin() + static_cast<std::ptrdiff_t>(start),
                          inside.begin() + static_cast<std::ptrdiff_t>(start + kNodesOfBrick));
      brick.error = 0;
      std::size_t m = start + kNodesOfBrick;
      for (int k = 0; k < kBrickCells; ++k)
        for (int j = 0; j < kBrickCells; ++j)
          for (int i = 0; i < kBrickCells; ++i, ++m) {
            if (!inside[m]) continue;
            double mean = 0;
            for (int c = 0; c < 8; ++c)
              mean += 0.125 * static_cast<double>(out[4 * node_at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1))]);
            brick.error = std::max(brick.error, std::abs(mean / value_scale - values[m]));
          }
      brick.stubborn = brick.level > 0 && brick.error > kStubborn * brick.parent_error ? brick.stubborn + 1 : 0;
      double* own = spacings.data() + 9 * q;
      std::nth_element(own, own + 4, own + 9);
      brick.spacing = own[4];
    });
    for (std::size_t p = 0; p < x.size(); ++p)
      if (inside[p]) report.least = std::min(report.least, values[p]), report.most = std::max(report.most, values[p]);
    for (std::size_t b = first; b < last; ++b) {
      branches[static_cast<std::size_t>(made[b].branch)] = ~static_cast<std::int32_t>(slots[b]);
      bricks[slots[b]] = std::move(made[b]);
    }
  }
}

/// Priority of splitting a brick; above 1 it should be split.
double BakedBricks::urgency(const BakedBrick& b) const {
  if (b.level >= kMostBrickLevels) return 0;
  const double cell = longest_cell(b);
  // Bricks that miss samples come first.
  if (b.inside == BakedBrick::Inside::none) return cell > b.held ? kMissed * cell / b.held : 0;
  if (cell <= kFinest * b.spacing || (b.stubborn > 1 && cell <= b.spacing)) return 0;
  const double wanted = b.error / (options.tolerance * range());
  // A coarse brick without a known error comes after all bricks with too large errors.
  const double coarse = cell > kCoarsest * b.spacing ? 1 + 1e-9 * cell / b.spacing : 0;
  return std::max(wanted, coarse);
}

void BakedBricks::restore_hanging() {
  for (const auto& [at, before] : hanging)
    std::copy(before.begin(), before.end(), nodes.begin() + static_cast<std::ptrdiff_t>(at));
  hanging.clear();
}

bool BakedBricks::split(Progress& progress) {
  std::vector<std::pair<double, std::size_t>> worst;
  for (std::size_t b = 0; b < bricks.size(); ++b)
    if (const double u = urgency(bricks[b]); u > 1) worst.emplace_back(-u, b);
  if (worst.empty()) return false;
  std::sort(worst.begin(), worst.end());
  const std::size_t most = options.memory / (kBrickSize * sizeof(float));
  const std::size_t room = most > bricks.size() ? (most - bricks.size()) / 7 : 0;
  if (room == 0) return false;
  if (worst.size() > room) worst.resize(room);
  restore_hanging();
  std::vector<BakedBrick> made;
  std::vector<std::size_t> slots;
  for (const auto& [u, b] : worst) {
    const BakedBrick parent = bricks[b];
    const auto children = static_cast<std::int32_t>(branches.size());
    branches[static_cast<std::size_t>(parent.branch)] = children;
    branches.resize(branches.size() + 8);
    for (int c = 0; c < 8; ++c) {
      BakedBrick child;
      child.branch = children + c, child.level = parent.level + 1;
      child.parent_error = parent.error, child.stubborn = parent.stubborn;
      child.at = {2 * parent.at[0] + (c & 1), 2 * parent.at[1] + (c >> 1 & 1), 2 * parent.at[2] + (c >> 2 & 1)};
      if (c == 0) {
        slots.push_back(b);
      } else {
        slots.push_back(bricks.size());
        bricks.emplace_back();
      }
      made.push_back(std::move(child));
    }
  }
  nodes.resize(bricks.size() * kBrickSize);
  fill(made, slots, progress);
  note_sample_spacings(progress);
  return true;
}

void BakedBricks::summarize() {
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    const float* from = nodes.data() + b * kBrickSize;
    float least = from[0], most = from[0];
    for (std::size_t v = 0; v < kNodesOfBrick; ++v)
      least = std::min(least, from[4 * v]), most = std::max(most, from[4 * v]);
    bricks[b].least = least, bricks[b].most = most;
  }
  report.bricks = bricks.size();
  report.bytes = nodes.size() * sizeof(float) + branches.size() * sizeof(std::int32_t) +
                 bricks.size() * sizeof(BakedBrick) + hanging.size() * sizeof(hanging[0]);
  report.levels = 0, report.cell_error_most = 0;
  report.finished = whole = true;
  for (const BakedBrick& b : bricks) {
    whole = whole && b.inside == BakedBrick::Inside::all;
    report.levels = std::max(report.levels, b.level + 1);
    report.cell_error_most = std::max(report.cell_error_most, b.error / range());
    report.bytes += b.mask.size();
    if (urgency(b) > 1 || (b.inside == BakedBrick::Inside::none && longest_cell(b) > b.held)) report.finished = false;
  }
}

}  // namespace sansmesh::inline v1::detail
