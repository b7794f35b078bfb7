// Where a fitted function should not be trusted without a look, and edits that may mend it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/function/edit_function.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

enum class Suspicion : std::uint8_t {
  /// Samples cover little of the supports: holes and gaps of a scan; not where a sheet that bounds no solid ends.
  low_coverage,
  high_error,  ///< samples lie farther off than elsewhere: misaligned scans, detail that is not resolved
  /// A piece of surface that hardly any samples stand for, or that a mesh would leave out as too small; in functions
  /// with sheets that bound no solid only the samples count: few of them, however small a part is beside the largest.
  extra_sheet,
  steep  ///< the gradient is far from 1: sheets too close to each other, contradicting samples
};
constexpr std::size_t kSuspicions = 4;
const char* suspicion_name(Suspicion kind);
/// What Diagnosis::mesh is coloured in there (sRGB).
std::array<std::uint8_t, 3> suspicion_color(Suspicion kind);

struct DiagnoseOptions {
  double coverage_below = 0.3;  ///< of supports (METHODS §3.1), 0..1
  /// rms distance of a support's samples (length, input); default: six times the median of all, at least a quarter of
  /// the spacing.
  std::optional<double> error_above = {};
  double gradient_above = kSoundSlope;  ///< norm, > 1
  std::size_t places = 20;              ///< at most this many places of each kind

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SuspiciousPlace {
  Suspicion kind;
  Vec3 position;             ///< middle (input)
  Vec3 normal;               ///< of the surface there, outward, on average; 0 if it faces all ways
  double radius = 0;         ///< of a ball around it (length)
  std::size_t supports = 0;  ///< that are concerned
  double worst = 0;          ///< coverage, error (length), area (length²) or gradient
  std::optional<Edit> edit;  ///< that may mend it
};

struct Diagnosis {
  std::vector<SuspiciousPlace> places;  ///< of each kind, the largest first
  std::array<std::size_t, kSuspicions>
      found{};                  ///< places of each kind, including those beyond DiagnoseOptions::places
  double error_above = 0;       ///< threshold used (length)
  double largest_gradient = 0;  ///< at and around the surface
  TriangleMesh mesh;            ///< with all components; coloured by what is suspicious
  std::vector<Edit> edits() const;
};

/// The edits are tried together before they are proposed, and those taken back that do harm: after all of them no
/// larger share of the samples is farther from the default mesh than lost_beyond (mesh_coverage.h), but for one in
/// 20,000, which making a mesh anew may cost by itself. Takes as long as making two meshes, or up to four where edits
/// do harm. Throws ArgumentError for bad options.
Diagnosis diagnose_function(const SurfaceFunction& function, const DiagnoseOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
