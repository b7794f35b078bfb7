// Every surface that can be made of samples, in one table: what library, command line, its help and its checks, and the
// check of the documentation know of it. A method is registered here and nowhere else.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "sansmesh/surface/implicit_surface.h"
#include "sansmesh/surface/projection_surface.h"

namespace sansmesh {

enum class SurfaceMethod {
  partition,
  hoppe,
  adamson,
  kolluri,
  dey,
  extremal,
  apss,
  amls,
  levin,
  alexa,
  curvature,
  mpu
};

/// In the order of the alternatives of SurfaceMethodInfo::formula.
enum class SurfaceFamily {
  partition,   ///< fitted: local functions, blended
  implicit,    ///< a function from weighted means of the samples
  projection,  ///< an operator that moves points onto the surface
  mpu          ///< fitted on an octree: a function that is defined in a whole cube
};

/// The formula of the family mpu, which has one.
struct MpuFormula {};

/// Fields of SurfaceOptions that mean something to some methods only.
enum class SurfaceOption {
  smoothing,
  bandwidth,
  weights,
  order,
  iterations,
  epsilon,
  normal,
  plane,
  polynomial,
  flow,
  diffusion,
  threshold,
  tau,
  separate_sheets,
  sharp,
  error,
  max_depth,
  smooth
};
inline constexpr std::size_t kSurfaceOptions = 18;

/// The field's name.
const char* field_name(SurfaceOption option);

struct SurfaceMethodInfo {
  SurfaceMethod method;
  const char* name;  ///< as users write it
  /// Which formula of its family makes it; that of the partition is its own.
  std::variant<std::monostate, ImplicitMethod, ProjectionMethod, MpuFormula> formula;
  const char* summary;                     ///< one line
  std::span<const SurfaceOption> options;  ///< that mean something to it
  const char* page;                        ///< file in docs/methods/
  const char* instead = "";                ///< why others mean nothing to it, where that is not plain

  SurfaceFamily family() const { return static_cast<SurfaceFamily>(formula.index()); }
  bool heeds(SurfaceOption option) const;
};

/// All of them, in the order of SurfaceMethod.
std::span<const SurfaceMethodInfo> surface_methods();

/// Throws ArgumentError for a value that is none.
const SurfaceMethodInfo& surface_method_info(SurfaceMethod method);

/// By name. Throws ArgumentError naming the choices.
SurfaceMethod surface_method(std::string_view name);

/// "partition, hoppe, …"
std::string surface_method_names();

/// Names of those that heed an option: "amls".
std::string heeded_by(SurfaceOption option);

}  // namespace sansmesh
