#include "sansmesh/render/volume/iso_roots.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sansmesh::inline v1::detail {
namespace {

constexpr int kRootParts = 4;  // parts of a step that are tested for a change of sign: a cubic has up to three roots
constexpr int kRootRounds = 10;

/// Brackets the changes of sign of the cubics.
void bracket_roots(std::span<const IsoSurface> isos, const TracedRound& round, std::vector<IsoRoot>& roots) {
  for (std::size_t i = 0; i < round.active.size(); ++i) {
    const TracedWalk& walk = round.walk(i);
    const TracedSample &a = walk.before, &b = round.samples[i];
    if (!walk.started || b.again || !a.inside || !b.inside) continue;
    const double d = b.t - a.t;
    if (!(d > 0)) continue;
    const StepCubic value(a.value, a.slope * d, b.value, b.slope * d);
    for (std::size_t k = 0; k < isos.size(); ++k) {
      const double level = isos[k].value;
      double low = a.value - level;
      for (int p = 1; p <= kRootParts; ++p) {
        const double high = (p == kRootParts ? b.value : value(p / double(kRootParts))) - level;
        if ((low >= 0) != (high >= 0)) {
          IsoRoot root;
          root.walk = static_cast<std::uint32_t>(i), root.iso = static_cast<std::uint32_t>(k);
          root.low = a.t + d * (p - 1) / kRootParts, root.high = p == kRootParts ? b.t : a.t + d * p / kRootParts;
          root.low_value = low, root.high_value = high, root.d = d;
          // For a single change the ends of the step bracket as well as those of the part, and are evaluated.
          if ((a.value >= level) != (b.value >= level)) root.sure = true;
          roots.push_back(root);
        }
        low = high;
      }
    }
  }
}

/// First positions. Changes of sign of the cubic alone are one of several in their step: these are verified.
void start_roots(std::span<const IsoSurface> isos, const TracedRound& round, std::span<IsoRoot> roots) {
  for (std::size_t r = 0; r < roots.size(); ++r) {
    IsoRoot& root = roots[r];
    root.sample.t =
        root.low + (root.high - root.low) * std::clamp(root.low_value / (root.low_value - root.high_value), 0.02, 0.98);
    const auto same = [&](const IsoRoot& o) { return o.walk == root.walk && o.iso == root.iso; };
    const bool alone = (r == 0 || !same(roots[r - 1])) && (r + 1 == roots.size() || !same(roots[r + 1]));
    if (root.sure && alone) {
      const TracedSample &a = round.walk(root.walk).before, &b = round.samples[root.walk];
      const double level = isos[root.iso].value;
      root.low = a.t, root.low_value = a.value - level;
      root.high = b.t, root.high_value = b.value - level;
    } else {
      root.sure = false;
    }
  }
}

/// Narrows the bracket by `value` (minus the iso-value) and `slope` at the sample, and chooses the next position.
/// False: the root is found or rejected.
bool narrow_root(IsoRoot& root, double value, double slope, double footprint, bool halve) {
  TracedSample& now = root.sample;
  if ((value >= 0) == (root.low_value >= 0)) {
    root.low = now.t, root.low_value = value;
  } else {
    root.high = now.t, root.high_value = value;
  }
  const double tolerance = std::max(1e-4 * root.d, 0.01 * footprint);
  double next = slope != 0 ? now.t - value / slope : now.t;
  const double change = std::abs(next - now.t);
  if ((slope != 0 && change < tolerance && next >= root.low - tolerance && next <= root.high + tolerance) ||
      root.high - root.low < tolerance || value == 0) {
    root.hit = root.sure || std::abs(value) <= 4 * std::abs(slope) * tolerance;
    if (slope != 0 && change < tolerance) now.t = std::clamp(next, root.low, root.high);
    return false;
  }
  const double inner = 0.02 * (root.high - root.low);
  if (!(next > root.low + inner && next < root.high - inner) || halve) next = 0.5 * (root.low + root.high);
  now.t = next;
  return true;
}

}  // namespace

std::size_t find_iso_roots(const VolumeField& field, const TracedFrame& frame, std::span<const IsoSurface> isos,
                           const TracedRound& round, std::vector<IsoRoot>& roots) {
  roots.clear();
  bracket_roots(isos, round, roots);
  start_roots(isos, round, roots);
  std::size_t count = 0;
  std::vector<std::size_t> open(roots.size());
  for (std::size_t r = 0; r < open.size(); ++r) open[r] = r;
  std::vector<Vec3> x, gradients;
  std::vector<double> values;
  for (int turn = 0; turn < kRootRounds && !open.empty(); ++turn) {
    x.clear();
    for (const std::size_t r : open) x.push_back(frame.world(round.walk(roots[r].walk), roots[r].sample.t));
    values.resize(x.size()), gradients.resize(x.size());
    field.evaluate(x, {values, gradients});
    count += x.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      IsoRoot& root = roots[open[i]];
      TracedSample& now = root.sample;
      now.value = values[i], now.gradient = gradients[i] * frame.frame.size;
      const double slope = dot(now.gradient, round.walk(root.walk).direction);
      if (narrow_root(root, values[i] - isos[root.iso].value, slope, frame.footprint(now.t), turn > 4))
        open[kept++] = open[i];
    }
    open.resize(kept);
  }
  for (const std::size_t r : open) roots[r].hit = roots[r].sure;
  std::stable_sort(roots.begin(), roots.end(), [](const IsoRoot& a, const IsoRoot& b) {
    return a.walk != b.walk ? a.walk < b.walk : a.sample.t < b.sample.t;
  });
  return count;
}

}  // namespace sansmesh::inline v1::detail
