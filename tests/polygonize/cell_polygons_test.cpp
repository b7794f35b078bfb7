// Cell polygons compared with the surface in the cell's simplices.
#include "sansmesh/polygonize/lattice/cell_polygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

using Edge = std::pair<int, int>;

Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// Successor of each crossing point on the cell's faces in the simplices' surface: around the twelve triangles of the
/// simplices on the faces, from the change to negative to the change to positive.
std::map<Edge, Edge> next_by_simplices(unsigned negative, int outer) {
  std::map<Edge, Edge> next;
  const auto below = [&](int c) { return (negative >> c & 1u) != 0; };
  for (int first = 0; first < 3; ++first)
    for (int second = 0; second < 3; ++second) {
      if (first == second) continue;
      // outer, one step along each of three axes in turn, the opposite corner: a simplex. Two of its faces are on the
      // cell's.
      const int a = outer, b = outer ^ 1 << first, c = b ^ 1 << second, d = outer ^ 7;
      const bool even = (second - first + 3) % 3 == 1;
      const int flips = (outer & 1) + (outer >> 1 & 1) + (outer >> 2 & 1);
      for (std::array<int, 3> t : {std::array{a, c, b}, std::array{b, c, d}}) {
        if (even != (flips % 2 == 0)) std::swap(t[1], t[2]);  // counter-clockwise from outside
        Edge from{-1, -1}, to{-1, -1};
        for (std::size_t k = 0; k < 3; ++k) {
          const int p = t[k], q = t[(k + 1) % 3];
          if (!below(p) && below(q)) from = edge_of(p, q);
          if (below(p) && !below(q)) to = edge_of(p, q);
        }
        if (from.first >= 0) {
          EXPECT_TRUE(next.emplace(from, to).second);
        }
      }
    }
  return next;
}

std::map<Edge, Edge> next_by_polygons(const CellPolygons& found) {
  std::map<Edge, Edge> next;
  std::size_t first = 0;
  for (const std::size_t end : found.ends) {
    for (std::size_t k = first; k < end; ++k) {
      const auto& p = found.points[k];
      const auto& q = found.points[k + 1 < end ? k + 1 : first];
      EXPECT_TRUE(next.emplace(edge_of(p[0], p[1]), edge_of(q[0], q[1])).second);
    }
    first = end;
  }
  return next;
}

TEST(CellPolygons, OnSplitFacesTheyAreWhatSimplicesHave) {
  CellPolygons found;
  for (int outer = 0; outer < 8; ++outer)
    for (unsigned negative = 0; negative < 256; ++negative) {
      trace_cell(negative, static_cast<std::size_t>(outer), 63, found);
      EXPECT_EQ(next_by_polygons(found), next_by_simplices(negative, outer)) << outer << " " << negative;
    }
}

/// Neighbours agree without communication: a polygon on a face depends on that face only.
TEST(CellPolygons, OtherFacesLeaveOutThePointsAcrossThem) {
  CellPolygons all, found;
  for (std::size_t outer = 0; outer < 8; ++outer)
    for (unsigned negative = 0; negative < 256; ++negative) {
      trace_cell(negative, outer, 63, all);
      for (const unsigned split : {0u, 1u, 6u, 33u, 62u}) {
        trace_cell(negative, outer, split, found);
        ASSERT_EQ(found.ends.size(), all.ends.size());
        std::vector<CellPolygons::Point> kept;
        for (const CellPolygons::Point& p : all.points) {
          const unsigned across = p[0] ^ p[1], axis = across == 6 ? 0 : across == 5 ? 1 : 2;
          const bool on_edge = across == 1 || across == 2 || across == 4;
          if (on_edge || split >> (2 * axis + (p[0] >> axis & 1u)) & 1u) kept.push_back(p);
        }
        EXPECT_EQ(found.points, kept) << outer << " " << negative << " " << split;
      }
    }
}

double twice_area(const std::vector<Vec3>& corner, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                  const Vec3& normal) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double part = dot(cross(corner[b] - corner[a], corner[c] - corner[a]), normal);
    EXPECT_GE(part, 0);
    sum += part;
  }
  return sum;
}

TEST(CellPolygons, TrianglesFillPolygonsAndAvoidThinOnes) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t n = 3; n < 12; ++n) {
    std::vector<Vec3> corner;
    for (std::size_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      corner.push_back({3 * std::cos(angle), std::sin(angle), 0});
    }
    best_triangles(corner, triangles);
    ASSERT_EQ(triangles.size(), n - 2);
    EXPECT_NEAR(twice_area(corner, triangles, {0, 0, 1}),
                3 * static_cast<double>(n) * std::sin(2 * std::numbers::pi / static_cast<double>(n)), 1e-12);
  }
  // A point in the middle of a side: no triangle may be degenerate there.
  for (std::size_t turn = 0; turn < 5; ++turn) {
    std::vector<Vec3> corner{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    std::rotate(corner.begin(), corner.begin() + static_cast<std::ptrdiff_t>(turn), corner.end());
    best_triangles(corner, triangles);
    for (const auto& [a, b, c] : triangles)
      EXPECT_GT(norm(cross(corner[b] - corner[a], corner[c] - corner[a])), 0.5) << turn;
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
