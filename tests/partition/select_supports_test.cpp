// Selection of supports by their properties.
#include <algorithm>
#include <cmath>
#include <random>

#include "partition/edit_checks.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

struct Block {
  Vec3 lower, upper, center;
};
Block block_of(const PartitionData& data, const Support& s) {
  // Bit by bit, the reference of morton_cell.
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
    const unsigned some_of_all = random(), few = some_of_all & random();
    const unsigned use = round < 80 ? 1u << (round % 8) : few & 255u;
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
    bool close = false;  // close to a bound, where float and double disagree
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

}  // namespace
}  // namespace sansmesh::inline v1
