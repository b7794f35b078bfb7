#include "sansmesh/render/splat/splat_layers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/group_rows.h"
#include "sansmesh/render/splat/splat_footprint.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kLayerTile = 16;
/// Sum of weights at the border of a sheet: less than half, so that irregular splats leave no holes.
constexpr float kBorderLevel = 0.35f;
/// The same for back sides: discs at sharp edges stick out behind the faces on the other side.
constexpr float kBorderBehind = 0.5f;
/// Depth range of a sheet, relative to the projected width of its first splat.
constexpr float kSheetDepth = 1.5f;
constexpr float kLeastCosine = 0.3f;
/// Splats before the weights of a sheet reach this sum do not determine its depth: they may be strays seen from the
/// side.
constexpr float kSheetBegins = 0.1f;
/// Largest cosine at which splats of bodies that face away still belong to the visible side: rounded tips may consist
/// of few splats.
constexpr float kRoundAway = 0.15f;
/// Splats that face the viewer are the front of a sheet unless their weight is below this share of those that face
/// away.
constexpr float kFewFront = 0.25f;
constexpr float kLeastShare = 1.0f / 512;
constexpr std::size_t kMostLayers = 4;

struct Fragment {
  float distance, weight;
  std::uint32_t splat;
};

struct PixelRange {
  int left, top, right, bottom;  // the last two are exclusive
};

}  // namespace

namespace {

/// Data that are common to all tiles.
class SplatRaster {
 public:
  SplatRaster(const EllipticSplats& splats, const Camera& camera, const SplatRasterOptions& options,
              const PixelRange& all)
      : splats_(splats),
        camera_(camera),
        options_(options),
        all_(all),
        culled_(splats.closed && !options.clip),
        feet_(splats.centers.size()) {
    across_ = (all.right - all.left + kLayerTile - 1) / kLayerTile;
    down_ = (all.bottom - all.top + kLayerTile - 1) / kLayerTile;
    parallel_for(0, feet_.size(), 4096, [&](std::size_t i) {
      const auto seen = splat_footprint(camera, options.width, options.height, splats.centers[i], splats.major[i],
                                        splats.minor[i], options.filter);
      if (!seen) return;
      feet_[i] = *seen;
      // As for a sheet of equal, evenly distributed splats: their weights sum to 1.
      feet_[i].peak *=
          splats.areas[i] / (2 * std::numbers::pi_v<float> * norm(splats.major[i]) * norm(splats.minor[i]));
    });
    bin();
  }

  std::size_t tiles() const { return static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_); }
  PixelRange pixels_of(std::size_t tile) const {
    const int left = all_.left + static_cast<int>(tile) % across_ * kLayerTile;
    const int top = all_.top + static_cast<int>(tile) / across_ * kLayerTile;
    return {left, top, std::min(left + kLayerTile, all_.right), std::min(top + kLayerTile, all_.bottom)};
  }

  /// The layers of a tile's pixels, row by row, and their number per pixel.
  void paint(std::size_t tile, std::vector<SplatLayer>& layers, std::vector<std::uint32_t>& counts) const {
    const PixelRange pixels = pixels_of(tile);
    const int wide = pixels.right - pixels.left;
    std::vector<std::vector<Fragment>> found(static_cast<std::size_t>(wide) *
                                             static_cast<std::size_t>(pixels.bottom - pixels.top));
    std::vector<Vec3f> origins, directions;
    for (int y = pixels.top; y < pixels.bottom; ++y)
      for (int x = pixels.left; x < pixels.right; ++x) {
        const float u = (2 * static_cast<float>(x) + 1) / static_cast<float>(options_.width) - 1;
        const float v = 1 - (2 * static_cast<float>(y) + 1) / static_cast<float>(options_.height);
        origins.push_back(camera_.origin(u, v));
        directions.push_back(camera_.direction(u, v));
      }
    for (const std::uint32_t i : splats_of_tile_[tile]) {
      const PixelRange part = range(feet_[i], pixels);
      for (int y = part.top; y < part.bottom; ++y)
        for (int x = part.left; x < part.right; ++x) {
          const auto at = static_cast<std::size_t>((y - pixels.top) * wide + x - pixels.left);
          add(i, x, y, origins[at], directions[at], found[at]);
        }
    }
    layers.clear();
    counts.clear();
    std::vector<Fragment> sheet;
    for (std::size_t at = 0; at < found.size(); ++at) {
      const std::size_t before = layers.size();
      const int x = pixels.left + static_cast<int>(at) % wide, y = pixels.top + static_cast<int>(at) / wide;
      resolve(x, y, directions[at], found[at], sheet, layers);
      counts.push_back(static_cast<std::uint32_t>(layers.size() - before));
    }
  }

 private:
  /// Pixels with centres inside the footprint.
  static PixelRange range(const SplatFootprint& f, const PixelRange& within) {
    const auto low = [](float v, int least, int most) { return index_in<int>(std::ceil(v), least, most); };
    return {
        low(f.x - f.reach_x - 0.5f, within.left, within.right), low(f.y - f.reach_y - 0.5f, within.top, within.bottom),
        low(f.x + f.reach_x + 0.5f, within.left, within.right), low(f.y + f.reach_y + 0.5f, within.top, within.bottom)};
  }

  template <class Visit>
  void for_tiles(const SplatFootprint& f, const Visit& visit) const {
    if (!(f.peak > 0)) return;
    const PixelRange r = range(f, all_);
    if (r.left >= r.right || r.top >= r.bottom) return;
    for (int v = (r.top - all_.top) / kLayerTile; v <= (r.bottom - 1 - all_.top) / kLayerTile; ++v)
      for (int u = (r.left - all_.left) / kLayerTile; u <= (r.right - 1 - all_.left) / kLayerTile; ++u)
        visit(static_cast<std::size_t>(v) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(u));
  }

  /// The splats of each tile, in their order.
  void bin() {
    splats_of_tile_ = group_rows(tiles(), [&](const auto& visit) {
      for (std::size_t i = 0; i < feet_.size(); ++i) for_tiles(feet_[i], [&](std::size_t tile) { visit(tile, i); });
    });
  }

  float wide(std::uint32_t i) const { return norm(splats_.major[i]); }

  void add(std::uint32_t i, int x, int y, const Vec3f& origin, const Vec3f& direction,
           std::vector<Fragment>& fragments) const {
    const SplatFootprint& f = feet_[i];
    const float square = f.square(static_cast<float>(x) + 0.5f - f.x, static_cast<float>(y) + 0.5f - f.y);
    if (!(square < kSplatCut * kSplatCut)) return;
    // Distance on the tangent plane, limited to the extent of the splat: seen from the side, the plane is not bounded.
    const Vec3f to_center = splats_.centers[i] - origin;
    const float cosine = dot(splats_.normals[i], direction), beside = dot(to_center, direction);
    if (cosine > kRoundAway && culled_) return;
    const float reach = kSplatCut * wide(i);
    const float t =
        cosine == 0 ? beside : std::clamp(dot(splats_.normals[i], to_center) / cosine, beside - reach, beside + reach);
    if (!(t > 0)) return;
    if (options_.clip) {
      const Vec3f at = origin + t * direction;
      for (int k = 0; k < 3; ++k)
        if (at[k] < options_.clip->lower[k] || at[k] > options_.clip->upper[k]) return;
    }
    fragments.push_back({t, f.peak * std::exp(-0.5f * square), i});
  }

  /// Depth behind a fragment up to which its sheet continues.
  float depth_limit(const Fragment& f, const Vec3f& direction) const {
    const float cosine = std::abs(dot(splats_.normals[f.splat], direction));
    return f.distance + kSheetDepth * wide(f.splat) / std::max(kLeastCosine, cosine);
  }
  bool faces(const Fragment& f, const Vec3f& direction) const {
    return dot(splats_.normals[f.splat], direction) <= (culled_ ? kRoundAway : 0);
  }

  /// Accumulates sheets from front to back until the pixel is full.
  void resolve(int x, int y, const Vec3f& direction, std::vector<Fragment>& fragments, std::vector<Fragment>& sheet,
               std::vector<SplatLayer>& layers) const {
    std::sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.splat < b.splat;
    });
    const std::size_t before = layers.size();
    float left = 1;
    std::size_t next = 0;
    while (next < fragments.size() && layers.size() < before + kMostLayers) {
      float limit = depth_limit(fragments[next], direction), facing = 0, away = 0;
      bool begun = false;
      sheet.clear();
      for (; next < fragments.size() && fragments[next].distance <= limit; ++next) {
        const Fragment& f = fragments[next];
        (faces(f, direction) ? facing : away) += f.weight;
        sheet.push_back(f);
        if (!begun && facing + away >= kSheetBegins) limit = depth_limit(f, direction), begun = true;
      }
      const bool front_side = facing >= kFewFront * away;
      SplatLayer layer;
      const float cover = blend(x, y, direction, sheet, front_side, layer);
      layer.share = left * cover;
      if (!(layer.share > kLeastShare)) continue;
      layers.push_back(layer);
      left -= layer.share;
      if (!(left > kLeastShare)) {  // the rest is invisible
        layers.back().share += left;
        break;
      }
    }
  }

  /// Means over the fragments of the sheet that face the same way; returns their covered share of the pixel.
  float blend(int x, int y, const Vec3f& direction, std::span<const Fragment> sheet, bool front_side,
              SplatLayer& layer) const {
    float sum = 0, slope_x = 0, slope_y = 0;
    for (const Fragment& s : sheet) {
      if (faces(s, direction) != front_side) continue;
      const SplatFootprint& f = feet_[s.splat];
      const float dx = static_cast<float>(x) + 0.5f - f.x, dy = static_cast<float>(y) + 0.5f - f.y;
      sum += s.weight;
      slope_x -= s.weight * (f.xx * dx + f.xy * dy);
      slope_y -= s.weight * (f.xy * dx + f.yy * dy);
      layer.distance += s.weight * s.distance;
      layer.normal += s.weight * splats_.normals[s.splat];
      layer.color += s.weight * splats_.colors[s.splat];
      layer.width += s.weight * wide(s.splat);
    }
    if (!(sum > 0)) return 0;
    const float share = 1 / sum;
    layer.distance *= share;
    layer.color *= share;
    layer.width *= share;
    layer.normal = normalized(front_side ? layer.normal : -layer.normal);
    // Distance in pixels to the border, where the sum is at its level.
    const float slope = std::hypot(slope_x, slope_y), above = sum - (front_side ? kBorderLevel : kBorderBehind);
    if (!(slope > 0)) return above > 0 ? 1.0f : 0.0f;
    return std::clamp(0.5f + above / slope, 0.0f, 1.0f);
  }

  const EllipticSplats& splats_;
  const Camera& camera_;
  const SplatRasterOptions& options_;
  PixelRange all_;
  bool culled_;  // back sides are invisible
  int across_ = 0, down_ = 0;
  std::vector<SplatFootprint> feet_;
  Adjacency splats_of_tile_;
};

}  // namespace

SplatLayers::SplatLayers(const EllipticSplats& splats, const Camera& camera, const SplatRasterOptions& options)
    : left_(-options.rim),
      top_(-options.rim),
      width_(options.width + 2 * options.rim),
      height_(options.height + 2 * options.rim) {
  const SplatRaster raster(splats, camera, options, {left_, top_, left_ + width_, top_ + height_});
  std::vector<std::vector<SplatLayer>> layers(raster.tiles());
  std::vector<std::vector<std::uint32_t>> counts(raster.tiles());
  parallel_for(0, raster.tiles(), 1, [&](std::size_t tile) { raster.paint(tile, layers[tile], counts[tile]); });

  const auto slot = [&](int x, int y) {
    return static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x - left_);
  };
  const auto each = [&](std::size_t tile, const auto& use) {
    const PixelRange r = raster.pixels_of(tile);
    std::size_t k = 0;
    for (int y = r.top; y < r.bottom; ++y)
      for (int x = r.left; x < r.right; ++x, ++k) use(slot(x, y), counts[tile][k]);
  };
  first_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
  for (std::size_t tile = 0; tile < raster.tiles(); ++tile)
    each(tile, [&](std::size_t pixel, std::uint32_t count) { first_[pixel + 1] = count; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  layers_.resize(first_.back());
  for (std::size_t tile = 0; tile < raster.tiles(); ++tile) {
    auto from = layers[tile].begin();
    each(tile, [&](std::size_t pixel, std::uint32_t count) {
      std::copy_n(from, count, layers_.begin() + static_cast<std::ptrdiff_t>(first_[pixel]));
      from += count;
    });
  }
}

std::span<const SplatLayer> SplatLayers::at(int x, int y) const {
  if (x < left_ || y < top_ || x >= left_ + width_ || y >= top_ + height_) return {};
  const std::size_t pixel =
      static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x - left_);
  return std::span(layers_).subspan(first_[pixel], first_[pixel + 1] - first_[pixel]);
}

}  // namespace sansmesh::inline v1
