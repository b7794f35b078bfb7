#include "sansmesh/render/volume/pixel_means.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

using Light = std::array<float, 4>;

constexpr std::size_t kMostAtOnce = 4096;  // rays of one call
constexpr float kSmooth = 2;               // levels by which the means of 2 × 2 undivided pixels differ at most
constexpr float kFlatEnough = 24;          // levels by which their corners differ at most
constexpr float kNoJump = 8, kJump = 24;   // levels between corners and centre where the light is smooth, and jumps
constexpr float kSharp = 48;               // levels above which the smallest cells are divided again
constexpr float kAtEdges = 0.45f;          // share of the centre at jumps
constexpr float kSurprise = 6;             // levels of an error at a pixel's centre that divides the cells around
constexpr float kStraightEdge = 6;  // levels by which edges of 2 × 2 undivided pixels are off the middle at most

Light sum_of(const Light& a, float wa, const Light& b, float wb) {
  Light sum;
  for (std::size_t k = 0; k < 4; ++k) sum[k] = wa * a[k] + wb * b[k];
  return sum;
}

/// Divisions of a pixel: rays per pixel double and double again.
int divisions_of(int samples) {
  int level = 0;
  while (2 << (2 * level) < 0.8 * samples * samples) ++level;
  return level;
}

/// Rays of a tile on the lattice of its finest cells.
class TileRays {
 public:
  /// `unit`: steps of the lattice in a pixel.
  TileRays(const PixelTile& tile, int unit, const TracePoints& trace)
      : tile_(tile), unit_(unit), trace_(trace), columns_(2 * cells(tile.right - tile.left) * unit + 1) {
    const auto rows = static_cast<std::size_t>(2 * cells(tile.bottom - tile.top) * unit + 1);
    // Most are never set.
    lights_ = std::make_unique_for_overwrite<Light[]>(static_cast<std::size_t>(columns_) * rows);
    states_.assign(static_cast<std::size_t>(columns_) * rows, kNew);
  }
  /// Number of pairs that contain n pixels.
  static int cells(int n) { return (n + 1) / 2; }

  void want(int x, int y) {
    const std::size_t i = index(x, y);
    if (states_[i] != kNew) return;
    states_[i] = kWanted;
    wanted_.push_back(i);
  }
  void trace_wanted() {
    for (std::size_t first = 0; first < wanted_.size(); first += kMostAtOnce) {
      const auto part = std::span(wanted_).subspan(first, std::min(kMostAtOnce, wanted_.size() - first));
      points_.clear();
      for (const std::size_t i : part) points_.push_back({place(i, true), place(i, false)});
      found_.resize(part.size());
      trace_(points_, found_);
      for (std::size_t k = 0; k < part.size(); ++k) {
        const TracedLight& l = found_[k];
        lights_[part[k]] = {l.light.x, l.light.y, l.light.z, l.left};
      }
    }
    rays_ += wanted_.size();
    wanted_.clear();
  }
  const Light& at(int x, int y) const { return lights_[index(x, y)]; }
  std::size_t rays() const { return rays_; }

 private:
  enum State : std::uint8_t { kNew, kWanted };

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  float place(std::size_t i, bool across) const {
    const auto n = static_cast<std::size_t>(columns_);
    const auto steps = static_cast<float>(across ? i % n : i / n);
    return static_cast<float>(across ? tile_.left : tile_.top) + steps / static_cast<float>(unit_);
  }

  PixelTile tile_;
  int unit_;
  const TracePoints& trace_;
  int columns_;
  std::unique_ptr<Light[]> lights_;
  std::vector<std::uint8_t> states_;
  std::vector<std::size_t> wanted_;
  std::vector<std::array<float, 2>> points_;
  std::vector<TracedLight> found_;
  std::size_t rays_ = 0;
};

/// A square of the picture in steps of the lattice.
struct PictureCell {
  int x = 0, y = 0, size = 0;
};

class TileMeans {
 public:
  TileMeans(const PixelTile& tile, const PixelMeanOptions& options, const TracePoints& trace, PixelMap<Light>& map)
      : tile_(tile),
        options_(options),
        divisions_(divisions_of(options.samples)),
        unit_(4 << divisions_),
        across_(TileRays::cells(tile.right - tile.left)),
        down_(TileRays::cells(tile.bottom - tile.top)),
        rays_(tile, unit_, trace),
        divided_(static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_), 0),
        map_(map) {}

  std::size_t run() {
    std::vector<PictureCell> now = divide_pairs();
    for (int level = 0; !now.empty(); ++level) {
      for (const PictureCell& cell : now) want(cell);
      rays_.trace_wanted();
      std::vector<PictureCell> next;
      for (const PictureCell& cell : now) {
        const float tolerated = 3 * static_cast<float>(options_.error) * static_cast<float>(1 << level);
        if ((level < divisions_ && differs(cell, tolerated)) ||
            (level == divisions_ && seen_difference(corners(cell), middle(cell)) > kSharp))
          add_quarters(cell, next);
        else
          add_mean(cell);
      }
      now.swap(next);
    }
    return rays_.rays();
  }

 private:
  void want(const PictureCell& c) {
    for (const int v : {0, c.size})
      for (const int u : {0, c.size}) rays_.want(c.x + u, c.y + v);
    rays_.want(c.x + c.size / 2, c.y + c.size / 2);
  }
  /// Middles of the edges: with them the first rays are a pixel apart, so that details of this size are not missed.
  void want_edges(const PictureCell& c) {
    const int half = c.size / 2;
    for (const int end : {0, c.size}) rays_.want(c.x + half, c.y + end), rays_.want(c.x + end, c.y + half);
  }
  const Light& middle(const PictureCell& c) const { return rays_.at(c.x + c.size / 2, c.y + c.size / 2); }
  /// Mean of the corners, the one in direction (right, down) with the share (near)².
  Light corners(const PictureCell& c, int right, int down, float near) const {
    const auto share = [&](int u, int v) { return (u == right ? near : 1 - near) * (v == down ? near : 1 - near); };
    Light sum{};
    for (const int v : {0, 1})
      for (const int u : {0, 1}) sum = sum_of(sum, 1, rays_.at(c.x + u * c.size, c.y + v * c.size), share(u, v));
    return sum;
  }
  Light corners(const PictureCell& c) const { return corners(c, 0, 0, 0.5f); }
  bool differs(const PictureCell& c, float levels) const {
    return options_.error == 0 || seen_difference(corners(c), middle(c)) > levels;
  }
  static void add_quarters(const PictureCell& c, std::vector<PictureCell>& to) {
    const int half = c.size / 2;
    for (const int v : {0, half})
      for (const int u : {0, half}) to.push_back({c.x + u, c.y + v, half});
  }
  PictureCell pair(std::size_t k) const {
    const int n = static_cast<int>(k), size = 2 * unit_;
    return {n % across_ * size, n / across_ * size, size};
  }

  /// Adds a cell's mean to its pixel: exact for quadratic polynomials where the light is smooth, with the shares that
  /// suit straight edges best where it jumps.
  void add_mean(const PictureCell& c) {
    const int x = tile_.left + c.x / unit_, y = tile_.top + c.y / unit_;
    if (x >= tile_.right || y >= tile_.bottom) return;
    const float area = static_cast<float>(c.size * c.size) / static_cast<float>(unit_ * unit_);
    const Light around = corners(c);
    const float jump = std::clamp((seen_difference(around, middle(c)) - kNoJump) / (kJump - kNoJump), 0.0f, 1.0f);
    const float inner = 2.0f / 3 + jump * (kAtEdges - 2.0f / 3);
    const Light mean = sum_of(middle(c), inner, around, 1 - inner);
    Light& pixel = map_.at(x, y);
    pixel = c.size == unit_ ? mean : sum_of(pixel, 1, mean, area);
  }
  /// Means of 2 × 2 pixels: the bilinear function through the corners, and (1 − (x² + y²)/2) times the difference at
  /// the centre in coordinates −1..1, exact for quadratic polynomials.
  void interpolate(const PictureCell& c) {
    const Light bulge = sum_of(middle(c), 1, corners(c), -1);
    for (const int v : {0, 1})
      for (const int u : {0, 1}) {
        const int x = tile_.left + c.x / unit_ + u, y = tile_.top + c.y / unit_ + v;
        if (x < tile_.right && y < tile_.bottom) map_.at(x, y) = sum_of(corners(c, u, v, 0.75f), 1, bulge, 2.0f / 3);
      }
  }
  /// True if the light at a pixel's centre differs from the interpolated one by more than kSurprise.
  bool surprises(const PictureCell& c) const {
    const Light bulge = sum_of(middle(c), 1, corners(c), -1);
    for (const int v : {0, 1})
      for (const int u : {0, 1}) {
        const Light& light = rays_.at(c.x + u * unit_ + unit_ / 2, c.y + v * unit_ + unit_ / 2);
        if (seen_difference(light, sum_of(corners(c, u, v, 0.75f), 1, bulge, 0.75f)) > kSurprise) return true;
      }
    return false;
  }

  void divide(std::size_t k, std::vector<std::size_t>& to) {
    if (divided_[k]) return;
    divided_[k] = 1;
    to.push_back(k);
  }
  void divide_around(std::size_t k, std::vector<std::size_t>& to) {
    const int x = static_cast<int>(k) % across_, y = static_cast<int>(k) / across_;
    for (int v = std::max(0, y - 1); v <= std::min(y + 1, down_ - 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(x + 1, across_ - 1); ++u)
        divide(static_cast<std::size_t>(v * across_ + u), to);
  }
  bool rough_pair(const PictureCell& c) const {
    if (differs(c, kSmooth * static_cast<float>(options_.error))) return true;
    for (const int v : {0, c.size})
      for (const int u : {0, c.size})
        if (seen_difference(rays_.at(c.x + u, c.y + v), middle(c)) > kFlatEnough) return true;
    const auto bent = [&](int u0, int v0, int u1, int v1) {
      const Light mean = sum_of(rays_.at(c.x + u0, c.y + v0), 0.5f, rays_.at(c.x + u1, c.y + v1), 0.5f);
      return seen_difference(mean, rays_.at(c.x + (u0 + u1) / 2, c.y + (v0 + v1) / 2)) > kStraightEdge;
    };
    const int n = c.size;
    return bent(0, 0, n, 0) || bent(0, n, n, n) || bent(0, 0, 0, n) || bent(n, 0, n, n);
  }

  /// Traces the first rays, interpolates smooth pairs of pixels, and returns the pixels of the others.
  std::vector<PictureCell> divide_pairs() {
    for (std::size_t k = 0; k < divided_.size(); ++k) want(pair(k)), want_edges(pair(k));
    rays_.trace_wanted();
    std::vector<std::size_t> now, next;
    for (std::size_t k = 0; k < divided_.size(); ++k)
      if (rough_pair(pair(k))) divide(k, now);
    std::vector<PictureCell> pixels;
    while (!now.empty()) {
      std::vector<PictureCell> quarters;
      for (const std::size_t k : now) add_quarters(pair(k), quarters);
      for (const PictureCell& c : quarters) want(c);
      rays_.trace_wanted();
      pixels.insert(pixels.end(), quarters.begin(), quarters.end());
      next.clear();
      for (const std::size_t k : now)
        if (surprises(pair(k))) divide_around(k, next);
      now.swap(next);
    }
    for (std::size_t k = 0; k < divided_.size(); ++k)
      if (!divided_[k]) interpolate(pair(k));
    for (const PictureCell& c : pixels) {
      const int x = tile_.left + c.x / unit_, y = tile_.top + c.y / unit_;
      if (x < tile_.right && y < tile_.bottom) map_.at(x, y) = {};
    }
    return pixels;
  }

  PixelTile tile_;
  const PixelMeanOptions& options_;
  int divisions_, unit_, across_, down_;
  TileRays rays_;
  std::vector<std::uint8_t> divided_;  // one per pair of pixels in each direction
  PixelMap<Light>& map_;
};

std::size_t centres_of_pixels(const PixelTile& tile, const TracePoints& trace, PixelMap<Light>& map) {
  std::vector<std::array<float, 2>> points;
  std::vector<TracedLight> lights;
  for (int y = tile.top; y < tile.bottom; ++y)
    for (int x = tile.left; x < tile.right; ++x)
      points.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
  lights.resize(points.size());
  trace(points, lights);
  std::size_t i = 0;
  for (int y = tile.top; y < tile.bottom; ++y)
    for (int x = tile.left; x < tile.right; ++x, ++i)
      map.at(x, y) = {lights[i].light.x, lights[i].light.y, lights[i].light.z, lights[i].left};
  return points.size();
}

}  // namespace

float seen_difference(const std::array<float, 4>& a, const std::array<float, 4>& b) {
  const auto root = [](const Light& p, std::size_t k) { return std::sqrt(std::max(0.0f, p[k] + 0.6f * p[3])); };
  float most = 0;
  for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(root(a, k) - root(b, k)));
  return 255 * most;
}

std::size_t pixel_means(const PixelTile& tile, const PixelMeanOptions& options, const TracePoints& trace,
                        PixelMap<std::array<float, 4>>& map) {
  if (options.samples == 1) return centres_of_pixels(tile, trace, map);
  return TileMeans(tile, options, trace, map).run();
}

}  // namespace sansmesh::inline v1
