// Area, volume, centre of mass, moments and size of a solid and of its parts.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/jobs/any_surface.h"
#include "sansmesh/measure/body_measures.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct MeasureResult {
  SolidMeasures measures;
  /// "open": no volume; "encloses_nothing": its sides cancel out; "faces_inward": the volume is negative; "cavities";
  /// "inside_out": parts that face inward, but bound no cavity; "nested", "crossing_components", "crosses_itself":
  /// volume that counts more than once; "nonmanifold": edges of more than two triangles; "bad_corners": triangles that
  /// were left out; "mesh": what there is to say of the mesh that was made.
  std::vector<Note> notes;
};

/// Of a function or isosurface its mesh is measured. Throws DataError of points, and if no triangle has an area;
/// Cancelled.
MeasureResult measure(const AnySurface& surface, Progress& progress);

/// All but the parts beyond the twentieth, in lines for people.
std::vector<std::string> summary_of(const SolidMeasures& measures);

}  // namespace sansmesh::inline v1
