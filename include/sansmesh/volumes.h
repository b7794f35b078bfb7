// Volumes that are open: their arrays, the one that is looked at, the reconstruction that makes fields of them, and
// what these say: values at points, lattices, fitted volumes, contents, advice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/points.h"
#include "sansmesh/progress.h"
#include "sansmesh/reconstruction_options.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_advice.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

class Isosurface;
struct FittedVolume;

// ---- Opening -----------------------------------------------------------------------------------------------------

/// Which array of a volume is looked at, and how it is read.
struct SANSMESH_API VolumeModelOptions {
  /// "NAME", "NAME:0", "NAME:x" or "NAME:magnitude"; empty: the dataset's own choice, a scalar where there is one.
  std::string array = {};
  ReconstructionOptions reconstruction = {};  ///< of all fields
  VolumeReadOptions read = {};                ///< of the files
  bool bare = false;                          ///< grids without any arrays are no error

  /// The rows of these options, without `bare`, which jobs decide.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A volume with one array that is looked at. Cheap to copy: copies share all that was read and made. Fields are made
/// when they are asked for, and kept; not safe from several threads, which may share the fields themselves. Errors of
/// the data are thrown as DataError that begins with the name; ArgumentError names options. What there is to say of a
/// field is added to `notes` with the code "reconstruction", at every call.
class SANSMESH_API VolumeModel {
 public:
  /// `name` stands in messages: the file. Throws ArgumentError for bad options, DataError where there are no arrays.
  VolumeModel(GridData data, std::string name, const VolumeModelOptions& options = {});
  /// The same of a volume that was fitted (FitVolumeResult::fitted).
  VolumeModel(const std::shared_ptr<const FittedVolume>& fitted, std::string name,
              const VolumeModelOptions& options = {});
  /// The same volume, another array or another method. Throws ArgumentError for bad options.
  VolumeModel(const VolumeModel& volume, const VolumeModelOptions& options);

  /// What it is called in messages.
  const std::string& name() const;
  /// As it was opened.
  const VolumeModelOptions& options() const;
  /// Of the files, with the code "volume".
  std::vector<Note> notes() const;
  /// "VTK XML unstructured grid", …
  const std::string& format() const;
  /// All that the file holds.
  const std::vector<DatasetArray>& arrays() const;
  /// Of the steps that the file holds; empty where there are none.
  const std::vector<double>& times() const;

  /// What `array` says, or the dataset's own choice; of a bare grid no name.
  const ArrayChoice& choice() const;
  /// The array that is looked at. Throws ArgumentError where there is none.
  const DatasetArray& array() const;
  /// What to call it: the array with its component, "V_0", "V_magnitude".
  std::string array_name() const;
  /// All components of several, none chosen.
  bool is_vector() const;
  /// The choice that a text names. Throws ArgumentError, which names `field`, for names of no array and components that
  /// it has not.
  ArrayChoice choose(const std::string& text, const std::string& field = "array") const;
  /// The same choice; of vectors the length, unless a component is chosen.
  ArrayChoice as_scalar(ArrayChoice choice) const;
  /// The array of that name so; `field` is what errors call it.
  ArrayChoice scalar_choice(const std::string& name, const std::string& field) const;

  /// The samples of the array.
  std::shared_ptr<const SampledVolume> samples(Progress& progress) const;
  /// What its values are like, and what is chosen for them: measured at the first call.
  const VolumeTraits& traits(Progress& progress) const;
  /// The method that suits them.
  const ReconstructionChoice& recommended(Progress& progress) const;

  /// The reconstruction of the array, or of another one (or component) with the method of this. It owns what it needs.
  std::shared_ptr<const VolumeField> field(Progress& progress, std::vector<Note>& notes) const;
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice, Progress& progress,
                                           std::vector<Note>& notes) const;  ///< of any array
  /// {f = value} of the array, for jobs that take surfaces. Throws ArgumentError where the array has several components
  /// and none was chosen.
  std::shared_ptr<const Isosurface> isosurface(double value, Progress& progress, std::vector<Note>& notes) const;
  /// Of the first field that was made: by which method, and why if the library chose it.
  const ReconstructionReport& report() const;

  /// Value of sample i of the array as chosen (its magnitude, where a vector is asked for as a whole). Samples must
  /// have been asked for.
  double sample_value(std::size_t i) const;
  /// The middle of the range of the array, or of its component. Throws DataError where it has no finite value.
  double middle_value() const;
  /// The value, or the middle of the range. Throws ArgumentError for vectors, whose lengths have none.
  double value_or_middle(const std::optional<double>& value) const;
  /// Throws ArgumentError where the array has several components and none was chosen.
  void check_scalar() const;

  /// Of the library.
  struct State;
  explicit VolumeModel(std::shared_ptr<State> state);  ///< of the library
  State& state() const { return *state_; }             ///< of the library

 private:
  std::shared_ptr<State> state_;
};

/// Reads a volume; several files are its blocks. Throws FileError, ArgumentError for bad options, those of raw files
/// with a fitted volume among them, and DataError where there are no arrays.
SANSMESH_API VolumeModel open_volume(const std::vector<std::string>& files, const VolumeModelOptions& options,
                                     Progress& progress);

/// "a.vtu", "a.vts and 2 other files".
SANSMESH_API std::string volume_name(const std::vector<std::string>& files);

/// A volume as it was used.
struct SANSMESH_API VolumeUse {
  std::string format;              ///< of its file
  std::string array;               ///< that was looked at
  std::string method;              ///< of reconstruction; empty without one
  std::string why;                 ///< the reason for that, if the library chose it
  std::size_t samples = 0;         ///< of the array
  std::string grid;                ///< in words
  std::vector<std::string> notes;  ///< on the values

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Array, method and samples that were used of a volume so far.
SANSMESH_API VolumeUse volume_use(const VolumeModel& volume, Progress& progress);

/// The method of reconstruction with its reason, and the samples, in a line for people each.
SANSMESH_API std::vector<std::string> summary_of(const VolumeModel& volume, Progress& progress);

/// A volume that changes in time: its steps, all open at once.
struct SANSMESH_API VolumeSeries {
  std::vector<VolumeModel> steps;  ///< two at least; array and method of all are those of the first
  std::vector<double> times;       ///< of the steps
  std::string name;                ///< of the files
  std::vector<Note> notes;         ///< of reading, of all steps

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// All steps of a file, or several files one after the other. `times`: of files, each, or the first and the step
/// between them; 0, 1, 2, … if there are none. Throws as open_volume and VolumeModel::field (of the first step, whose
/// method is chosen here), ArgumentError for other numbers of times, DataError where there is one step only.
SANSMESH_API VolumeSeries open_volume_series(const std::vector<std::string>& files, const VolumeModelOptions& options,
                                             const std::vector<double>& times, Progress& progress);

// ---- Values ------------------------------------------------------------------------------------------------------

/// How values at points were found.
struct SANSMESH_API ProbeReport {
  ReconstructionReport reconstruction;  ///< of the field
  std::size_t inside = 0;               ///< points in the volume

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Values of a volume at points. Of point i and component c the value stands at i * names.size() + c.
struct ProbeResult {
  std::vector<Vec3> points;          ///< as they were given
  std::vector<std::string> names;    ///< of the components: the array's, or NAME_0, NAME_1, …
  std::vector<double> values;        ///< unit of the array
  std::vector<Vec3> gradients;       ///< values per length
  std::vector<std::uint8_t> inside;  ///< 1 in the volume; elsewhere values go on from its boundary
  ProbeReport report;                ///< how they were found
  /// Those of VolumeModel::field; "outside": no point lies in the volume.
  std::vector<Note> notes;
};

/// Values and gradients of the array that the volume was opened with. Points that are not finite are outside. Throws as
/// VolumeModel::field, Cancelled.
SANSMESH_API ProbeResult probe_volume(const VolumeModel& volume, std::span<const Vec3> points, Progress& progress);

/// Value of one component at a point.
struct SANSMESH_API ProbedValue {
  Vec3 at;              ///< the point
  std::string name;     ///< of the component
  double value = 0;     ///< unit of the array
  Vec3 gradient;        ///< values per length
  bool inside = false;  ///< in the volume

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// A point after the other, and of each its components.
SANSMESH_API std::vector<ProbedValue> probed_values(const ProbeResult& probed);

/// The points in the volume and, of twenty at most, each with its values; in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const ProbeResult& probed);

/// A row a point: x,y,z,NAME,NAME_dx,NAME_dy,NAME_dz,inside.
SANSMESH_API std::string probe_table(const ProbeResult& probed);

/// How a grid was filled.
struct SANSMESH_API ResampleReport {
  ReconstructionReport reconstruction;  ///< of the field
  std::array<std::size_t, 3> size{};    ///< values along the axes
  double inside = 0;                    ///< share of the values that lie in the volume

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// "128 × 64 × 64 values, 93.1 % in the volume".
SANSMESH_API std::string lattice_words(const std::array<std::size_t, 3>& size, double inside);

/// A volume on a uniform grid.
struct ResampleResult {
  GridBlock block;          ///< the arrays NAME (float) and `inside` (uint8: 1 in the volume) at its points
  ResampleReport report;    ///< how it was filled
  std::vector<Note> notes;  ///< those of VolumeModel::field
};

/// The array that the volume was opened with. Throws as VolumeModel::field, ArgumentError for bad options, DataError
/// where values do not fit into floats, Cancelled.
SANSMESH_API ResampleResult resample(const VolumeModel& volume, const ResampleOptions& options, Progress& progress);

// ---- Fitting -----------------------------------------------------------------------------------------------------

/// What is kept beside the array that is fitted.
struct SANSMESH_API FitVolumeOptions {
  bool all_arrays = false;  ///< keep the other arrays as well

  /// The rows of these options.
  static const OptionSchema& schema();
};

/// A fit in numbers.
struct SANSMESH_API FitVolumeReport {
  ReconstructionReport reconstruction;  ///< of the field
  std::size_t samples = 0;              ///< of the volume
  std::vector<std::string> arrays;      ///< that are kept
  std::vector<std::size_t> by_degree;   ///< polynomials of degree 0, 1, …; empty for methods without coefficients

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// A volume with its reconstruction, to be kept. Cheap to copy.
struct FitVolumeResult {
  std::shared_ptr<const FittedVolume> fitted;  ///< what write_fit writes, and a VolumeModel is made of
  FitVolumeReport report;                      ///< the fit in numbers
  /// Those of VolumeModel::field; "no_coefficients": the method has none, and is set up again at each use.
  std::vector<Note> notes;
};

/// The array that the volume was opened with, all its components. Throws ArgumentError where only a component of it was
/// chosen, as VolumeModel::field, Cancelled.
SANSMESH_API FitVolumeResult fit_volume(const VolumeModel& volume, const FitVolumeOptions& options, Progress& progress);

/// Writes a file (.smv, .smv.gz) that open_volume reads, whole or not at all. Throws FileError, also for other endings.
SANSMESH_API void write_fit(const std::string& file, const FitVolumeResult& fit);

// ---- Contents ----------------------------------------------------------------------------------------------------

/// The reconstruction that a fitted volume holds.
struct SANSMESH_API HeldReconstruction {
  std::string array;                   ///< its name
  ReconstructionOptions options;       ///< with what was chosen from the data
  std::vector<std::size_t> by_degree;  ///< as in FitVolumeReport

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Contents of a file of a volume.
struct SANSMESH_API VolumeInfo {
  std::string format;                             ///< of the file
  VolumeFacts facts;                              ///< on the grid
  std::size_t samples = 0;                        ///< of the array
  bool in_cells = false;                          ///< values are those of cells
  Box3 box;                                       ///< around the samples
  std::vector<AttributeInfo> arrays;              ///< all of the file
  std::optional<HeldReconstruction> fitted = {};  ///< of a fitted volume
  std::vector<double> times;                      ///< of the steps
  std::vector<std::string> file_notes;            ///< on how the file was read
  /// Information, what was left out or mended: "merged", "not_finite", "hidden", "overlapped", "degenerate",
  /// "inverted", "layer".
  std::vector<Note> notes = {};

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Bare grids too, where the model may be one. Throws DataError where nothing can be made of them, Cancelled.
SANSMESH_API VolumeInfo volume_info(const VolumeModel& volume, Progress& progress);

/// All of it in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const VolumeInfo& info);

/// Advice on a volume: what can be made of it, by which method and with which arrays.
struct SANSMESH_API VolumeAdvice {
  VolumeFacts facts;  ///< on the grid
  VolumeOffer offer;  ///< what there is, with traits of the array and the method that suits it
  std::vector<VolumeRecommendation> recommendations;  ///< the first choice first
  std::string array;  ///< that surfaces and pictures are of: of vectors the magnitude; empty of bare grids
  double value = 0;   ///< of surfaces: the middle of the range, of vectors the mean of their lengths
  std::string flow;   ///< the array of vectors; empty if there is none
  /// Ends of a line across the flow, through the middle of the box, that surfaces of the flow may start from.
  std::optional<std::array<Vec3, 2>> seeds;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Throws DataError where there is neither an array nor a body, Cancelled.
SANSMESH_API VolumeAdvice advise(const VolumeModel& volume, Progress& progress);

/// What the volume is like, and the method that suits it, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const VolumeAdvice& advice);

}  // namespace sansmesh::inline v1
