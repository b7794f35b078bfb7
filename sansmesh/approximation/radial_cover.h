// Cover of the samples' box by balls that hold a bounded number of samples each, with blending weights: the partition
// of unity of local interpolation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1::detail {

template <int D>
class RadialCover {
 public:
  struct Ball {
    Position<D> center;
    double radius;
  };
  struct Part {
    std::uint32_t ball;
    double weight;
    Position<D> slope;
  };

  RadialCover() = default;
  /// The box, larger by a tenth, is halved across its longest edge until a cell holds at most a third of
  /// `local_samples` samples and the ball around it at most eight times `local_samples`.
  RadialCover(const SampleIndex<D>& samples, std::size_t local_samples);

  const std::vector<Ball>& balls() const { return balls_; }
  /// The samples in a ball, or the `local_samples` nearest to its centre if the ball holds fewer.
  void members(std::size_t ball, const SampleIndex<D>& samples, std::vector<std::uint32_t>& out) const;
  /// Balls with a positive weight at x (at the nearest point of the box for x outside); at least one.
  void find(const Position<D>& x, std::vector<Part>& out) const;

 private:
  // Bounding box of the balls below; `ball` for a leaf.
  struct Node {
    Position<D> lower, upper;
    std::int32_t left = -1, right = -1, ball = -1;
  };

  Position<D> lower_{}, upper_{};
  std::size_t local_samples_ = 0;
  std::vector<Ball> balls_;
  std::vector<Node> nodes_;
};

extern template class RadialCover<1>;
extern template class RadialCover<2>;
extern template class RadialCover<3>;

}  // namespace sansmesh::inline v1::detail
