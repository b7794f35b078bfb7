#include "sansmesh/volume_reconstruction_options.h"

#include <string>
#include <string_view>

#include "sansmesh/core/check_range.h"
#include "sansmesh/schema/registry_words.h"
#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kCellValues[] = {"means", "centres"};

}  // namespace

const OptionSchema& VolumeReconstructionOptions::schema() {
  using O = VolumeReconstructionOptions;
  using Words = RegistryWords<VolumeMethod>;
  static const std::string method = "Reconstruction between samples: " + VolumeMethod::registry().names();
  static const std::string radius = "Support radius in spacings (" + methods_that_use("radius") + ")";
  static const OptionRow rows[] = {
      option<&O::method, Words>(
          {.text = method, .from_data = "from grid, resolution and noise", .choices = Words::names()}),
      option<&O::degree>(
          {.text = "Highest degree of polynomials: 0..4 for mls and mls-detail, 0..2 for amls, 1..5 for lagrange",
           .unit = "degree",
           .range = {.least = 0, .most = 5},
           .needs = "method"}),
      option<&O::iterations>({.text = "Number of iterations that add residuals (amls)",
                              .range = {.least = 0, .most = 100},
                              .needs = "method"}),
      option<&O::epsilon>({.text = "Shape parameter (amls): smaller is smoother",
                           .range = {.least = 0.05, .most = 10},
                           .needs = "method",
                           .old_name = "shape"}),
      option<&O::order>({.text = "Order of approximation (amls): 2, 4 or 6", .unit = "order", .needs = "method"}),
      option<&O::spherical>({.text = "Spherical instead of ellipsoidal supports (amls), for comparison; not for "
                                     "uniform and rectilinear grids",
                             .negative_text = "Ellipsoidal supports that follow the spacing (amls)",
                             .needs = "method"}),
      option<&O::radius>({.text = radius, .range = {.least = 1, .most = 10}, .needs = "method"}),
      option<&O::robust>({.text = "Robust weights that keep steps between materials sharp (mls-detail)",
                          .negative_text = "Weights by distance alone, which blur steps (mls-detail)",
                          .needs = "method"}),
      option<&O::interpolate>({.text = "Pass through the samples (mls, mls-detail)",
                               .from_data = "on",
                               .negative_text = "Take the values of polynomials as printed, which filter noise (mls, "
                                                "mls-detail)",
                               .needs = "method"}),
      option<&O::b>({.text = "B of the BC family (cubic)", .range = {.least = 0, .most = 1}, .needs = "method"}),
      option<&O::c>({.text = "C of the BC family (cubic); 0.5 with B = 0 is Catmull–Rom",
                     .range = {.least = 0, .most = 1},
                     .needs = "method"}),
      option<&O::smoothing>(
          {.text = "Factor of the noise (white, correlated or Rician) by which samples are smoothed first; 0 "
                   "interpolates them",
           .from_data = "1 if noise is found",
           .range = {.least = 0, .most = 10}}),
      option<&O::cell_values>({.text = "Values in cells: means over the cell (mls-detail), or values at its centre",
                               .from_data = "means for mls-detail, else centres",
                               .choices = kCellValues}),
      option<&O::logarithm>({.text = "Reconstruct the logarithm of positive values, so that none becomes negative",
                             .from_data = "on where samples span two decades and follow geometric means",
                             .negative_text = "Reconstruct the values themselves, even where they span decades"}),
  };
  static const OptionSchema schema{rows};
  return schema;
}

void VolumeReconstructionOptions::validate() const {
  validate_options(*this);
  check_argument(!order || *order == 2 || *order == 4 || *order == 6, "`order` must be 2, 4 or 6");
}

}  // namespace sansmesh::inline v1
