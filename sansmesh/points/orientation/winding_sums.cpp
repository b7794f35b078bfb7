#include "sansmesh/points/orientation/winding_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Distance, in its radii, at which a group replaces its nodes; and radius below which it always does, since rounding
/// moves the centre of coincident nodes.
constexpr float kFarRadii = 2, kPointRadius = 1e-6f;
constexpr float kPerSolidAngle = 1 / (4 * std::numbers::pi_v<float>);
/// Groups of eight nodes per range of threads.
constexpr std::size_t kGroups = 16;

}  // namespace

WindingSums::WindingSums(std::span<const Vec3f> nodes) : size_(nodes.size()) {
  if (size_ == 0) return;
  for (std::size_t n = size_;; n = (n + kWidth - 1) / kWidth) {
    first_.push_back(first_.back() + n);
    if (n == 1) break;
  }
  const std::size_t all = first_.back(), levels = first_.size() - 1;
  x_.resize(all), y_.resize(all), z_.resize(all), radius_.resize(all);
  for (std::size_t i = 0; i < size_; ++i) x_[i] = nodes[i].x, y_[i] = nodes[i].y, z_[i] = nodes[i].z;
  std::size_t members = 1;
  for (std::size_t l = 1; l < levels; ++l) {
    members *= kWidth;
    parallel_for(first_[l], first_[l + 1], 256, [&](std::size_t g) {
      const std::size_t begin = (g - first_[l]) * members;
      const std::span<const Vec3f> own = nodes.subspan(begin, std::min(members, size_ - begin));
      Vec3f center;
      for (const Vec3f& p : own) center += p;
      center = center / static_cast<float>(own.size());
      float squared = 0;
      for (const Vec3f& p : own) squared = std::max(squared, squared_norm(p - center));
      x_[g] = center.x, y_[g] = center.y, z_[g] = center.z, radius_[g] = std::sqrt(squared);
    });
  }
  const std::size_t groups = (size_ + kWidth - 1) / kWidth;
  std::vector<std::vector<std::uint32_t>> used(groups);
  parallel_for(0, groups, kGroups, [&](std::size_t t) {
    const std::size_t own = levels > 1 ? first_[1] + t : 0;
    const Vec3f center{x_[own], y_[own], z_[own]};
    const auto use = [&](const auto& self, std::size_t level, std::size_t g) -> void {
      const float apart = norm(Vec3f{x_[g], y_[g], z_[g]} - center) - radius_[own];
      if (level == 0 || radius_[g] < kPointRadius || apart > kFarRadii * radius_[g]) {
        used[t].push_back(static_cast<std::uint32_t>(g));
        return;
      }
      const std::size_t begin = first_[level - 1] + (g - first_[level]) * kWidth;
      const std::size_t end = std::min(first_[level], begin + kWidth);
      for (std::size_t child = begin; child < end; ++child) self(self, level - 1, child);
    };
    use(use, levels - 1, first_[levels - 1]);
  });
  std::size_t count = 0;
  for (const auto& of_group : used) count += of_group.size();
  used_.reserve(count), used_from_.reserve(groups + 1);
  for (const auto& of_group : used) {
    used_.insert(used_.end(), of_group.begin(), of_group.end());
    used_from_.push_back(used_.size());
  }
}

void WindingSums::sum_up(std::vector<float>& values) const {
  for (std::size_t l = 1; l + 1 < first_.size(); ++l)
    for (std::size_t g = first_[l]; g < first_[l + 1]; ++g) {
      const std::size_t begin = first_[l - 1] + (g - first_[l]) * kWidth;
      const std::size_t end = std::min(first_[l], begin + kWidth);
      for (std::size_t i = begin; i < end; ++i) values[g] += values[i];
    }
}

WindingSums::Sources WindingSums::sources(std::span<const Vec3f> area) const {
  const std::size_t all = first_.back();
  Sources s{std::vector<float>(all), std::vector<float>(all), std::vector<float>(all)};
  for (std::size_t i = 0; i < size_; ++i) s.x[i] = area[i].x, s.y[i] = area[i].y, s.z[i] = area[i].z;
  sum_up(s.x), sum_up(s.y), sum_up(s.z);
  return s;
}

/// Calls add(first node, number of nodes, sources, x, y, z) for each group of eight nodes with the coordinates of
/// these.
template <class Add>
void WindingSums::for_each_group(const Add& add) const {
  parallel_for(0, used_from_.size() - 1, kGroups, [&](std::size_t t) {
    const std::size_t begin = t * kWidth, count = std::min(kWidth, size_ - begin);
    float x[kWidth] = {}, y[kWidth] = {}, z[kWidth] = {};
    for (std::size_t k = 0; k < count; ++k) x[k] = x_[begin + k], y[k] = y_[begin + k], z[k] = z_[begin + k];
    add(begin, count, std::span<const std::uint32_t>(used_).subspan(used_from_[t], used_from_[t + 1] - used_from_[t]),
        x, y, z);
  });
}

void WindingSums::winding(std::span<const Vec3f> area, float width, std::span<float> values) const {
  const Sources a = sources(area);
  for_each_group([&](std::size_t begin, std::size_t count, std::span<const std::uint32_t> used, const float* x,
                     const float* y, const float* z) {
    float w[kWidth] = {};
    for (const std::uint32_t s : used)
      for (std::size_t k = 0; k < kWidth; ++k) {
        const float dx = x_[s] - x[k], dy = y_[s] - y[k], dz = z_[s] - z[k];
        const float inverse = 1 / (dx * dx + dy * dy + dz * dz + width * width);
        w[k] += (dx * a.x[s] + dy * a.y[s] + dz * a.z[s]) * inverse * std::sqrt(inverse);
      }
    for (std::size_t k = 0; k < count; ++k) values[begin + k] = w[k] * kPerSolidAngle;
  });
}

void WindingSums::gradient(std::span<const Vec3f> area, float width, std::span<Vec3f> outward) const {
  const Sources a = sources(area);
  for_each_group([&](std::size_t begin, std::size_t count, std::span<const std::uint32_t> used, const float* x,
                     const float* y, const float* z) {
    float gx[kWidth] = {}, gy[kWidth] = {}, gz[kWidth] = {};
    for (const std::uint32_t s : used) {
      const float ax = a.x[s], ay = a.y[s], az = a.z[s];
      for (std::size_t k = 0; k < kWidth; ++k) {
        const float dx = x_[s] - x[k], dy = y_[s] - y[k], dz = z_[s] - z[k];
        const float inverse = 1 / (dx * dx + dy * dy + dz * dz + width * width), cubed = inverse * std::sqrt(inverse);
        const float slope = 3 * (dx * ax + dy * ay + dz * az) * inverse;
        gx[k] += (ax - slope * dx) * cubed, gy[k] += (ay - slope * dy) * cubed, gz[k] += (az - slope * dz) * cubed;
      }
    }
    for (std::size_t k = 0; k < count; ++k) outward[begin + k] = Vec3f{gx[k], gy[k], gz[k]} * kPerSolidAngle;
  });
}

void WindingSums::transposed(std::span<const float> value, float width, std::span<Vec3f> sums) const {
  std::vector<float> v(first_.back());
  std::copy(value.begin(), value.end(), v.begin());
  sum_up(v);
  for_each_group([&](std::size_t begin, std::size_t count, std::span<const std::uint32_t> used, const float* x,
                     const float* y, const float* z) {
    float gx[kWidth] = {}, gy[kWidth] = {}, gz[kWidth] = {};
    for (const std::uint32_t s : used)
      for (std::size_t k = 0; k < kWidth; ++k) {
        const float dx = x[k] - x_[s], dy = y[k] - y_[s], dz = z[k] - z_[s];
        const float inverse = 1 / (dx * dx + dy * dy + dz * dz + width * width);
        const float factor = v[s] * inverse * std::sqrt(inverse);
        gx[k] += dx * factor, gy[k] += dy * factor, gz[k] += dz * factor;
      }
    for (std::size_t k = 0; k < count; ++k) sums[begin + k] = Vec3f{gx[k], gy[k], gz[k]} * kPerSolidAngle;
  });
}

}  // namespace sansmesh::inline v1::detail
