// A PartitionOfUnity's data and what is built from them for evaluation; not part of the public interface.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/partition/global_sign.h"
#include "sansmesh/partition/partition_of_unity.h"

namespace sansmesh {

/// Boxes over groups of eight consecutive entries of the level below (functions sorted along the Morton curve), from
/// the functions' balls (level 0) up to one node: which supports reach a box is a few cache lines away.
struct SupportTree {
  std::vector<std::vector<Box3f>> levels;

  /// One function per support.
  void build(std::span<const LocalFunction> functions);
  /// Appends the supports whose boxes meet `box`, in ascending order; false: there are more than `most`, and only some
  /// of them were appended.
  bool query(const Box3f& box, std::size_t most, std::vector<std::uint32_t>& found) const;
};

/// How a function is evaluated: divided by the length of its gradient; bounded closely.
constexpr std::uint8_t kNormalised = 1, kClose = 2;

struct PartitionOfUnity::State {
  PartitionData data;
  SupportTree tree;
  std::vector<std::uint8_t> manner;  ///< of each function: kNormalised | kClose, from the data
  GlobalSign sign;                   ///< the far field
};

}  // namespace sansmesh
