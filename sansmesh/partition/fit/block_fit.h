// Least-squares fits around a block: selection of samples, local frame, and degree.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/morton.h"
#include "sansmesh/partition/fit/gathered_samples.h"
#include "sansmesh/partition/fit/local_fit.h"
#include "sansmesh/partition/fit/sample_tree.h"
#include "sansmesh/partition/partition_of_unity.h"

namespace sansmesh::inline v1 {

/// Blocks of a tree of samples and the balls around them.
struct BlockFitter {
  const SampleTree& tree;
  const PartitionOptions& options;
  float support = 1.5f;  ///< radius of a support / circumscribed radius of its block
  int deepest = 0;       ///< level whose blocks are fitted with any number of samples
  float fit = support;   ///< radius of the initial ball of samples of a fit / circumscribed radius of the block
  float height = 0;      ///< least distance off the surface up to which samples count, for noise (length)

  float block_edge(int level) const { return tree.edge() / static_cast<float>(1u << level); }

  Vec3f center(int level, std::uint32_t cell) const {
    const auto c = morton_cell(tree.level(level).code[cell]);
    const float h = block_edge(level);
    return tree.lower() + Vec3f{(static_cast<float>(c[0]) + 0.5f) * h, (static_cast<float>(c[1]) + 0.5f) * h,
                                (static_cast<float>(c[2]) + 0.5f) * h};
  }

  float support_radius(int level) const { return support * 0.8660254f * block_edge(level); }
  float fit_radius(int level) const { return fit * 0.8660254f * block_edge(level); }
};

/// A fitter of the accepted scales, whose balls are not stretched.
inline BlockFitter fitter_of(const SampleTree& tree, const PartitionOptions& options, const ScaleBasis& basis) {
  return {tree, options, static_cast<float>(basis.support), basis.finest, static_cast<float>(basis.fit)};
}

/// tr(G⁻¹ Σ w² m mᵀ) · Σ w / Σ w²: the degrees of freedom that a fit of each degree takes from Σ w r², in units of the
/// weights' effective count, for w = (1 − t²)² over a disc. Less than the number of basis functions, because those with
/// most of their norm near the rim, where the weights vanish, have little effect.
constexpr std::array<float, kMaxDegree + 1> kFreedom{1.0f, 7.0f / 3, 4.0f, 6.0f, 25.0f / 3};

/// Radii of larger balls for blocks with too few samples, in units of the ball's radius: twice the area, and the
/// parent's ball.
constexpr float kReaches[] = {1.41f, 2.0f};

/// Where a function follows its samples to a small part of the radius of its ball, its support is wider by up to this
/// share: the blocks beside it may be empty, and the far field is less exact.
constexpr float kExactReach = 0.25f;

/// Buffers reused from block to block.
struct Workspace {
  GatheredSamples ball;
  LocalSamples samples;
  BallView view;  ///< the samples, seen from outside
};

/// Distance from the block's centre, over its radius, that a ball shifted along the normal reaches: a surface through
/// the block passes at most 1/1.5 of the radius of the default support away from the centre, and its disc around there
/// ends √(1 + 1/1.5²) = 1.2 radii from the centre. The rest is for noise.
constexpr float kShift = 1.3f;

/// Weight of a sample in a fit. t: squared distance from the centre of the ball over the squared radius, below 1.
inline float smooth_weight(float t) { return (1 - t) * (1 - t); }

/// Sets the frame's axes.
void set_normal(LocalFunction& f, const Vec3f& nu);

/// Collects the samples in a ball (every stride-th) from the given cells of a level.
void gather(const SampleTree& tree, int level, const SampleTree::Neighbours& cells, const Vec3f& c, float radius,
            GatheredSamples& ball, std::size_t stride = 1);

/// Collects samples within the radius of a fit or, if these are too few, within up to twice that (the parent's ball).
/// Returns the factor, or 0 if even that ball has too few samples.
float gather_enough(const BlockFitter& fitter, int level, std::uint32_t cell, const SampleTree::Neighbours& own,
                    const SampleTree::Neighbours& parents, GatheredSamples& ball);

/// Fits all degrees around the centre of the samples in ws.ball. The frame's normal is the mean of the samples'
/// normals, corrected if a first plane is tilted against it (noisy normals). The ball is shifted along the normal until
/// the surface passes through its centre, because an off-centre ball would cut more noisy samples off on one side than
/// on the other, a bias. `dropped` receives the share of the weight of samples that face away. `height`: if it exceeds
/// the scale, the ball is stretched along the normal to this length.
DegreeFits fit_local(float scale, int max_degree, Workspace& ws, LocalFunction& f, float* dropped = nullptr,
                     float height = 0);

/// Coverage k (tejada2008, 4.4.3): area of the box of the projected samples / area of the projected ball.
double coverage(const BallView& view);

/// Robustness tests (tejada2008, 4.4.3): curved polynomials only if the samples cover the support and surround its
/// centre.
int highest_degree(const PartitionOptions& options, const DegreeFits& fits, const BallView& view);

/// The given samples in the ball around a fitted function's centre, including those that face away, then those beyond
/// it, with weight 0. Returns the number of the former.
std::size_t ball_samples(const SampleTree& tree, const LocalFunction& f, std::span<const std::uint32_t> ids,
                         std::vector<Vec3f>& position, std::vector<Vec3f>& normal, std::vector<float>& weight);

}  // namespace sansmesh::inline v1
