#include "sansmesh/mesh_options.h"

#include <fmt/core.h>

#include <limits>

#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kMeshers[] = {"auto", "blocks", "walk"};
constexpr std::string_view kComponents[] = {"auto", "all", "largest"};

constexpr OptionRow kRows[] = {
    option<&MeshOptions::components>(
        {.text = "Components to keep: auto (those with enough samples), all, largest or a number",
         .suggestions = kComponents}),
    option<&MeshOptions::fill_holes>({.text = "Close holes of an open surface up to this width",
                                      .unit = "length",
                                      .from_data = "6 local spacings: gaps between scan lines",
                                      .range = at_least(0)}),
    option<&MeshOptions::trim>({.text = "Remove the surface farther than this from all samples; 0: from data",
                                .unit = "length",
                                .range = at_least(0),
                                .implied = "0"}),
    option<&MeshOptions::close_handles>(
        {.text = "Keep handles and tunnels as narrow as the spacing that no samples support",
         .negative = "keep_handles"}),
    option<&MeshOptions::confidence>(
        {.text = "Write each vertex's distance to the nearest sample and its confidence, 0 to 1",
         .from_data = "if the surface is open",
         .negative_text = "Do not write distance and confidence"}),
    option<&MeshOptions::measure_quality>(
        {.text = "Print aspect ratios of the triangles before and after enhancement", .name = "quality"}),
    option<&MeshOptions::box>({.text = "Clip to this box: x0,y0,z0,x1,y1,z1", .unit = "length"}),
    option<&MeshOptions::mesher>(
        {.text = "blocks: marching whole blocks, with enhancement; walk: the paper's walk from simplex to simplex; "
                 "auto: walk for a fit by the paper's method, else blocks",
         .choices = kMeshers}),
    option<&MeshOptions::mesh_error>({.text = "Accepted mean distance between mesh and surface",
                                      .unit = "length",
                                      .from_data = "from data",
                                      .range = positive()}),
    option<&MeshOptions::triangles>({.text = "Simplify to at most this number of triangles", .range = at_least(4)}),
    option<&MeshOptions::block_depth>({.text = "Deepest level of the blocks; a smaller one is coarser",
                                       .unit = "level",
                                       .from_data = "from the function",
                                       .range = {kLeastDepth, kMostDepth},
                                       .old_name = "depth"}),
    option<&MeshOptions::enhance>({.text = "No clustering, smoothing or simplification of triangles"}),
    option<&MeshOptions::displacement>(
        {.text = "With `enhance = false`, or the walk: displacement of lattice vertices from the surface",
         .unit = "ratio",
         .range = {0, 1, false, true}}),
    option<&MeshOptions::carry_colors>({.text = "Leave out the samples' colours", .negative = "no_colors"})};
constexpr OptionSchema kSchema{kRows};

}  // namespace

std::string text_of_option(const ComponentChoice& choice) {
  using Kind = ComponentChoice::Kind;
  if (choice.kind != Kind::count) return choice.kind == Kind::all ? "all" : "auto";
  return choice.count == 1 ? "largest" : std::to_string(choice.count);
}

void option_of_text(std::string_view word, ComponentChoice& choice) {
  using Kind = ComponentChoice::Kind;
  if (word == "auto") return void(choice = {});
  if (word == "all") return void(choice = {.kind = Kind::all});
  if (word == "largest") return void(choice = {.kind = Kind::count, .count = 1});
  const auto count = whole_in(word, 1, std::numeric_limits<int>::max());
  if (!count)
    throw ArgumentError(ArgumentFault{.field = {},
                                      .value = "'" + printable(word, 60) + "'",
                                      .allowed = "auto, all, largest or a number of at least 1",
                                      .remedy = {}});
  choice = {.kind = Kind::count, .count = static_cast<int>(*count)};
}

const OptionSchema& MeshOptions::schema() { return kSchema; }

void MeshOptions::validate() const {
  const auto check = [](bool ok, const std::string& what) {
    if (!ok) throw ArgumentError(what);
  };
  validate_options(*this);
  check(!triangles || enhance, "`triangles` cannot be combined with `enhance = false`");
  check(displacement == 0 || !enhance || mesher != Mesher::blocks,
        "`displacement` needs `enhance = false`: clustering undoes it");
  if (mesher == Mesher::walk) validate_walk();
  check(components.kind != ComponentChoice::Kind::count || components.count >= 1,
        "the number of `components` must be at least 1");
  check(!box || !box->empty(), "the lower corner of `box` must lie below its upper one");
}

void MeshOptions::validate_walk() const {
  const auto unset = [](bool ok, const char* field) {
    if (!ok) throw ArgumentError(fmt::format("a walk does not use `{}`; it needs `mesher = blocks`", field));
  };
  unset(!mesh_error, "mesh_error");
  unset(!triangles, "triangles");
  unset(!fill_holes, "fill_holes");
  unset(!trim, "trim");
  unset(enhance, "enhance = false");
}

namespace {

/// Measured aspect ratios are at least 1.
std::optional<double> if_measured(const MeshReport& r, double ratio) { return value_if(r.aspect_mean > 0, ratio); }

constexpr ReportRow kMeshReportRows[] = {
    reported<[](const MeshReport& r) { return value_if(r.simplices > 0, r.simplices); }>(
        {.name = "simplices", .text = "Simplices visited by a walk; absent without one"}),
    reported<&MeshReport::blocks>({.text = "Blocks"}),
    reported<&MeshReport::block_depth>({.text = "Deepest level of the tree of blocks"}),
    reported<&MeshReport::lost>(
        {.name = "lost_share", .text = "Share of the samples without a surface", .unit = "share"}),
    reported<&MeshReport::components>({.name = "components", .text = "Connected parts of the mesh"}),
    reported<&MeshReport::genus>({.text = "Handles and tunnels of all components"}),
    reported<&MeshReport::closed_handles>({.name = "handles.closed", .text = "Closed handles that no samples support"}),
    reported<&MeshReport::narrow_handles>(
        {.name = "handles.narrow",
         .text = "Remaining handles narrower than two spacings or four times the noise, or without samples around"}),
    reported<&MeshReport::narrowest_handle>(
        {.name = "handles.narrowest", .text = "Centre of the shortest loop around one of them", .unit = "length"}),
    reported<&MeshReport::mesh_error>(
        {.name = "output.mesh_error", .text = "Target distance between mesh and surface", .unit = "length"}),
    reported<[](const MeshReport& r) { return if_measured(r, r.aspect_mean_before); }>(
        {.name = "aspect_ratio.mean_before", .text = "Mean aspect ratio before enhancement"}),
    reported<[](const MeshReport& r) { return if_measured(r, r.aspect_deviation_before); }>(
        {.name = "aspect_ratio.deviation_before", .text = "Standard deviation of the aspect ratios before"}),
    reported<[](const MeshReport& r) { return if_measured(r, r.aspect_mean); }>(
        {.name = "aspect_ratio.mean", .text = "Mean aspect ratio after enhancement"}),
    reported<[](const MeshReport& r) { return if_measured(r, r.aspect_deviation); }>(
        {.name = "aspect_ratio.deviation", .text = "Standard deviation of the aspect ratios after"})};

}  // namespace

const ReportSchema& MeshReport::schema() {
  static constexpr ReportSchema schema{kMeshReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
