// The data of a partition of unity and what is built from them for evaluation; not part of the public interface.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/partition/global_sign.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh::inline v1 {

/// How a function is evaluated: divided by the length of its gradient; bounded closely.
constexpr std::uint8_t kNormalised = 1, kClose = 2;
/// Neither bounded nor divided: as the sources blend (PartitionData::paper).
constexpr std::uint8_t kPlain = 4;

/// (f/R)² up to which a support's weight is left alone, and |f|/R up to which its value is. Noisy samples lie half a
/// radius off their fits; without noise, and of steep functions, only what is close to the zero set is right.
constexpr float kTrusted = 0.36f, kStraight = 0.3f;
constexpr float kTrustedClose = 0.2f, kStraightClose = 0.2f;

/// How deep a point is among the supports: 0 at the rim of a single one, 1 in its middle, linear in between, since the
/// fourth root of the weights is 1 − r²/R² there. From 0 to kFade the far field hands over, evenly but for kRound at
/// either end, so that the hand-over is nowhere steeper than it has to be.
constexpr float kFade = 0.56f, kRound = 0.06f;
constexpr float kFadeRoot = 1 - (1 - kFade) * (1 - kFade), kFadeWeight = kFadeRoot * kFadeRoot * kFadeRoot * kFadeRoot;

/// With a plain blend the supports cover the whole cube, and the far field takes over outside of it alone: below this
/// share of the least weight in the cube, that of a single support at the corner of its block.
constexpr float kPlainShare = 0.9f;

struct PartitionState {
  PartitionData data;
  float full = kFadeWeight;          ///< weight from which the far field has no share
  BallTree tree;                     ///< the supports
  std::vector<std::uint8_t> manner;  ///< of each function: kNormalised | kClose, from the data
  FarField far;                      ///< where no support reaches
};

}  // namespace sansmesh::inline v1
