// Open volumes: their arrays and reconstruction, values at points, lattices, fitted volumes, contents, advice.
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
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume_advice.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volume_read_options.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

class Isosurface;
struct FittedVolume;

// ---- Opening -----------------------------------------------------------------------------------------------------

/// Options that select and read an array of a volume.
struct SANSMESH_API VolumeModelOptions {
  /// "NAME", "NAME:0", "NAME:x" or "NAME:magnitude"; empty: the dataset's default, a scalar if there is one.
  std::string array = {};
  VolumeReconstructionOptions reconstruction = {};  ///< reconstruction of all fields
  VolumeReadOptions read = {};                      ///< reading of the files
  bool bare = false;                                ///< accepts grids without arrays

  /// Option rows without `bare`, which jobs set.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A volume with one selected array. Cheap to copy: copies share all data. Fields are made on demand and kept. Not
/// thread-safe, but threads may share the fields. Errors in the data are thrown as DataError that begins with the name;
/// ArgumentError names options. Each call adds notes on the field to `notes` under the code "reconstruction".
class SANSMESH_API VolumeModel {
 public:
  /// `name` appears in messages: the file. Throws ArgumentError for bad options, DataError if there are no arrays.
  VolumeModel(GridData data, std::string name, const VolumeModelOptions& options = {});
  /// Opens a fitted volume (FitVolumeResult::fitted).
  VolumeModel(const std::shared_ptr<const FittedVolume>& fitted, std::string name,
              const VolumeModelOptions& options = {});
  /// The same volume with another array or method. Throws ArgumentError for bad options.
  VolumeModel(const VolumeModel& volume, const VolumeModelOptions& options);

  /// Name in messages.
  const std::string& name() const;
  /// Options of opening.
  const VolumeModelOptions& options() const;
  /// Notes on the files, with the code "volume".
  std::vector<Note> notes() const;
  /// File format: "VTK XML unstructured grid", …
  const std::string& format() const;
  /// All arrays of the file.
  const std::vector<DatasetArray>& arrays() const;
  /// Times of the steps in the file; empty without steps.
  const std::vector<double>& times() const;

  /// The array selected by `array`, or the dataset's default; a bare grid has an empty name.
  const ArrayChoice& choice() const;
  /// The selected array. Throws ArgumentError if there is none.
  const DatasetArray& array() const;
  /// Name of the selected array with its component: "V_0", "V_magnitude".
  std::string array_name() const;
  /// Whether the array has several components and none is selected.
  bool is_vector() const;
  /// Parses a choice. Throws ArgumentError, which names `field`, for unknown arrays and components.
  ArrayChoice choose(const std::string& text, const std::string& field = "array") const;
  /// The same choice as a scalar: the length of a vector unless a component is selected.
  ArrayChoice as_scalar(ArrayChoice choice) const;
  /// Parses a choice as a scalar; errors name `field`.
  ArrayChoice scalar_choice(const std::string& name, const std::string& field) const;

  /// Samples of the array.
  std::shared_ptr<const SampledVolume> samples(Progress& progress) const;
  /// Statistics of the values and choices derived from them; measured at the first call.
  const VolumeTraits& traits(Progress& progress) const;
  /// The method that suits them.
  const VolumeReconstructionChoice& recommended(Progress& progress) const;

  /// Reconstruction of the selected array, or of another array or component, with the same method. It owns its data.
  std::shared_ptr<const VolumeField> field(Progress& progress, std::vector<Note>& notes) const;
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice, Progress& progress,
                                           std::vector<Note>& notes) const;  ///< for any array
  /// Isosurface {f = value} of the array, for jobs that accept surfaces. Throws ArgumentError if the array has several
  /// components and none is selected.
  std::shared_ptr<const Isosurface> isosurface(double value, Progress& progress, std::vector<Note>& notes) const;
  /// Method of the first field, with the reason if the library chose it.
  const VolumeReconstructionReport& report() const;

  /// Value of sample i of the selected array (the magnitude of a whole vector). Requires an earlier call of samples().
  double sample_value(std::size_t i) const;
  /// Middle of the range of the array or component. Throws DataError if it has no finite value.
  double middle_value() const;
  /// The value, or the middle of the range. Throws ArgumentError for vectors, whose lengths have no default value.
  double value_or_middle(const std::optional<double>& value) const;
  /// Throws ArgumentError if the array has several components and none is selected.
  void check_scalar() const;

  /// Internal state.
  struct State;
  explicit VolumeModel(std::shared_ptr<State> state);  ///< for the library only
  State& state() const { return *state_; }             ///< for the library only

 private:
  std::shared_ptr<State> state_;
};

/// Reads a volume; several files are its blocks. Throws FileError, ArgumentError for bad options (also raw file options
/// for a fitted volume), and DataError if there are no arrays.
SANSMESH_API VolumeModel open_volume(const std::vector<std::string>& files, const VolumeModelOptions& options,
                                     Progress& progress);

/// "a.vtu", "a.vts and 2 other files".
SANSMESH_API std::string volume_name(const std::vector<std::string>& files);

/// A volume as it was used.
struct SANSMESH_API VolumeUse {
  std::string format;                    ///< format of its file
  std::string array;                     ///< selected array
  std::string method;                    ///< reconstruction method; empty without one
  std::string why;                       ///< reason for the method, if the library chose it
  std::size_t samples = 0;               ///< samples of the array
  std::string grid;                      ///< description of the grid
  std::vector<std::string> notes;        ///< notes on the values
  double smoothing = 0;                  ///< factor of the noise by which the samples were smoothed; 0: not smoothed
  double noise = 0;                      ///< deviation of the noise (unit of the array), if the samples were smoothed
  std::string noise_kind;                ///< "white", "correlated" or "Rician"; empty if it is not known
  std::optional<bool> interpolate = {};  ///< false: a method as printed, which does not pass through the samples
  std::optional<bool> logarithm = {};    ///< whether the logarithm is reconstructed, once a field is made
  std::optional<CellValues> cell_values = {};  ///< meaning of values in cells, once a field is made

  static const ReportSchema& schema();  ///< report rows
};

/// Array, method and samples used so far.
SANSMESH_API VolumeUse volume_use(const VolumeModel& volume, Progress& progress);

/// Reconstruction method with its reason, and the samples, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const VolumeModel& volume, Progress& progress);

/// A volume that changes in time, with all steps open at once.
struct SANSMESH_API VolumeSeries {
  std::vector<VolumeModel> steps;  ///< at least two; all have the array and method of the first
  std::vector<double> times;       ///< times of the steps
  std::string name;                ///< name of the files
  std::vector<Note> notes;         ///< notes from reading all steps

  static const ReportSchema& schema();  ///< report rows
};

/// Opens all steps of a file, or one file per step. `times`: all times of files, or the first and the interval; default
/// 0, 1, 2, …. Throws as open_volume and VolumeModel::field (for the first step, which determines the method),
/// ArgumentError for other numbers of times, DataError if there is only one step.
SANSMESH_API VolumeSeries open_volume_series(const std::vector<std::string>& files, const VolumeModelOptions& options,
                                             const std::vector<double>& times, Progress& progress);

// ---- Values ------------------------------------------------------------------------------------------------------

/// Report of probe_volume().
struct SANSMESH_API ProbeReport {
  VolumeReconstructionReport reconstruction;  ///< report of the field
  std::size_t inside = 0;                     ///< points in the volume

  static const ReportSchema& schema();  ///< report rows
};

/// Values of a volume at points. The value of component c at point i has index i * names.size() + c.
struct ProbeResult {
  std::vector<Vec3> points;          ///< as given
  std::vector<std::string> names;    ///< names of the components: the array's, or NAME_0, NAME_1, …
  std::vector<double> values;        ///< unit of the array
  std::vector<Vec3> gradients;       ///< values per length
  std::vector<std::uint8_t> inside;  ///< 1 inside the volume; values outside are extrapolated from its boundary
  ProbeReport report;                ///< how they were computed
  /// Those of VolumeModel::field; "outside": no point is in the volume.
  std::vector<Note> notes;
};

/// Values and gradients of the volume's array. Points that are not finite count as outside. Throws as
/// VolumeModel::field, Cancelled.
SANSMESH_API ProbeResult probe_volume(const VolumeModel& volume, std::span<const Vec3> points, Progress& progress);

/// Value of one component at a point.
struct SANSMESH_API ProbedValue {
  Vec3 at;              ///< the point
  std::string name;     ///< name of the component
  double value = 0;     ///< unit of the array
  Vec3 gradient;        ///< values per length
  bool inside = false;  ///< point is inside the volume

  static const ReportSchema& schema();  ///< report rows
};

/// All values, ordered by point, then by component.
SANSMESH_API std::vector<ProbedValue> probed_values(const ProbeResult& probed);

/// Number of points inside, and the values of up to twenty points; as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const ProbeResult& probed);

/// CSV table with one row per point: x,y,z,NAME,NAME_dx,NAME_dy,NAME_dz,inside.
SANSMESH_API std::string probe_table(const ProbeResult& probed);

/// Report of resample().
struct SANSMESH_API ResampleReport {
  VolumeReconstructionReport reconstruction;  ///< report of the field
  std::array<std::size_t, 3> size{};          ///< values along the axes
  double inside = 0;                          ///< share of the values inside the volume

  static const ReportSchema& schema();  ///< report rows
};

/// "128 × 64 × 64 values, 93.1 % in the volume".
SANSMESH_API std::string lattice_words(const std::array<std::size_t, 3>& size, double inside);

/// A volume on a uniform grid.
struct ResampleResult {
  GridBlock block;          ///< arrays NAME (float) and `inside` (uint8: 1 inside the volume) at its points
  ResampleReport report;    ///< how it was filled
  std::vector<Note> notes;  ///< those of VolumeModel::field
};

/// Resamples the volume's array. Throws as VolumeModel::field, ArgumentError for bad options, DataError if values do
/// not fit into floats, Cancelled.
SANSMESH_API ResampleResult resample(const VolumeModel& volume, const ResampleOptions& options, Progress& progress);

// ---- Smoothing ---------------------------------------------------------------------------------------------------

/// Options of smoothed samples. The factor of the noise is `smoothing` of the volume's reconstruction.
struct SANSMESH_API SmoothVolumeOptions {
  bool all_arrays = false;  ///< smooths all arrays of the same samples, not only the selected one
  bool deviations = false;  ///< adds an array NAME_deviation: the estimated remaining deviation (unit of the array)

  /// Option rows, one per field.
  static const OptionSchema& schema();
};

/// Noise of one array.
struct SANSMESH_API SmoothedArray {
  std::string name;      ///< name of the array
  double smoothing = 0;  ///< factor of the noise; 0: no noise was found, and the values are unchanged
  double noise = 0;      ///< deviation of the noise (unit of the array; of the component with most); 0 if unchanged
  std::string kind;      ///< "white", "correlated" or "Rician"; empty without noise

  static const ReportSchema& schema();  ///< report rows
};

/// Report of smooth_volume().
struct SANSMESH_API SmoothVolumeReport {
  std::size_t samples = 0;            ///< samples of the volume
  std::vector<SmoothedArray> arrays;  ///< smoothed arrays

  static const ReportSchema& schema();  ///< report rows
};

/// Smoothed samples on their own grid.
struct SmoothVolumeResult {
  std::shared_ptr<const SampledVolume> samples;  ///< samples, cells, and only the smoothed arrays
  SmoothVolumeReport report;                     ///< noise of each array
  std::vector<Note> notes;  ///< "no_noise": no array was changed; "too_many": noise was found, but not smoothed
};

/// Smooths the samples by what their noise asks for and keeps steps. Throws ArgumentError if options of a
/// reconstruction other than `smoothing` are set, DataError, Cancelled.
SANSMESH_API SmoothVolumeResult smooth_volume(const VolumeModel& volume, const SmoothVolumeOptions& options,
                                              Progress& progress);

/// Throws FileError or ArgumentError, before any work, if write_smoothed() cannot write the results of these options
/// to `file`.
SANSMESH_API void check_smoothed_writable(const std::string& file, const VolumeModel& volume,
                                          const SmoothVolumeOptions& options, Progress& progress);

/// Noise of each array as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const SmoothVolumeReport& report);

/// Writes smoothed samples: .vtu (any grid), .vti (uniform grids with values at points), .mhd, .mha or .nrrd (such
/// grids with one array). Throws FileError, ArgumentError for other grids and for more arrays.
SANSMESH_API void write_smoothed(const std::string& file, const SmoothVolumeResult& smoothed);

// ---- Fitting -----------------------------------------------------------------------------------------------------

/// Options of a fitted volume.
struct SANSMESH_API FitVolumeOptions {
  bool all_arrays = false;  ///< keeps the other arrays as well

  /// Option rows, one per field.
  static const OptionSchema& schema();
};

/// Report of fit_volume().
struct SANSMESH_API FitVolumeReport {
  VolumeReconstructionReport reconstruction;  ///< report of the field
  std::size_t samples = 0;                    ///< samples of the volume
  std::vector<std::string> arrays;            ///< arrays that are kept
  std::vector<std::size_t> by_degree;  ///< polynomials of degree 0, 1, …; empty for methods without coefficients

  static const ReportSchema& schema();  ///< report rows
};

/// Volume with a stored reconstruction. Cheap to copy.
struct FitVolumeResult {
  std::shared_ptr<const FittedVolume> fitted;  ///< input of write_fit and of a VolumeModel
  FitVolumeReport report;                      ///< statistics
  /// Those of VolumeModel::field; "no_coefficients": the method has none and is set up again at each use.
  std::vector<Note> notes;
};

/// Fits all components of the volume's array. Throws ArgumentError if only a component was selected, as
/// VolumeModel::field, Cancelled.
SANSMESH_API FitVolumeResult fit_volume(const VolumeModel& volume, const FitVolumeOptions& options, Progress& progress);

/// Writes a file (.smv, .smv.gz) for open_volume, atomically. Throws FileError, also for other endings.
SANSMESH_API void write_fit(const std::string& file, const FitVolumeResult& fit);

// ---- Contents ----------------------------------------------------------------------------------------------------

/// Reconstruction stored in a fitted volume.
struct SANSMESH_API HeldReconstruction {
  std::string array;                    ///< name of the array
  VolumeReconstructionOptions options;  ///< options with values chosen from the data
  std::vector<std::size_t> by_degree;   ///< as in FitVolumeReport
  double noise = 0;  ///< deviation of the noise without which the file also keeps the samples; 0: only as they are

  static const ReportSchema& schema();  ///< report rows
};

/// Contents of a volume file.
struct SANSMESH_API VolumeInfo {
  std::string format;                             ///< file format
  VolumeFacts facts;                              ///< facts about the grid
  std::size_t samples = 0;                        ///< samples of the array
  bool in_cells = false;                          ///< whether values belong to cells
  Box3 box;                                       ///< bounding box of the samples
  std::vector<AttributeInfo> arrays;              ///< all arrays of the file
  std::optional<HeldReconstruction> fitted = {};  ///< for a fitted volume
  std::vector<double> times;                      ///< times of the steps
  std::vector<std::string> file_notes;            ///< notes on reading the file
  std::optional<double> noise =
      {};                       ///< deviation of the noise of the selected array (unit of the array); 0: none found
  std::string noise_kind = {};  ///< "white", "correlated" or "Rician"; empty without noise
  /// Information, and what was dropped or repaired: "merged", "not_finite", "hidden", "overlapped", "degenerate",
  /// "inverted", "layer".
  std::vector<Note> notes = {};

  static const ReportSchema& schema();  ///< report rows
};

/// Describes a volume, also a bare grid if the model may be one. Throws DataError if the data are unusable, Cancelled.
SANSMESH_API VolumeInfo volume_info(const VolumeModel& volume, Progress& progress);

/// All facts as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const VolumeInfo& info);

/// Estimated errors of linear interpolation.
struct SANSMESH_API ResolutionReport {
  std::string array;      ///< array
  double range = 0;       ///< range of its values; of vectors the diagonal of the box of their components
  double mean = 0;        ///< mean over the samples (unit of the array)
  double median = 0;      ///< median
  double high = 0;        ///< 99 % of the samples have at most this error
  double most = 0;        ///< largest error
  Vec3 most_at = {};      ///< its sample
  double unresolved = 0;  ///< share of samples at which polynomials of neighbours disagree
  double finer = 1;       ///< factor of the samples per length for errors of 1 % of the range at 99 % of the samples

  static const ReportSchema& schema();  ///< report rows
};

/// The estimated errors of a volume.
struct ResolutionResult {
  std::shared_ptr<const SampledVolume> samples;  ///< samples and cells, with an array "error": mean over their cells
  ResolutionReport report;                       ///< statistics
  std::vector<Note> notes;                       ///< "unresolved": at a third of the samples polynomials disagree
};

/// Estimates the error of linear interpolation in the cells of each sample by what polynomials of higher degree predict
/// (docs/methods/volume-resolution.md). Throws ArgumentError without an array, DataError, Cancelled.
SANSMESH_API ResolutionResult estimate_resolution(const VolumeModel& volume, Progress& progress);

/// Statistics as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const ResolutionReport& report);

/// Writes the array "error" as write_smoothed().
SANSMESH_API void write_resolution(const std::string& file, const ResolutionResult& resolution);

/// The array "error" as a volume, for pictures.
SANSMESH_API VolumeModel resolution_volume(const ResolutionResult& resolution, const std::string& name);

/// Advice on a volume: possible results, methods and arrays.
struct SANSMESH_API VolumeAdvice {
  VolumeFacts facts;        ///< facts about the grid
  VolumeAdviceInput offer;  ///< available results, with statistics of the array and the recommended method
  std::vector<VolumeRecommendation> recommendations;  ///< best first
  std::string array;  ///< array for surfaces and pictures (the magnitude of vectors); empty for bare grids
  double value = 0;   ///< isovalue: the middle of the range; for vectors, the mean length
  std::string flow;   ///< array of vectors; empty if there is none
  /// Ends of a seed line across the flow, through the middle of the box, for flow surfaces.
  std::optional<std::array<Vec3, 2>> seeds;

  static const ReportSchema& schema();  ///< report rows
};

/// Throws DataError if there is neither an array nor a body, Cancelled.
SANSMESH_API VolumeAdvice advise(const VolumeModel& volume, Progress& progress);

/// Description of the volume and the recommended method, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const VolumeAdvice& advice);

}  // namespace sansmesh::inline v1
