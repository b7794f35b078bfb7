#include "sansmesh/volume_advice.h"

#include <fmt/core.h>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

using VolumeAim = VolumeRecommendation::Aim;

/// Share of the samples next to steps above which a volume has borders that no single value follows.
constexpr double kBorders = 0.005;

std::string border_reason(const VolumeTraits& traits) {
  return fmt::format(
      "the array jumps at {:.2g} % of its samples: borders between materials have the largest gradients, "
      "at any value",
      100 * traits.steps);
}

}  // namespace

const char* aim_word(VolumeAim aim) {
  static constexpr const char* kWords[] = {"values", "grid",         "surface",      "border",      "picture",
                                           "lines",  "flow surface", "flow picture", "deformation", "forces"};
  return kWords[static_cast<std::size_t>(aim)];
}

std::vector<VolumeRecommendation> advise_volume(const VolumeAdviceInput& offer) {
  std::vector<VolumeRecommendation> list;
  const auto add = [&](VolumeAim aim, std::string why) { list.push_back({.aim = aim, .why = std::move(why)}); };
  const bool changes = offer.steps > 1;
  if (offer.vectors) {
    add(VolumeAim::flow_picture,
        std::string(changes ? "path" : "stream") +
            " surfaces show the paths of the flow, line integral convolution its directions on them");
    add(VolumeAim::flow_surface, "the same as a mesh: particles are added where the flow diverges");
    add(VolumeAim::lines, changes ? "the flow changes with time: particles follow path lines, not stream lines"
                                  : "the flow is steady: particles follow stream lines");
  }
  if (offer.values) {
    const std::string& name = offer.recommended.method;
    // Surfaces by moving least squares weight samples by their values and are less sensitive to noise and coarse edges.
    // On grids other than lattices their layers fall apart in flat cells (docs/methods/volume-surfaces.md).
    const bool by_samples = offer.lattice && !(offer.traits.resolved() && offer.traits.edges_resolved());
    if (by_samples && offer.traits.steps >= kBorders) add(VolumeAim::border, border_reason(offer.traits));
    add(VolumeAim::surface,
        by_samples
            ? "of one value, by moving least squares on the samples: smooth where an isosurface follows every sample"
            : "of one value, an isosurface of the reconstruction: as smooth as the samples resolve it");
    list.back().by_samples = by_samples;
    add(VolumeAim::picture, fmt::format("the whole volume, reconstructed by {}", name));
    add(VolumeAim::values, "values and gradients at any point, by the same reconstruction");
    add(VolumeAim::grid, "the same on a lattice, for programs that read only these");
    add(VolumeAim::deformation, "moved with handles by moving least squares, without a mesh");
  }
  // Volumes with vectors are more likely a fluid, or the result of a simulation.
  if (offer.body && !offer.vectors)
    add(VolumeAim::forces, "its cells form a body: gravity, forces and contacts move it by springs or elasticity");
  return list;
}

}  // namespace sansmesh::inline v1
