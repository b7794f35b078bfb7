// Inside or outside, decided by the whole cloud at once: the generalised winding number of its oriented patches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/vec.h"
#include "sansmesh/points/oriented_patches.h"

namespace sansmesh {

/// w(x) = Σ area · ⟨n, p − x⟩ / (4π ‖p − x‖³): about 1 inside, 0 outside, 1/2 on the surface and on the membrane that
/// closes a hole (Barill et al. 2018, Fast winding numbers for soups and clouds; expansions up to order 2).
/// Within about its size of a patch the dipole is that of a ball of density ∝ 1 − s²: bounded, w has one continuous
/// derivative across the surface, and nothing changes farther away.
///
/// Space is divided into blocks; all points of a block use the same expansions. Hence w(x) depends on x alone, neither
/// on the batch nor on the number of threads. From block to block w jumps by the error of the expansions (< 0.001).
class WindingNumber {
 public:
  /// No patches: w = 0 everywhere.
  WindingNumber() = default;
  /// Patches with an area or size that is not positive, or anything not finite, are left out.
  explicit WindingNumber(const OrientedPatches& patches);

  bool empty() const { return near_.empty(); }

  /// w at each x and, unless empty, its gradient (per unit of length; points inward). w, gradients: as long as x, else
  /// ArgumentError. 0 where x is not finite. Parallel; cheapest where many points of a batch are close together.
  void evaluate(std::span<const Vec3f> x, std::span<float> w, std::span<Vec3f> gradients = {}) const;

  /// A patch, or (padded) none: position, area · normal / 4π, reciprocal powers of the blur's radius.
  struct NearSource {
    float position[3], dipole[3], inverse2, inverse3;
  };
  /// Moments of a group of patches about its centre, traceless, with all constant factors in them.
  struct FarSource {
    float position[3], dipole[3];
    float second[6];  ///< xx yy zz xy xz yz
    float third[10];  ///< xxx yyy zzz xxy xxz xyy yyz xzz yzz xyz
  };

 private:
  struct Node {
    Vec3f center;
    float radius;               ///< of the ball around `center` with all patches and their blurs
    std::uint32_t first, last;  ///< patches
    std::uint32_t right = 0;    ///< second child; the first one follows its parent; 0: leaf
  };
  struct Builder;
  struct Block;

  void collect(const Vec3f& center, float radius, Block& block) const;

  Vec3 center_;       ///< Everything below is in units where the patches fill the unit ball around 0.
  double scale_ = 1;  ///< length of that unit
  float block_edge_ = 1;
  std::vector<NearSource> near_;
  std::vector<Node> nodes_;
  std::vector<FarSource> far_;  ///< one a node
};

/// The same sum over all patches in double precision: slow and obvious.
double winding_number_direct(const OrientedPatches& patches, const Vec3& x);

}  // namespace sansmesh
