// What a body of tetrahedra is made of, what acts on it, and in which steps it will move.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/dynamics/soft_body_options.h"
#include "sansmesh/error.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/report.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// What the scene, or nobody, says of a body. What is not given here either follows from the data.
struct SimulateOptions {
  std::optional<SoftBodyModel> model = {};
  std::optional<double> stiffness = {};  ///< of springs, N/m, > 0
  std::optional<double> young = {};      ///< Young's modulus, Pa, > 0
  std::optional<double> poisson = {};    ///< Poisson's ratio, 0..0.49
  std::optional<double> damping = {};    ///< of springs, N s/m; of elasticity, s; >= 0
  std::optional<double> density = {};    ///< kg/m³, > 0
  std::optional<LengthUnit> unit = {};   ///< of lengths in the body's file and the scene
  std::optional<double> duration = {};   ///< s, > 0. Of `duration`, `fps` and `frames` two at most
  std::optional<double> fps = {};        ///< frames a second, > 0
  std::optional<int> frames = {};        ///< the body at rest among them, >= 2
  std::optional<DynamicsIntegrator> integrator = {};
  std::optional<double> longest_step = {};  ///< s, > 0
  bool z_up = false;                        ///< gravity pulls along −z, whatever the scene says

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the option.
  void validate() const;
};

/// What the scene says, or nobody does, cannot be simulated.
class SceneError : public ArgumentError {
 public:
  using ArgumentError::ArgumentError;
};

struct SimulationPlan {
  std::shared_ptr<const TetMesh> rest;  ///< in the unit of its file
  double unit = 1;                      ///< metres of that
  bool z_up = false;
  SoftBodyOptions options;
  DynamicsScene scene;          ///< lengths in the file's unit
  bool step_given = false;      ///< by scene or options
  std::size_t frames = 0;       ///< the body at rest among them
  double frame_time = 0;        ///< s
  std::size_t frame_steps = 0;  ///< steps from frame to frame
  /// "mean_material": several materials, their mean is taken; "no_material": cells without one; "unit": it is guessed.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// What the options and the scene say together, and for what neither says: materials of the cells (arrays `density`,
/// `young` and `poisson`), a unit and a material that suit the body (suited_options), and a floor below it where
/// nothing else keeps it from falling for ever. Throws ArgumentError, SceneError, and DataError for bodies and
/// materials that cannot be simulated.
SimulationPlan plan_simulation(TetMesh body, SceneScript scene, const SimulateOptions& options);

}  // namespace sansmesh::inline v1
