// Pictures that look at suspicious places, each from outside and near enough to see it with what is around.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/function/diagnose_function.h"
#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

class PlacePictures {
 public:
  /// The diagnosis must outlive this.
  explicit PlacePictures(const Diagnosis& diagnosis);

  /// A place in the middle of a picture, with a ring around it and a line of text. Of the surface only what is within
  /// some times its size is drawn. The view is along the normal or, where something else is in front of the place, from
  /// where most of it is seen; where hardly any is, what is in front of it is cut away; their view does not matter.
  Image of(const SuspiciousPlace& place, const std::string& text, RenderOptions options, Progress& progress) const;

 private:
  struct View {
    Vec3 direction;  ///< towards the viewer
    double seen;     ///< share of the place that is
  };
  View best_view(const SuspiciousPlace& place, double reach) const;

  const Diagnosis& diagnosis_;
  Box3f bounds_;
  RayScene rays_;
};

/// Pictures of the same size side by side, in rows from the upper left.
Image contact_sheet(const std::vector<Image>& pictures);

}  // namespace sansmesh::inline v1
