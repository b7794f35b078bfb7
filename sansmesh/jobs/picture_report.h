// Report on pictures of surfaces, points and meshes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/jobs/picture_options.h"
#include "sansmesh/jobs/use_picture.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/note.h"
#include "sansmesh/render/surface_caster.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct DrawnObject {
  ObjectKind kind = ObjectKind::mesh;
  std::string title;
  std::string color;  ///< "#rrggbb", or "own"
  double opacity = 1;

  static const ReportSchema& schema();
};

struct RenderReport {
  std::vector<DrawnObject> objects;      ///< where they stand side by side, or are translucent, lines or turned
  std::optional<SurfaceReport> surface;  ///< where a surface is drawn without a mesh
  std::optional<CastCounts> rays;        ///< of that
  std::optional<std::size_t> splats;     ///< in place of rays

  static const ReportSchema& schema();
};

struct RenderResult {
  RenderReport report;
  /// "surface": what there is to say of a surface without a mesh; "outliers": samples that were left out.
  std::vector<Note> notes;
};

}  // namespace sansmesh::inline v1
