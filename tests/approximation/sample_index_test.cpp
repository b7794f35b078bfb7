#include "sansmesh/approximation/sample_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "approximation/approximation_samples.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

template <int D>
void check_queries(double offset, double scale) {
  auto x = test::random_positions<D>(700, 5);
  for (auto& p : x)
    for (double& v : p) v = offset + scale * v;
  const SampleIndex<D> index(x);
  auto queries = test::random_positions<D>(60, 6, -0.3, 1.3);
  queries.push_back(x[3]);
  for (auto& q : queries)
    for (double& v : q)
      if (v < 2) v = offset + scale * v;
  queries.back() = x[3];
  Position<D> far{};
  far.fill(offset + 9 * scale);
  queries.push_back(far);
  std::vector<typename SampleIndex<D>::Hit> hits;
  for (const auto& q : queries)
    for (const double radius : {0.01, 0.2, 1.0, 20.0}) {
      index.within(q, radius * scale, hits);
      std::vector<std::uint32_t> found, expected;
      for (const auto& hit : hits) {
        found.push_back(hit.index);
        EXPECT_EQ(hit.squared_distance, squared_distance<D>(q, x[hit.index]));
      }
      for (std::uint32_t i = 0; i < x.size(); ++i)
        if (squared_distance<D>(q, x[i]) < radius * scale * (radius * scale)) expected.push_back(i);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
    }
}

TEST(SampleIndex, FindsExactlyTheSamplesInABall) {
  check_queries<1>(0, 1);
  check_queries<2>(4e5, 1e-3);  // survey coordinates
  check_queries<3>(-1e7, 10);
  check_queries<3>(0, 1e-100);
}

TEST(SampleIndex, SpacingOfGridsAndRandomSamples) {
  EXPECT_NEAR(SampleIndex<1>(test::grid<1>(50, 3, 0.02)).spacing(), 0.02, 1e-12);
  EXPECT_NEAR(SampleIndex<2>(test::grid<2>(20, -1, 0.1)).spacing(), 0.1, 1e-12);
  EXPECT_NEAR(SampleIndex<3>(test::grid<3>(12, 5, 2.5)).spacing(), 2.5, 1e-12);
  EXPECT_NEAR(SampleIndex<2>(test::random_positions<2>(10000, 1)).spacing(), 0.009, 0.0005);
  EXPECT_NEAR(SampleIndex<3>(test::random_positions<3>(27000, 1)).spacing(), 1 / 30.0, 0.001);
  const std::vector<Position<2>> same(5, {1, 2});
  EXPECT_EQ(SampleIndex<2>(same).spacing(), 1);
}

TEST(SampleIndex, RefusesWhatIsNotFinite) {
  EXPECT_THROW(SampleIndex<2>(std::vector<Position<2>>{}), DataError);
  EXPECT_THROW(SampleIndex<2>(std::vector<Position<2>>{{0, std::numeric_limits<double>::quiet_NaN()}}), DataError);
  const SampleIndex<1> index(std::vector<Position<1>>{{0}, {1}});
  std::vector<SampleIndex<1>::Hit> hits;
  index.within({std::numeric_limits<double>::infinity()}, 1, hits);
  EXPECT_TRUE(hits.empty());
  index.within({0.5}, std::numeric_limits<double>::infinity(), hits);
  EXPECT_EQ(hits.size(), 2u);
}

}  // namespace
}  // namespace sansmesh::inline v1
