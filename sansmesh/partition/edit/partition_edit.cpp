#include "sansmesh/partition/edit/partition_edit.h"
#include "sansmesh/fit_options.h"
#include "sansmesh/option.h"
#include "sansmesh/partition/fit/local_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/assemble.h"
#include "sansmesh/partition/edit/replace_supports.h"
#include "sansmesh/partition/fit/crease_fit.h"
#include "sansmesh/partition/fit/flatness.h"
#include "sansmesh/partition/fit/leaf_fit.h"
#include "sansmesh/partition/paper/paper_edit.h"
#include "sansmesh/partition/partition_of_unity.h"

namespace sansmesh::inline v1 {
namespace {

/// Samples within this distance of a block (in its edges) contribute to the fits below it: balls, those of twice the
/// size that supports with few samples use, and the neighbours that noise is pooled over.
constexpr float kMargin = 6;
/// Levels of the grid that marks the neighbourhood of an edit.
constexpr int kGridLevel = 6;

constexpr const char* kNoSamples = "its samples were not kept: it cannot be fitted again";

struct Cube {
  Vec3f lower;
  float edge;
};

Cube cube_of(const PartitionData& data, int level, std::uint64_t code) {
  const auto cell = morton_cell(code);
  const float h = data.edge / static_cast<float>(1u << level);
  return {data.lower +
              Vec3f{static_cast<float>(cell[0]) * h, static_cast<float>(cell[1]) * h, static_cast<float>(cell[2]) * h},
          h};
}

double squared_distance_to(const Cube& c, const Vec3f& p) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({c.lower[k] - p[k], p[k] - (c.lower[k] + c.edge), 0.0f});
    sum += d * d;
  }
  return sum;
}

bool meets(const Cube& c, const Box3f& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (b.upper[k] < c.lower[k] || b.lower[k] > c.lower[k] + c.edge) return false;
  return true;
}

bool chosen_by(const SupportQuery& q, const PartitionData& data, std::size_t i) {
  const Support& s = data.supports[i];
  if (q.flags && !(*q.flags)[i]) return false;
  if (q.coverage_below && !(s.coverage < *q.coverage_below)) return false;
  if (q.coverage_fails && !fails_coverage(data.functions[i], s, *q.coverage_fails)) return false;
  if (q.error_above && !(s.error > *q.error_above)) return false;
  if (q.samples_below && !(s.samples < *q.samples_below)) return false;
  if ((q.level_from && s.level < *q.level_from) || (q.level_to && s.level > *q.level_to)) return false;
  const Cube c = cube_of(data, s.level, s.code);
  if (q.ball && !(squared_distance_to(c, q.ball->center) <= std::pow(static_cast<double>(q.ball->radius), 2)))
    return false;
  if (q.box && !meets(c, *q.box)) return false;
  if (q.half_space) {
    const Vec3f center = c.lower + Vec3f{0.5f, 0.5f, 0.5f} * c.edge;
    if (dot(center - q.half_space->point, q.half_space->normal) <= 0) return false;
  }
  return true;
}

/// Finest cells with samples but without a support: no fit was possible there, or it was removed.
std::vector<std::uint64_t> bare_cells(const PartitionData& data) {
  const int level = static_cast<int>(data.flatness.size()) - 1;
  std::vector<std::uint64_t> bare;  // positions along the curve
  std::size_t s = 0;
  for (const std::uint64_t code : data.flatness.back().code) {
    const std::uint64_t position = curve_position(level, code);
    const auto end = [&] { return curve_position(data.supports[s].level, data.supports[s].code + 1); };
    while (s < data.supports.size() && end() <= position) ++s;
    if (s == data.supports.size() || curve_position(data.supports[s].level, data.supports[s].code) > position)
      bare.push_back(position);
  }
  return bare;
}

/// Largest blocks whose supports are all chosen, and none of which is missing.
std::vector<BlockKey> filled_blocks(const PartitionData& data, const Selection& chosen) {
  const std::size_t n = data.supports.size();
  const std::vector<std::uint64_t> bare = bare_cells(data);
  std::vector<std::uint32_t> before(n + 1, 0);  // number of chosen ones among the first i
  for (const std::uint32_t i : chosen) before[i + 1] = 1;
  for (std::size_t i = 0; i < n; ++i) before[i + 1] += before[i];
  const auto first_from = [&](std::uint64_t position) {
    std::size_t low = 0, high = n;
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      const Support& s = data.supports[middle];
      if (curve_position(s.level, s.code) < position)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  };
  std::vector<BlockKey> result, stack{{0, 0}};
  while (!stack.empty()) {
    const BlockKey b = stack.back();
    stack.pop_back();
    const std::size_t first = first_from(curve_position(b.level, b.code)),
                      last = first_from(curve_position(b.level, b.code + 1));
    const std::uint32_t taken = before[last] - before[first];
    if (taken == 0) continue;
    const auto gap = std::lower_bound(bare.begin(), bare.end(), curve_position(b.level, b.code));
    const bool whole = gap == bare.end() || *gap >= curve_position(b.level, b.code + 1);
    const bool single = last - first == 1 && data.supports[first].level <= b.level;
    if (taken == last - first && (whole || single)) {
      result.push_back(b);
    } else if (b.level < 20) {
      for (std::uint64_t k = 0; k < 8; ++k) stack.push_back({b.level + 1, b.code << 3 | k});
    }
  }
  return result;
}

/// Tree of the samples within kMargin edges of some blocks, with the cells of the whole cloud's tree.
SampleTree tree_around(const PartitionData& data, std::span<const BlockKey> blocks, const EditSamples& samples) {
  if (samples.positions.empty()) throw DataError(kNoSamples);
  constexpr int kCells = 1 << kGridLevel;
  std::vector<std::uint8_t> marked(static_cast<std::size_t>(kCells) * kCells * kCells, 0);
  const float scale = static_cast<float>(kCells) / data.edge;
  const auto cell = [&](float x) { return index_in<int>(x * scale, 0, kCells - 1); };
  for (const BlockKey& b : blocks) {
    const Cube c = cube_of(data, b.level, b.code);
    const Vec3f low = c.lower - data.lower - Vec3f{1, 1, 1} * (kMargin * c.edge);
    const float size = (1 + 2 * kMargin) * c.edge;
    for (int z = cell(low.z); z <= cell(low.z + size); ++z)
      for (int y = cell(low.y); y <= cell(low.y + size); ++y)
        for (int x = cell(low.x); x <= cell(low.x + size); ++x)
          marked[static_cast<std::size_t>((z * kCells + y) * kCells + x)] = 1;
  }
  const std::size_t n = samples.positions.size(), chunk = 1 << 16, chunks = (n + chunk - 1) / chunk;
  std::vector<std::vector<std::uint32_t>> found(chunks);
  parallel_for(0, chunks, 1, [&](std::size_t k) {
    for (std::size_t i = k * chunk; i < std::min(n, (k + 1) * chunk); ++i) {
      const Vec3f p = samples.positions[i] - data.lower;
      if (marked[static_cast<std::size_t>((cell(p.z) * kCells + cell(p.y)) * kCells + cell(p.x))])
        found[k].push_back(static_cast<std::uint32_t>(i));
    }
  });
  std::vector<Vec3f> positions, normals;
  for (const auto& part : found)
    for (const std::uint32_t i : part) positions.push_back(samples.positions[i]), normals.push_back(samples.normals[i]);
  if (positions.empty()) throw DataError("there are no samples around the chosen supports");
  return {std::move(positions), std::move(normals), data.lower, data.edge, data.basis.sort_depth};
}

std::vector<BlockKey> blocks_of(const PartitionData& data, const Selection& chosen) {
  std::vector<BlockKey> blocks;
  blocks.reserve(chosen.size());
  for (const std::uint32_t i : chosen) blocks.push_back({data.supports[i].level, data.supports[i].code});
  return blocks;
}

/// New gaps for the cells below the refitted blocks.
std::vector<PartitionData::Flatness> updated_flatness(const PartitionData& data, const BlockFitter& fitter,
                                                      const ScaleChoice& choice, std::span<const BlockKey> roots,
                                                      std::span<const FittedLeaf> leaves) {
  std::vector<PartitionData::Flatness> result = data.flatness;
  const std::size_t levels = std::min(result.size(), choice.trials.size());
  std::vector<std::vector<std::uint64_t>> code(levels);
  std::vector<std::vector<float>> gap(levels);
  for (std::size_t l = 0; l < levels; ++l) {
    code[l] = result[l].code.copy();
    gap[l] = result[l].gap.copy();
    for (const BlockKey& root : roots) {
      const auto level = static_cast<std::size_t>(root.level);
      if (l < level) continue;
      const std::uint64_t low = root.code << (3 * (l - level)), high = (root.code + 1) << (3 * (l - level));
      const auto& cells = fitter.tree.level(static_cast<int>(l)).code;
      auto here = std::lower_bound(code[l].begin(), code[l].end(), low);
      for (auto it = std::lower_bound(cells.begin(), cells.end(), low); it != cells.end() && *it < high; ++it) {
        while (here != code[l].end() && *here < *it) ++here;
        if (here == code[l].end()) break;
        if (*here != *it) continue;
        gap[l][static_cast<std::size_t>(here - code[l].begin())] =
            flatness_gap(fitter, choice, static_cast<int>(l), static_cast<std::uint32_t>(it - cells.begin()));
      }
    }
  }
  for (const FittedLeaf& leaf : leaves)
    if (leaf.support.creased)
      mark_crease(code, gap, data.edge, leaf.support.level, leaf.support.code, least_cosine(pieces_of(ref_of(leaf))));
  for (std::size_t l = 0; l < levels; ++l) result[l].gap = std::move(gap[l]);
  return result;
}

/// Radius of a support over that of a fit's, if a refit has given it another; 1 if not. The supports of exact functions
/// are wider than their block's, but their balls of samples are not.
float refitted_radius(const BlockFitter& whole, const LocalFunction& f, int level) {
  const float own = whole.support_radius(level), ball = f.scale / whole.fit_radius(level);
  if (f.radius == own || f.radius == whole.fit_radius(level)) return 1;
  if (f.is_constant() && f.radius > own && f.radius <= (1 + kExactReach) * own) return 1;
  for (const float reach : {1.0f, kReaches[0], kReaches[1]})
    if (std::abs(ball - reach) < 1e-3f) return 1;
  return f.radius / own;
}

/// Chosen supports whose block was refitted. The others have too few samples, and are unchanged.
Selection in_served_blocks(const PartitionData& data, const Selection& chosen, std::span<const BlockKey> roots,
                           const SampleTree& tree, const ScaleChoice& choice) {
  std::vector<std::uint64_t> leaves;
  leaves.reserve(choice.leaves.size());
  for (const Leaf& leaf : choice.leaves)
    leaves.push_back(curve_position(leaf.level, tree.level(leaf.level).code[leaf.cell]));
  std::sort(leaves.begin(), leaves.end());
  std::vector<std::array<std::uint64_t, 2>> bare;
  for (const BlockKey& root : roots) {
    const std::uint64_t first = curve_position(root.level, root.code), last = curve_position(root.level, root.code + 1);
    const auto leaf = std::lower_bound(leaves.begin(), leaves.end(), first);
    if (leaf == leaves.end() || *leaf >= last) bare.push_back({first, last});
  }
  if (bare.empty()) return chosen;
  Selection served;
  for (const std::uint32_t i : chosen) {
    const std::uint64_t at = curve_position(data.supports[i].level, data.supports[i].code);
    if (std::none_of(bare.begin(), bare.end(), [&](const auto& b) { return b[0] <= at && at < b[1]; }))
      served.push_back(i);
  }
  return served;
}

/// The chosen support that is nearest to another along the curve.
std::uint32_t nearest_of(const PartitionData& data, const Selection& chosen, const Support& support) {
  const auto position_of = [](const Support& s) { return curve_position(s.level, s.code); };
  const std::uint64_t at = position_of(support);
  const auto next = std::lower_bound(chosen.begin(), chosen.end(), at, [&](std::uint32_t i, std::uint64_t position) {
    return position_of(data.supports[i]) < position;
  });
  if (next == chosen.begin()) return *next;
  if (next == chosen.end()) return *std::prev(next);
  return position_of(data.supports[*next]) - at < at - position_of(data.supports[*std::prev(next)]) ? *next
                                                                                                    : *std::prev(next);
}

/// Replaces the chosen functions by constants; value_of(i): the constant of the i-th, in radii.
template <class ValueOf>
EditResult with_constants(const PartitionData& data, const Selection& chosen, const ValueOf& value_of) {
  std::vector<FittedLeaf> leaves(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const LocalFunction& old = data.functions[chosen[i]];
    LocalFunction& f = leaves[i].function;
    f.center = old.center;
    f.radius = old.radius;
    f.coefficient[0] = -value_of(i) * old.radius;
    leaves[i].support = data.supports[chosen[i]];
    leaves[i].support.state = Support::constant;
    leaves[i].support.creased = 0;
    leaves[i].support.foot = f.center;
    leaves[i].support.area = 0;
  }
  return replace_supports(data, chosen, std::move(leaves));
}

}  // namespace

Selection select_supports(const PartitionData& data, const SupportQuery& query) {
  if (query.flags && query.flags->size() != data.supports.size())
    throw ArgumentError("select: one flag a support is needed");
  Selection chosen;
  for (std::size_t i = 0; i < data.supports.size(); ++i)
    if (chosen_by(query, data, i)) chosen.push_back(static_cast<std::uint32_t>(i));
  return chosen;
}

EditResult set_degree(const PartitionData& data, const Selection& chosen, int degree, const EditSamples& samples,
                      Progress& progress) {
  const bool automatic = degree == kAutomaticDegree;
  if (!automatic && (degree < 0 || degree > kMaxDegree)) throw ArgumentError("the degree must lie in 0..4");
  if (chosen.empty()) return {data, {}, {}, 0, 0};
  if (data.paper) {
    if (samples.positions.empty()) throw DataError(kNoSamples);
    return set_paper_degree(data, chosen, automatic ? std::nullopt : std::optional(degree), samples, progress);
  }
  SampleTree tree = tree_around(data, blocks_of(data, chosen), samples);
  tree.build_levels(data.basis.finest);
  const BlockFitter whole = fitter_of(tree, data.options, data.basis);
  progress.begin("fit again", chosen.size());
  std::vector<FittedLeaf> leaves(chosen.size());
  std::atomic<std::size_t> kept{0}, lower{0};
  parallel_ranges(0, chosen.size(), 64, [&](std::size_t first, std::size_t last) {
    NeighbourWalk walk(tree);
    Workspace ws;
    for (std::size_t i = first; i < last; ++i) {
      const Support& s = data.supports[chosen[i]];
      const std::int64_t found = tree.find(s.level, s.code);
      if (found < 0) throw DataError("its samples do not belong to its supports");
      const auto cell = static_cast<std::uint32_t>(found);
      walk.go(s.level, cell);
      BlockFitter fitter = whole;
      fitter.fit *= refitted_radius(whole, data.functions[chosen[i]], s.level);
      const float reach = gather_enough(fitter, s.level, cell, walk.own(), walk.parents(), ws.ball);
      const Cube c = cube_of(data, s.level, s.code);
      const LocalFunction& old = data.functions[chosen[i]];
      FittedLeaf& leaf = leaves[i];
      leaf.support = s;
      if (reach > 0) {
        const DegreeFits fits = fit_local(reach * fitter.fit_radius(s.level),
                                          automatic ? data.options.max_degree : degree, ws, leaf.function);
        if (fits.highest >= 0) {
          LocalFunction& f = leaf.function;
          f.radius = old.radius;
          f.degree = automatic ? highest_degree(data.options, fits, ws.view) : std::min(degree, fits.highest);
          lower += !automatic && f.degree < degree;
          f.coefficient = monomial_coefficients(fits, f.degree);
          leaf.support.state = Support::fitted;
          leaf.support.creased = 0;
          leaf.support.samples = static_cast<std::uint32_t>(ws.samples.size());
          leaf.support.coverage = static_cast<float>(coverage(ws.view));
          leaf.support.error =
              f.scale * std::sqrt(static_cast<float>(fits.mean_square[static_cast<std::size_t>(f.degree)]));
          set_surface_patch(f, c.lower, c.edge, leaf.support);
          continue;
        }
      }
      // With too few samples for any fit it is unchanged.
      ++kept;
      leaf.function = old;
      for (std::int32_t next = old.next; next != 0; next = leaf.more.back().next)
        leaf.more.push_back(data.functions[static_cast<std::size_t>(next) - 1]);
    }
    progress.advance(last - first);
  });
  EditResult result = replace_supports(data, chosen, std::move(leaves));
  result.changes -= kept;
  result.lower = lower;
  return result;
}

EditResult refit(const PartitionData& data, const Selection& chosen, const PartitionOptions& options,
                 const EditSamples& samples, Progress& progress) {
  options.validate();
  if (data.paper)
    throw DataError(
        "it was fitted by the published method, from the top down, which cannot be repeated for a part of it");
  if (chosen.empty()) return {data, {}, {}, 0, 0};
  const std::vector<BlockKey> roots = filled_blocks(data, chosen);
  SampleTree tree = tree_around(data, roots, samples);
  tree.build_levels(data.basis.tried);
  ScaleBasis basis = data.basis;
  if (options.error) basis.accepted = *options.error;
  if (options.support) basis.support = basis.fit = *options.support, basis.height = 0;
  const ScaleChoice choice = choose_scales_below(tree, options, basis, roots, progress);
  if (choice.leaves.empty()) throw DataError("the samples around the chosen supports are too few for any fit");
  const Selection served = in_served_blocks(data, chosen, roots, tree, choice);
  const BlockFitter fitter = fitter_of(tree, options, choice);
  progress.begin("fit again", choice.leaves.size());
  std::vector<FittedLeaf> leaves(choice.leaves.size());
  parallel_ranges(0, leaves.size(), 64, [&](std::size_t first, std::size_t last) {
    FitWorkspace ws(tree);
    for (std::size_t i = first; i < last; ++i) leaves[i] = fit_leaf(fitter, choice, choice.leaves[i], ws);
    progress.advance(last - first);
  });
  // The openness of a sheet is not decided again for a part of it.
  for (FittedLeaf& leaf : leaves) leaf.support.open = data.supports[nearest_of(data, chosen, leaf.support)].open;
  std::vector<PartitionData::Flatness> flatness = updated_flatness(data, fitter, choice, roots, leaves);
  EditResult result = replace_supports(data, served, std::move(leaves));
  result.data.flatness = std::move(flatness);
  return result;
}

EditResult set_constant(const PartitionData& data, const Selection& chosen, float value) {
  const double size = std::abs(static_cast<double>(value));
  if (!(size >= kLeastConstant && size <= kMostConstant))
    throw ArgumentError(fmt::format("a constant must lie between {} and {} radii of its support, positive or negative",
                                    kLeastConstant, kMostConstant));
  return with_constants(data, chosen, [&](std::size_t) { return value; });
}

EditResult set_automatic_constant(const PartitionData& data, const Selection& chosen) {
  if (chosen.empty()) return {data, {}, {}, 0, 0};
  const PartitionOfUnity rest(remove_supports(data, chosen).data);
  std::vector<Vec3> centers;
  centers.reserve(chosen.size());
  for (const std::uint32_t i : chosen) centers.push_back(data.origin + Vec3(data.functions[i].center));
  std::vector<double> values(centers.size());
  rest.evaluate(centers, values);
  return with_constants(data, chosen, [&](std::size_t i) {
    const double value = values[i] / static_cast<double>(data.functions[chosen[i]].radius);
    return static_cast<float>(std::copysign(std::clamp(std::abs(value), kLeastConstant, kMostConstant), value));
  });
}

EditResult remove_supports(const PartitionData& data, const Selection& chosen) {
  return replace_supports(data, chosen, {});
}

}  // namespace sansmesh::inline v1
