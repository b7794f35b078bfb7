// Editing the supports of a fitted function: what is chosen, what changes, and what must not.
#include "sansmesh/partition/partition_edit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>
#include <random>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/polygonize/mesh_topology.h"
#include "sansmesh/polygonize/polygonize.h"
#include "support/clouds.h"

namespace sansmesh {
namespace {

/// A function with the samples that editing wants, in their order.
struct Fitted {
  PartitionData data;
  std::vector<Vec3f> positions, normals;
  EditSamples samples() const { return {positions, normals}; }
};

Fitted fit(const PointSet& cloud, const PartitionOptions& options = {}) {
  Progress progress;
  std::vector<std::uint32_t> order;
  Fitted f{fit_partition_of_unity(cloud, options, progress, &order).data(), {}, {}};
  for (const std::uint32_t i : order) f.positions.push_back(cloud.positions[i]), f.normals.push_back(cloud.normals[i]);
  return f;
}

template <class T>
bool same_bytes(const SharedArray<T>& a, const SharedArray<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const PartitionData& a, const PartitionData& b) {
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

/// The pieces of one support, with the links between them left out: these shift where others come or go.
std::vector<LocalFunction> pieces(const PartitionData& data, std::size_t i) {
  std::vector<LocalFunction> result{data.functions[i]};
  while (result.back().next != 0) {
    const auto next = static_cast<std::size_t>(result.back().next) - 1;
    result.back().next = 0;
    result.push_back(data.functions[next]);
  }
  return result;
}

bool same_support(const PartitionData& a, std::size_t i, const PartitionData& b, std::size_t j) {
  const std::vector<LocalFunction> p = pieces(a, i), q = pieces(b, j);
  return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof(LocalFunction)) == 0 &&
         std::memcmp(&a.supports[i], &b.supports[j], sizeof(Support)) == 0;
}

/// The sums of the report, added up again.
void expect_sums(const PartitionData& data) {
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

Selection everything(const PartitionData& data) {
  Selection all(data.supports.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Selection in_ball(const PartitionData& data, const Vec3f& center, float radius) {
  SupportQuery query;
  query.ball = {center, radius};
  return select_supports(data, query);
}

Selection others(const PartitionData& data, const Selection& chosen) {
  const Selection all = everything(data);
  Selection rest;
  std::set_difference(all.begin(), all.end(), chosen.begin(), chosen.end(), std::back_inserter(rest));
  return rest;
}

double value_at(const PartitionData& data, const Vec3f& x) {
  const PartitionOfUnity field(data);
  const Vec3 p = data.origin + Vec3(x);
  double f = 0;
  field.evaluate(std::span<const Vec3>(&p, 1), std::span<double>(&f, 1));
  return f;
}

/// Mean |F| at points of the unit sphere.
double error_on_sphere(const PartitionData& data) {
  const PartitionOfUnity field(data);
  std::vector<Vec3> x;
  for (const Vec3f& p : test::sphere(2000, 0, 9).positions) x.push_back(data.origin + Vec3(p));
  std::vector<double> f(x.size());
  field.evaluate(x, f);
  double sum = 0;
  for (const double v : f) sum += std::abs(v);
  return sum / static_cast<double>(f.size());
}

TriangleMesh mesh_of(const PartitionData& data) {
  const PartitionOfUnity field(data);
  PolygonizeOptions options;
  options.seeds = field.seeds();
  Progress progress;
  return polygonize(field, field.mesh_blocks(0.037 * data.report.spacing), data.origin, options, progress);
}

/// The whole sphere with a bump of points that are needed for levels to differ from place to place.
PointSet uneven_sphere(std::size_t n, double noise = 0) {
  PointSet cloud = test::sphere(n, noise);
  const PointSet fine = test::sphere(8 * n, noise, 4);
  for (std::size_t i = 0; i < fine.size(); ++i)
    if (fine.positions[i].x > 0.8f)
      cloud.positions.push_back(fine.positions[i]), cloud.normals.push_back(fine.normals[i]);
  return cloud;
}

struct NamedCloud {
  const char* name;
  PointSet cloud;
};
std::vector<NamedCloud> clouds() {
  PointSet far = test::torus(6000);
  far.origin = {431234.5, 5812345.25, 812};
  return {{"sphere", test::sphere(8000)},
          {"noisy sphere", test::sphere(8000, 0.02)},
          {"uneven sphere", uneven_sphere(4000, 0.002)},
          {"cube", test::cube(8000)},
          {"far torus", far}};
}

TEST(Refit, OfAllIsTheFitAgainToTheBit) {
  for (const auto& [name, cloud] : clouds()) {
    SCOPED_TRACE(name);
    const Fitted f = fit(cloud);
    Progress progress;
    const EditResult again = refit(f.data, everything(f.data), f.data.options, f.samples(), progress);
    expect_same(again.data, f.data);
    again.data.validate();
    EXPECT_EQ(again.changes, f.data.supports.size());
    EXPECT_EQ(again.supports, f.data.supports.size());
  }
}

// Everything that a fit depends on lies within a few of its edges (samples, noise and risks of the neighbours), and
// those samples are all there: a part comes out as it was as well, up to its rim.
TEST(Refit, OfAPartIsTheFitAgainToTheBit) {
  for (const auto& [name, cloud] : clouds()) {
    SCOPED_TRACE(name);
    const Fitted f = fit(cloud);
    Progress progress;
    for (const std::size_t at : {std::size_t{0}, f.positions.size() / 2, f.positions.size() - 1})
      for (const float radius : {0.0f, 0.1f, 0.5f}) {
        const Selection chosen = in_ball(f.data, f.positions[at], radius);
        ASSERT_FALSE(chosen.empty());
        const EditResult again = refit(f.data, chosen, f.data.options, f.samples(), progress);
        expect_same(again.data, f.data);
        EXPECT_EQ(again.changes, chosen.size());
        EXPECT_EQ(again.supports, chosen.size());
      }
  }
}

TEST(Refit, AfterAnEditBringsTheFitBack) {
  const Fitted f = fit(test::cube(8000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.5f);
  const EditResult flat = set_degree(f.data, chosen, 1, f.samples(), progress);
  const EditResult erased = set_constant(f.data, chosen, 1);
  for (const PartitionData* edited : {&flat.data, &erased.data})
    expect_same(refit(*edited, chosen, f.data.options, f.samples(), progress).data, f.data);
}

TEST(Refit, LeavesAllOthersUntouched) {
  const Fitted f = fit(test::cube(8000));
  Progress progress;
  PartitionOptions other = f.data.options;
  other.error = 0.02;
  other.sharp = false;
  other.max_degree = 2;
  other.support = 1.9;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.4f);
  const EditResult edited = refit(f.data, chosen, other, f.samples(), progress);
  edited.data.validate();
  expect_sums(edited.data);
  EXPECT_EQ(edited.data.supports.size() + chosen.size(), f.data.supports.size() + edited.supports);
  std::size_t kept = 0, smooth = 0;
  for (std::size_t i = 0; i < edited.data.supports.size(); ++i) {
    const Support& s = edited.data.supports[i];
    const auto old = std::find_if(f.data.supports.begin(), f.data.supports.end(),
                                  [&](const Support& o) { return o.level == s.level && o.code == s.code; });
    if (old != f.data.supports.end() &&
        same_support(edited.data, i, f.data, static_cast<std::size_t>(old - f.data.supports.begin()))) {
      ++kept;
    } else {
      ++smooth;
      EXPECT_EQ(s.creased, 0);
      EXPECT_LE(edited.data.functions[i].degree, 2);
      const LocalFunction& g = edited.data.functions[i];
      EXPECT_NEAR(g.radius, 1.9 * 0.8660254 * f.data.edge / (1 << s.level), 1e-5);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_GE(g.center[k] - g.radius, edited.changed.lower[k]);
        EXPECT_LE(g.center[k] + g.radius, edited.changed.upper[k]);
      }
    }
  }
  EXPECT_EQ(kept, f.data.supports.size() - chosen.size());
  EXPECT_EQ(smooth, edited.supports);
  for (const std::uint32_t i : chosen) {
    EXPECT_TRUE(edited.changed.contains(f.data.functions[i].center - Vec3f{1, 1, 1} * f.data.functions[i].radius));
    EXPECT_TRUE(edited.changed.contains(f.data.functions[i].center + Vec3f{1, 1, 1} * f.data.functions[i].radius));
  }
}

TEST(Refit, FollowsItsOptions) {
  const Fitted f = fit(test::torus(20000));
  Progress progress;
  const Selection all = everything(f.data);
  PartitionOptions coarse = f.data.options;
  coarse.error = 0.01;
  EXPECT_LT(refit(f.data, all, coarse, f.samples(), progress).data.supports.size(), f.data.supports.size());
  PartitionOptions shallow = f.data.options;
  shallow.max_depth = 3;
  EXPECT_EQ(refit(f.data, all, shallow, f.samples(), progress).data.report.depth, 3);
  PartitionOptions planes = f.data.options;
  planes.max_degree = 1;
  const PartitionData flat = refit(f.data, all, planes, f.samples(), progress).data;
  EXPECT_EQ(flat.report.functions_of_degree[1], flat.supports.size());
}

TEST(SetDegree, EveryDegreeOnASphere) {
  const Fitted f = fit(test::sphere(20000));
  Progress progress;
  double last = 1e30;
  for (int degree = 0; degree <= 4; ++degree) {
    SCOPED_TRACE(degree);
    const EditResult edited = set_degree(f.data, everything(f.data), degree, f.samples(), progress);
    edited.data.validate();
    expect_sums(edited.data);
    for (std::size_t i = 0; i < edited.data.supports.size(); ++i) {
      ASSERT_EQ(edited.data.functions[i].degree, degree);
      ASSERT_EQ(edited.data.functions[i].radius, f.data.functions[i].radius);
      ASSERT_EQ(edited.data.supports[i].code, f.data.supports[i].code);
    }
    const double error = error_on_sphere(edited.data);
    EXPECT_LT(error, degree % 2 == 0 && degree > 0 ? 0.5 * last : 1.1 * last);
    last = error;
  }
  EXPECT_LT(last, 1e-4);
}

TEST(SetDegree, PlanesLeaveTheSquareOfTheRadius) {
  // The best plane over a disc of radius r on a sphere of radius 1 is off by about a tenth of r².
  Progress progress;
  std::vector<double> ratio;
  for (const int depth : {3, 4, 5}) {
    PartitionOptions options;
    options.max_depth = depth;
    options.error = 1e-9;
    const Fitted f = fit(test::sphere(60000), options);
    const double radius = 1.5 * 0.8660254 * f.data.edge / (1 << f.data.report.depth);
    ASSERT_EQ(f.data.report.depth, depth);
    const PartitionData flat = set_degree(f.data, everything(f.data), 1, f.samples(), progress).data;
    ratio.push_back(error_on_sphere(flat) / (radius * radius));
    double rms = 0;
    for (const Support& s : flat.supports)
      rms += static_cast<double>(s.error) / static_cast<double>(flat.supports.size());
    EXPECT_NEAR(rms / (radius * radius), 0.097, 0.02) << depth;
  }
  for (const double r : ratio) EXPECT_NEAR(r / ratio[0], 1, 0.4);
}

TEST(SetDegree, LeavesAllOthersUntouchedAndTakesCreasesAway) {
  const Fitted f = fit(test::cube(8000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.5f);
  std::size_t creased = 0;
  for (const std::uint32_t i : chosen) creased += f.data.supports[i].creased;
  ASSERT_GT(creased, 5u);
  ASSERT_LT(creased, f.data.report.creased);
  for (const int degree : {0, 1, 3}) {
    const EditResult edited = set_degree(f.data, chosen, degree, f.samples(), progress);
    edited.data.validate();
    expect_sums(edited.data);
    EXPECT_EQ(edited.data.report.creased, f.data.report.creased - creased);
    for (const std::uint32_t i : chosen) {
      EXPECT_EQ(edited.data.functions[i].degree, degree);
      EXPECT_EQ(edited.data.functions[i].next, 0);
    }
    for (const std::uint32_t i : others(f.data, chosen)) EXPECT_TRUE(same_support(edited.data, i, f.data, i)) << i;
    // The tree of the mesh and its samples stay: shared, not copied.
    EXPECT_EQ(edited.data.flatness[2].gap.data(), f.data.flatness[2].gap.data());
  }
}

TEST(SetDegree, KeepsTheRadiusThatARefitGave) {
  const Fitted f = fit(test::sphere(8000));
  Progress progress;
  PartitionOptions wide = f.data.options;
  wide.support = 2;
  const PartitionData data = refit(f.data, everything(f.data), wide, f.samples(), progress).data;
  const PartitionData edited = set_degree(data, everything(data), 2, f.samples(), progress).data;
  edited.validate();
  for (std::size_t i = 0; i < edited.supports.size(); ++i) {
    EXPECT_EQ(edited.functions[i].radius, data.functions[i].radius);
    EXPECT_GE(edited.functions[i].scale, 0.999f * data.functions[i].radius);  // fitted over all of its ball
  }
}

TEST(SetConstant, Erases) {
  const Fitted f = fit(test::sphere(8000));
  const Selection chosen = in_ball(f.data, {0, 0, 1}, 0.3f);
  for (const float value : {0.01f, 1.0f, 100.0f}) {
    const EditResult edited = set_constant(f.data, chosen, value);
    edited.data.validate();
    expect_sums(edited.data);
    const PartitionOfUnity field(edited.data);
    for (const std::uint32_t i : chosen) {
      EXPECT_EQ(edited.data.supports[i].state, Support::constant);
      EXPECT_EQ(edited.data.supports[i].area, 0);
      EXPECT_TRUE(edited.data.functions[i].is_constant());
      EXPECT_FLOAT_EQ(local_value(edited.data.functions[i], f.data.functions[i].center),
                      value * f.data.functions[i].radius);
    }
    for (const std::uint32_t i : others(f.data, chosen)) EXPECT_TRUE(same_support(edited.data, i, f.data, i)) << i;
    // Larger ones may be bounded by the radius.
    const double radius = f.data.functions[chosen[0]].radius, full = std::min<double>(value, 1) * radius;
    EXPECT_GT(value_at(edited.data, {0, 0, 1}), 0.5 * full);
  }
  const EditResult edited = set_constant(f.data, chosen, 1);
  EXPECT_LT(edited.data.report.area, f.data.report.area - 0.2);
  const TriangleMesh mesh = mesh_of(edited.data);
  EXPECT_TRUE(measure_topology(mesh).closed());
  float highest = -1, lowest = 1;
  for (const Vec3f& v : mesh.vertices) highest = std::max(highest, v.z), lowest = std::min(lowest, v.z);
  EXPECT_LT(highest, 0.99f);
  EXPECT_NEAR(lowest, -1, 0.01);
}

TEST(SetConstant, Fills) {
  const Fitted f = fit(test::sphere(8000));
  const Selection chosen = in_ball(f.data, {0, 0, 1}, 0.3f);
  const EditResult edited = set_constant(f.data, chosen, -1);
  edited.data.validate();
  EXPECT_LT(value_at(edited.data, {0, 0, 1}), 0);
  const TriangleMesh mesh = mesh_of(edited.data);
  EXPECT_TRUE(measure_topology(mesh).closed());
  float highest = -1;
  for (const Vec3f& v : mesh.vertices) highest = std::max(highest, v.z);
  EXPECT_GT(highest, 1.03f);
}

TEST(SetConstant, ConstantsCanBeEditedAgain) {
  const Fitted f = fit(test::cube(8000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.4f);
  const PartitionData erased = set_constant(f.data, chosen, 1).data;
  const PartitionData filled = set_constant(erased, chosen, -2).data;
  EXPECT_LT(local_value(filled.functions[chosen[0]], filled.functions[chosen[0]].center), 0);
  const PartitionData planes = set_degree(erased, chosen, 1, f.samples(), progress).data;
  planes.validate();
  for (const std::uint32_t i : chosen) {
    EXPECT_EQ(planes.supports[i].state, Support::fitted);
    EXPECT_EQ(planes.functions[i].degree, 1);
  }
  expect_same(planes, set_degree(f.data, chosen, 1, f.samples(), progress).data);
}

TEST(SetConstant, RejectsValuesThatMeanNothing) {
  const Fitted f = fit(test::sphere(1000));
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {0.0f, 1e-4f, -1e-4f, 1e4f, inf, -inf, std::nanf("")})
    EXPECT_THROW(set_constant(f.data, {0}, bad), ArgumentError) << bad;
}

TEST(RemoveSupports, LeavesTheOthers) {
  const Fitted f = fit(test::cube(8000));
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.4f), rest = others(f.data, chosen);
  const EditResult edited = remove_supports(f.data, chosen);
  edited.data.validate();
  expect_sums(edited.data);
  EXPECT_EQ(edited.supports, 0u);
  ASSERT_EQ(edited.data.supports.size(), rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) EXPECT_TRUE(same_support(edited.data, i, f.data, rest[i])) << i;
  EXPECT_TRUE(measure_topology(mesh_of(edited.data)).closed());
  EXPECT_THROW(remove_supports(f.data, everything(f.data)), DataError);
}

TEST(Edits, OfNothingChangeNothing) {
  const Fitted f = fit(test::sphere(2000));
  Progress progress;
  for (const EditResult& r :
       {set_degree(f.data, {}, 1, f.samples(), progress), refit(f.data, {}, {}, f.samples(), progress),
        set_constant(f.data, {}, 1), remove_supports(f.data, {})}) {
    expect_same(r.data, f.data);
    EXPECT_TRUE(r.changed.empty());
    EXPECT_EQ(r.changes, 0u);
    EXPECT_EQ(r.supports, 0u);
  }
}

template <class Error, class Work>
void expect_error(const char* part, Work&& work) {
  try {
    work();
    ADD_FAILURE() << "no error that says: " << part;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Edits, SayWhatTheyCannotDo) {
  const Fitted f = fit(test::sphere(2000));
  Progress progress;
  const Selection all = everything(f.data);
  expect_error<DataError>("samples were not kept", [&] { set_degree(f.data, all, 1, {}, progress); });
  expect_error<DataError>("samples were not kept", [&] { refit(f.data, all, f.data.options, {}, progress); });
  for (const int degree : {-1, 5, 100})
    expect_error<ArgumentError>("degree", [&] { set_degree(f.data, all, degree, f.samples(), progress); });
  PartitionOptions options;
  options.max_depth = 40;
  expect_error<ArgumentError>("max_depth", [&] { refit(f.data, all, options, f.samples(), progress); });
  options = {};
  options.error = -1;
  expect_error<ArgumentError>("error", [&] { refit(f.data, all, options, f.samples(), progress); });
  // Samples of something else.
  const std::vector<Vec3f> far(10, Vec3f{1, 1, 1} * 0.999f), up(10, Vec3f{0, 0, 1});
  expect_error<DataError>("samples", [&] { set_degree(f.data, all, 1, {far, up}, progress); });
  SupportQuery query;
  query.flags = std::vector<std::uint8_t>(3);
  expect_error<ArgumentError>("flag", [&] { select_supports(f.data, query); });
}

TEST(Edits, DoNotDependOnTheThreads) {
  const Fitted f = fit(test::cube(20000));
  Progress progress;
  const Selection chosen = in_ball(f.data, {1, 1, 1}, 0.9f);
  PartitionOptions other = f.data.options;
  other.max_degree = 3;
  std::vector<PartitionData> results[2];
  for (const unsigned threads : {1u, 2u}) {
    set_thread_count(static_cast<int>(threads));
    auto& r = results[threads - 1];
    r.push_back(refit(f.data, chosen, other, f.samples(), progress).data);
    r.push_back(set_degree(f.data, chosen, 2, f.samples(), progress).data);
    r.push_back(set_constant(f.data, chosen, 1).data);
    r.push_back(remove_supports(f.data, chosen).data);
  }
  set_thread_count(0);
  for (std::size_t i = 0; i < 4; ++i) expect_same(results[0][i], results[1][i]);
}

TEST(Edits, CanBeCancelled) {
  const Fitted f = fit(test::sphere(2000));
  Progress progress;
  progress.cancel();
  EXPECT_THROW(refit(f.data, everything(f.data), {}, f.samples(), progress), Cancelled);
  EXPECT_THROW(set_degree(f.data, everything(f.data), 1, f.samples(), progress), Cancelled);
}

struct Block {
  Vec3 lower, upper, center;
};
Block block_of(const PartitionData& data, const Support& s) {
  // Bit by bit: what morton_cell does at once.
  Vec3 cell;
  for (unsigned bit = 0; bit < 3u * s.level; ++bit)
    if (s.code >> bit & 1) cell[bit % 3] += std::ldexp(1.0, static_cast<int>(bit / 3));
  const double h = static_cast<double>(data.edge) / std::ldexp(1.0, s.level);
  const Vec3 lower = Vec3(data.lower) + cell * h;
  return {lower, lower + Vec3{h, h, h}, lower + Vec3{h, h, h} * 0.5};
}

TEST(SelectSupports, BlocksAreThoseOfTheCentres) {
  const Fitted f = fit(uneven_sphere(4000));
  for (std::size_t i = 0; i < f.data.supports.size(); ++i)
    EXPECT_LT(norm(block_of(f.data, f.data.supports[i]).center - Vec3(f.data.functions[i].center)), 1e-5);
}

TEST(SelectSupports, EveryCriterionAndAllTogether) {
  const Fitted f = fit(uneven_sphere(4000, 0.002));
  const PartitionData& data = f.data;
  std::vector<float> errors, coverages;
  for (const Support& s : data.supports) errors.push_back(s.error), coverages.push_back(s.coverage);
  std::sort(errors.begin(), errors.end()), std::sort(coverages.begin(), coverages.end());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto place = [&] { return Vec3f{uniform(random), uniform(random), uniform(random)} * 1.1f; };
  std::size_t some = 0;
  for (int round = 0; round < 400; ++round) {
    // The first rounds use one criterion each, the rest a random few.
    const unsigned use = round < 80 ? 1u << (round % 8) : random() & random() & 255u;
    SupportQuery q;
    if (use & 1) q.ball = {place(), 0.8f * std::abs(uniform(random))};
    if (use & 2) {
      Box3f box;
      box.extend(place()), box.extend(place());
      q.box = box;
    }
    if (use & 4) q.half_space = {place(), normalized(place())};
    if (use & 8) q.coverage_below = coverages[random() % coverages.size()];
    if (use & 16) q.error_above = errors[random() % errors.size()];
    if (use & 32) q.samples_below = data.supports[random() % data.supports.size()].samples;
    if (use & 64) {
      if (random() % 3) q.level_from = static_cast<int>(random() % 7);
      if (random() % 3) q.level_to = static_cast<int>(random() % 7);
    }
    if (use & 128) {
      q.flags.emplace(data.supports.size());
      for (std::uint8_t& flag : *q.flags) flag = random() % 2;
    }
    Selection expected;
    bool close = false;  // to where float and double disagree
    for (std::uint32_t i = 0; i < data.supports.size(); ++i) {
      const Support& s = data.supports[i];
      const Block b = block_of(data, s);
      bool in = true;
      if (q.ball) {
        Vec3 nearest;
        for (std::size_t k = 0; k < 3; ++k)
          nearest[k] = std::clamp(static_cast<double>(q.ball->center[k]), b.lower[k], b.upper[k]);
        const double off = norm(nearest - Vec3(q.ball->center)) - static_cast<double>(q.ball->radius);
        in &= off <= 0;
        close |= std::abs(off) < 1e-6;
      }
      if (q.box)
        for (std::size_t k = 0; k < 3; ++k)
          in &=
              b.upper[k] >= static_cast<double>(q.box->lower[k]) && b.lower[k] <= static_cast<double>(q.box->upper[k]);
      if (q.half_space) {
        const double off = dot(b.center - Vec3(q.half_space->point), Vec3(q.half_space->normal));
        in &= off > 0;
        close |= std::abs(off) < 1e-6;
      }
      if (q.coverage_below) in &= s.coverage < *q.coverage_below;
      if (q.error_above) in &= s.error > *q.error_above;
      if (q.samples_below) in &= s.samples < *q.samples_below;
      if (q.level_from) in &= s.level >= *q.level_from;
      if (q.level_to) in &= s.level <= *q.level_to;
      if (q.flags) in &= (*q.flags)[i] != 0;
      if (in) expected.push_back(i);
    }
    if (close) continue;
    EXPECT_EQ(select_supports(data, q), expected) << round;
    some += !expected.empty() && expected.size() < data.supports.size();
  }
  EXPECT_GT(some, 150u);
  EXPECT_EQ(select_supports(data, {}), everything(data));
}

PointSet moved(PointSet cloud, const Vec3f& by, float scale = 1) {
  for (Vec3f& p : cloud.positions) p = p * scale + by;
  return cloud;
}
void append(PointSet& to, const PointSet& from) {
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  to.normals.insert(to.normals.end(), from.normals.begin(), from.normals.end());
}
PointSet flipped(PointSet cloud) {
  for (Vec3f& n : cloud.normals) n = n * -1.0f;
  return cloud;
}

TEST(FindSheets, SeparateAndConcentricSpheres) {
  PointSet separate = test::sphere(10000);
  append(separate, moved(test::sphere(3600), {2.5f, 0, 0}, 0.6f));
  PointSet concentric = test::sphere(10000);
  append(concentric, flipped(moved(test::sphere(3600), {}, 0.6f)));
  for (const PointSet& cloud : {separate, concentric}) {
    const Fitted f = fit(cloud);
    const Sheets sheets = find_sheets(f.data, f.positions);
    ASSERT_EQ(sheets.size(), 2u);
    const double sphere = 4 * std::numbers::pi;
    EXPECT_NEAR(sheets.area[0], sphere, 0.05 * sphere);
    EXPECT_NEAR(sheets.area[1], 0.36 * sphere, 0.05 * 0.36 * sphere);
    EXPECT_NEAR(sheets.evidence[0], 1, 0.1);
    EXPECT_NEAR(sheets.evidence[1], 1, 0.1);
    for (std::size_t i = 0; i < f.data.supports.size(); ++i) {
      const Vec3f foot = f.data.supports[i].foot;
      const bool small = std::min(norm(foot - Vec3f{2.5f, 0, 0}), norm(foot)) < 0.8f;
      EXPECT_EQ(sheets.of_support[i], small ? 1u : 0u) << norm(foot);
    }
    const Sheets bare = find_sheets(f.data, {});
    EXPECT_EQ(bare.of_support, sheets.of_support);
    EXPECT_EQ(bare.evidence, std::vector<double>(2, 0));
  }
}

TEST(FindSheets, StraysMakeSheetsThatNothingStandsFor) {
  PointSet cloud = test::sphere(20000);
  std::mt19937 random(2);
  std::normal_distribution<float> gauss;
  for (int i = 0; i < 30; ++i) {
    cloud.positions.push_back(Vec3f{2, 2, 2} + Vec3f{gauss(random), gauss(random), gauss(random)} * 0.15f);
    cloud.normals.push_back(normalized(Vec3f{gauss(random), gauss(random), gauss(random)}));
  }
  const Fitted f = fit(cloud);
  const Sheets sheets = find_sheets(f.data, f.positions);
  ASSERT_GE(sheets.size(), 2u);
  EXPECT_NEAR(sheets.evidence[0], 1, 0.1);
  for (std::size_t k = 1; k < sheets.size(); ++k)
    EXPECT_TRUE(sheets.evidence[k] < 0.25 || sheets.area[k] < 0.01 * sheets.area[0])
        << k << ": " << sheets.evidence[k] << ", " << sheets.area[k];
  for (std::size_t i = 0; i < f.data.supports.size(); ++i)
    EXPECT_EQ(sheets.of_support[i] == 0, norm(f.data.functions[i].center) < 1.5f);
}

TEST(FindSheets, CreasesDoNotCutASheet) {
  for (const std::size_t n : {3000, 20000}) {
    const Fitted f = fit(test::cube(n));
    ASSERT_GT(f.data.report.creased, 10u);
    const Sheets sheets = find_sheets(f.data, f.positions);
    EXPECT_EQ(sheets.size(), 1u);
    EXPECT_NEAR(sheets.area[0], 24, 3.6);  // of creased supports only the first piece counts
    EXPECT_NEAR(sheets.evidence[0], 1, 0.1);
  }
}

/// Both faces of a square plate of edge 2, without its rim, or with it.
PointSet plate(float thickness, bool rim) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointSet cloud;
  for (int i = 0; i < 30000; ++i) {
    const float side = i % 2 ? 1.0f : -1.0f;
    cloud.positions.push_back({uniform(random), uniform(random), side * 0.5f * thickness});
    cloud.normals.push_back({0, 0, side});
  }
  const int around = rim ? static_cast<int>(30000 * thickness) : 0;
  for (int i = 0; i < around; ++i) {
    const std::size_t axis = static_cast<std::size_t>(i / 2 % 2);
    Vec3f p{uniform(random), uniform(random), 0.5f * thickness * uniform(random)}, n;
    p[axis] = n[axis] = i % 2 ? 1.0f : -1.0f;
    cloud.positions.push_back(p), cloud.normals.push_back(n);
  }
  return cloud;
}

TEST(FindSheets, SidesOfAPlateAreJoinedByItsRimAlone) {
  // Parallel sides that face apart are two sheets, however near to each other; the rim, if sampled, makes them one.
  const Fitted open = fit(plate(0.2f, false));
  const Sheets two = find_sheets(open.data, open.positions);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_NEAR(two.area[0], 4, 1);  // the blocks at the rim are filled
  EXPECT_NEAR(two.area[1], 4, 1);
  for (std::size_t i = 0; i < open.data.supports.size(); ++i)
    EXPECT_EQ(two.of_support[i] == two.of_support[0],
              (open.data.functions[i].nu.z > 0) == (open.data.functions[0].nu.z > 0));
  const Fitted closed = fit(plate(0.2f, true));
  EXPECT_EQ(find_sheets(closed.data, closed.positions).size(), 1u);
}

TEST(FindSheets, ConstantsAreOnNone) {
  const Fitted f = fit(test::sphere(8000));
  const Selection chosen = in_ball(f.data, {0, 0, 1}, 0.3f);
  const EditResult edited = set_constant(f.data, chosen, 1);
  const Sheets sheets = find_sheets(edited.data, f.positions);
  EXPECT_EQ(sheets.size(), 1u);
  for (const std::uint32_t i : chosen) EXPECT_EQ(sheets.of_support[i], Sheets::kNone);
  // A sheet cut in two by what was erased.
  SupportQuery band;
  band.box = Box3f{{-2, -2, -0.05f}, {2, 2, 0.05f}};
  const EditResult halves = set_constant(f.data, select_supports(f.data, band), 1);
  EXPECT_EQ(find_sheets(halves.data, f.positions).size(), 2u);
}

TEST(FindSheets, DoNotDependOnTheThreads) {
  const Fitted f = fit(test::cube(8000));
  set_thread_count(1);
  const Sheets one = find_sheets(f.data, f.positions);
  set_thread_count(2);
  const Sheets two = find_sheets(f.data, f.positions);
  set_thread_count(0);
  EXPECT_EQ(one.of_support, two.of_support);
  EXPECT_EQ(one.area, two.area);
  EXPECT_EQ(one.evidence, two.evidence);
}

}  // namespace
}  // namespace sansmesh
