// Fitted functions to edit, points in them, and comparisons of before and after; for the tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "sansmesh/partition/edit/partition_edit.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "sansmesh/polygonize/polygonize.h"
#include "support/clouds.h"
#include "support/same_bytes.h"

namespace sansmesh::test {

/// A function with the ordered samples that editing needs.
struct Fitted {
  PartitionData data;
  std::vector<Vec3f> positions, normals;
  EditSamples samples() const { return {positions, normals}; }
};

inline Fitted fit(const PointSet& cloud, const PartitionOptions& options = {}) {
  Progress progress;
  PointSet sorted;
  const PartitionData data = fit_partition_of_unity(cloud, options, progress, &sorted).data();
  return {data, std::move(sorted.positions), std::move(sorted.normals)};
}

inline void expect_same(const PartitionData& a, const PartitionData& b) {
  EXPECT_TRUE(same_bytes(a.functions, b.functions));
  EXPECT_TRUE(same_bytes(a.supports, b.supports));
  ASSERT_EQ(a.flatness.size(), b.flatness.size());
  for (std::size_t l = 0; l < a.flatness.size(); ++l) {
    EXPECT_TRUE(same_bytes(a.flatness[l].code, b.flatness[l].code)) << l;
    EXPECT_TRUE(same_bytes(a.flatness[l].gap, b.flatness[l].gap)) << l;
    EXPECT_TRUE(same_bytes(a.flatness[l].child, b.flatness[l].child)) << l;
  }
  EXPECT_EQ(a.report.functions, b.report.functions);
  EXPECT_EQ(a.report.functions_of_degree, b.report.functions_of_degree);
  EXPECT_EQ(a.report.creased, b.report.creased);
  EXPECT_EQ(a.report.depth, b.report.depth);
  EXPECT_EQ(a.report.area, b.report.area);
}

/// The pieces of one support without their links, which shift when others are added or removed.
inline std::vector<LocalFunction> pieces(const PartitionData& data, std::size_t i) {
  std::vector<LocalFunction> result{data.functions[i]};
  while (result.back().next != 0) {
    const auto next = static_cast<std::size_t>(result.back().next) - 1;
    result.back().next = 0;
    result.push_back(data.functions[next]);
  }
  return result;
}

inline bool same_support(const PartitionData& a, std::size_t i, const PartitionData& b, std::size_t j) {
  const std::vector<LocalFunction> p = pieces(a, i), q = pieces(b, j);
  return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof(LocalFunction)) == 0 &&
         // Bitwise comparison, not numeric equality. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
         std::memcmp(&a.supports[i], &b.supports[j], sizeof(Support)) == 0;
}

/// Recomputes the sums of the report.
inline void expect_sums(const PartitionData& data) {
  PartitionReport r;
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    ++r.functions;
    ++r.functions_of_degree[static_cast<std::size_t>(data.functions[i].degree)];
    r.creased += data.supports[i].creased;
    r.depth = std::max<int>(r.depth, data.supports[i].level);
    r.area += static_cast<double>(data.supports[i].area);
  }
  EXPECT_EQ(data.report.functions, r.functions);
  EXPECT_EQ(data.report.functions_of_degree, r.functions_of_degree);
  EXPECT_EQ(data.report.creased, r.creased);
  EXPECT_EQ(data.report.depth, r.depth);
  EXPECT_NEAR(data.report.area, r.area, 1e-5 * (1 + r.area));
}

inline Selection everything(const PartitionData& data) {
  Selection all(data.supports.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

inline Selection in_ball(const PartitionData& data, const Vec3f& center, float radius) {
  SupportQuery query;
  query.ball = {center, radius};
  return select_supports(data, query);
}

inline Selection others(const PartitionData& data, const Selection& chosen) {
  const Selection all = everything(data);
  Selection rest;
  std::set_difference(all.begin(), all.end(), chosen.begin(), chosen.end(), std::back_inserter(rest));
  return rest;
}

inline double value_at(const PartitionData& data, const Vec3f& x) {
  const PartitionOfUnity field(data);
  const Vec3 p = data.origin + Vec3(x);
  double f = 0;
  field.evaluate(std::span<const Vec3>(&p, 1), std::span<double>(&f, 1));
  return f;
}

/// Mean |F| at points of the unit sphere.
inline double error_on_sphere(const PartitionData& data) {
  const PartitionOfUnity field(data);
  std::vector<Vec3> x;
  for (const Vec3f& p : sphere(2000, 0, 9).positions) x.push_back(data.origin + Vec3(p));
  std::vector<double> f(x.size());
  field.evaluate(x, f);
  double sum = 0;
  for (const double v : f) sum += std::abs(v);
  return sum / static_cast<double>(f.size());
}

inline TriangleMesh mesh_of(const PartitionData& data) {
  const PartitionOfUnity field(data);
  PolygonizeOptions options;
  options.seeds = field.seeds();
  Progress progress;
  return polygonize(field, field.mesh_blocks(0.037 * data.report.spacing), data.origin, options, progress);
}

/// The whole sphere with a denser part, so that levels vary.
inline PointSet uneven_sphere(std::size_t n, double noise = 0) {
  PointSet cloud = sphere(n, noise);
  const PointSet fine = sphere(8 * n, noise, 4);
  for (std::size_t i = 0; i < fine.size(); ++i)
    if (fine.positions[i].x > 0.8f)
      cloud.positions.push_back(fine.positions[i]), cloud.normals.push_back(fine.normals[i]);
  return cloud;
}

}  // namespace sansmesh::test
