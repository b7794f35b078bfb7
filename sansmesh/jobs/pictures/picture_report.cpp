#include "sansmesh/pictures.h"

namespace sansmesh::inline v1 {

const ReportSchema& DrawnObject::schema() {
  static constexpr ReportRow rows[] = {
      reported<&DrawnObject::kind>({.text = "Kind of the object", .choices = kObjectWords}),
      reported<&DrawnObject::title>({.name = "name", .text = "Name in the legend"}),
      reported<&DrawnObject::color>({.text = "Colour, #rrggbb or own"}),
      reported<&DrawnObject::opacity>({.text = "Opacity", .unit = "share"})};
  return report_schema<rows>();
}

const ReportSchema& RenderReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const RenderReport& r) { return r.surface ? std::optional(r.surface->samples) : std::nullopt; }>(
          {.name = "input.samples", .text = "Samples of a surface without a mesh"}),
      reported<&RenderReport::surface>({.text = "Surface drawn without a mesh"}),
      reported<&RenderReport::splats>({.text = "Splats, instead of rays"}),
      reported<&RenderReport::rays>({.text = "Rays cast at that surface"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
