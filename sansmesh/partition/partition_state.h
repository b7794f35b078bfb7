// What a PartitionOfUnity is made of; shared by its fitting and its evaluation, not part of the public interface.
#pragma once

#include <vector>

#include "sansmesh/partition/global_sign.h"
#include "sansmesh/partition/partition_of_unity.h"

namespace sansmesh {

/// Boxes over groups of eight consecutive entries of the level below (functions sorted along the Morton curve), from
/// the functions' balls (level 0) up to one node: which supports reach a box is a few cache lines away.
struct SupportTree {
  std::vector<std::vector<Box3f>> levels;

  void build(std::span<const LocalFunction> functions, std::span<const std::uint32_t> heads);
  /// Appends the positions (in `heads`) of all supports whose boxes meet `box`, in ascending order.
  void query(const Box3f& box, std::vector<std::uint32_t>& found) const;
};

struct PartitionOfUnity::State {
  Vec3 origin;  ///< of the cloud: F is a function of world positions
  Vec3f lower;  ///< root cube, relative to origin
  float edge = 0;
  std::vector<LocalFunction> functions;  ///< heads and, behind them in any order, further pieces of creased supports
  std::vector<std::uint32_t> heads;      ///< first function of each support, in Morton order
  std::vector<Vec3f> foot;               ///< of each support's centre on its surface
  SupportTree tree;
  /// Per level, for every block with samples: gap that linear triangles would leave (length; infinite at creases and
  /// where sheets meet). Children as in SampleTree.
  struct Flatness {
    std::vector<std::uint64_t> code;
    std::vector<float> gap;
    std::vector<std::uint32_t> child;
  };
  std::vector<Flatness> flatness;
  GlobalSign sign;  ///< the far field
  PartitionReport report;
};

}  // namespace sansmesh
