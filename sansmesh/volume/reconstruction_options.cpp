#include "sansmesh/reconstruction_options.h"

#include <string>

#include "sansmesh/core/check_range.h"
#include "sansmesh/schema/registry_words.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {

const OptionSchema& ReconstructionOptions::schema() {
  using O = ReconstructionOptions;
  using Words = RegistryWords<VolumeMethod>;
  static const std::string method = "Reconstruction between samples: " + VolumeMethod::registry().names();
  static const std::string radius = "Of supports in spacings (" + methods_that_use("radius") + ")";
  static const OptionRow rows[] = {
      option<&O::method, Words>(
          {.text = method, .from_data = "from grid, resolution and noise", .choices = Words::names()}),
      option<&O::degree>({.text = "Highest degree of polynomials: up to 4 of mls and mls-detail, from 1 of lagrange",
                          .unit = "degree",
                          .range = {.least = 0, .most = 5},
                          .needs = "method"}),
      option<&O::iterations>(
          {.text = "Times that residuals are added (amls)", .range = {.least = 0, .most = 100}, .needs = "method"}),
      option<&O::epsilon>({.text = "Of amls: shape parameter, small is smooth",
                           .range = {.least = 0.05, .most = 10},
                           .needs = "method",
                           .old_name = "shape"}),
      option<&O::order>({.text = "Of amls: 2, 4 or 6", .unit = "order", .needs = "method"}),
      option<&O::spherical>({.text = "Of amls: whether supports are balls, not ellipsoids; for comparison, not for "
                                     "uniform and rectilinear grids",
                             .needs = "method"}),
      option<&O::radius>({.text = radius, .range = {.least = 1, .most = 10}, .needs = "method"}),
      option<&O::robust>(
          {.text = "Of mls-detail: whether weights leave steps between materials sharp, as they do by themselves",
           .needs = "method"}),
      option<&O::b>({.text = "Of cubic: B of its family", .range = {.least = 0, .most = 1}, .needs = "method"}),
      option<&O::c>({.text = "Of cubic: C of its family; with B = 0, 0.5 is Catmull–Rom",
                     .range = {.least = 0, .most = 1},
                     .needs = "method"}),
  };
  static const OptionSchema schema{rows};
  return schema;
}

void ReconstructionOptions::validate() const {
  validate_options(*this);
  check_argument(!order || *order == 2 || *order == 4 || *order == 6, "`order` must be 2, 4 or 6");
}

}  // namespace sansmesh::inline v1
