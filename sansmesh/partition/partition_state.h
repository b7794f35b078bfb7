// Data of a partition of unity with precomputed structures for evaluation.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/partition/far/global_sign.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh::inline v1 {

/// Flags of a function's evaluation: divided by the length of its gradient; bounded closely.
constexpr std::uint8_t kNormalised = 1, kClose = 2;
/// Flag: neither bounded nor divided, the published blend (PartitionData::paper).
constexpr std::uint8_t kPlain = 4;

/// (f/R)² up to which a support's weight is unchanged, and |f|/R up to which its value is. Noisy samples are up to half
/// a radius off their fits; without noise, and for steep functions, values are reliable only close to the zero set.
constexpr float kTrusted = 0.36f, kStraight = 0.3f;
constexpr float kTrustedClose = 0.2f, kStraightClose = 0.2f;

/// Depth of a point among the supports: 0 at the rim of a single one, 1 at its centre, linear in between, because the
/// fourth root of the weights is 1 − r²/R² there. From 0 to kFade the far field blends into the supports, linearly
/// except for kRound at either end, which minimises the steepest slope of the blend.
constexpr float kFade = 0.56f, kRound = 0.06f;
constexpr float kFadeRoot = 1 - (1 - kFade) * (1 - kFade), kFadeWeight = kFadeRoot * kFadeRoot * kFadeRoot * kFadeRoot;

/// The supports of a plain blend cover the whole cube, and the far field applies only outside of it: below this share
/// of the least weight in the cube, that of a single support at the corner of its block.
constexpr float kPlainShare = 0.9f;

struct PartitionState {
  PartitionData data;
  float full = kFadeWeight;          ///< weight above which the far field has no share
  BallTree tree;                     ///< tree of the supports
  BallTree creased;                  ///< tree of those with a crease
  std::vector<std::uint8_t> manner;  ///< for each function: kNormalised | kClose, derived from the data
  FarField far;                      ///< field outside all supports
};

}  // namespace sansmesh::inline v1
