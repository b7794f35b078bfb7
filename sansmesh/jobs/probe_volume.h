// Values and gradients of a volume at points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct ProbeReport {
  ReconstructionReport reconstruction;
  std::size_t inside = 0;  ///< points in the volume

  static const ReportSchema& schema();
};

/// Of point i and component c the value stands at i * names.size() + c.
struct ProbeResult {
  std::vector<Vec3> points;
  std::vector<std::string> names;  ///< of the components: the array's, or NAME_0, NAME_1, …
  std::vector<double> values;
  std::vector<Vec3> gradients;
  std::vector<std::uint8_t> inside;  ///< 1 in the volume; elsewhere values go on from its boundary
  ProbeReport report;
  /// Those of VolumeModel::field; "outside": no point lies in the volume.
  std::vector<Note> notes;
};

/// The array that the volume was opened with. Points that are not finite are outside. Throws as VolumeModel::field,
/// Cancelled.
ProbeResult probe_volume(VolumeModel& volume, std::span<const Vec3> points, Progress& progress);

/// One component at a point.
struct ProbedValue {
  Vec3 at;
  std::string name;
  double value = 0;
  Vec3 gradient;
  bool inside = false;

  static const ReportSchema& schema();
};

/// A point after the other, and of each its components.
std::vector<ProbedValue> probed_values(const ProbeResult& probed);

/// A row a point: x,y,z,NAME,NAME_dx,NAME_dy,NAME_dz,inside.
std::string probe_table(const ProbeResult& probed);

}  // namespace sansmesh::inline v1
