#include "sansmesh/partition/far/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/largest_first.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/partition/fit/sample_tree.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest distance, in edges of the smaller block, of the foot of a neighbour on the same sheet from the zero set.
constexpr float kAgreement = 0.35f;
/// Number of steps from piece to piece onto a crease.
constexpr int kSteps = 8;

/// Value of a support at x, including its crease, and the piece that it comes from.
struct SupportValue {
  float value;
  const LocalFunction* piece;
};
SupportValue support_value(const PartitionData& data, std::uint32_t i, const Vec3f& x) {
  const LocalFunction* f = &data.functions[i];
  SupportValue found{local_value(*f, x), f};
  while (f->next != 0) {
    const bool convex = f->convex != 0;
    f = &data.functions[static_cast<std::size_t>(f->next) - 1];
    const float other = local_value(*f, x);
    if (convex ? other > found.value : other < found.value) found = {other, f};
  }
  return found;
}

/// A point of a support on the surface. The foot of a creased support is on its first piece, possibly beyond the
/// crease, off the surface.
Vec3f point_on_surface(const PartitionData& data, std::uint32_t i) {
  const Support& s = data.supports[i];
  if (!s.creased) return s.foot;
  Vec3f x = data.functions[i].center;
  for (int step = 0; step < kSteps; ++step) {
    const SupportValue found = support_value(data, i, x);
    x -= found.piece->nu * found.value;
  }
  return x;
}

bool same_sheet(const PartitionData& data, std::span<const Vec3f> surface_points, std::uint32_t i, std::uint32_t j) {
  const Support &a = data.supports[i], &b = data.supports[j];
  const float edge = data.edge / static_cast<float>(1u << std::max(a.level, b.level));
  if (!a.creased && !b.creased && dot(data.functions[i].nu, data.functions[j].nu) <= 0) return false;
  const bool there = std::abs(support_value(data, i, surface_points[j]).value) <= kAgreement * edge;
  const bool back = std::abs(support_value(data, j, surface_points[i]).value) <= kAgreement * edge;
  // A support with hardly any samples beyond a crease continues a face past it, where no neighbour agrees.
  return a.creased || b.creased ? there || back : there && back;
}

/// Finds the samples in the block of each support.
void find_samples(const PartitionData& data, std::span<const Vec3f> samples, Sheets& sheets) {
  const int depth = data.basis.sort_depth;
  std::vector<std::uint64_t> code(samples.size());
  const float scale = static_cast<float>(1u << depth) / data.edge;
  const std::uint32_t most = (1u << depth) - 1;
  parallel_for(0, code.size(), 16384, [&](std::size_t i) {
    const Vec3f p = (samples[i] - data.lower) * scale;
    const auto cell = [&](float x) { return index_in<std::uint32_t>(x, 0, most); };
    code[i] = morton_code(cell(p.x), cell(p.y), cell(p.z));
  });
  // Rounding of the cells may differ in the last bit from that of the order.
  if (!std::is_sorted(code.begin(), code.end())) std::sort(code.begin(), code.end());
  sheets.first.resize(data.supports.size());
  sheets.count.resize(data.supports.size());
  parallel_for(0, sheets.count.size(), 2048, [&](std::size_t i) {
    const Support& s = data.supports[i];
    const int shift = 3 * (depth - std::min<int>(s.level, depth));
    const auto first = std::lower_bound(code.begin(), code.end(), s.code << shift);
    sheets.first[i] = static_cast<std::uint32_t>(first - code.begin());
    sheets.count[i] = static_cast<std::uint32_t>(std::lower_bound(first, code.end(), (s.code + 1) << shift) - first);
  });
}

}  // namespace

Sheets find_sheets(const PartitionData& data, std::span<const Vec3f> samples) {
  const std::size_t n = data.supports.size();
  // Blocks that touch have feet at most about two of the larger one's diagonals apart.
  std::vector<Vec3f> feet(n);
  std::vector<float> reach(n);
  parallel_for(0, n, 8192, [&](std::size_t i) {
    feet[i] = point_on_surface(data, static_cast<std::uint32_t>(i));
    reach[i] = data.edge / static_cast<float>(1u << data.supports[i].level) * 1.8f;
  });
  const BallTree tree(feet, reach);
  const std::size_t chunk = 1024, chunks = (n + chunk - 1) / chunk;
  std::vector<std::vector<std::array<std::uint32_t, 2>>> links(chunks);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
      if (data.supports[i].state == Support::constant) continue;
      tree.touching({feet[i], feet[i]}, near);
      for (const std::uint32_t j : near)
        if (j != i && data.supports[j].state != Support::constant &&
            same_sheet(data, feet, static_cast<std::uint32_t>(i), j))
          links[c].push_back({static_cast<std::uint32_t>(i), j});
    }
  });
  UnionFind sets(n);
  for (const auto& part : links)
    for (const auto& link : part) sets.join(link[0], link[1]);

  Sheets sheets;
  sheets.of_support.assign(n, Sheets::kNone);
  std::vector<std::uint32_t> number(n, Sheets::kNone);
  std::vector<double> area, found;
  if (!samples.empty()) find_samples(data, samples, sheets);
  for (std::size_t i = 0; i < n; ++i) {
    if (data.supports[i].state == Support::constant) continue;
    std::uint32_t& k = number[sets.find(static_cast<std::uint32_t>(i))];
    if (k == Sheets::kNone) {
      k = static_cast<std::uint32_t>(area.size());
      area.push_back(0), found.push_back(0);
    }
    sheets.of_support[i] = k;
    area[k] += static_cast<double>(data.supports[i].area);
    if (!sheets.count.empty()) found[k] += sheets.count[i];
  }
  const std::vector<std::uint32_t> order = largest_first(area);
  std::vector<std::uint32_t> rank(area.size());
  const double one = data.report.spacing * data.report.spacing;
  for (std::size_t r = 0; r < order.size(); ++r) {
    const std::uint32_t k = order[r];
    rank[k] = static_cast<std::uint32_t>(r);
    sheets.area.push_back(area[k]);
    sheets.evidence.push_back(area[k] > 0 ? found[k] * one / area[k] : 0);
  }
  for (std::uint32_t& k : sheets.of_support)
    if (k != Sheets::kNone) k = rank[k];
  return sheets;
}

}  // namespace sansmesh::inline v1
