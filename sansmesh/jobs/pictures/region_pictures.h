// Close-up pictures of doubtful regions of a surface, seen from outside.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

class RegionPictures {
 public:
  /// The diagnosis must outlive this.
  explicit RegionPictures(const Diagnosis& diagnosis);

  /// Draws a region in the centre of the picture, with a ring around it and a line of text. Only the surface within a
  /// multiple of the region's size is drawn. The view is along the normal. If the region is occluded there, the view
  /// with the largest visible share is used; if hardly any of it is visible, the occluder is cut away. The view in
  /// `options` is ignored.
  Image of(const SuspiciousRegion& region, const std::string& text, RenderOptions options, Progress& progress) const;

 private:
  struct View {
    Vec3 direction;  ///< towards the viewer
    double seen;     ///< visible share of the region
  };
  View best_view(const SuspiciousRegion& region, double reach) const;

  const Diagnosis& diagnosis_;
  Box3f bounds_;
  RayScene rays_;
};

/// Pictures of equal size in rows, from the upper left.
Image contact_sheet(const std::vector<Image>& pictures);

}  // namespace sansmesh::inline v1
