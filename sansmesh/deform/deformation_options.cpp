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
      option<&O::kind>({.text = "What it is made of around each place: affine, similarity (turns and scales), rigid "
                                "(turns), nonlinear (bends)",
                        .unit = "kind",
                        .choices = kDeformationKinds}),
      option<&O::degree>({.text = "Of nonlinear: 2 (from 9 handles on) or 3 (19)", .unit = "degree", .range = {2, 3}}),
      option<&O::alpha>({.text = "How local it is: weights are 1/distance^(2 alpha), with segments of 1 at least",
                         .range = {0.5, 8}}),
      option<&O::damping>({.text = "How much less what lies behind a cut follows: influence falls with "
                                   "distance/(distance + FACTOR · detour)",
                           .unit = "factor",
                           .range = {1, 1e6},
                           .name = "cut_damping"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void MlsDeformationOptions::validate() const { validate_options(*this); }

}  // namespace sansmesh::inline v1
