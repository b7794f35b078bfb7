#include "sansmesh/volume_advice.h"

#include <fmt/core.h>

#include "sansmesh/volume/reconstruction.h"

namespace sansmesh::inline v1 {
namespace {

using VolumeAim = VolumeRecommendation::Aim;

/// Share of the samples next to steps from which on a volume has borders that no single value follows.
constexpr double kBorders = 0.005;

std::string border_reason(const VolumeTraits& traits) {
  return fmt::format(
      "the array jumps at {:.2g} % of its samples: borders between materials are where it changes most, "
      "at whatever value",
      100 * traits.steps);
}

}  // namespace

const char* aim_word(VolumeAim aim) {
  static constexpr const char* kWords[] = {"values", "grid",         "surface",      "border",      "picture",
                                           "lines",  "flow surface", "flow picture", "deformation", "forces"};
  return kWords[static_cast<std::size_t>(aim)];
}

std::vector<VolumeRecommendation> advise_volume(const VolumeOffer& offer) {
  std::vector<VolumeRecommendation> list;
  const auto add = [&](VolumeAim aim, std::string why) { list.push_back({.aim = aim, .why = std::move(why)}); };
  const bool changes = offer.steps > 1;
  if (offer.vectors) {
    add(VolumeAim::flow_picture, std::string(changes ? "path" : "stream") +
                                     " surfaces show where the flow goes, line integral convolution how it goes there");
    add(VolumeAim::flow_surface, "the same as a mesh: particles are added where the flow parts them");
    add(VolumeAim::lines, changes ? "the flow changes with time: path lines are what particles do, stream lines are not"
                                  : "the flow does not change: stream lines are what particles do");
  }
  if (offer.values) {
    const std::string& name = offer.suited.method;
    // Surfaces by moving least squares weigh samples by their values: noise and coarse edges do them less harm.
    // On other grids than lattices their layers fall apart where cells are flat (docs/methods/volume-surfaces.md).
    const bool by_samples = offer.lattice && !(offer.traits.resolved() && offer.traits.edges_resolved());
    if (by_samples && offer.traits.steps >= kBorders) add(VolumeAim::border, border_reason(offer.traits));
    add(VolumeAim::surface,
        by_samples ? "of one value, by moving least squares over the samples: smooth where an isosurface follows each"
                   : "of one value, an isosurface of the reconstruction: smooth, as far as the samples resolve it");
    list.back().by_samples = by_samples;
    add(VolumeAim::picture, fmt::format("all of the volume at once, as {} sees it", name));
    add(VolumeAim::values, "values and gradients at any place, by the same reconstruction");
    add(VolumeAim::grid, "the same on a lattice, for programs that read nothing else");
    add(VolumeAim::deformation, "pulled at handles, without a mesh: by moving least squares, seen through the map");
  }
  // Where there are vectors it is more likely a body of fluid, or a simulation's result.
  if (offer.body && !offer.vectors)
    add(VolumeAim::forces, "its cells are a body: gravity, forces and contacts move it as springs or elasticity do");
  return list;
}

}  // namespace sansmesh::inline v1
