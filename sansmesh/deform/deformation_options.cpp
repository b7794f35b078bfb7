#include "sansmesh/deform_options.h"

#include <cstddef>

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kDeformationKinds[] = {"affine", "similarity", "rigid", "nonlinear"};

}  // namespace

std::string_view kind_word(DeformationKind kind) { return kDeformationKinds[static_cast<std::size_t>(kind)]; }

const OptionSchema& MlsDeformationOptions::schema() {
  using O = MlsDeformationOptions;
  static constexpr OptionRow rows[] = {
      option<&O::kind>(
          {.text = "Local map: affine, similarity (rotation and scale), rigid (rotation), nonlinear (polynomials)",
           .unit = "kind",
           .choices = kDeformationKinds}),
      option<&O::degree>(
          {.text = "Degree of nonlinear maps: 2 (at least 9 handles) or 3 (19)", .unit = "degree", .range = {2, 3}}),
      option<&O::alpha>(
          {.text = "Exponent of the weights 1/distance^(2 alpha); with segments at least 1", .range = {0.5, 8}}),
      option<&O::damping>({.text = "Reduction of influence across a cut, to distance/(distance + FACTOR · detour)",
                           .unit = "factor",
                           .range = {1, 1e6},
                           .name = "cut_damping"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void MlsDeformationOptions::validate() const { validate_options(*this); }

}  // namespace sansmesh::inline v1
