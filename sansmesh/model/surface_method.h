// Registry of the methods that make surfaces of samples, and the parts that a method produces.
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

/// Properties of a surface that its field does not express.
struct SurfaceTraits {
  /// The surface continues, and closes, where there are no samples, unless it bounds no solid.
  bool closes_holes = false;
  bool creases = false;  ///< the field has creases that a mesh should follow
  /// Largest |field| on either side of a jump that is part of the surface, over the radius of the local support ball:
  /// there patches do not meet.
  double jump = 0.01;
};

/// A surface made of samples. All members are in the coordinates of the prepared cloud; the structure owns its data.
struct SurfaceParts {
  /// Null if `make_field` creates it on demand; pictures of projections never need it.
  std::shared_ptr<const ScalarField> field;
  std::function<std::shared_ptr<const ScalarField>(Progress&)> make_field;
  std::shared_ptr<const Projection> projection;  ///< null unless the surface is defined by one
  BallUnion support;                             ///< balls that contain the surface: around samples first, then others
  /// Spacing of the samples around the ball centres (length); empty if the balls themselves determine the resolution.
  std::vector<float> spacings;
  std::function<std::vector<Vec3>()> seeds;    ///< points near the surface; null: the ball centres
  std::shared_ptr<const NormalField> normals;  ///< normals better than the gradients; may be null
  /// The samples as the method uses them, for sharp normals; null if it does not support these.
  std::shared_ptr<const SurfaceSamples> samples;
  SurfaceTraits traits;
  double spacing = 0, noise = 0;  ///< spacing and noise of the samples (length)
  double smoothing = 0;           ///< median width of the weight functions over the local spacing; 0 without weights
  int order = 0, iterations = 0;  ///< parameters of an iterated approximation
};

/// A method that makes a surface of samples. Registered once, in its own source; library, command line, help and
/// documentation use the registry.
struct SurfaceMethod {
  std::string_view name;     ///< name for users
  std::string_view summary;  ///< one line
  std::string_view page;     ///< file in docs/methods/
  /// Makes the surface of clean, oriented samples; may change their normals. Lengths among the options are in the
  /// coordinates of the cloud.
  SurfaceParts (*make)(PreparedCloud& cloud, const SurfaceOptions& options, Progress& progress) = nullptr;
  std::span<const std::string_view> uses = {};  ///< names of the options that it uses
  std::string_view instead = {};                ///< reason why it ignores other options, if not obvious
  bool projects = false;                        ///< the surface is defined by a projection
  /// Throws ArgumentError for option values that it does not support; may be null.
  void (*check)(const SurfaceOptions& options) = nullptr;
  /// Options of this method alone, stored in SurfaceOptions::own (own_option.h). Names begin with that of the method:
  /// "shepard_neighbours".
  std::span<const OptionRow> own = {};

  /// Whether the method uses an option.
  bool uses_option(std::string_view option) const;

  /// Methods of the library in the order of sansmesh/model/methods/CMakeLists.txt, followed by registered ones.
  static Registry<SurfaceMethod>& registry();
};

/// Methods of each source in sansmesh/model/methods/, in the order of its CMakeLists.txt, which generates the
/// definition.
std::vector<std::span<const SurfaceMethod>> own_surface_methods();

/// Looks up a method. Throws ArgumentError naming the choices.
inline const SurfaceMethod& surface_method(std::string_view name) { return SurfaceMethod::registry().at(name); }

/// Names of the methods that use an option: "amls".
std::string surfaces_that_use(std::string_view option);

}  // namespace sansmesh::inline v1
