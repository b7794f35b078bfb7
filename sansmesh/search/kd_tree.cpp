#include "sansmesh/search/kd_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using detail::NeighbourKey;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kLeaf = kTreeWidth;

struct Item {
  float at[3];
  std::uint32_t index;
};

int widest_axis(std::span<const Item> items) {
  float lower[3] = {kInfinity, kInfinity, kInfinity}, upper[3] = {-kInfinity, -kInfinity, -kInfinity};
  for (const Item& item : items)
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], item.at[k]);
      upper[k] = std::max(upper[k], item.at[k]);
    }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (upper[k] - lower[k] > upper[axis] - lower[axis]) axis = k;
  return axis;
}

// Compares coordinates, then indices, so that the halves do not depend on the selection algorithm.
template <int kAxis>
void split_along(std::span<Item> items, std::size_t middle) {
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [](const Item& a, const Item& b) {
                     return a.at[kAxis] != b.at[kAxis] ? a.at[kAxis] < b.at[kAxis] : a.index < b.index;
                   });
}

// Sorts items so that any aligned run of 8^l leaves is one region of space: splits are at powers of two leaves.
void arrange(std::span<Item> items) {
  while (items.size() > kLeaf) {
    const std::size_t leaf_count = (items.size() + kLeaf - 1) / kLeaf;
    const std::size_t middle = std::bit_floor(leaf_count - 1) * kLeaf;
    switch (widest_axis(items)) {
      case 0:
        split_along<0>(items, middle);
        break;
      case 1:
        split_along<1>(items, middle);
        break;
      default:
        split_along<2>(items, middle);
    }
    const std::span<Item> left = items.first(middle), right = items.subspan(middle);
    if (items.size() > 8192) {
      parallel_invoke([&] { arrange(left); }, [&] { arrange(right); });
      return;
    }
    arrange(left);
    items = right;
  }
}

detail::KdTreeLeaf make_leaf(std::span<const Item> items) {
  detail::KdTreeLeaf leaf;
  for (std::size_t c = 0; c < kLeaf; ++c) {
    const bool used = c < items.size();
    leaf.x[c] = used ? items[c].at[0] : kInfinity;
    leaf.y[c] = used ? items[c].at[1] : kInfinity;
    leaf.z[c] = used ? items[c].at[2] : kInfinity;
    leaf.index[c] = used ? items[c].index : std::numeric_limits<std::uint32_t>::max();
  }
  return leaf;
}

void write_neighbours(std::span<const NeighbourKey> keys, std::span<Neighbour> out) {
  for (std::size_t i = 0; i < keys.size(); ++i)
    out[i] = {std::bit_cast<float>(static_cast<std::uint32_t>(keys[i] >> 32)), static_cast<std::uint32_t>(keys[i])};
}

}  // namespace

KdTree::KdTree(std::span<const Vec3f> points) {
  if (points.size() >= std::numeric_limits<std::uint32_t>::max())
    throw ArgumentError("KdTree: more points than 32-bit indices can name");
  std::vector<Item> items;
  items.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = points[i];
    if (is_finite(p)) items.push_back({{p.x, p.y, p.z}, static_cast<std::uint32_t>(i)});
  }
  size_ = items.size();
  if (size_ == 0) return;
  arrange(items);

  const std::size_t leaf_count = (size_ + kLeaf - 1) / kLeaf;
  leaves_.resize(leaf_count);
  order_.resize(size_);
  std::vector<Box3f> boxes(leaf_count);
  parallel_for(0, leaf_count, 4096, [&](std::size_t l) {
    const auto leaf = std::span<const Item>(items).subspan(l * kLeaf, std::min(kLeaf, size_ - l * kLeaf));
    leaves_[l] = make_leaf(leaf);
    for (std::size_t c = 0; c < leaf.size(); ++c) {
      order_[l * kLeaf + c] = leaf[c].index;
      boxes[l].extend(Vec3f{leaf[c].at[0], leaf[c].at[1], leaf[c].at[2]});
    }
  });
  levels_ = box_levels(std::move(boxes));
}

std::size_t KdTree::nearest(const Vec3f& q, std::span<Neighbour> out) const {
  const std::size_t count = std::min(out.size(), size_);
  if (count == 0 || !is_finite(q)) return 0;
  thread_local std::vector<NeighbourKey> keys;
  keys.resize(count);
  detail::nearest_keys({leaves_.data(), levels_}, q, keys);
  write_neighbours(keys, out);
  return count;
}

std::optional<Neighbour> KdTree::nearest(const Vec3f& q) const {
  Neighbour result[1];
  if (nearest(q, result) == 0) return std::nullopt;
  return result[0];
}

double KdTree::distance(const Vec3f& q) const {
  const auto found = nearest(q);
  return found ? std::sqrt(static_cast<double>(found->squared_distance)) : std::numeric_limits<double>::infinity();
}

void KdTree::within(const Vec3f& q, float radius, std::vector<Neighbour>& out) const {
  within_by_slot(q, radius, out);
  std::sort(out.begin(), out.end());
}

void KdTree::within_by_slot(const Vec3f& q, float radius, std::vector<Neighbour>& out) const {
  out.clear();
  if (size_ == 0 || !is_finite(q) || !(radius >= 0)) return;
  detail::append_within({leaves_.data(), levels_}, q, radius * radius, out);
}

std::size_t KdTree::count_within(const Vec3f& q, float radius) const {
  if (size_ == 0 || !is_finite(q) || !(radius >= 0)) return 0;
  return detail::count_within({leaves_.data(), levels_}, q, radius * radius);
}

std::vector<Vec3f> KdTree::positions() const {
  std::vector<Vec3f> result(size_);
  parallel_for(0, size_, 65536, [&](std::size_t s) { result[s] = position(s); });
  return result;
}

void KdTree::for_each_nearest(std::size_t k, const Visit& visit) const {
  parallel_ranges(0, leaves_.size(), 256, [&](std::size_t first, std::size_t last) {
    for_each_nearest(k, first * kLeaf, std::min(last * kLeaf, size_), visit);
  });
}

void KdTree::for_each_nearest(std::size_t k, std::size_t first, std::size_t last, const Visit& visit) const {
  const std::size_t count = std::min(k, size_);
  std::vector<NeighbourKey> keys(count);
  std::vector<Neighbour> neighbours(count);
  const detail::KdTreeView view{leaves_.data(), levels_};
  for (std::size_t s = first; s < last; ++s) {
    if (count > 0) detail::nearest_keys_of_slot(view, static_cast<std::uint32_t>(s), keys);
    write_neighbours(keys, neighbours);
    visit(static_cast<std::uint32_t>(s), neighbours);
  }
}

}  // namespace sansmesh::inline v1
