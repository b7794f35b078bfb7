#include "sansmesh/flow_options.h"

#include <gtest/gtest.h>

#include <string>

#include "sansmesh/error.h"
#include "support/clean_text.h"

namespace sansmesh::inline v1 {
namespace {

const Box3 kBox{{0, 0, 0}, {4, 2, 1}};

TEST(Seeds, ShapesAreWhatTheySay) {
  const Seeds line = parse_seeds("line(0,0,0, 1,2,4, 5)", kBox);
  ASSERT_EQ(line.points.size(), 5u);
  EXPECT_TRUE(line.curve && !line.closed);
  EXPECT_EQ(line.points[1], (Vec3{0.25, 0.5, 1}));
  EXPECT_EQ(line.points[4], (Vec3{1, 2, 4}));

  const Seeds circle = parse_seeds(" circle(1,2,3, 0,0,2, 0.5, 8) ", kBox);
  ASSERT_EQ(circle.points.size(), 8u);
  EXPECT_TRUE(circle.curve && circle.closed);
  for (const Vec3& x : circle.points) {
    EXPECT_NEAR(norm(x - Vec3{1, 2, 3}), 0.5, 1e-12);
    EXPECT_NEAR(x.z, 3, 1e-12);
  }

  const Seeds plane = parse_seeds("plane(0,0,0, 1,0,0, 0,2,0, 3, 2)", kBox);
  ASSERT_EQ(plane.points.size(), 6u);
  EXPECT_FALSE(plane.curve);
  EXPECT_EQ(plane.points[1], (Vec3{0.5, 0, 0}));
  EXPECT_EQ(plane.points[5], (Vec3{1, 2, 0}));

  const Seeds box = parse_seeds("box(64)", kBox);
  EXPECT_NEAR(static_cast<double>(box.points.size()), 64, 20);
  for (const Vec3& x : box.points) EXPECT_TRUE(kBox.contains(x));
  // Layers, thick and thin, and rods have the same number.
  for (const Vec3& size : {Vec3{3, 2, 0}, Vec3{3, 0.01, 2}, Vec3{0.001, 2, 2}, Vec3{0, 1e-3, 5}}) {
    const Box3 layer{{1, 1, 1}, Vec3{1, 1, 1} + size};
    const Seeds flat = parse_seeds("box(200)", layer);
    EXPECT_NEAR(static_cast<double>(flat.points.size()), 200, 15);
    for (const Vec3& x : flat.points) EXPECT_TRUE(layer.contains(x));
  }
}

TEST(Seeds, SeveralMakeOneSetAndFilesAreNamed) {
  const Seeds both = parse_seeds("point(1,1,1); line(0,0,0,1,0,0,3)", kBox);
  EXPECT_EQ(both.points.size(), 4u);
  EXPECT_FALSE(both.curve);
  EXPECT_EQ(parse_seeds("points(a b.csv)", kBox).file, "a b.csv");
  EXPECT_TRUE(parse_seeds("loop(ring.csv)", kBox).closed);
  EXPECT_TRUE(parse_seeds("mesh(body.ply)", kBox).mesh);
  EXPECT_FALSE(parse_seeds("points(mesh.csv)", kBox).mesh);
}

TEST(Seeds, MistakesAreNamed) {
  for (const std::string text : {"", "line", "line(0,0,0)", "line(0,0,0, 1,0,0, 1)", "line(0,0,0, 1,0,0, 2.5)",
                                 "line(0,0,x, 1,0,0, 5)", "sphere(1)", "circle(0,0,0, 0,0,0, 1, 8)", "points()",
                                 "point(1,1,1);", "point(1,1,1);points(a.csv)", "box(nan)", "box(1e12)"})
    EXPECT_THROW(parse_seeds(text, kBox), ArgumentError) << text;
}

TEST(Seeds, MessagesQuoteAnythingInOnePrintableLine) {
  const std::string text = "line(0,0,\x05\n\xff" + std::string(10000, 'x') + ", 1,0,0, 5)";
  try {
    parse_seeds(text, kBox);
    FAIL();
  } catch (const ArgumentError& error) {
    EXPECT_TRUE(test::is_clean(error.what()));
    EXPECT_LT(std::string(error.what()).size(), 1000u);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
