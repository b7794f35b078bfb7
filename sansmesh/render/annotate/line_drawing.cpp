#include "sansmesh/render/annotate/line_drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/render/annotate/crest_lines.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kLineTile = 64;
/// Two sheets are behind each other if their tangent planes are separated by more than this many times the distance of
/// neighbouring rays. A smooth sheet with points up to its silhouette stays near one.
constexpr float kSheetGap = 4;
constexpr float kFoldCosine = 0.87f;  // 30°

/// Hits of neighbouring rays of a tile.
struct RayGrid {
  int left, top, wide, high;  // in rays of the whole picture
  std::vector<std::optional<SurfacePoint>> points;
  std::vector<Vec3f> positions;

  std::size_t slot(int x, int y) const {
    return static_cast<std::size_t>(y - top) * static_cast<std::size_t>(wide) + static_cast<std::size_t>(x - left);
  }
};

class EdgeInk {
 public:
  EdgeInk(const PictureScene& scene, const Camera& camera, const RenderOptions& options)
      : scene_(scene),
        camera_(camera),
        n_(options.quality.samples),
        radius_(std::max(0.5f, 0.5f * static_cast<float>(options.look.line_width * n_))),
        reach_(static_cast<int>(std::ceil(radius_)) + 1),
        across_(2 / static_cast<float>(options.view.width * n_)),
        down_(2 / static_cast<float>(options.view.height * n_)),
        step_(camera.half_height * down_) {}

  void paint(int left, int top, int right, int bottom, PixelMap<float>& ink) const {
    RayGrid grid{left * n_ - reach_,
                 top * n_ - reach_,
                 (right - left) * n_ + 2 * reach_,
                 (bottom - top) * n_ + 2 * reach_,
                 {},
                 {}};
    look(grid);
    std::vector<std::uint8_t> mask(grid.points.size());
    for (int y = grid.top; y < grid.top + grid.high; ++y)
      for (int x = grid.left; x < grid.left + grid.wide; ++x) {
        const std::size_t here = grid.slot(x, y);
        if (x + 1 < grid.left + grid.wide && edge(grid, here, grid.slot(x + 1, y)))
          stamp(grid, static_cast<float>(x) + 0.5f, static_cast<float>(y), mask);
        if (y + 1 < grid.top + grid.high && edge(grid, here, grid.slot(x, y + 1)))
          stamp(grid, static_cast<float>(x), static_cast<float>(y) + 0.5f, mask);
      }
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        int covered = 0;
        for (int v = 0; v < n_; ++v)
          for (int u = 0; u < n_; ++u) covered += mask[grid.slot(x * n_ + u, y * n_ + v)];
        ink.at(x, y) = static_cast<float>(covered) / static_cast<float>(n_ * n_);
      }
  }

 private:
  void look(RayGrid& grid) const {
    const std::size_t count = static_cast<std::size_t>(grid.wide) * static_cast<std::size_t>(grid.high);
    grid.points.resize(count);
    grid.positions.resize(count);
    CameraRays rays(camera_);
    constexpr int kRows = 8;  // with rays in one batch
    for (int row = 0; row < grid.high; row += kRows) {
      rays.clear();
      const int rows = std::min(kRows, grid.high - row);
      for (int y = row; y < row + rows; ++y)
        for (int x = 0; x < grid.wide; ++x)
          rays.add((static_cast<float>(grid.left + x) + 0.5f) * across_ - 1,
                   1 - (static_cast<float>(grid.top + y) + 0.5f) * down_);
      const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.wide);
      const EyeRays eye = rays.rays();
      scene_.closest(eye, std::span(grid.points).subspan(first, rays.size()));
      for (std::size_t i = 0; i < rays.size(); ++i) {
        std::optional<SurfacePoint>& p = grid.points[first + i];
        if (p && p->cover < 0.5f) p.reset();
        if (p) grid.positions[first + i] = eye.at(i, p->distance);
      }
    }
  }

  bool edge(const RayGrid& grid, std::size_t a, std::size_t b) const {
    const auto &p = grid.points[a], &q = grid.points[b];
    if (!p || !q) return p.has_value() != q.has_value();
    const Vec3f d = grid.positions[b] - grid.positions[a];
    const float apart = step_ * (camera_.parallel ? 1 : std::min(p->distance, q->distance));
    if (std::min(std::abs(dot(d, p->normal)), std::abs(dot(d, q->normal))) > kSheetGap * apart) return true;
    return dot(p->normal, q->normal) < kFoldCosine && crisp(grid, a, b);
  }

  /// Whether the normals jump here: equal changes on both sides are a smooth curve.
  bool crisp(const RayGrid& grid, std::size_t a, std::size_t b) const {
    const std::size_t step = b - a;
    if (a < step || b + step >= grid.points.size()) return false;
    const auto &p = grid.points[a], &q = grid.points[b], &before = grid.points[a - step],
               &after = grid.points[b + step];
    const auto turn = [](const SurfacePoint& s, const SurfacePoint& t) { return norm(s.normal - t.normal); };
    const float jump = turn(*p, *q);
    return (before && 2 * turn(*before, *p) < jump) && (after && 2 * turn(*q, *after) < jump);
  }

  /// Marks a disc of rays around a point of the grid.
  void stamp(const RayGrid& grid, float cx, float cy, std::vector<std::uint8_t>& mask) const {
    const int left = index_in<int>(std::ceil(cx - radius_), grid.left, grid.left + grid.wide);
    const int right = index_in<int>(std::floor(cx + radius_), grid.left - 1, grid.left + grid.wide - 1);
    const int top = index_in<int>(std::ceil(cy - radius_), grid.top, grid.top + grid.high);
    const int bottom = index_in<int>(std::floor(cy + radius_), grid.top - 1, grid.top + grid.high - 1);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const float dx = static_cast<float>(x) - cx, dy = static_cast<float>(y) - cy;
        if (dx * dx + dy * dy <= radius_ * radius_) mask[grid.slot(x, y)] = 1;
      }
  }

  const PictureScene& scene_;
  const Camera& camera_;
  int n_;
  float radius_;  // half the width of lines, in rays
  int reach_;
  float across_, down_, step_;  // between rays: in the picture, and at distance 1
};

}  // namespace

PixelMap<float> line_ink(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                         const RenderOptions& options, Progress& progress) {
  PixelMap<float> ink(options.view.width, options.view.height);
  const EdgeInk edges(scene, camera, options);
  const int across = (ink.width + kLineTile - 1) / kLineTile, down = (ink.height + kLineTile - 1) / kLineTile;
  const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  progress.begin("lines", tiles);
  parallel_for(0, tiles, 1, [&](std::size_t tile) {
    const int left = static_cast<int>(tile) % across * kLineTile, top = static_cast<int>(tile) / across * kLineTile;
    edges.paint(left, top, std::min(left + kLineTile, ink.width), std::min(top + kLineTile, ink.height), ink);
    progress.advance();
  });
  const PixelMap<float> crests = crest_ink(scene, camera, frame, options);
  for (std::size_t i = 0; i < ink.pixels.size(); ++i) ink.pixels[i] = std::max(ink.pixels[i], crests.pixels[i]);
  progress.finish();
  return ink;
}

void draw_ink(Image& image, const PixelMap<float>& ink, const Vec3f& color) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    Rgba& pixel = image.pixels[i];
    const float over = ink.pixels[i], alpha = over + pixel[3] * (1 - over);
    if (!(over > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) pixel[k] = (color[k] * over + pixel[k] * pixel[3] * (1 - over)) / alpha;
    pixel[3] = alpha;
  }
}

}  // namespace sansmesh::inline v1
