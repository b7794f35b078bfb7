#include "sansmesh/render/volume/baked_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "sansmesh/core/binary_scale.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/render/volume/baked_kernels.h"
#include "sansmesh/render/volume/value_histogram.h"

namespace sansmesh::inline v1 {
namespace {

using detail::kBrickCells;
using detail::kBrickNodes;
using detail::kBrickSize;

constexpr int kRootsAlong = 2;  // the longest side
constexpr int kMostLevels = 12;
constexpr double kFinest = 0.5;    // of the spacing: cells as fine as this are not split
constexpr double kCoarsest = 3;    // of the spacing: cells coarser than this could hide something, whatever their error
constexpr double kStubborn = 0.8;  // of its parent's error: that much left after a split is no curvature but a jump
constexpr double kMissed = 1e9;    // urgency of bricks that hold places but no point found inside
constexpr std::size_t kEnoughChecked = 50;  // of the points of the check one in so many inside is enough
constexpr std::size_t kBrickBatch = 96;
constexpr std::size_t kCheckPoints = 20000;
constexpr std::size_t kNodesOfBrick = kBrickSize / 4;

constexpr std::size_t node_at(int i, int j, int k) {
  return static_cast<std::size_t>(i + kBrickNodes * (j + kBrickNodes * k));
}

/// Where the n-th of an even spread of points over the unit cube lies (Roberts' recurrence).
Vec3 spread_in_cube(std::size_t n) {
  constexpr double kG = 1.22074408460575947536;
  const auto part = [&](double step) {
    const double at = 0.5 + step * static_cast<double>(n + 1);
    return at - std::floor(at);
  };
  return {part(1 / kG), part(1 / (kG * kG)), part(1 / (kG * kG * kG))};
}

}  // namespace

void BakeOptions::validate() const {
  check_range("tolerance", tolerance, 1e-6, 1);
  if (memory < std::size_t{1} << 20) throw ArgumentError("`memory` must be at least 1 MB (1048576)");
}

struct BakedVolume::State {
  enum class Inside : std::uint8_t { none, some, all };

  struct Brick {
    std::int32_t branch = 0;  ///< its entry in `branches`
    int level = 0;
    std::array<int, 3> at{};    ///< in bricks of its level
    float least = 0, most = 0;  ///< of its nodes
    double error = 0;           ///< at the middles of its cells, those in the volume
    double spacing = 0;         ///< of the field
    double parent_error = 0;
    double held = std::numeric_limits<double>::infinity();  ///< least spacing at the places in it, where `none`
    int stubborn = 0;                                       ///< generations in a row that splitting did not help
    Inside inside = Inside::none;
    std::vector<std::uint8_t> mask;  ///< of nodes, where `some`
  };

  const VolumeField* field;
  BakeOptions options;
  bool whole = false;  ///< all that is in the box is in the volume
  BakeReport report;
  Box3 box;
  std::array<int, 3> counts{1, 1, 1};
  Vec3 root;  ///< edges of a root
  double value_scale = 1,
         slope_scale = 1;  ///< powers of two: nodes are the value times the first, its slopes times both
  std::vector<std::int32_t> branches;
  std::vector<Brick> bricks;
  std::vector<float> nodes;
  std::vector<std::size_t> pending;  ///< places whose bricks are not full
  std::vector<Vec3> known;           ///< some of the places, with the field's values
  std::vector<double> known_values;
  /// Nodes that took what a coarser brick says, with what they were before.
  std::vector<std::pair<std::size_t, std::array<float, 4>>> hanging;

  State(const VolumeField& f, const BakeOptions& o) : field(&f), options(o) {
    options.validate();
    if (f.components() != 1) throw ArgumentError("a field of one component can be baked");
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
    for (std::size_t i = 0; i < options.places.size(); ++i)
      if (is_finite(options.places[i])) pending.push_back(i);
    slope_scale = binary_scale(1 / longest);
    known = some_places(options.places, kCheckPoints);
    known_values.resize(known.size());
    f.evaluate(known, {known_values});
    report.evaluations += known.size();
    for (const double v : known_values)
      report.least = std::min(report.least, v), report.most = std::max(report.most, v);
  }

  detail::BrickTree tree() const {
    return {branches.data(),
            nodes.data(),
            box.lower,
            {1 / root.x, 1 / root.y, 1 / root.z},
            {counts[0], counts[1], counts[2]}};
  }
  Vec3 edges(int level) const { return root * std::ldexp(1.0, -level); }
  double longest_cell(const Brick& b) const {
    const Vec3 e = edges(b.level);
    return std::max({e.x, e.y, e.z}) / kBrickCells;
  }
  /// How values and slopes are kept: floats that are about 1 large, or ordinary ones as they are.
  float kept_value(double v) const { return kept(v * value_scale); }
  float kept_slope(double v) const { return kept(v * value_scale * slope_scale); }
  static float kept(double v) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(v, -kMost, kMost));
  }
  double range() const { return report.most > report.least ? report.most - report.least : 1; }

  void add_roots(Progress& progress) {
    std::vector<Brick> roots;
    for (int k = 0; k < counts[2]; ++k)
      for (int j = 0; j < counts[1]; ++j)
        for (int i = 0; i < counts[0]; ++i) {
          Brick b;
          b.branch = static_cast<std::int32_t>(roots.size()), b.at = {i, j, k};
          roots.push_back(std::move(b));
        }
    branches.resize(roots.size());
    bricks.resize(roots.size());
    nodes.resize(roots.size() * kBrickSize);
    std::vector<std::size_t> slots(roots.size());
    std::iota(slots.begin(), slots.end(), std::size_t{0});
    std::vector<Brick> again = roots;
    fill(roots, slots, progress);
    value_scale = binary_scale(std::max(std::abs(report.least), std::abs(report.most)));
    if (value_scale != 1) fill(again, slots, progress);
    hold_places(progress);
  }

  /// Tells bricks that seem to miss the volume how fine it is in them.
  void hold_places(Progress& progress) {
    progress.check();
    const detail::BrickTree own = tree();
    std::vector<std::int32_t> in(pending.size());
    parallel_for(0, pending.size(), 4096,
                 [&](std::size_t i) { in[i] = detail::brick_place(own, options.places[pending[i]]).brick; });
    std::vector<std::int32_t> holders;
    std::vector<Vec3> x;
    std::size_t left = 0;
    for (std::size_t i = 0; i < pending.size(); ++i) {
      const Inside inside = bricks[static_cast<std::size_t>(in[i])].inside;
      if (inside == Inside::all) continue;  // found, and so is all that it will be split into
      if (inside == Inside::none) holders.push_back(in[i]), x.push_back(options.places[pending[i]]);
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

  /// Samples bricks and puts them where they belong.
  void fill(std::vector<Brick>& made, std::span<const std::size_t> slots, Progress& progress) {
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
        Brick& brick = made[first + q];
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
        brick.inside = in == kNodesOfBrick ? Inside::all : in == 0 && !middles_in ? Inside::none : Inside::some;
        if (brick.inside == Inside::some)
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

  /// How much a brick should be split: more than 1 if it should.
  double urgency(const Brick& b) const {
    if (b.level >= kMostLevels) return 0;
    const double cell = longest_cell(b);
    // What is missed altogether comes first.
    if (b.inside == Inside::none) return cell > b.held ? kMissed * cell / b.held : 0;
    if (cell <= kFinest * b.spacing || (b.stubborn > 1 && cell <= b.spacing)) return 0;
    const double wanted = b.error / (options.tolerance * range());
    // A brick that has no error yet but is coarse comes after all that are known to be wrong.
    const double coarse = cell > kCoarsest * b.spacing ? 1 + 1e-9 * cell / b.spacing : 0;
    return std::max(wanted, coarse);
  }

  bool split(Progress& progress) {
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
    std::vector<Brick> made;
    std::vector<std::size_t> slots;
    for (const auto& [u, b] : worst) {
      const Brick parent = bricks[b];
      const auto children = static_cast<std::int32_t>(branches.size());
      branches[static_cast<std::size_t>(parent.branch)] = children;
      branches.resize(branches.size() + 8);
      for (int c = 0; c < 8; ++c) {
        Brick child;
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
    hold_places(progress);
    return true;
  }

  /// The brick that holds a place given in bricks of a level, or −1: finer ones, or nothing, are there.
  std::int32_t coarser_at(const std::array<int, 3>& at, int level) const {
    std::size_t index = 0;
    for (std::size_t k = 3; k-- > 0;) {
      if (at[k] < 0 || at[k] >= counts[k] << level) return -1;
      index = index * static_cast<std::size_t>(counts[k]) + static_cast<std::size_t>(at[k] >> level);
    }
    std::int32_t branch = branches[index];
    for (int below = level - 1; branch >= 0; --below) {
      if (below < 0) return -1;
      branch = branches[static_cast<std::size_t>(branch) + static_cast<std::size_t>((at[0] >> below & 1) |
                                                                                    (at[1] >> below & 1) << 1 |
                                                                                    (at[2] >> below & 1) << 2)];
    }
    return bricks[static_cast<std::size_t>(~branch)].level < level ? ~branch : -1;
  }

  /// Value and gradient of a brick at a node of a finer one, in place.
  std::array<float, 4> between(const Brick& coarse, std::size_t slot, const Brick& fine,
                               const std::array<int, 3>& node) const {
    double f[3];
    int cell[3];
    for (std::size_t k = 0; k < 3; ++k) {
      // In cells of the coarse one: exact, as all are powers of two.
      const double scale = std::ldexp(1.0, coarse.level - fine.level);
      const double at = (static_cast<double>(fine.at[k]) * kBrickCells + node[k]) * scale -
                        static_cast<double>(coarse.at[k]) * kBrickCells;
      cell[k] = std::clamp(static_cast<int>(at), 0, kBrickCells - 1);
      f[k] = std::clamp(at - cell[k], 0.0, 1.0);
    }
    std::array<double, 4> sum{};
    for (int c = 0; c < 8; ++c) {
      const double w = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
      if (w == 0) continue;
      const float* from = nodes.data() + slot * kBrickSize +
                          4 * node_at(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2 & 1));
      for (std::size_t k = 0; k < 4; ++k) sum[k] += w * static_cast<double>(from[k]);
    }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2]),
            static_cast<float>(sum[3])};
  }

  void restore_hanging() {
    for (const auto& [at, before] : hanging)
      std::copy(before.begin(), before.end(), nodes.begin() + static_cast<std::ptrdiff_t>(at));
    hanging.clear();
  }

  /// Closes the cracks, coarse bricks first: what a finer one takes over is final.
  void settle() {
    std::vector<std::size_t> order(bricks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return bricks[a].level < bricks[b].level; });
    for (const std::size_t b : order) {
      const Brick& brick = bricks[b];
      std::array<std::int32_t, 27> coarser;
      coarser.fill(-1);
      bool any = false;
      for (int d = 0; d < 27; ++d) {
        if (d == 13) continue;
        coarser[static_cast<std::size_t>(d)] =
            coarser_at({brick.at[0] + d % 3 - 1, brick.at[1] + d / 3 % 3 - 1, brick.at[2] + d / 9 - 1}, brick.level);
        any = any || coarser[static_cast<std::size_t>(d)] >= 0;
      }
      if (!any) continue;
      const auto side = [](int i) { return i == 0 ? -1 : i == kBrickCells ? 1 : 0; };
      for (int k = 0; k < kBrickNodes; ++k)
        for (int j = 0; j < kBrickNodes; ++j)
          for (int i = 0; i < kBrickNodes; ++i) {
            const int s[3] = {side(i), side(j), side(k)};
            if (s[0] == 0 && s[1] == 0 && s[2] == 0) continue;
            std::int32_t found = -1;
            for (int c = 1; c < 8; ++c) {
              const int dx = c & 1 ? s[0] : 0, dy = c & 2 ? s[1] : 0, dz = c & 4 ? s[2] : 0;
              const std::int32_t other = coarser[static_cast<std::size_t>(13 + dx + 3 * dy + 9 * dz)];
              if (other < 0) continue;
              const int level = bricks[static_cast<std::size_t>(other)].level;
              if (found < 0 || level < bricks[static_cast<std::size_t>(found)].level) found = other;
            }
            if (found < 0) continue;
            const auto slot = static_cast<std::size_t>(found);
            const std::array<float, 4> value = between(bricks[slot], slot, brick, {i, j, k});
            const std::size_t at = b * kBrickSize + 4 * node_at(i, j, k);
            std::array<float, 4> before;
            std::copy_n(nodes.begin() + static_cast<std::ptrdiff_t>(at), 4, before.begin());
            hanging.emplace_back(at, before);
            std::copy(value.begin(), value.end(), nodes.begin() + static_cast<std::ptrdiff_t>(at));
          }
    }
    for (std::size_t b = 0; b < bricks.size(); ++b) {
      const float* from = nodes.data() + b * kBrickSize;
      float least = from[0], most = from[0];
      for (std::size_t v = 0; v < kNodesOfBrick; ++v)
        least = std::min(least, from[4 * v]), most = std::max(most, from[4 * v]);
      bricks[b].least = least, bricks[b].most = most;
    }
  }

  void sum_up(const BakedVolume& baked) {
    report.bricks = bricks.size();
    report.bytes = nodes.size() * sizeof(float) + branches.size() * sizeof(std::int32_t) +
                   bricks.size() * sizeof(Brick) + hanging.size() * sizeof(hanging[0]);
    report.levels = 0, report.cell_error_most = 0;
    report.finished = whole = true;
    for (const Brick& b : bricks) {
      whole = whole && b.inside == Inside::all;
      report.levels = std::max(report.levels, b.level + 1);
      report.cell_error_most = std::max(report.cell_error_most, b.error / range());
      report.bytes += b.mask.size();
      if (urgency(b) > 1 || (b.inside == Inside::none && longest_cell(b) > b.held)) report.finished = false;
    }
    std::vector<Vec3> x(kCheckPoints);
    const Vec3 size = box.size();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 u = spread_in_cube(i);
      x[i] = box.lower + Vec3{u.x * size.x, u.y * size.y, u.z * size.z};
    }
    std::vector<double> exact(x.size()), found(x.size());
    std::vector<std::uint8_t> inside(x.size());
    field->evaluate(x, {exact, {}, inside});
    report.evaluations += x.size();
    baked.evaluate(x, {found});
    double sum = 0, most = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!inside[i]) continue;
      const double e = std::abs(exact[i] - found[i]) / range();
      sum += e, most = std::max(most, e), ++count;
    }
    if (count * kEnoughChecked < x.size()) {
      found.resize(known.size());
      baked.evaluate(known, {found});
      for (std::size_t i = 0; i < known.size(); ++i) {
        const double e = std::abs(known_values[i] - found[i]) / range();
        sum += e, most = std::max(most, e), ++count;
      }
    }
    report.checked = count;
    report.error_mean = count > 0 ? sum / static_cast<double>(count) : 0;
    report.error_most = most;
  }
};

BakedVolume::BakedVolume(const VolumeField& field, const BakeOptions& options, Progress& progress)
    : BakedVolume(field, options, kMostLevels, progress) {}

BakedVolume::BakedVolume(const VolumeField& field, const BakeOptions& options, int rounds, Progress& progress)
    : state_(std::make_unique<State>(field, options)) {
  progress.begin("baking");
  state_->add_roots(progress);
  for (int round = 0; round < rounds; ++round)
    if (!state_->split(progress)) break;
  state_->settle();
  state_->sum_up(*this);
  progress.finish();
}

BakedVolume::~BakedVolume() = default;

bool BakedVolume::refine(Progress& progress) {
  progress.begin("baking");
  const bool more = state_->split(progress);
  if (more) {
    state_->settle();
    state_->sum_up(*this);
  }
  progress.finish();
  return more;
}

const BakeReport& BakedVolume::report() const { return state_->report; }
Box3 BakedVolume::bounds() const { return state_->box; }

void BakedVolume::evaluate(std::span<const Vec3> x, const VolumeAnswers& wanted) const {
  const detail::BrickTree tree = state_->tree();
  const State& s = *state_;
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
      const detail::BrickPlace p = detail::brick_place(tree, x[i]);
      const State::Brick& brick = s.bricks[static_cast<std::size_t>(p.brick)];
      if (brick.inside != State::Inside::some) {
        wanted.inside[i] = brick.inside == State::Inside::all;
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
        if (brick.mask[node_at(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2 & 1))])
          sum += (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) * (c & 4 ? t[2] : 1 - t[2]);
      wanted.inside[i] = sum >= 0.5f;
    }
  });
}

void BakedVolume::spacing(std::span<const Vec3> x, std::span<double> found) const {
  const detail::BrickTree tree = state_->tree();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const detail::BrickPlace p = detail::brick_place(tree, is_finite(x[i]) ? x[i] : tree.lower);
    const State::Brick& brick = state_->bricks[static_cast<std::size_t>(p.brick)];
    const Vec3 e = state_->edges(brick.level);
    found[i] = std::max(std::min({e.x, e.y, e.z}) / kBrickCells, brick.spacing);
  }
}

void BakedVolume::ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
  const State& s = *state_;
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
        const State::Brick& brick = s.bricks[static_cast<std::size_t>(~part.branch)];
        r.least = std::min(r.least, static_cast<double>(brick.least) / s.value_scale);
        r.most = std::max(r.most, static_cast<double>(brick.most) / s.value_scale);
        continue;
      }
      const Vec3 half = s.edges(part.level + 1);
      for (int c = 0; c < 8; ++c) {
        const Vec3 lower = part.lower + Vec3{c & 1 ? half.x : 0, c & 2 ? half.y : 0, c & 4 ? half.z : 0};
        bool apart = false;
        for (std::size_t k = 0; k < 3; ++k) {
          // What lies beyond the box has the values of its faces.
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
    reported<&BakeReport::bricks>({.text = "Bricks that the field was baked into"}),
    reported<&BakeReport::bytes>({.text = "Memory of the bricks", .unit = "bytes"}),
    reported<&BakeReport::finished>({.text = "Whether they are as fine as was asked for"}),
    reported<&BakeReport::checked>({.text = "Places at which errors were found"}),
    reported<&BakeReport::error_mean>({.text = "Mean error there", .unit = "share of the range"}),
    reported<&BakeReport::error_most>({.text = "Largest error there", .unit = "share of the range"})};

}  // namespace

const ReportSchema& BakeReport::schema() {
  static constexpr ReportSchema schema{kBakeReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
