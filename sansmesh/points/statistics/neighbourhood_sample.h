// Complete neighbourhoods of a few hundred samples of a cloud of any size, for statistics.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Neighbourhood of a sample: all distinct positions within some radius, in ascending order of distance.
struct Neighbourhood {
  Vec3f center;                  ///< position of the sample
  std::vector<Vec3f> offsets;    ///< positions − center; offsets[0] is zero; without duplicates
  std::vector<float> distances;  ///< lengths of the offsets, ascending
};

/// Neighbourhoods of at most `size` samples around `count` samples, chosen evenly over the file order and
/// reproducibly. One pass over the cloud: about 10 ns per sample and 100 ns per neighbour, without a tree over all
/// samples. Ignores non-finite samples. Memory is at most twice that of the neighbourhoods for each of up to 64 parts
/// of the cloud, but about that of the neighbourhoods if, as usual, samples that are adjacent in the file are close in
/// space. Where many samples share a position, each position counts as one sample.
std::vector<Neighbourhood> sample_neighbourhoods(std::span<const Vec3f> points, std::size_t count, std::size_t size);

}  // namespace sansmesh::inline v1
