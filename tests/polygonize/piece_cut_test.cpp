// Cuts of minima and maxima of planes are closed, however many planes meet at a point.
#include "sansmesh/polygonize/pieces/piece_cut.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {
namespace {

using Kind = PieceNode::Kind;

/// Planes combined by least() and greatest().
class Planes final : public PieceExpression {
 public:
  /// The half-space behind the plane through a point; values are `steepness` times distances.
  std::uint32_t plane(const Vec3& normal, const Vec3& through, double steepness = 1) {
    const Vec3 n = normalized(normal) * steepness;
    planes_.push_back({n, dot(n, through)});
    return add({Kind::piece, static_cast<std::uint32_t>(planes_.size() - 1), 0});
  }
  std::uint32_t least(std::uint32_t a, std::uint32_t b) { return add({Kind::least, a, b}); }
  std::uint32_t greatest(std::uint32_t a, std::uint32_t b) { return add({Kind::greatest, a, b}); }
  std::uint32_t cube(const Vec3& center = {}, double half = 1) {
    std::uint32_t all = plane({1, 0, 0}, center + Vec3{half, 0, 0});
    for (const Vec3& n : {Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
      all = greatest(all, plane(n, center + half * n));
    return all;
  }

  Box3 bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  std::uint32_t pieces() const override { return static_cast<std::uint32_t>(planes_.size()); }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = dot(planes_[piece].normal, x[i]) - planes_[piece].offset;
      if (!gradients.empty()) gradients[i] = planes_[piece].normal;
    }
  }
  double curvature_bound(std::uint32_t, const Vec3&, double) const override { return 0; }
  std::uint32_t same_at(std::uint32_t piece, std::span<const Vec3>) const override { return piece; }
  std::uint32_t same_within(std::uint32_t piece, const Vec3&, double) const override { return piece; }

 private:
  struct Plane {
    Vec3 normal;
    double offset;
  };
  std::uint32_t add(const Node& node) {
    nodes_.push_back(node);
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }
  std::vector<Plane> planes_;
};

/// Cuts `field` in its own blocks, or in those of another field.
CutPieces cut(const PieceExpression& field, const PieceExpression* of_blocks = nullptr) {
  Progress progress;
  PieceBlockOptions options;
  options.mesh_error = 1e-3;
  options.most_blocks = 100'000;
  const PieceExpression& other = of_blocks ? *of_blocks : field;
  return cut_pieces(field, piece_blocks(other, other.bounds(), options, 0, progress), progress);
}

MeshTopology topology_of(const CutPieces& pieces) {
  TriangleMesh mesh;
  mesh.triangles = pieces.triangles;
  mesh.vertices.resize(pieces.vertices.size());
  return measure_topology(mesh);
}

constexpr Vec3 kTip{0.1234, 0.0567, 0.0345};

/// A small cube at the tip, intersected with the union of `count` half-spaces that end at multiples of `step`.
std::uint32_t in_one_of(Planes& field, int count, double step, double half) {
  std::uint32_t any = 0;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t one = field.plane({1, 0.1, 0.05}, kTip + Vec3{step * k, 0, 0});
    any = k == 0 ? one : field.least(any, one);
  }
  return field.greatest(field.cube(kTip, half), any);
}

/// A plane is part of the surface as far as one of many half-spaces reaches: each divides it, and only the last one
/// ends it. In one simplex of a face this is one long side, in the other more than a hundred parts.
TEST(PieceCut, SidesOfManyPartsMeetOneSide) {
  for (const int count : {20, 120}) {
    Planes field;
    const std::uint32_t within = in_one_of(field, count, 1e-5, 0.008);
    field.greatest(within, field.plane({0.1, 0.2, 1}, kTip));
    const CutPieces pieces = cut(field);
    ASSERT_FALSE(pieces.crowded) << count;
    EXPECT_FALSE(pieces.cracked) << count;
    const MeshTopology topology = topology_of(pieces);
    EXPECT_TRUE(topology.closed()) << count << ": " << topology.boundary_edges << " open edges";
    EXPECT_EQ(topology.components, 1u) << count;
  }
}

TEST(PieceCut, AnyTreesOfPlanesThroughOnePlaceAreClosed) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> near(-2e-3, 2e-3);
  for (int trial = 0; trial < 14; ++trial) {
    Planes field;
    const std::uint32_t cube = field.cube();
    std::vector<std::uint32_t> open;
    const int count = 3 + trial % 11;
    for (int k = 0; k < count; ++k)
      open.push_back(field.plane({normal(random), normal(random), normal(random)},
                                 kTip + Vec3{near(random), near(random), near(random)}));
    while (open.size() > 1) {
      const std::size_t i = random() % (open.size() - 1);
      const std::uint32_t a = open[i], b = open[i + 1];
      open[i] = random() % 2 ? field.least(a, b) : field.greatest(a, b);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    field.greatest(cube, open[0]);
    const CutPieces pieces = cut(field);
    EXPECT_FALSE(pieces.cracked || pieces.crowded) << trial;
    EXPECT_TRUE(pieces.triangles.empty() || topology_of(pieces).closed()) << trial;
  }
}

TEST(PieceCut, BlocksHoldUpTo251Pieces) {
  constexpr int kFacesOfCube = 6, kMost = static_cast<int>(kMostPiecesInBlock);
  for (const int count : {kMost - kFacesOfCube, kMost + 1}) {
    Planes field;
    in_one_of(field, count, 1e-8, 0.0005);
    const CutPieces pieces = cut(field);
    if (count > kMost) {
      ASSERT_TRUE(pieces.crowded);
      EXPECT_LT(norm(*pieces.crowded - kTip), 0.05);
      EXPECT_TRUE(pieces.triangles.empty());
    } else {
      EXPECT_FALSE(pieces.crowded);
      EXPECT_TRUE(topology_of(pieces).closed());
    }
  }
}

/// Blocks are at most an eighth of the root, so values in them are a fraction of its edge.
TEST(PieceCut, CellsAsLargeAsTheSolidAreASmallPartOfTheRoot) {
  Planes field;
  const std::uint32_t plane = field.plane({0.3, 0.2, 1}, kTip);
  field.greatest(plane, field.cube());
  Progress progress;
  for (const double cell : {0.3, 1.0, 2.0, 5.0}) {
    PieceBlockOptions options;
    options.mesh_error = 1e-3, options.cell = cell, options.most_blocks = 100'000;
    EXPECT_GE(piece_blocks(field, field.bounds(), options, 0, progress).tree.edge(), 8 * cell);
  }
}

/// Integers cannot represent such values: an error, not a surface with other signs.
TEST(PieceCut, ValuesThatAreNoDistancesAreAnError) {
  Planes gentle;
  const std::uint32_t flat = gentle.plane({0.3, 0.2, 1}, kTip);
  gentle.greatest(flat, gentle.cube());
  for (const double steepness : {100.0, std::numeric_limits<double>::infinity()}) {
    Planes steep;
    const std::uint32_t plane = steep.plane({0.3, 0.2, 1}, kTip, steepness);
    steep.greatest(plane, steep.cube());
    try {
      cut(steep, &gentle);
      ADD_FAILURE() << steepness;
    } catch (const DataError& e) {
      EXPECT_NE(std::string(e.what()).find("values change faster there than distances do"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
