#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "deform/handle_sets.h"
#include "sansmesh/error.h"

namespace sansmesh::test {
namespace {

/// Message of the constructor for these handles.
std::string said(const std::vector<Handle>& handles, const MlsDeformationOptions& options = {}) {
  try {
    const MlsDeformation map(handles, options);
  } catch (const ArgumentError& e) {
    return e.what();
  }
  return "";
}

void expect_parts(const std::string& text, std::initializer_list<const char*> parts) {
  for (const char* part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST(MlsDeformationErrors, NameTheHandle) {
  const auto third = [](const std::function<void(Handle&)>& spoil) {
    std::vector<Handle> handles = loose_handles(6);
    spoil(handles[2]);
    return said(handles);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  expect_parts(third([&](Handle& h) { h.p.y = nan; }), {"handle 3", "`p`", "finite"});
  expect_parts(third([&](Handle& h) { h.q.z = infinite; }), {"handle 3", "`q`", "finite"});
  expect_parts(third([](Handle& h) { h.weight = 0; }), {"handle 3", "`weight`", "above 0"});
  expect_parts(third([&](Handle& h) { h.weight = nan; }), {"handle 3", "`weight`"});
  expect_parts(third([](Handle& h) { h.q_end = Vec3{}; }), {"handle 3", "`q_end` without `p_end`"});
  expect_parts(third([](Handle& h) { h.p_end = Vec3{}; }), {"handle 3", "`p_end` without `q_end`"});
  expect_parts(third([](Handle& h) { h.q_end = h.q, h.p_end = Vec3{}; }), {"handle 3", "`q_end`", "`q`", "`p_end`"});
  expect_parts(third([](Handle& h) {
                 h.directions = {{{1, 0, 0}, {0, 0, 0}}};
               }),
               {"handle 3", "direction 1", "`after`"});
  expect_parts(third([](Handle& h) { h.reach = -1; }), {"handle 3", "`reach`"});
  expect_parts(said({}), {"at least one handle"});
}

TEST(MlsDeformationErrors, SegmentsNeedWeightsThatHoldThem) {
  std::vector<Handle> handles = loose_handles(6);
  EXPECT_EQ(said(handles, of_kind(DeformationKind::rigid, 2, 0.75)), "");
  handles[3].q_end = handles[3].q + Vec3{1, 0, 0}, handles[3].p_end = handles[3].p + Vec3{0, 1, 0};
  EXPECT_EQ(said(handles, of_kind(DeformationKind::rigid, 2, 1)), "");
  expect_parts(said(handles, of_kind(DeformationKind::rigid, 2, 0.75)),
               {"handle 4", "segment", "`alpha`", "at least 1"});
}

TEST(MlsDeformationErrors, NameBothOfTwoThatContradictEachOther) {
  std::vector<Handle> handles = loose_handles(6);
  handles[4].q = handles[1].q;
  expect_parts(said(handles), {"handles 2 and 5", "one target"});
  handles[4].p = handles[1].p;
  EXPECT_EQ(said(handles), "");
  // A point on a segment, and two segments that cross.
  Handle bar, other;
  bar.q = {0, 0, 0}, bar.q_end = Vec3{2, 0, 0}, bar.p = bar.q, bar.p_end = bar.q_end;
  other.q = {1, 0, 0}, other.p = {1, 0.1, 0};
  expect_parts(said({bar, other}), {"handles 1 and 2"});
  other.p = other.q;
  EXPECT_EQ(said({bar, other}), "");
  other.q = other.p = {1, -1, 0}, other.q_end = Vec3{1, 1, 0}, other.p_end = Vec3{1, 2, 0};
  expect_parts(said({other, bar}), {"handles 1 and 2"});
}

TEST(MlsDeformationErrors, SayWhatTheKindNeeds) {
  const auto affine = of_kind(DeformationKind::affine), two = of_kind(DeformationKind::nonlinear),
             three = of_kind(DeformationKind::nonlinear, 3);
  expect_parts(said(loose_handles(3), affine), {"`affine`", "at least 4", "not 3", "`rigid`"});
  expect_parts(said(loose_handles(8), two), {"`nonlinear`", "`degree` 2", "at least 9", "not 8", "`rigid`"});
  expect_parts(said(loose_handles(18), three), {"`degree` 3", "at least 19", "not 18", "`degree` 2"});
  EXPECT_EQ(said(loose_handles(4), affine), "");
  EXPECT_EQ(said(loose_handles(9), two), "");
  EXPECT_EQ(said(loose_handles(19), three), "");
  std::vector<Handle> flat = loose_handles(30), line = flat, saddle = flat;
  for (Handle& h : flat) h.q = turned({h.q.x, h.q.y, 0}, {1, 1, 0}, 1) + Vec3{3, 2, 1};
  for (Handle& h : line) h.q = Vec3{1, 2, 3} * h.q.x;
  for (Handle& h : saddle) h.q.z = h.q.x * h.q.y;
  expect_parts(said(flat, affine), {"`affine`", "coplanar"});
  expect_parts(said(line, affine), {"`affine`", "line"});
  expect_parts(said(flat, two), {"`nonlinear`", "plane"});
  expect_parts(said(saddle, two), {"`nonlinear`", "surface"});
  EXPECT_EQ(said(flat), "");
  EXPECT_EQ(said(line, of_kind(DeformationKind::similarity)), "");
}

TEST(MlsDeformationErrors, NameOptionsOutOfRange) {
  MlsDeformationOptions options;
  options.alpha = 0.4;
  expect_parts(said(loose_handles(5), options), {"`alpha`"});
  options.alpha = 1, options.damping = 0.5;
  expect_parts(said(loose_handles(5), options), {"`cut_damping`"});
  options.damping = 1, options.degree = 4;
  expect_parts(said(loose_handles(5), options), {"`degree`"});
}

}  // namespace
}  // namespace sansmesh::test
