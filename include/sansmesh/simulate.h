// Dynamics of tetrahedral bodies: reads, plans, simulates and draws them with the surfaces and volumes that they carry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "sansmesh/report.h"
#include "sansmesh/simulate_options.h"
#include "sansmesh/tet_mesh.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

struct TetDataset;
class VolumeModel;

// ---- Reading -----------------------------------------------------------------------------------------------------

/// Tetrahedral body from a file. Cheap to copy.
struct SANSMESH_API SimulationBody {
  std::shared_ptr<const TetDataset> tets;         ///< for the library only
  std::string file = {};                          ///< source file
  const TetMesh& mesh() const;                    ///< mesh in the unit of the file
  const std::vector<std::string>& notes() const;  ///< tetrahedra that were inverted, split or dropped, one line each
  /// Vertex with that number in the file. Throws DataError if there is none, or no tetrahedron uses it.
  std::uint32_t vertex(std::uint64_t number) const;
};

/// Reads the cells of a volume as tetrahedra: splits hexahedra, wedges and pyramids, reorients inverted ones. Throws
/// FileError, DataError if there are none, a position is not finite, or a tetrahedron has no volume.
SANSMESH_API SimulationBody read_body(const std::string& file);

/// Reads a scene (docs/formats/scene.md) and a file of fixed vertices (.bou); either name may be empty. `z_up`
/// overrides the scene: z points up. Throws FileError.
SANSMESH_API SceneScript read_scene(const std::string& file, const std::string& fixed, const SimulationBody& body,
                                    bool z_up);

// ---- Planning ----------------------------------------------------------------------------------------------------

/// Options that override the scene. Values missing from both are derived from the data.
struct SANSMESH_API SimulateOptions {
  std::optional<SoftBodyModel> model = {};     ///< default: springs, unless `young` is given
  std::optional<double> stiffness = {};        ///< stiffness of springs, N/m, > 0
  std::optional<double> young = {};            ///< Young's modulus, Pa, > 0
  std::optional<double> poisson = {};          ///< Poisson's ratio, 0..0.49
  std::optional<double> damping = {};          ///< for springs N s/m, for elasticity s; >= 0
  std::optional<double> density = {};          ///< kg/m³, > 0
  std::optional<LengthUnit> unit = {};         ///< unit of lengths in the body's file and the scene
  std::optional<double> duration = {};         ///< s, > 0. At most two of `duration`, `fps` and `frames`
  std::optional<double> fps = {};              ///< frames per second, > 0
  std::optional<int> frames = {};              ///< number of frames with the initial one, >= 2
  std::optional<std::string> integrator = {};  ///< name; default: implicit-euler
  std::optional<double> longest_step = {};     ///< s, > 0
  bool z_up = false;                           ///< gravity pulls along −z regardless of the scene

  /// Option rows, one per field.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the option.
  void validate() const;
};

/// Plan of a simulation: material, forces, steps and frames.
struct SANSMESH_API SimulationPlan {
  std::string body_file, scene_file;    ///< names in errors, if body and scene are from files
  std::shared_ptr<const TetMesh> rest;  ///< in the unit of its file
  double unit = 1;                      ///< metres per unit of the file
  bool z_up = false;                    ///< z points up
  SoftBodyOptions options;              ///< material and solver options
  DynamicsScene scene;                  ///< lengths in the file's unit
  bool step_given = false;              ///< the scene or the options give the step
  std::size_t frames = 0;               ///< number of frames with the initial one
  double frame_time = 0;                ///< s
  std::size_t frame_steps = 0;          ///< steps from frame to frame
  /// "mean_material": the mean of several materials is used; "no_material": cells without one; "unit": the unit is
  /// guessed.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< report rows
};

/// Combines options and scene. Missing values come from materials of the cells (arrays `density`, `young` and
/// `poisson`), or are a unit and material that suit the body (recommended_options); a floor is added if nothing else
/// stops an endless fall. Throws ArgumentError, SceneError, and DataError for bodies and materials that cannot be
/// simulated.
SANSMESH_API SimulationPlan plan_simulation(TetMesh body, SceneScript scene, const SimulateOptions& options);
/// Plans for a body from a file. Bodies and scenes that cannot be simulated then give a FileError with the name of
/// their file, here and in simulate().
SANSMESH_API SimulationPlan plan_simulation(const SimulationBody& body, SceneScript scene,
                                            const SimulateOptions& options);

// ---- Moving ------------------------------------------------------------------------------------------------------

/// Data stored for each frame besides its moment.
struct KeptMotion {
  bool positions = true, velocities = true;  ///< for all vertices
};

/// Positions and velocities of all vertices of a moving body at the frames, in the unit of its file. Cheap to copy:
/// copies share the data.
class SANSMESH_API Motion {
 public:
  /// No frames.
  Motion();
  Motion(const std::shared_ptr<const TetMesh>& rest, const KeptMotion& kept);  ///< no frames yet, for a body
  /// Memory for that number of frames.
  double bytes(std::size_t frames) const;
  /// Adds a frame. Positions and velocities are in metres; `unit`: metres per unit of the file. All copies share the
  /// frame.
  void add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit);

  /// The body at rest.
  const TetMesh& rest() const;
  /// Number of stored frames.
  std::size_t frames() const;
  /// Time in s.
  double time(std::size_t frame) const;
  /// Empty if not stored.
  std::vector<Vec3> positions(std::size_t frame) const;
  /// Velocities per second.
  const std::vector<Vec3f>& velocities(std::size_t frame) const;
  /// Centre of the body at rest.
  const Vec3& origin() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// Surface carried by the tetrahedra: their boundary, or a surface inside them. Cheap to copy.
class SANSMESH_API CarriedSurface {
 public:
  explicit CarriedSurface(const TetMesh& rest);  ///< boundary of the tetrahedra
  /// Throws DataError if a vertex is not finite.
  CarriedSurface(const TetMesh& rest, TriangleMesh surface);
  /// The surface at a frame.
  TriangleMesh at(const Motion& motion, std::size_t frame) const;
  /// "outside": vertices outside all tetrahedra.
  std::vector<Note> notes() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

/// Reads the surface of a mesh file, or takes the boundary of the body if the name is empty. Throws FileError.
SANSMESH_API CarriedSurface read_carried(const std::string& file, const SimulationPlan& plan);

/// State of a simulation after a step.
struct SimulationMoment {
  BodyEnergies energies;  ///< after the step
  StepReport step;        ///< work of the step
};

/// Report of a simulation.
struct SANSMESH_API SimulateReport {
  std::size_t steps = 0, halvings = 0;    ///< counts
  std::size_t unsettled = 0;              ///< steps whose contacts would still change
  std::uint64_t iterations = 0;           ///< iterations of conjugate gradients
  double shortest_step = 0;               ///< s
  int most_contacts = 0;                  ///< maximum at the end of a step
  double seconds = 0;                     ///< run time
  BodyEnergies first, last;               ///< initial and final state
  std::vector<SimulationMoment> moments;  ///< initial state and, if requested, the state after each step

  static const ReportSchema& schema();  ///< report rows
  /// All moments as a CSV table: energies, iterations, contacts.
  std::string table() const;
};

/// Body, run time and frames, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SimulationPlan& plan, const SimulateReport& report);

/// Result of simulate().
struct SimulateResult {
  Motion motion;          ///< all its frames
  SimulateReport report;  ///< counts and energies
  /// "within_obstacle": vertices start inside an obstacle; "unstable_step": the step exceeds the stability limit of the
  /// integrator; "halved": conjugate gradients did not converge; "unsettled": contacts kept changing until the ends of
  /// many steps.
  std::vector<Note> notes;
};

/// Simulates the plan. `moments`: keeps the moments of all steps. Throws SceneError for impossible scenes,
/// ArgumentError for frames that need too much memory, DataError if the body explodes, Cancelled.
SANSMESH_API SimulateResult simulate(const SimulationPlan& plan, const KeptMotion& kept, bool moments,
                                     Progress& progress);

// ---- Pictures ----------------------------------------------------------------------------------------------------

/// Volume rendered in the deforming tetrahedra.
struct CarriedVolume {
  std::shared_ptr<const VolumeField> field = {};  ///< of one component
  bool image = false;                             ///< the samples form a lattice
  VolumePictureOptions look =
      {};  ///< only the part specific to volumes; the rest comes from the options of all pictures
};

/// The array that a volume was opened with (the length of vectors). Throws as VolumeModel::field.
SANSMESH_API CarriedVolume carried_volume(const VolumeModel& volume, Progress& progress, std::vector<Note>& notes);

/// Pictures of all frames from one viewpoint that shows the whole motion.
class SANSMESH_API MotionPictures {
 public:
  /// Checks all options before the simulation. The up axis follows the plan. Without a surface, a volume is required.
  /// Throws ArgumentError.
  MotionPictures(const SimulationPlan& plan, std::optional<CarriedSurface> surface, std::optional<CarriedVolume> volume,
                 RenderOptions options);
  ~MotionPictures();
  MotionPictures(MotionPictures&&) noexcept;             ///< move
  MotionPictures& operator=(MotionPictures&&) noexcept;  ///< move

  /// "volume_ends": the volume does not cover all tetrahedra.
  const std::vector<Note>& notes() const;
  /// Sets the motion of the plan. Call once, before draw().
  void show(Motion motion);
  /// Draws a frame, counted from 0. Not thread-safe. Throws DataError if there is nothing to draw, Cancelled.
  Image draw(std::size_t frame, Progress& progress);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
