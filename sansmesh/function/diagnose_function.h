// Where a fitted function should not be trusted without a look, and edits that may mend it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/function/edit_function.h"

namespace sansmesh {

enum class Suspicion : std::uint8_t {
  low_coverage,  ///< samples cover little of the supports: borders, holes, gaps of a scan
  high_error,    ///< samples lie farther off than elsewhere: misaligned scans, detail that is not resolved
  extra_sheet,   ///< a piece of surface that hardly any samples stand for
  steep          ///< the gradient is far from 1: sheets too close to each other, contradicting samples
};
constexpr std::size_t kSuspicions = 4;
const char* suspicion_name(Suspicion kind);

struct DiagnoseOptions {
  double coverage_below = 0.3;  ///< of supports (METHODS §3.1), 0..1
  /// rms distance of a support's samples (length, input); default: six times the median of all, at least a quarter of
  /// the spacing.
  std::optional<double> error_above;
  double gradient_above = kSoundSlope;  ///< norm, > 1
  std::size_t places = 20;              ///< at most this many places of each kind
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SuspiciousPlace {
  Suspicion kind;
  Vec3 position;             ///< middle (input)
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

/// Throws ArgumentError for bad options.
Diagnosis diagnose_function(const SurfaceFunction& function, const DiagnoseOptions& options, Progress& progress);

}  // namespace sansmesh
