#include "sansmesh/measure/section_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "measure/measure_shapes.h"
#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++count;
  return count;
}

TEST(SectionText, CsvHoldsEveryVertex) {
  const TriangleMesh torus = test::torus_mesh(20, 10);
  const Section sections[] = {section_mesh(torus, axis_plane(2, 0.1)), section_mesh(torus, axis_plane(0, 0.1))};
  std::istringstream rows(section_csv(sections));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "plane,curve,closed,vertex,x,y,z,u,v");
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t c = 0; c < sections[s].curves.size(); ++c)
      for (std::size_t i = 0; i < sections[s].curves[c].points.size(); ++i) {
        ASSERT_TRUE(std::getline(rows, row));
        std::replace(row.begin(), row.end(), ',', ' ');
        std::istringstream numbers(row);
        std::size_t plane = 9, curve = 9, closed = 9, vertex = 9;
        double x = 0, y = 0, z = 0, u = 0, v = 0;
        numbers >> plane >> curve >> closed >> vertex >> x >> y >> z >> u >> v;
        EXPECT_EQ(plane, s);
        EXPECT_EQ(curve, c);
        EXPECT_EQ(closed, 1u);
        EXPECT_EQ(vertex, i);
        EXPECT_NEAR(norm(Vec3{x, y, z} - sections[s].curves[c].points[i]), 0, 1e-10);
        EXPECT_NEAR(u, sections[s].curves[c].plane[i][0], 1e-10);
        EXPECT_NEAR(v, sections[s].curves[c].plane[i][1], 1e-10);
      }
  EXPECT_FALSE(std::getline(rows, row));
}

TEST(SectionText, SvgHasOneGroupAPlane) {
  const TriangleMesh torus = test::torus_mesh(20, 10);
  std::vector<Section> sections;
  for (const CutPlane& plane : plane_series(2, -0.5, 0.1, 11)) sections.push_back(section_mesh(torus, plane));
  const std::string svg = section_svg(sections);
  EXPECT_EQ(count_of(svg, "<g id=\"plane"), 11u);
  EXPECT_EQ(count_of(svg, "<svg "), 12u);
  EXPECT_EQ(count_of(svg, "</svg>"), 12u);
  EXPECT_EQ(count_of(svg, "<g "), count_of(svg, "</g>"));
  EXPECT_EQ(count_of(svg, "fill-rule=\"evenodd\""), 11u);
  EXPECT_NE(svg.find("z = -0.5"), std::string::npos);
  EXPECT_NE(svg.find("area "), std::string::npos);
  for (const char* bad : {"nan", "inf"}) EXPECT_EQ(svg.find(bad), std::string::npos) << bad;
  // All show the same part of the plane.
  const std::size_t box = svg.find("viewBox=", svg.find("<g "));
  EXPECT_EQ(count_of(svg, svg.substr(box, svg.find(" fill-rule", box) - box)), 11u);
  // The planes that miss the torus have no path but their own drawing; the others one path each with all of its curves.
  EXPECT_EQ(count_of(svg, "<path fill=\"#c9d5e3\""), 7u);
  EXPECT_EQ(count_of(svg, "Z\n"), 14u);
}

TEST(SectionText, TrueToScale) {
  const Section section[] = {section_mesh(test::box_mesh({0, 0, 0}, {50, 30, 10}), axis_plane(2, 5))};
  const std::string svg = section_svg(section, {.unit = "mm", .titles = false});
  // 50 × 30 and margins of 4 % of the longer side.
  EXPECT_NE(svg.find("width=\"54mm\" height=\"34mm\" viewBox=\"0 0 54 34\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("width=\"54\" height=\"34\" viewBox=\"-2 -32 54 34\""), std::string::npos) << svg;
  EXPECT_THROW(section_svg(section, {.unit = "furlong"}), ArgumentError);
}

TEST(SectionText, FarPlacesAreDrawnRelativeToOneNearby) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {5, 3, 1});
  box.origin = {512345, 4054321, 0};
  const Section section[] = {section_mesh(box, axis_plane(2, 0.5))};
  const std::string svg = section_svg(section);
  EXPECT_NE(svg.find("data-origin=\"512350 4054320\""), std::string::npos) << svg.substr(0, 600);
  EXPECT_NE(svg.find("M"), std::string::npos);
  const std::string empty = section_svg({});
  EXPECT_NE(empty.find("</svg>"), std::string::npos);
}

TEST(SectionText, RoundLengths) {
  EXPECT_DOUBLE_EQ(round_length(0.37), 0.2);
  EXPECT_DOUBLE_EQ(round_length(5), 5);
  EXPECT_DOUBLE_EQ(round_length(1.99), 1);
  EXPECT_DOUBLE_EQ(round_length(1000), 1000);
}

}  // namespace
}  // namespace sansmesh
