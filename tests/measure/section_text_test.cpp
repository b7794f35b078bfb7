#include "sansmesh/measure/section_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "measure/measure_shapes.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
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

TEST(SectionText, SvgHasOneGroupPerPlane) {
  const TriangleMesh torus = test::torus_mesh(20, 10);
  std::vector<Section> sections;
  for (const CutPlane& plane : plane_series(2, -0.5, 0.1, 11)) sections.push_back(section_mesh(torus, plane));
  const std::string svg = section_svg(sections);
  EXPECT_EQ(count_of(svg, "<g id=\"plane"), 11u);
  EXPECT_EQ(count_of(svg, "inkscape:label=\"z = "), 11u);
  EXPECT_EQ(count_of(svg, "<svg "), 1u);
  EXPECT_EQ(count_of(svg, "</svg>"), 1u);
  EXPECT_EQ(count_of(svg, "<g "), count_of(svg, "</g>"));
  EXPECT_EQ(count_of(svg, "fill-rule=\"evenodd\""), 11u);
  EXPECT_NE(svg.find("z = -0.5"), std::string::npos);
  EXPECT_NE(svg.find("area "), std::string::npos);
  for (const char* bad : {"nan", "inf"}) EXPECT_EQ(svg.find(bad), std::string::npos) << bad;
  // All at the same scale.
  const std::size_t matrix = svg.find("matrix(");
  EXPECT_EQ(count_of(svg, svg.substr(matrix, svg.find(" 0 0 ", matrix) - matrix)), 11u);
  // Planes that miss the torus have no path; the others have one path with all of their curves.
  EXPECT_EQ(count_of(svg, "<path fill=\"#c9d5e3\""), 7u);
  EXPECT_EQ(count_of(svg, "Z\n"), 14u);
}

TEST(SectionText, TrueToScale) {
  const Section section[] = {section_mesh(test::box_mesh({0, 0, 0}, {50, 30, 10}), axis_plane(2, 5))};
  const std::string svg = section_svg(section, {.unit = "mm", .titles = false});
  // 50 × 30 and margins of 4 % of the longer side.
  // In pixels of 1/96 inch, 3.779528 to the millimetre.
  EXPECT_NE(svg.find("width=\"54mm\" height=\"34mm\" viewBox=\"0 0 204.0945 128.5039\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("transform=\"matrix(3.779528 0 0 3.779528 7.559055 120.9449)\""), std::string::npos) << svg;
  EXPECT_THROW(section_svg(section, {.unit = "furlong"}), ArgumentError);
}

TEST(SectionText, LettersAreReadableAndFit) {
  // Renderers misplace letters of fonts smaller than a few units: the layout must not depend on the unit.
  const TriangleMesh torus = test::torus_mesh(20, 10);
  std::vector<Section> sections;
  for (const CutPlane& plane : plane_series(2, -0.2, 0.2, 3)) sections.push_back(section_mesh(torus, plane));
  for (const char* unit : {"", "mm", "cm", "in"}) {
    const std::string svg = section_svg(sections, {.unit = unit});
    const double font = std::stod(svg.substr(svg.find("font-size=\"") + 11));
    EXPECT_GE(font, 7) << unit;
    EXPECT_LE(font, 13) << unit;
    // The second line of the second drawing ends before the third drawing, or is below it.
    std::vector<double> left;
    for (std::size_t at = svg.find("<text x=\""); at != std::string::npos; at = svg.find("<text x=\"", at + 1))
      left.push_back(std::stod(svg.substr(at + 9)));
    ASSERT_EQ(left.size(), 9u);
    const double width = std::stod(svg.substr(svg.find("viewBox=\"0 0 ") + 13));
    const std::size_t line = svg.find("length "), end = svg.find('<', svg.find(">length ") + 1);
    ASSERT_NE(line, std::string::npos);
    const auto letters = static_cast<double>(end - svg.find(">length ") - 1);
    EXPECT_GT((left[3] > left[0] ? left[3] : width) - left[0], 0.5 * font * letters) << unit;
  }
  EXPECT_NE(section_svg(sections, {.unit = "cm"}).find(" cm\u00B2"), std::string::npos);
}

TEST(SectionText, FarSectionsUseANearbyOrigin) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {5, 3, 1});
  box.origin = {512345, 4054321, 0};
  const Section section[] = {section_mesh(box, axis_plane(2, 0.5))};
  const std::string svg = section_svg(section);
  EXPECT_NE(svg.find("data-origin=\"512350 4054320\""), std::string::npos) << svg.substr(0, 600);
  EXPECT_NE(svg.find('M'), std::string::npos);
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
}  // namespace sansmesh::inline v1
