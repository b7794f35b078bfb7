// Edges of triangles as lines.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sansmesh/render_options.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kSide = 200;

/// A square of 2 × 2 at a depth, of n × n squares cut in two.
TriangleMesh grid_at(float z, std::uint32_t n, float half = 1) {
  TriangleMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.vertices.push_back({half * (2 * static_cast<float>(i) / static_cast<float>(n) - 1),
                               half * (2 * static_cast<float>(j) / static_cast<float>(n) - 1), z});
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

RenderOptions line_drawing(double width) {
  RenderOptions options;
  options.view.width = options.view.height = kSide;
  options.quality.samples = 4;
  options.view.direction = {0, 0};
  options.look.background = Background::transparent();
  options.look.ground = options.look.shadows = options.look.smooth = false;
  options.quality.occlusion_rays = 0;
  options.look.wireframe = PictureLook::Wireframe::only;
  options.look.wire_width = width;
  return options;
}

double inked(const Image& image) {
  double sum = 0;
  for (const Rgba& p : image.pixels) sum += static_cast<double>(p[3]);
  return sum;
}

/// Pixels per unit length of a square of 2 × 2 that fills the picture's height.
const double kPerLength = 0.5 * kSide * (1 - 0.13);

TEST(MeshWires, LinesAreAsWideAsAskedFor) {
  for (const bool parallel : {false, true})
    for (const double width : {1.0, 2.0, 3.0}) {
      RenderOptions options = line_drawing(width);
      options.view.orthographic = parallel;
      // 3 inner lines in each direction, diagonals of total length 4 times 2√2, and the border.
      const double length = kPerLength * (2 * 3 * 2 + 4 * 2 * std::sqrt(2.0) + 4 * 2);
      EXPECT_NEAR(inked(render_mesh(grid_at(0, 4), options)) / length, width, 0.12 * width) << parallel << width;
    }
}

TEST(MeshWires, LinesFarAwayAreAsWideAsNearOnes) {
  // An edge along the viewing direction, between two triangles: rows of pixels across it.
  TriangleMesh kite;
  kite.vertices = {{0, 0, 0}, {0, 0, -30}, {-8, 0, -15}, {8, 0, -15}};
  kite.triangles = {{0, 3, 1}, {0, 1, 2}};
  RenderOptions options = line_drawing(2);
  options.view.direction = {0, 25};
  options.view.field_of_view = 70;
  const Image image = render_mesh(kite, options);
  const auto across = [&](int y, int half) {
    double sum = 0;
    for (int x = kSide / 2 - half; x < kSide / 2 + half; ++x) sum += static_cast<double>(image.at(x, y)[3]);
    return sum;
  };
  std::vector<int> rows;
  for (int y = 0; y < kSide; ++y)
    if (across(y, 4) > 0) rows.push_back(y);
  ASSERT_GT(rows.size(), 40u);
  for (std::size_t k = rows.size() / 4; k < 3 * rows.size() / 4; ++k) EXPECT_NEAR(across(rows[k], 4), 2, 0.3);
}

TEST(MeshWires, WhatTheSurfaceHidesIsNotDrawn) {
  // The lines of a smaller square are behind one of two triangles.
  TriangleMesh front = grid_at(0, 1);
  const TriangleMesh both = test::joined(front, grid_at(-0.2f, 6, 0.3f), {0.5f, -0.5f, 0});
  RenderOptions options = line_drawing(1);
  options.view.orthographic = true;
  EXPECT_EQ(inked(render_mesh(both, options)), inked(render_mesh(front, options)));
  options.view.direction = {180, 0};
  EXPECT_GT(inked(render_mesh(both, options)), inked(render_mesh(front, options)) + 300);
}

TEST(MeshWires, StandOnTheShadedSurface) {
  RenderOptions options = line_drawing(2);
  options.look.wireframe = PictureLook::Wireframe::over;
  options.look.wire_color = {0, 0, 0};
  options.view.orthographic = true;
  const Image image = render_mesh(grid_at(0, 2), options);
  const int middle = kSide / 2, quarter = static_cast<int>(0.5 * kPerLength);
  EXPECT_LT(image.at(middle, middle - quarter)[1], 0.1f) << "on a line";
  EXPECT_EQ(image.at(middle, middle - quarter)[3], 1);
  EXPECT_GT(image.at(middle + quarter / 2, middle - 3 * quarter / 2)[1], 0.5f) << "beside them";
  const RenderOptions usual;
  options.look.wireframe = usual.look.wireframe, options.look.wire_width = usual.look.wire_width,
  options.look.wire_color = usual.look.wire_color;
  EXPECT_GT(render_mesh(grid_at(0, 2), options).at(middle, middle - quarter)[1], 0.5f);
}

TEST(MeshWires, SeamsAreDrawnAsOtherEdges) {
  TriangleMesh whole = grid_at(0, 1), cut = whole;
  cut.vertices.push_back(cut.vertices[0]);
  cut.vertices.push_back(cut.vertices[3]);
  cut.triangles[1] = {4, 5, 2};
  const RenderOptions options = line_drawing(3);
  EXPECT_EQ(inked(render_mesh(whole, options)), inked(render_mesh(cut, options)));
}

}  // namespace
}  // namespace sansmesh::inline v1
