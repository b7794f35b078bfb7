// Bodies of tetrahedra that move by forces: read, planned, moved, and what they carry.
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

/// A body of tetrahedra as a file holds it. Cheap to copy.
struct SANSMESH_API SimulationBody {
  std::shared_ptr<const TetDataset> tets;         ///< of the library
  std::string file = {};                          ///< that it was read from
  const TetMesh& mesh() const;                    ///< in the unit of the file
  const std::vector<std::string>& notes() const;  ///< what was turned, cut or left out, one line each
  /// The vertex that the file calls so. Throws DataError where there is none, or no tetrahedron uses it.
  std::uint32_t vertex(std::uint64_t number) const;
};

/// The cells of a volume as tetrahedra: hexahedra, wedges and pyramids are cut, inverted ones turned. Throws FileError,
/// DataError where there are none, a position is not finite, or a tetrahedron has no volume.
SANSMESH_API SimulationBody read_body(const std::string& file);

/// The scene of a file (docs/formats/scene.md), and the vertices of another (.bou) that stay where they are; either may
/// be empty. `z_up`: that z points up whatever the scene says. Throws FileError.
SANSMESH_API SceneScript read_scene(const std::string& file, const std::string& fixed, const SimulationBody& body,
                                    bool z_up);

// ---- Planning ----------------------------------------------------------------------------------------------------

/// What the scene, or nobody, says of a body. What is not given here either follows from the data.
struct SANSMESH_API SimulateOptions {
  std::optional<SoftBodyModel> model = {};     ///< default: springs, but with `young`
  std::optional<double> stiffness = {};        ///< of springs, N/m, > 0
  std::optional<double> young = {};            ///< Young's modulus, Pa, > 0
  std::optional<double> poisson = {};          ///< Poisson's ratio, 0..0.49
  std::optional<double> damping = {};          ///< of springs, N s/m; of elasticity, s; >= 0
  std::optional<double> density = {};          ///< kg/m³, > 0
  std::optional<LengthUnit> unit = {};         ///< of lengths in the body's file and the scene
  std::optional<double> duration = {};         ///< s, > 0. Of `duration`, `fps` and `frames` two at most
  std::optional<double> fps = {};              ///< frames a second, > 0
  std::optional<int> frames = {};              ///< the body at rest among them, >= 2
  std::optional<std::string> integrator = {};  ///< by name; default: implicit-euler
  std::optional<double> longest_step = {};     ///< s, > 0
  bool z_up = false;                           ///< gravity pulls along −z, whatever the scene says

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the option.
  void validate() const;
};

/// What a body is made of, what acts on it, and in which steps it will move.
struct SANSMESH_API SimulationPlan {
  std::string body_file, scene_file;    ///< that errors are of, where the body and the scene came from files
  std::shared_ptr<const TetMesh> rest;  ///< in the unit of its file
  double unit = 1;                      ///< metres of that
  bool z_up = false;                    ///< z points up
  SoftBodyOptions options;              ///< of the body
  DynamicsScene scene;                  ///< lengths in the file's unit
  bool step_given = false;              ///< by scene or options
  std::size_t frames = 0;               ///< the body at rest among them
  double frame_time = 0;                ///< s
  std::size_t frame_steps = 0;          ///< steps from frame to frame
  /// "mean_material": several materials, their mean is taken; "no_material": cells without one; "unit": it is guessed.
  std::vector<Note> notes;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What the options and the scene say together, and for what neither says: materials of the cells (arrays `density`,
/// `young` and `poisson`), a unit and a material that suit the body (recommended_options), and a floor below it where
/// nothing else keeps it from falling for ever. Throws ArgumentError, SceneError, and DataError for bodies and
/// materials that cannot be simulated.
SANSMESH_API SimulationPlan plan_simulation(TetMesh body, SceneScript scene, const SimulateOptions& options);
/// The same of a body from a file. What cannot be simulated is a FileError of that, or of the scene's file, here and in
/// simulate().
SANSMESH_API SimulationPlan plan_simulation(const SimulationBody& body, SceneScript scene,
                                            const SimulateOptions& options);

// ---- Moving ------------------------------------------------------------------------------------------------------

/// What is kept of a motion beside the moments of its frames.
struct KeptMotion {
  bool positions = true, velocities = true;  ///< of all vertices
};

/// Positions and velocities of all vertices of a body that moved, at moments, in the unit of its file. Cheap to copy:
/// copies share what was kept.
class SANSMESH_API Motion {
 public:
  /// Without any frame.
  Motion();
  Motion(const std::shared_ptr<const TetMesh>& rest, const KeptMotion& kept);  ///< without any frame, of a body
  /// What so many frames take in memory.
  double bytes(std::size_t frames) const;
  /// Positions and velocities in metres; `unit`: metres of the file's unit. All copies get the frame.
  void add(double time, const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities, double unit);

  /// The body at rest.
  const TetMesh& rest() const;
  /// That were kept.
  std::size_t frames() const;
  /// Seconds.
  double time(std::size_t frame) const;
  /// Empty where they were not kept.
  std::vector<Vec3> positions(std::size_t frame) const;
  /// Per second.
  const std::vector<Vec3f>& velocities(std::size_t frame) const;
  /// Middle of the body at rest.
  const Vec3& origin() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// A surface that the tetrahedra carry: their own boundary, or one that lies in them. Cheap to copy.
class SANSMESH_API CarriedSurface {
 public:
  explicit CarriedSurface(const TetMesh& rest);  ///< their own boundary
  /// Throws DataError where a vertex is not finite.
  CarriedSurface(const TetMesh& rest, TriangleMesh surface);
  /// Where the body is at a frame.
  TriangleMesh at(const Motion& motion, std::size_t frame) const;
  /// "outside": vertices that lie in no tetrahedron.
  std::vector<Note> notes() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

/// The surface in a mesh file, or the boundary of the body where there is no name. Throws FileError.
SANSMESH_API CarriedSurface read_carried(const std::string& file, const SimulationPlan& plan);

/// A moment of a simulation, after a step.
struct SimulationMoment {
  BodyEnergies energies;  ///< after the step
  StepReport step;        ///< what it took
};

/// Counts and energies of a simulation.
struct SANSMESH_API SimulateReport {
  std::size_t steps = 0, halvings = 0;    ///< that it took
  std::size_t unsettled = 0;              ///< steps after which contacts would still change
  std::uint64_t iterations = 0;           ///< of conjugate gradients
  double shortest_step = 0;               ///< s
  int most_contacts = 0;                  ///< at the end of a step
  double seconds = 0;                     ///< that it took
  BodyEnergies first, last;               ///< at rest, and in the end
  std::vector<SimulationMoment> moments;  ///< at rest, and where they are asked for after each step

  static const ReportSchema& schema();  ///< a row for each thing that it tells
  /// All moments as a table (CSV): energies, iterations, contacts.
  std::string table() const;
};

/// What was simulated, how long that took and its frames, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const SimulationPlan& plan, const SimulateReport& report);

/// A motion with what there is to say of it.
struct SimulateResult {
  Motion motion;          ///< all its frames
  SimulateReport report;  ///< in numbers
  /// "within_obstacle": vertices begin in one; "unstable_step": longer than the integrator bears; "halved": conjugate
  /// gradients did not converge; "unsettled": contacts changed until the ends of many steps.
  std::vector<Note> notes;
};

/// Moves the body as planned; the moments of all steps are kept where `moments` says so. Throws SceneError for scenes
/// that cannot be, ArgumentError for frames that would take too much memory, DataError where the body explodes,
/// Cancelled.
SANSMESH_API SimulateResult simulate(const SimulationPlan& plan, const KeptMotion& kept, bool moments,
                                     Progress& progress);

// ---- Pictures ----------------------------------------------------------------------------------------------------

/// A volume that is seen through the tetrahedra.
struct CarriedVolume {
  std::shared_ptr<const VolumeField> field = {};  ///< of one component
  bool image = false;                             ///< its samples lie on a lattice
  VolumePictureOptions look = {};                 ///< its own part: what all pictures share is taken from their options
};

/// The array that a volume was opened with, of vectors the length. Throws as VolumeModel::field.
SANSMESH_API CarriedVolume carried_volume(const VolumeModel& volume, Progress& progress, std::vector<Note>& notes);

/// Pictures of all frames from one place, from which the whole motion is seen.
class SANSMESH_API MotionPictures {
 public:
  /// Checks all options before there is any motion; up is as in the plan. Without a surface there is a volume. Throws
  /// ArgumentError.
  MotionPictures(const SimulationPlan& plan, std::optional<CarriedSurface> surface, std::optional<CarriedVolume> volume,
                 RenderOptions options);
  ~MotionPictures();
  MotionPictures(MotionPictures&&) noexcept;             ///< moves
  MotionPictures& operator=(MotionPictures&&) noexcept;  ///< moves

  /// "volume_ends": the volume does not reach everywhere in the tetrahedra.
  const std::vector<Note>& notes() const;
  /// To be called once, before pictures are drawn, with the motion as planned.
  void show(Motion motion);
  /// The picture of a frame of the motion, from 0 on. Not from several threads. Throws DataError where there is nothing
  /// to draw, Cancelled.
  Image draw(std::size_t frame, Progress& progress);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
