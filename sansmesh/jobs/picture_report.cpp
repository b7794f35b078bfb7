#include "sansmesh/pictures.h"

namespace sansmesh::inline v1 {

namespace {

constexpr ReportRow kDrawnObjectRows[] = {
    reported<&DrawnObject::kind>({.text = "Kind of the object", .choices = kObjectWords}),
    reported<&DrawnObject::title>({.name = "name", .text = "Name in the legend"}),
    reported<&DrawnObject::color>({.text = "Colour, #rrggbb or own"}),
    reported<&DrawnObject::opacity>({.text = "Opacity", .unit = "share"})};

}  // namespace

const ReportSchema& DrawnObject::schema() {
  static constexpr ReportSchema schema{kDrawnObjectRows};
  return schema;
}

namespace {

constexpr ReportRow kRenderReportRows[] = {
    reported<[](const RenderReport& r) { return r.surface ? std::optional(r.surface->samples) : std::nullopt; }>(
        {.name = "input.samples", .text = "Samples of a surface without a mesh"}),
    reported<&RenderReport::surface>({.text = "Surface drawn without a mesh"}),
    reported<&RenderReport::splats>({.text = "Splats, instead of rays"}),
    reported<&RenderReport::rays>({.text = "Rays cast at that surface"})};

}  // namespace

const ReportSchema& RenderReport::schema() {
  static constexpr ReportSchema schema{kRenderReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
