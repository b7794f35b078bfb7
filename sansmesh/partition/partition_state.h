// A PartitionOfUnity's data and what is built from them for evaluation; not part of the public interface.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/partition/global_sign.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh {

/// How a function is evaluated: divided by the length of its gradient; bounded closely.
constexpr std::uint8_t kNormalised = 1, kClose = 2;

struct PartitionOfUnity::State {
  PartitionData data;
  BallTree tree;                     ///< the supports
  std::vector<std::uint8_t> manner;  ///< of each function: kNormalised | kClose, from the data
  GlobalSign sign;                   ///< the far field
};

}  // namespace sansmesh
