#include "sansmesh/jobs/pictures/region_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/render/annotate/stroke_text.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {
namespace {

/// View radius in radii of the region; at most this share of the diagonal.
constexpr double kSeen = 4, kMostSeen = 0.6;
/// Half size of the drawn box in view radii.
constexpr double kDrawn = 2.5;
/// Most vertices of a region whose visibility is tested.
constexpr std::size_t kAsked = 200;
/// Preference for the normal direction, relative to the visible share of the region.
constexpr double kAlong = 0.3;
/// A region with a smaller visible share is cut open: everything more than this many of its radii in front of it is
/// removed.
constexpr double kHidden = 0.2, kInFront = 1.1;
/// Lightness of the strip behind text, 0..1.
constexpr float kStrip = 0.75f;
/// Space between the pictures of a sheet in pixels.
constexpr int kGap = 6;
constexpr int kRingParts = 96;

/// Directions around a normal at several angles; the normal first.
std::vector<Vec3> directions_around(const Vec3& normal) {
  const Vec3 other = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(normal, other)), v = cross(normal, u);
  std::vector<Vec3> all{normal};
  for (const double tilt : {25.0, 50.0, 75.0, 105.0, 140.0})
    for (int k = 0; k < 8; ++k) {
      const double t = tilt * std::numbers::pi / 180, a = k * std::numbers::pi / 4;
      all.push_back(normal * std::cos(t) + (u * std::cos(a) + v * std::sin(a)) * std::sin(t));
    }
  all.push_back(-normal);
  return all;
}

/// Draws a ring visible on light and dark backgrounds.
void draw_ring(Image& image, double radius) {
  const double x = 0.5 * image.width, y = 0.5 * image.height;
  const double width = std::max(1.5, 0.006 * std::min(image.width, image.height));
  const Rgba rim{1, 1, 1, 0.8f}, ink{0.1f, 0.1f, 0.12f, 1};
  for (const bool inner : {false, true})
    for (int k = 0; k < kRingParts; ++k) {
      const double a = 2 * std::numbers::pi * k / kRingParts, b = 2 * std::numbers::pi * (k + 1) / kRingParts;
      draw_line(image, x + radius * std::cos(a), y + radius * std::sin(a), x + radius * std::cos(b),
                y + radius * std::sin(b), inner ? width : 2.4 * width, inner ? ink : rim);
    }
}

/// Draws text in the upper left corner, on a light strip.
void draw_text(Image& image, const std::string& text) {
  const double letters = std::max(9.0, 0.032 * std::min(image.width, image.height)), line = 1.9 * letters;
  const auto lines = 1 + std::count(text.begin(), text.end(), '\n');
  const int strip = std::min(image.height, static_cast<int>(letters + line * static_cast<double>(lines)));
  for (int y = 0; y < strip; ++y)
    for (int x = 0; x < image.width; ++x) {
      Rgba& pixel = image.at(x, y);
      for (std::size_t k = 0; k < 3; ++k) pixel[k] += kStrip * (1 - pixel[k]);
      pixel[3] += kStrip * (1 - pixel[3]);
    }
  double y = 1.9 * letters;
  for (std::size_t at = 0; at <= text.size(); y += line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string part = text.substr(at, end - at);
    const double fits = std::min(1.0, (image.width - 2 * letters) / std::max(1.0, stroke_width(part, letters)));
    draw_strokes(image, letters, y, fits * letters, part, {0.1f, 0.1f, 0.12f, 1});
    at = end + 1;
  }
}

}  // namespace

RegionPictures::RegionPictures(const Diagnosis& diagnosis)
    : diagnosis_(diagnosis),
      bounds_(bounds(diagnosis.mesh)),
      rays_(RayScene::triangles(diagnosis.mesh.vertices, diagnosis.mesh.triangles)) {}

RegionPictures::View RegionPictures::best_view(const SuspiciousRegion& region, double reach) const {
  const TriangleMesh& mesh = diagnosis_.mesh;
  const Vec3 middle = mesh.origin + Vec3(bounds_.center());
  Vec3 normal = region.normal;
  if (!(norm(normal) > 0)) normal = region.position - middle;
  if (!(norm(normal) > 0)) normal = {0, 0, 1};
  normal = normalized(normal);
  // The doubtful vertices, or all vertices of the region if there are none.
  const Vec3f at(region.position - mesh.origin);
  const auto radius = static_cast<float>(region.radius);
  std::vector<Vec3f> here, marked;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!(squared_norm(mesh.vertices[v] - at) <= radius * radius)) continue;
    here.push_back(mesh.vertices[v]);
    if (mesh.colors[v] == suspicion_color(region.kind)) marked.push_back(mesh.vertices[v]);
  }
  if (!marked.empty()) here = std::move(marked);
  if (here.empty()) here.push_back(at);  // the surface of a fit may be elsewhere
  const std::size_t stride = 1 + here.size() / kAsked;
  View best{normal, 0};
  double most = -1;
  for (const Vec3& direction : directions_around(normal)) {
    const Vec3f d(direction);
    std::size_t seen = 0, asked = 0;
    for (std::size_t i = 0; i < here.size(); i += stride, ++asked)
      seen += !rays_.blocked(here[i] + d * (1e-3f * radius), d, static_cast<float>(2 * kDrawn * reach));
    const double share = static_cast<double>(seen) / static_cast<double>(asked);
    const double worth = share + kAlong * dot(direction, normal);
    if (worth > most + 1e-9) most = worth, best = {direction, share};
  }
  return best;
}

Image RegionPictures::of(const SuspiciousRegion& region, const std::string& text, RenderOptions options,
                         Progress& progress) const {
  const TriangleMesh& mesh = diagnosis_.mesh;
  const double seen =
      std::min(kSeen * region.radius, std::max(region.radius, kMostSeen * static_cast<double>(bounds_.diagonal())));
  const Vec3f at(region.position - mesh.origin);
  const Box3f drawn = widened(Box3f{at, at}, static_cast<float>(kDrawn * seen));
  const View view = best_view(region, seen);
  const bool cut = view.seen < kHidden;
  const Vec3f toward(view.direction);
  const auto front = static_cast<float>(kInFront * region.radius);
  std::vector<std::uint8_t> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    Box3f box;
    float nearest = INFINITY;
    for (const std::uint32_t v : mesh.triangles[i]) {
      box.extend(mesh.vertices[v]);
      nearest = std::min(nearest, dot(mesh.vertices[v] - at, toward));
    }
    keep[i] = touch(box, drawn) && !(cut && nearest > front);
  }
  TriangleMesh part = mesh;
  keep_triangles(part, keep);
  options.look.ground = false;
  options.view.direction = view_from(view.direction, options.view.up);
  options.view.orthographic = true;
  options.view.look_at = region.position;
  options.view.look_radius = seen;
  options.view.zoom = 1;
  options.view.clip_box.reset();
  Image image = render_mesh(part, options, progress);
  draw_ring(image, 0.5 * (1 - kPictureMargin) * std::min(image.width, image.height) * region.radius / seen);
  draw_text(image, cut ? text + " (hidden: cut open)" : text);
  return image;
}

Image contact_sheet(const std::vector<Image>& pictures) {
  if (pictures.empty()) return {};
  const int width = pictures[0].width, height = pictures[0].height, count = static_cast<int>(pictures.size());
  const int columns = std::clamp(static_cast<int>(std::ceil(std::sqrt(count))), std::min(count, 3), 40),
            rows = (count + columns - 1) / columns;
  Image sheet(columns * (width + kGap) - kGap, rows * (height + kGap) - kGap, {1, 1, 1, 1});
  for (int i = 0; i < count; ++i)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        sheet.at(i % columns * (width + kGap) + x, i / columns * (height + kGap) + y) =
            pictures[static_cast<std::size_t>(i)].at(x, y);
  return sheet;
}

}  // namespace sansmesh::inline v1
