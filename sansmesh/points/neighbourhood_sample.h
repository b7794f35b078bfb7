// Complete neighbourhoods at a few hundred places of a cloud of any size: what its statistics are made from.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The samples around one place: every different position within some radius, in ascending order of distance.
struct Neighbourhood {
  Vec3f place;                   ///< a sample
  std::vector<Vec3f> offsets;    ///< positions − place; offsets[0] is zero, exact duplicates are left out
  std::vector<float> distances;  ///< lengths of the offsets, ascending
};

/// Neighbourhoods of about `size` samples (at most; sometimes fewer) around `places` samples chosen evenly over the
/// file order, always the same ones. One pass over the cloud: about 10 ns per sample and 100 ns per neighbour; no tree
/// over all samples is built. Non-finite samples are ignored. Memory is at most that of twice the neighbourhoods for
/// each of up to 64 parts of the cloud, wherever the samples lie: those next to each other in the file are mostly so in
/// space, and then it is about that of the neighbourhoods. Where many share a position, each position counts as one
/// sample.
std::vector<Neighbourhood> sample_neighbourhoods(std::span<const Vec3f> points, std::size_t places, std::size_t size);

}  // namespace sansmesh::inline v1
