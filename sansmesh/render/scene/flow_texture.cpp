#include "sansmesh/render/scene/flow_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kSide = 4;          // side of a block, in pixels
constexpr float kSameSheet = 8;   // steps in depth between neighbours
constexpr float kAcross = 1e-3f;  // least tangential share of a vector
constexpr float kDarkest = 0.1f, kBrightest = 2.2f;

/// A number between −√3 and √3, uniformly distributed over the cells of space and the levels.
float cell_noise(const std::array<std::int32_t, 3>& cell, std::int32_t level) {
  std::uint32_t h = 0x9E3779B9u * static_cast<std::uint32_t>(level + 64);
  for (const std::int32_t c : cell) {
    h ^= static_cast<std::uint32_t>(c) * 0x85EBCA6Bu;
    h ^= h >> 15, h *= 0x2C1B3C6Du;
    h ^= h >> 12, h *= 0x297A2D39u;
    h ^= h >> 15;
  }
  return (static_cast<float>(h >> 8) * 0x1p-23f - 1) * std::numbers::sqrt3_v<float>;
}

/// Solid noise with cells of width about `size`: interpolates two octaves, so that it is continuous where the size
/// changes.
float solid_noise(const Vec3f& at, float size) {
  const float level = std::log2(size), low = std::floor(level), t = level - low;
  float sum = 0;
  for (int octave = 0; octave < 2; ++octave) {
    const float scale = std::exp2(-(low + static_cast<float>(octave)));
    std::array<std::int32_t, 3> cell;
    // Shifted off the origin: coordinate planes would be boundaries of cells.
    for (std::size_t k = 0; k < 3; ++k) cell[k] = whole_part<std::int32_t>(std::floor((at[k] + 8) * scale + 0.37f));
    sum += (octave == 0 ? 1 - t : t) * cell_noise(cell, index_in<std::int32_t>(low, -200, 200) + octave);
  }
  return sum / std::sqrt(t * t + (1 - t) * (1 - t));
}

}  // namespace

const OptionSchema& FlowTextureOptions::schema() {
  using O = FlowTextureOptions;
  static constexpr OptionRow rows[] = {
      option<&O::streak_length>({.text = "Length of the streaks", .unit = "pixels", .range = {1, 1000}}),
      option<&O::streak_width>({.text = "Width of the streaks", .unit = "pixels", .range = {0.5, 100}}),
      option<&O::streak_contrast>({.text = "Contrast of the streaks", .unit = "share", .range = {0, 1}})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void FlowTextureOptions::validate() const {
  validate_options(*this);
  if (phase) check_range("phase", *phase, 0, 1);
}

FlowTexture::FlowTexture(const PictureScene& scene, const Camera& camera, int width, int height, bool keep)
    : camera_(camera),
      width_(width),
      height_(height),
      across_((width + kSide - 1) / kSide),
      footprint_(2 * camera.half_height / static_cast<float>(height)) {
  const auto rows = static_cast<std::size_t>((height + kSide - 1) / kSide);
  const auto in_row = static_cast<std::size_t>(across_ * kSide * kSide);
  struct Row {
    std::vector<std::uint32_t> counts;
    std::vector<Entry> entries;
    std::vector<Vec3f> positions;
    std::vector<SurfacePoint> points;
  };
  std::vector<Row> found(rows);
  parallel_for(0, rows, 1, [&](std::size_t r) {
    CameraRays going(camera_);
    std::vector<std::size_t> slots, first;
    std::vector<SurfacePoint> points;
    const int top = static_cast<int>(r) * kSide;
    for (std::size_t i = 0; i < in_row; ++i) {
      const int slot = static_cast<int>(i), x = slot / (kSide * kSide) * kSide + slot % kSide,
                y = top + slot / kSide % kSide;
      if (x >= width || y >= height) continue;
      slots.push_back(i);
      going.add((2 * static_cast<float>(x) + 1) / static_cast<float>(width) - 1,
                1 - (2 * static_cast<float>(y) + 1) / static_cast<float>(height));
    }
    const EyeRays rays = going.rays();
    if (rays.size() > 0) scene.layers(rays, first, points);
    Row& row = found[r];
    row.counts.assign(in_row, 0);
    for (std::size_t k = 0; k < slots.size(); ++k)
      row.counts[slots[k]] = static_cast<std::uint32_t>(first[k + 1] - first[k]);
    for (std::size_t i = 0; i < rays.size(); ++i)
      for (std::size_t k = first[i]; k < first[i + 1]; ++k) {
        row.positions.push_back(rays.at(i, points[k].distance));
        row.entries.push_back(entry(points[k], row.positions.back()));
      }
    if (keep) row.points = std::move(points);
  });
  first_.reserve(rows * in_row + 1);
  first_.push_back(0);
  for (const Row& row : found) {
    for (const std::uint32_t n : row.counts) first_.push_back(first_.back() + n);
    entries_.insert(entries_.end(), row.entries.begin(), row.entries.end());
    positions_.insert(positions_.end(), row.positions.begin(), row.positions.end());
    points_.insert(points_.end(), row.points.begin(), row.points.end());
  }
}

inline std::size_t FlowTexture::slot(int x, int y) const {
  const auto u = static_cast<unsigned>(x), v = static_cast<unsigned>(y);  // unsigned, so that divisions are shifts
  const unsigned block = v / kSide * static_cast<unsigned>(across_) + u / kSide;
  return block * kSide * kSide + v % kSide * kSide + u % kSide;
}

/// Points beyond the picture's border map to the nearest pixel: painters sample slightly beyond it.
std::size_t FlowTexture::slot(const Vec3f& origin, const Vec3f& direction) const {
  const Vec3f way = camera_.parallel ? origin - camera_.position : direction;
  const float ahead = camera_.shrink(-dot(way, camera_.backward));
  const float u = dot(way, camera_.right) / (ahead * camera_.half_width),
              v = dot(way, camera_.up) / (ahead * camera_.half_height);
  return slot(index_in<int>(0.5f * (1 + u) * static_cast<float>(width_), 0, width_ - 1),
              index_in<int>(0.5f * (1 - v) * static_cast<float>(height_), 0, height_ - 1));
}

FlowTexture::Entry FlowTexture::entry(const SurfacePoint& point, const Vec3f& position) const {
  const Vec3f from = position - camera_.position;
  Entry e;
  e.depth = -dot(from, camera_.backward);
  const Vec3f along = point.vector - dot(point.vector, point.normal) * point.normal;
  const float length = norm(along);
  if (!(e.depth > 0) || !(length > kAcross * norm(point.vector))) return e;
  // Width of a pixel in space at this depth.
  const float scale = camera_.shrink(e.depth), step = footprint_ * scale / length;
  const float away = camera_.parallel ? 0 : -dot(along, camera_.backward);
  const float x = dot(from, camera_.right) / scale, y = dot(from, camera_.up) / scale;
  e.du = step * (dot(along, camera_.right) - x * away) / scale * static_cast<float>(width_) / (2 * camera_.half_width);
  e.dv = -step * (dot(along, camera_.up) - y * away) / scale / footprint_;
  return e;
}

inline const FlowTexture::Entry* FlowTexture::nearest(std::size_t slot, float depth) const {
  const Entry *e = entries_.data() + first_[slot], *last = entries_.data() + first_[slot + 1];
  if (e == last) return nullptr;
  const Entry* best = e;
  for (++e; e != last; ++e)
    if (std::abs(e->depth - depth) < std::abs(best->depth - depth)) best = e;
  return best;
}

void FlowTexture::grain(double pixels) {
  if (grain_ == pixels) return;
  grain_ = pixels;
  parallel_for(0, entries_.size(), 4096, [&](std::size_t i) {
    entries_[i].noise =
        solid_noise(positions_[i], footprint_ * camera_.shrink(entries_[i].depth) * static_cast<float>(pixels));
  });
}

float FlowTexture::sum(int x, int y, const Entry& from) const {
  const int steps = static_cast<int>(kernel_.size() / 2);
  const float* weights = kernel_.data() + steps;
  float light = 0, power = 0;
  // Steps within one pixel see the same noise: it counts once with the sum of their weights.
  const auto lay = [&](const Entry& entry, float weight) {
    light += weight * entry.noise;
    power += weight * weight;
  };
  float middle = weights[0];
  const auto right = static_cast<float>(width_), bottom = static_cast<float>(height_);
  for (const int way : {-1, 1}) {
    const Entry* now = &from;
    float u = static_cast<float>(x) + 0.5f, v = static_cast<float>(y) + 0.5f, weight = 0;
    const auto leave = [&] {
      if (now == &from)
        middle += weight;
      else
        lay(*now, weight);
      weight = 0;
    };
    int i = x, j = y;
    for (int k = way; k != way * (steps + 1); k += way) {
      u += static_cast<float>(way) * now->du, v += static_cast<float>(way) * now->dv;
      if (!(u >= 0 && v >= 0 && u < right && v < bottom)) break;
      const int iu = static_cast<int>(u), jv = static_cast<int>(v);
      if (iu != i || jv != j) {
        i = iu, j = jv;
        const Entry* next = nearest(slot(i, j), now->depth);
        if (!next || std::abs(next->depth - now->depth) > kSameSheet * footprint_ * camera_.shrink(now->depth)) break;
        if (next->du == 0 && next->dv == 0) break;
        leave();
        now = next;
      }
      weight += weights[k];
    }
    leave();
  }
  lay(from, middle);
  // Short lines also have the full contrast: the sum is normalised by its variance.
  return power > 0 ? light / std::sqrt(power) : 0;
}

void FlowTexture::convolve(const FlowTextureOptions& options) {
  options.validate();
  grain(options.streak_width);
  const int steps = std::max(1, static_cast<int>(std::lround(options.streak_length / 2)));
  kernel_.clear();
  for (int k = -steps; k <= steps; ++k) {
    const float at = static_cast<float>(k) / static_cast<float>(steps + 1), pi = std::numbers::pi_v<float>;
    float w = 0.5f * (1 + std::cos(pi * at));
    if (options.phase) w *= 0.5f * (1 + std::cos(2 * pi * (at + static_cast<float>(*options.phase))));
    kernel_.push_back(w);
  }
  // Noise of steps within one cell is correlated.
  const float gain = static_cast<float>(options.streak_contrast / std::sqrt(std::max(1.0, options.streak_width)));
  factors_.assign(entries_.size(), 1);
  parallel_for(0, static_cast<std::size_t>((height_ + kSide - 1) / kSide), 1, [&](std::size_t r) {
    const int top = static_cast<int>(r) * kSide, bottom = std::min(top + kSide, height_);
    for (int left = 0; left < width_; left += kSide)
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < std::min(left + kSide, width_); ++x) {
          const std::size_t i = slot(x, y);
          for (std::uint32_t e = first_[i]; e < first_[i + 1]; ++e)
            if (entries_[e].du != 0 || entries_[e].dv != 0)
              factors_[e] = std::clamp(1 + gain * sum(x, y, entries_[e]), kDarkest, kBrightest);
        }
  });
}

float FlowTexture::factor(const Vec3f& origin, const Vec3f& direction, const SurfacePoint& point) const {
  if (point.vector == Vec3f{}) return 1;
  const Entry* e = nearest(slot(origin, direction), -point.distance * dot(direction, camera_.backward));
  return e ? factors_[static_cast<std::size_t>(e - entries_.data())] : 1;
}

std::optional<SurfacePoint> FlowTexture::first_point(const Vec3f& origin, const Vec3f& direction) const {
  const std::size_t i = slot(origin, direction);
  if (first_[i] == first_[i + 1]) return std::nullopt;
  SurfacePoint point = points_[first_[i]];
  point.color *= factors_[first_[i]];
  return point;
}

}  // namespace sansmesh::inline v1
