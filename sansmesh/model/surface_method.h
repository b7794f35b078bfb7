// Surfaces of samples by name: what a method is, what it makes, and the registry of all of them.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/normal_field.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/option.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/schema/registry.h"
#include "sansmesh/surface/surface_samples.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Properties of a surface that its field does not tell.
struct SurfaceTraits {
  /// It goes on where there are no samples, and is closed there, unless it bounds no solid.
  bool closes_holes = false;
  bool creases = false;  ///< the field has creases that a mesh should follow
  /// How far from zero the field may be on either side of a jump that is part of the surface, over the radius of the
  /// ball of the support there: patches that do not meet, or nearly nothing.
  double jump = 0.01;
};

/// A surface made of samples. Everything is in the coordinates of the prepared cloud, and owns what it needs.
struct SurfaceParts {
  /// Null where `make_field` makes it, for those who ask; pictures of projections never do.
  std::shared_ptr<const ScalarField> field;
  std::function<std::shared_ptr<const ScalarField>(Progress&)> make_field;
  std::shared_ptr<const Projection> projection;  ///< null unless the surface is defined by one
  BallUnion support;                             ///< where the surface can be: balls around samples, then others
  /// Distances between the samples around the centres of the balls (length); none where the balls themselves tell how
  /// fine the surface is.
  std::vector<float> spacings;
  std::function<std::vector<Vec3>()> seeds;    ///< points near the surface; the centres of the balls where it is null
  std::shared_ptr<const NormalField> normals;  ///< better ones than the gradients; may be null
  /// The samples as the method uses them, from which sharp normals are made; null where it has no use for those.
  std::shared_ptr<const SurfaceSamples> samples;
  SurfaceTraits traits;
  double spacing = 0, noise = 0;  ///< of the samples (length)
  double smoothing = 0;           ///< median width of weights over the local spacing; 0 where there are none
  int order = 0, iterations = 0;  ///< of an iterated approximation
};

/// One surface that can be made of samples. Registered once, in its own source: library, command line, help and
/// documentation know it from there.
struct SurfaceMethod {
  std::string_view name;     ///< as users write it
  std::string_view summary;  ///< one line
  std::string_view page;     ///< file in docs/methods/
  /// The surface of clean, oriented samples. It may move their normals. Lengths among the options are in the
  /// coordinates of the cloud.
  SurfaceParts (*make)(PreparedCloud& cloud, const SurfaceOptions& options, Progress& progress) = nullptr;
  std::span<const std::string_view> uses = {};  ///< names of the options that mean something to it
  std::string_view instead = {};                ///< why others mean nothing to it, where that is not plain
  bool projects = false;                        ///< it is defined by a projection
  /// Throws ArgumentError for values of options that it does not take, though it uses the options; may be null.
  void (*check)(const SurfaceOptions& options) = nullptr;
  /// Options that no other surface has, kept in SurfaceOptions::own (own_option.h). Their names begin with the
  /// surface's: "shepard_neighbours".
  std::span<const OptionRow> own = {};

  /// Whether an option means something to it.
  bool uses_option(std::string_view option) const;

  /// Those of the library in the order of sansmesh/model/methods/CMakeLists.txt, then those that programs add.
  static Registry<SurfaceMethod>& registry();
};

/// Those of each source of sansmesh/model/methods/, in the order of its CMakeLists.txt, from which the definition is
/// made.
std::vector<std::span<const SurfaceMethod>> own_surface_methods();

/// By name. Throws ArgumentError naming the choices.
inline const SurfaceMethod& surface_method(std::string_view name) { return SurfaceMethod::registry().at(name); }

/// Names of those that use an option: "amls".
std::string surfaces_that_use(std::string_view option);

}  // namespace sansmesh::inline v1
