#include "sansmesh/meshing/mesh_csg.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/length_limits.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/error.h"
#include "sansmesh/field/piece_expression.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/polygonize/creases/crease_blocks.h"
#include "sansmesh/polygonize/creases/crease_mesh.h"
#include "sansmesh/polygonize/pieces/piece_surface.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kCellsOnDiagonal = 256;
constexpr double kMostCells = 4096;
/// Parts with a resolution of their own use cells of that size, down to this fraction of the usual ones.
constexpr double kFinestShare = 4;
/// Cells across the thinnest parts; below the least number, parts may be missing. Where cells below the usual size
/// would take more than kMostBlocks blocks, as for walls, they are twice as large.
constexpr double kAcross = 2, kLeastAcross = 1;
constexpr std::size_t kMostBlocks = 1'000'000;
/// Default quadric error in cells: a tenth of the error of curved parts.
constexpr double kCsgSimplify = 9.5e-4;
/// By default, simplification is skipped if it could remove a smaller fraction of the vertices, which would not justify
/// its time.
constexpr double kCsgLeastGain = 0.05;
/// A block is flat if it departs from a plane by at most this fraction of the simplification error.
constexpr double kFlat = 0.5;
constexpr double kRounding = 1.0001;
/// Where blocks of two sizes meet, vertices start farther from the surface than two steps of the size of their
/// triangles reach.
constexpr int kRootSteps = 3;

/// Quadric error, over the mean error of the resulting triangles.
constexpr double kQuadricShare = 1.5;
/// Surfaces that coincide within this fraction of the diagonal are identical: far above the rounding of values, below
/// the resolution of float.
constexpr double kTie = 4e-10;
/// Components of fewer cells across are suspicious.
constexpr double kSpeck = 6;
constexpr double kFlatShareOfThickness = 1e-4;
constexpr std::size_t kMostPieceBlocks = 3'000'000;
/// Relative change of the volume by rounding to float above which the mesh is rejected.
constexpr double kMostRoundedAway = 0.01;

/// Extent over distance from the origin below which values are rounded by more than the mesh error.
constexpr double kResolvedShare = 1e-11;

double farthest_coordinate(const Vec3& x) { return std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}); }

/// Region of the surface, found on a coarse grid.
struct Reached {
  Box3 box;  ///< smaller than that of the field: the bounds of a difference are those of its first operand
  /// Smallest blocks that a part with a known resolution needs; infinite: no such part.
  double detail = std::numeric_limits<double>::infinity();
};

Reached look_around(const PiecewiseField& field, const Box3& box, std::optional<double> slope) {
  constexpr std::size_t n = std::size_t{1} << kCreaseBaseLevel;
  const Vec3 step = box.size() * (1.0 / n);
  std::vector<Vec3> centers(n * n * n);
  std::vector<double> values(centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i)
    for (std::size_t k = 0, rest = i; k < 3; ++k, rest /= n)
      centers[i][k] = box.lower[k] + (static_cast<double>(rest % n) + 0.5) * step[k];
  std::vector<Surroundings> around(centers.size());
  field.survey(centers, {norm(step) / 2, 0}, values, around);
  std::vector<ValueRange> ranges(slope ? 0 : centers.size());
  if (!slope) field.ranges(centers, norm(step) / 2, ranges);
  Reached reached;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (slope ? std::abs(values[i]) > *slope * norm(step) / 2 : !ranges[i].holds_zero()) continue;
    reached.box.extend(centers[i] - step * 0.5);
    reached.box.extend(centers[i] + step * 0.5);
    const double detail = around[i].detail;
    if (detail > 0) reached.detail = std::min(reached.detail, detail);
  }
  if (reached.box.empty()) throw DataError("the solid is empty");
  reached.box = common_part(reached.box, box);  // without rounding where nothing was excluded
  return reached;
}

/// Edges of blocks.
struct Cells {
  double smooth;  ///< on curved parts without further information
  double usual;   ///< along creases; at most `smooth`
  double thin;    ///< along creases of thin parts: `usual`, or a half, a quarter … of it
};

/// The requested cell.
double checked_cell(const CsgMeshOptions& options, const Vec3& size, double longest) {
  const double cell = options.cell ? *options.cell : longest / *options.resolution;
  if (longest / cell > kMostCells)
    throw ArgumentError(fmt::format("`cell` {} is too small for a box of {} × {} × {}: at most {} cells along a side",
                                    cell, size.x, size.y, size.z, kMostCells));
  return std::min(cell, longest / 2);
}

Cells cells_of(const Reached& reached, double thickness, const CsgMeshOptions& options) {
  const Box3& box = reached.box;
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) throw DataError("the solid has no extent");
  if (!options.cell && !options.resolution) {
    const double cell = std::min(box.diagonal() / kCellsOnDiagonal, longest / 2);
    // Blocks of one size, without simplification, are independent of the parts.
    if (options.simplify.value_or(1) == 0) return {cell, cell, cell};
    const double least = cell / kFinestShare, usual = std::clamp(reached.detail, least, cell);
    double thin = usual;
    while (thin > thickness / kAcross && thin / 2 >= least) thin /= 2;
    return {cell, usual, thin};
  }
  const double used = checked_cell(options, size, longest);
  return {used, used, used};
}

void measure(const TriangleMesh& mesh, CsgMeshReport& report) {
  const MeshSize size = measure_size(mesh);
  report.area = size.area, report.volume = size.volume;
  const MeshTopology topology = measure_topology(mesh);
  report.components = topology.components;
  report.closed = topology.closed();
}

struct Blocks {
  BlockTree tree;
  double cell;  ///< edge of the smallest block
};

/// Blocks as small as thin parts need, or nearly, if they are not too many and small enough to resolve such parts.
Blocks affordable_blocks(const PiecewiseField& field, const Box3& box, const Cells& cells, double thickness,
                         CreaseBlockOptions sizes, Progress& progress) {
  for (sizes.cell = cells.thin; sizes.cell < cells.usual && sizes.cell <= thickness / kLeastAcross; sizes.cell *= 2)
    if (std::optional<BlockTree> tree = crease_blocks(field, box, sizes, progress, kMostBlocks))
      return {std::move(*tree), sizes.cell};
  sizes.cell = cells.usual;
  return {crease_blocks(field, box, sizes, progress), sizes.cell};
}

Note too_thin_for(double cell, double thickness) {
  return {.code = "too_thin",
          .text = fmt::format("parts or holes may be missing: some are {:.3g} across, cells {:.3g}", thickness, cell)};
}

/// Warns of components that are only a few cells large and may not belong to the solid.
void warn_of_specks(const TriangleMesh& mesh, CsgMeshReport& r) {
  if (r.components < 2) return;
  const MeshComponents components = find_components(mesh);
  std::vector<Box3f> box(components.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) box[components.of_triangle[t]].extend(mesh.vertices[v]);
  std::size_t specks = 0;
  Vec3 at;
  for (const Box3f& b : box) {
    const Vec3f size = b.size();
    if (static_cast<double>(std::max({size.x, size.y, size.z})) > kSpeck * r.cell) continue;
    if (specks++ == 0) at = mesh.origin + Vec3((b.lower + b.upper) * 0.5f);
  }
  if (specks > 0)
    r.notes.push_back(
        {.code = "specks",
         .text = fmt::format("{} of {} {} less than {:g} cells across, such as at ({:.4g}, {:.4g}, {:.4g}): stray, "
                             "perhaps, where surfaces come close to each other or cross",
                             grouped(specks), counted(components.size(), "component"), specks == 1 ? "is" : "are",
                             kSpeck, at.x, at.y, at.z),
         .remedy = "`components = auto` leaves out what is small"});
}

/// As an error: thin parts hidden by others count too, because they cannot be distinguished.
std::string too_thin_for_default(const Box3& box, double cell, double thickness) {
  const Vec3 size = box.size();
  const double finer = 0.9 * thickness;
  const bool may_be_had = std::max({size.x, size.y, size.z}) / finer < 0.9 * kMostCells;
  return fmt::format(
      "some parts are {:.3g} across, and would be missing or broken at cells of {:.3g}: give {}`cell = {:.2g}`, if "
      "they are hidden or may be left out",
      thickness, cell, may_be_had ? fmt::format("`cell = {:.2g}`, or ", finer) : "", cell);
}

TriangleMesh mesh_of_pieces(const PieceExpression& field, const Box3& box, double thickness,
                            const CsgMeshOptions& options, Progress& progress, CsgMeshReport& r) {
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z}), diagonal = box.diagonal();
  PieceSurfaceOptions pieces;
  pieces.most_blocks = kMostPieceBlocks;
  pieces.mesh_error = options.mesh_error.value_or(kCsgMeshError * diagonal);
  pieces.triangles = options.triangles.value_or(0);
  if (options.cell || options.resolution) {
    pieces.cell = checked_cell(options, size, longest);
    pieces.simplify = options.simplify.value_or(kCsgSimplify * pieces.cell);
  } else {
    pieces.simplify = options.simplify.value_or(kQuadricShare * pieces.mesh_error);
  }
  pieces.flat_error = kFlatShareOfThickness * thickness;
  PieceSurfaceReport found;
  TriangleMesh mesh = polygonize_pieces(field, box, box.center(), pieces, progress, found);
  r.cell = found.cell, r.depth = found.depth, r.blocks = found.blocks;
  r.mean_error = found.mean_error, r.largest_error = found.largest_error;
  const bool chosen = pieces.cell > 0;
  if (found.too_many || (found.unresolved > 0 && !chosen)) {
    const double usual = diagonal / kCellsOnDiagonal;
    throw DataError(fmt::format(
        "{}: {}; give a `cell`, such as {:.2g}, and parts thinner than that may be missing",
        std::isfinite(thickness) ? fmt::format("some parts are {:.3g} across", thickness) : "some parts are too thin",
        found.too_many ? fmt::format("more than {} blocks", kMostPieceBlocks)
                       : fmt::format("too thin in a box of {:.3g}", longest),
        usual));
  }
  if (found.unresolved > 0 && thickness < pieces.cell) r.notes.push_back(too_thin_for(pieces.cell, thickness));
  if (mesh.triangles.empty())
    throw DataError(chosen ? fmt::format("the solid is empty, or thinner than the cells of {:.3g}", pieces.cell)
                           : "the solid is empty, or thinner than double precision resolves");
  if (found.unsimplified && pieces.simplify > 0)
    r.notes.push_back({.code = "not_simplified",
                       .text = fmt::format("the mesh has all {} triangles that were cut out: with fewer it would go "
                                           "through itself",
                                           grouped(mesh.triangles.size())),
                       .remedy = fmt::format("a smaller mesh error than {:.2g} may help", pieces.mesh_error)});
  if (found.rounded_away > kMostRoundedAway)
    throw DataError(
        fmt::format("some walls are thinner than the coordinates of meshes (floats) can hold in a box of "
                    "{:.3g}: rounding would change the volume by {:.2g} %",
                    longest, 100 * found.rounded_away));
  finish_csg(mesh, options, r);
  return mesh;
}

TriangleMesh mesh_of(const PiecewiseField& field, const Box3& whole_box, const CsgMeshOptions& options,
                     Progress& progress, CsgMeshReport* report) {
  std::optional<double> slope = field.slope_bound();
  if (slope) *slope *= kRounding;
  const Reached reached = look_around(field, whole_box, slope);
  const Box3& box = reached.box;
  const double thickness = field.thickness();
  CsgMeshReport local;
  CsgMeshReport& r = report ? *report : local;
  r = {};
  r.box = box;
  if (const auto expression = field.expression(kTie * box.diagonal()))
    return mesh_of_pieces(*expression, box, thickness, options, progress, r);
  const Cells cells = cells_of(reached, thickness, options);
  PolygonizeOptions polygonize;
  polygonize.simplify = options.simplify.value_or(
      options.mesh_error ? std::min(kQuadricShare * *options.mesh_error, cells.smooth) : kCsgSimplify * cells.smooth);
  polygonize.triangles = options.triangles.value_or(0);
  polygonize.least_gain = options.simplify || options.mesh_error || options.triangles ? 0 : kCsgLeastGain;
  CreaseBlockOptions sizes;
  sizes.smooth_cell = cells.smooth, sizes.slope = slope;
  if (polygonize.simplify > 0) {
    sizes.flat = kFlat * std::min(polygonize.simplify, kCsgSimplify * cells.smooth);
    polygonize.root_steps = kRootSteps;
  }
  auto [tree, cell] = affordable_blocks(field, box, cells, thickness, sizes, progress);

  const bool too_thin = thickness < kLeastAcross * cell;
  if (too_thin && !options.cell && !options.resolution) throw DataError(too_thin_for_default(box, cell, thickness));
  r.cell = cell, r.depth = tree.depth(), r.blocks = tree.leaves().size();
  TriangleMesh mesh = polygonize_with_creases(field, std::move(tree), box.center(), polygonize, progress);
  if (mesh.triangles.empty())
    throw DataError(fmt::format("the solid is empty, or thinner than the cells of {:.3g}", cell) +
                    (too_thin ? fmt::format(": parts are {:.3g} across; a smaller `cell` shows them", thickness) : ""));
  if (too_thin) r.notes.push_back(too_thin_for(cell, thickness));
  finish_csg(mesh, options, r);
  warn_of_specks(mesh, r);
  return mesh;
}

}  // namespace

Box3 box_of_solid(const PiecewiseField& solid, const CsgMeshOptions& options) {
  const Box3 box = options.box ? common_part(solid.bounds(), *options.box) : solid.bounds();
  if (box.empty()) throw DataError(options.box ? "the solid has no point inside the box" : "the solid is empty");
  std::string endless;
  for (std::size_t k = 0; k < 3; ++k)
    for (const bool upper : {false, true})
      if (!std::isfinite((upper ? box.upper : box.lower)[k]))
        endless += fmt::format("{}{}{}", endless.empty() ? "" : ", ", upper ? '+' : '-', "xyz"[k]);
  if (!endless.empty())
    throw ArgumentError(fmt::format(
        "the solid may be unbounded in the directions {}: intersect it with a box, or clip it with `box`", endless));
  for (std::size_t k = 0; k < 3; ++k)
    if (std::max(std::abs(box.lower[k]), std::abs(box.upper[k])) > kLargestCoordinate)
      throw ArgumentError(fmt::format("the solid reaches out to {:.3g}: coordinates of meshes end at {:.0g}",
                                      std::max(std::abs(box.lower[k]), std::abs(box.upper[k])), kLargestCoordinate));
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  const char* const what = options.box ? "the part of the solid inside the box" : "the solid";
  if (longest < kSmallestExtent)
    throw DataError(
        fmt::format("{} is {:.3g} across: too small for a mesh; the least is {:.0g}", what, longest, kSmallestExtent));
  const double away = std::max(farthest_coordinate(box.lower), farthest_coordinate(box.upper));
  if (longest < kResolvedShare * away)
    throw DataError(
        fmt::format("{} is {:.3g} across and {:.3g} away from the origin: too far away to be resolved; move it "
                    "closer",
                    what, longest, away));
  return box;
}

Solid solid_in_box(const Solid& solid, const Box3& box) {
  return csg::intersect(solid, csg::box(box.lower, box.upper));
}

void finish_csg(TriangleMesh& mesh, const CsgMeshOptions& options, CsgMeshReport& report) {
  MeshReport chosen;
  detail::choose_components(mesh, options.components.value_or(ComponentChoice{ComponentChoice::Kind::all, 1}), {}, 0,
                            chosen);
  report.notes.insert(report.notes.begin(), chosen.notes.begin(), chosen.notes.end());
  measure(mesh, report);
}

const OptionSchema& CsgMeshOptions::schema() {
  using O = CsgMeshOptions;
  static constexpr std::string_view meshers[] = {"auto", "faces", "function"};
  static constexpr OptionRow rows[] = {
      option<&O::mesher>({.text =
                              "faces: exact operations on triangles, which stay where nothing cuts them; function: a "
                              "mesh of the solid's function; auto: faces if all parts have them (curved primitives "
                              "without a mesh: from 100 on)",
                          .choices = meshers}),
      option<&O::mesh_error>({.text = "Accepted mean distance between mesh and surface",
                              .unit = "length",
                              .from_data = "a 50,000th of the box's diagonal; with functions less",
                              .range = positive()}),
      option<&O::triangles>({.text = "Largest number of triangles; `mesh_error` then follows from it",
                             .unit = "count",
                             .range = at_least(4)}),
      option<&O::resolution>(
          {.text = "Number of cells along the longest side of the box, instead of `cell`",
           .unit = "count",
           .from_data = "from the mesh error and thin parts; with functions 256 to 1024 on the box's diagonal",
           .range = {4, kMostCells}}),
      option<&O::cell>({.text = "Edge of the cells", .unit = "length", .range = positive(), .excludes = "resolution"}),
      option<&O::box>({.text = "Clip to this box: x0,y0,z0,x1,y1,z1; required for unbounded solids", .unit = "box"}),
      option<&O::simplify>({.text = "Simplify where the surface is flat to within this; 0: off",
                            .unit = "length",
                            .from_data = "from the mesh error",
                            .range = at_least(0)}),
      option<&O::components>(
          {.text = "Components to keep: auto (at least 1.5 % of the largest one's area), all, largest or a number",
           .unit = "choice",
           .from_data = "auto with functions, otherwise all"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void CsgMeshOptions::validate() const {
  validate_options(*this);
  if (mesher == CsgMesher::faces && (triangles || cell || resolution || simplify))
    throw ArgumentError("`triangles`, `cell`, `resolution` and `simplify` need `mesher = function`");
  if (triangles && simplify && *simplify == 0) throw ArgumentError("`triangles` needs simplification: `simplify` is 0");
  if (!box) return;
  for (std::size_t k = 0; k < 3; ++k)
    if (!(box->lower[k] < box->upper[k]))
      throw ArgumentError(fmt::format("`box`: its lower corner must lie below its upper one, but {} >= {} in {}",
                                      box->lower[k], box->upper[k], "xyz"[k]));
}

TriangleMesh mesh_csg(const PiecewiseField& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report) {
  const CancelScope listening(progress);
  options.validate();
  const Box3 whole_box = box_of_solid(solid, options);
  if (!options.box) return mesh_of(solid, whole_box, options, progress, report);
  const std::shared_ptr<const ScalarField> borrowed(std::shared_ptr<const void>(), &solid);
  return mesh_of(solid_in_box(csg::leaf(borrowed), *options.box), whole_box, options, progress, report);
}

TriangleMesh mesh_csg(const Solid& solid, const CsgMeshOptions& options, Progress& progress, CsgMeshReport* report) {
  const CancelScope listening(progress);
  options.validate();
  const Box3 whole_box = box_of_solid(solid, options);
  return mesh_of(options.box ? solid_in_box(solid, *options.box) : solid, whole_box, options, progress, report);
}

namespace {

constexpr ReportRow kCsgMeshReportRows[] = {
    reported<[](const CsgMeshReport& r) { return r.box.lower; }>(
        {.name = "box.lower", .text = "Lower corner of the bounding box of the surface", .unit = "length"}),
    reported<[](const CsgMeshReport& r) { return r.box.upper; }>(
        {.name = "box.upper", .text = "Upper corner of that box", .unit = "length"}),
    reported<[](const CsgMeshReport& r) { return r.mesher == CsgMesher::faces ? "faces" : "function"; }>(
        {.name = "mesher", .text = "Algorithm: faces or function"}),
    reported<&CsgMeshReport::reason>({.text = "Why this algorithm was used"}),
    reported<&CsgMeshReport::cut_faces>({.text = "With faces: faces of the parts that others cut or touch"}),
    reported<&CsgMeshReport::seam_vertices>({.text = "With faces: vertices where faces intersect"}),
    reported<&CsgMeshReport::cell>({.text = "Edge of the smallest blocks", .unit = "length"}),
    reported<&CsgMeshReport::depth>({.text = "Levels of the tree of blocks"}),
    reported<&CsgMeshReport::blocks>({.text = "Blocks"}),
    reported<&CsgMeshReport::area>({.text = "Area of the mesh", .unit = "length²"}),
    reported<&CsgMeshReport::volume>({.text = "Volume of the mesh", .unit = "length³"}),
    reported<&CsgMeshReport::mean_error>({.text = "Mean distance of the triangles from the surface", .unit = "length"}),
    reported<&CsgMeshReport::largest_error>(
        {.text = "Largest distance of the triangles from the surface", .unit = "length"}),
    reported<&CsgMeshReport::components>({.name = "components", .text = "Connected parts of the mesh"}),
    reported<&CsgMeshReport::closed>({.name = "closed", .text = "Whether the mesh is closed"})};

}  // namespace

const ReportSchema& CsgMeshReport::schema() {
  static constexpr ReportSchema schema{kCsgMeshReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
