#include "sansmesh/partition/far/far_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

/// Moments of a group, see FarTree::Moments.
struct GroupMoments {
  std::array<double, 6> first{}, spread{};
  std::array<double, 10> second{};
  Vec3 softened;       // s a
  double widened = 0;  // w s
};

constexpr std::size_t kPair[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/// Adds the contribution of a part at offset d from the position of `sum`, with its area vector and weight.
void add_moments(const GroupMoments& part, const Vec3& d, const Vec3& area, double weight, GroupMoments& sum) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j) {
      sum.first[kPair[i][j]] += part.first[kPair[i][j]] + 0.5 * (d[i] * area[j] + d[j] * area[i]);
      sum.spread[kPair[i][j]] += part.spread[kPair[i][j]] + weight * d[i] * d[j];
      for (std::size_t k = j; k < 3; ++k, ++at) {
        const double turned =
            d[i] * part.first[kPair[j][k]] + d[j] * part.first[kPair[i][k]] + d[k] * part.first[kPair[i][j]];
        const double moved = d[i] * d[j] * area[k] + d[i] * d[k] * area[j] + d[j] * d[k] * area[i];
        sum.second[at] += part.second[at] + (2 * turned + moved) / 3;
      }
    }
  sum.softened += part.softened;
  sum.widened += part.widened;
}

void store_moments(const GroupMoments& from, FarTree::Moments& to, std::size_t k) {
  for (std::size_t i = 0; i < 6; ++i) {
    to.first[i][k] = static_cast<float>(from.first[i]);
    to.spread[i][k] = static_cast<float>(from.spread[i]);
  }
  for (std::size_t i = 0; i < 10; ++i) to.second[i][k] = static_cast<float>(from.second[i]);
  const auto& t = from.second;
  const Vec3 trace{t[0] + t[3] + t[5], t[1] + t[6] + t[8], t[2] + t[7] + t[9]};
  for (std::size_t a = 0; a < 3; ++a) to.turned[a][k] = static_cast<float>(3 * trace[a] + from.softened[a]);
  to.size[k] = static_cast<float>(from.spread[0] + from.spread[3] + from.spread[5] + from.widened);
}

std::vector<std::vector<FarTree::Moments>> moments_of(const std::vector<std::vector<FarTree::Octet>>& levels) {
  std::vector<std::vector<FarTree::Moments>> all;
  std::vector<GroupMoments> below;  // moments of the members of the octets of a level
  for (std::size_t l = 1; l < levels.size(); ++l) {
    std::vector<FarTree::Moments> moments(levels[l].size());
    std::vector<GroupMoments> groups(kTreeWidth * levels[l].size());
    parallel_for(0, levels[l - 1].size(), 256, [&](std::size_t n) {
      const FarTree::Octet &group = levels[l][n / kTreeWidth], &members = levels[l - 1][n];
      const std::size_t lane = n % kTreeWidth;
      const Vec3 point(Vec3f{group.x[lane], group.y[lane], group.z[lane]});
      for (std::size_t k = 0; k < kTreeWidth; ++k) {
        if (members.radius[k] < 0) continue;
        const Vec3 area(Vec3f{members.ax[k], members.ay[k], members.az[k]});
        const auto weight = static_cast<double>(members.area[k]);
        GroupMoments own;
        if (l > 1) {
          own = below[kTreeWidth * n + k];
        } else {
          own.softened = area * (0.25 * weight), own.widened = 0.25 * weight * weight;
        }
        const Vec3 d = Vec3(Vec3f{members.x[k], members.y[k], members.z[k]}) - point;
        add_moments(own, d, area, weight, groups[n]);
      }
      store_moments(groups[n], moments[n / kTreeWidth], lane);
    });
    all.push_back(std::move(moments));
    below = std::move(groups);
  }
  return all;
}

/// Least squared radius of a group, in weights of its heaviest patch: moments require s ≪ r² for every patch, and s /
/// r² is at most 1/32 where the approximation begins, even for close or single patches.
constexpr float kLeastReach = 2;

}  // namespace

FarTree far_tree(std::span<const OrientedPatch> patches, float unit) {
  struct Item {
    Vec3f position, area;
    float weight = 0, radius = -1;
    Box3f box;
    float heaviest = 0;  // largest weight of a patch
  };
  std::vector<Item> items;
  for (const OrientedPatch& p : patches) {
    const Vec3f position = p.position / unit, area = p.area / unit / unit;
    const float a = norm(area);
    if (!(a > 0) || !is_finite(position)) continue;
    const float weight = std::max(a, p.least / unit / unit);
    items.push_back({position, area, weight, std::sqrt(a / std::numbers::pi_v<float>), {position, position}, weight});
  }
  FarTree tree;
  tree.levels = eight_wide_levels<FarTree::Octet>(
      std::move(items), [](std::span<const Item> siblings, std::size_t level, FarTree::Octet& octet) {
        Item group;
        Vec3f mean;
        for (std::size_t k = 0; k < kTreeWidth; ++k) {
          const Item item = k < siblings.size() ? siblings[k] : Item{};
          octet.x[k] = item.position.x, octet.y[k] = item.position.y, octet.z[k] = item.position.z;
          octet.ax[k] = item.area.x, octet.ay[k] = item.area.y, octet.az[k] = item.area.z;
          octet.area[k] = item.weight, octet.radius[k] = item.radius;
          mean += item.position * item.weight;
          group.area += item.area;
          group.weight += item.weight;
          group.heaviest = std::max(group.heaviest, item.heaviest);
        }
        group.position = mean / group.weight;
        for (const Item& item : siblings) group.box.extend(item.box);
        float far = 0;  // smaller of two bounds that include the members' extents
        for (const Item& item : siblings)
          far = std::max(far, norm(item.position - group.position) + (level == 0 ? 0 : item.radius));
        for (int c = 0; c < 8; ++c)
          group.radius = std::max(group.radius, norm(box_corner(group.box, c) - group.position));
        group.radius = std::max(std::min(group.radius, far), std::sqrt(kLeastReach * group.heaviest));
        return group;
      });
  tree.moments = moments_of(tree.levels);
  return tree;
}

}  // namespace sansmesh::inline v1
