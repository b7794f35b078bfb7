#include "sansmesh/dataset/isosurface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/level_scale.h"
#include "sansmesh/error.h"
#include "sansmesh/field/exponential_volume.h"
#include "sansmesh/field/level_field.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/volume/grid/volume_boundary.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest number of points that determine the scale of the values.
constexpr std::size_t kSlopes = 4096;
/// Edge of the blocks in spacings.
constexpr double kBlock = 1;
/// Largest number of blocks; otherwise blocks are enlarged, with a warning.
constexpr std::size_t kMostIsoBlocks = 6'000'000;
/// Default mesh error in spacings.
constexpr double kIsoError = 0.02;
/// Margin of the cube of blocks around the volume, in blocks on each side: the surface must not reach the cube's faces,
/// where it would be closed.
constexpr double kAroundVolume = 3;
constexpr double kRounding = 1 + 1e-9;
/// Half the diagonal of a block with edge 1.
const double kHalfDiagonal = std::sqrt(0.75);

LocalFrame frame_of(const SampledVolume& volume) {
  const Box3 box = volume.bounds();
  return frame_for(box.center(), box.diagonal());
}

}  // namespace

/// The field whose level set is the surface, and the map of values to its values.
struct Isosurface::Leveled {
  std::shared_ptr<const VolumeField> field;
  double unit = 0;  ///< unit of the logarithm; 0 without
  double of(double value) const { return unit > 0 ? std::log(value / unit) : value; }
  double back(double level) const { return unit > 0 ? std::exp(level) * unit : level; }
};

Isosurface::Leveled Isosurface::leveled(std::shared_ptr<const VolumeField> field, double value) {
  if (const auto* const positive = dynamic_cast<const ExponentialVolume*>(field.get()); positive && value > 0)
    return {positive->logarithm(), positive->factor()};
  return {std::move(field)};
}

namespace {

Box3 own_bounds(const SampledVolume& volume, const LocalFrame& frame) { return frame.from_input(volume.bounds()); }

}  // namespace

// ---- Domain ------------------------------------------------------------------------------------------------------

struct VolumeDomain::Boundary {
  Boundary(const SampledVolume& volume, const LocalFrame& frame) : locator(volume), mesh(boundary(volume, frame)) {}

  static TriangleMesh boundary(const SampledVolume& volume, const LocalFrame& frame) {
    TriangleMesh mesh = volume_boundary(volume);
    move_from_input(mesh, frame);
    return mesh;
  }

  VolumeLocator locator;
  TriangleMesh mesh;
  MeshDistance distance{mesh};
};

VolumeDomain::VolumeDomain(const SampledVolume& volume, const LocalFrame& frame)
    : volume_(volume), frame_(frame), bounds_(own_bounds(volume, frame)) {
  if (!volume.lattice) boundary_ = std::make_unique<const Boundary>(volume, frame);
}

VolumeDomain::~VolumeDomain() = default;

void VolumeDomain::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  parallel_ranges(0, x.size(), 512, [&](std::size_t begin, std::size_t end) {
    const std::size_t n = end - begin;
    std::vector<Vec3> input(n);
    for (std::size_t i = 0; i < n; ++i) input[i] = frame_.to_input(x[begin + i]);
    if (!boundary_) {
      const Lattice& l = *volume_.lattice;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 a = l.to_axes(input[i]);
        double most = -std::numeric_limits<double>::infinity();
        Vec3 towards;
        for (std::size_t k = 0; k < 3; ++k) {
          if (l.lower[k] - a[k] > most) most = l.lower[k] - a[k], towards = -l.directions[k];
          if (a[k] - l.upper[k] > most) most = a[k] - l.upper[k], towards = l.directions[k];
        }
        values[begin + i] = frame_.from_input(most);
        if (!gradients.empty()) gradients[begin + i] = towards;
      }
      return;
    }
    std::vector<MeasuredPoint> found(n);
    boundary_->distance.measure(x.subspan(begin, n), std::numeric_limits<double>::infinity(), found);
    std::vector<CellLocation> locations(n);
    boundary_->locator.locate(input, locations);
    for (std::size_t i = 0; i < n; ++i) {
      const double sign = locations[i].inside ? -1 : 1, distance = std::abs(found[i].distance);
      values[begin + i] = std::isfinite(distance) ? sign * distance : sign;
      if (!gradients.empty())
        gradients[begin + i] = distance > 0 ? (x[begin + i] - found[i].point) * (sign / distance) : Vec3{};
    }
  });
}

void VolumeDomain::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  detail::ranges_by_slope(*this, 1, x, radius, found);
}

void VolumeDomain::locate(std::span<const Vec3> x, std::span<std::uint8_t> inside) const {
  parallel_ranges(0, x.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> input(end - begin);
    for (std::size_t i = begin; i < end; ++i) input[i - begin] = frame_.to_input(x[i]);
    if (!boundary_) {
      const Lattice& l = *volume_.lattice;
      for (std::size_t i = begin; i < end; ++i) {
        const Vec3 a = l.to_axes(input[i - begin]);
        bool within = true;
        for (std::size_t k = 0; k < 3; ++k) within = within && a[k] >= l.lower[k] && a[k] <= l.upper[k];
        inside[i] = within;
      }
      return;
    }
    std::vector<CellLocation> locations(end - begin);
    boundary_->locator.locate(input, locations);
    for (std::size_t i = begin; i < end; ++i) inside[i] = locations[i - begin].inside;
  });
}

// ---- Field -------------------------------------------------------------------------------------------------------

Isosurface::Isosurface(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeField> field,
                       const std::function<double(std::size_t)>& sample_value, double value)
    : Isosurface(std::move(volume), leveled(std::move(field), value), sample_value, value) {}

Isosurface::Isosurface(std::shared_ptr<const SampledVolume> volume, const Leveled& leveled,
                       const std::function<double(std::size_t)>& sample_value, double value)
    : volume_(std::move(volume)),
      field_(leveled.field),
      frame_(frame_of(*volume_)),
      value_(value),
      level_(leveled.of(value)),
      domain_(*volume_, frame_),
      ranges_(
          *volume_, [&](std::size_t i) { return leveled.of(sample_value(i)); }, frame_) {
  if (!std::isfinite(value)) throw ArgumentError("`value` must be finite");
  const std::vector<Vec3> points = ranges_.points_with(level_);
  if (points.empty()) {
    const ValueRange all = ranges_.of_samples();
    throw DataError(fmt::format("has no surface of the value {:.6g}: values lie between about {:.6g} and {:.6g}", value,
                                leveled.back(all.least), leveled.back(all.most)));
  }
  std::vector<double> slopes = slopes_at(*field_, level_, points, frame_, kSlopes);
  if (!slopes.empty()) slope_ = median(slopes) * frame_.unit;
}

std::vector<Vec3> Isosurface::in_input(std::span<const Vec3> x) const {
  std::vector<Vec3> y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = frame_.to_input(x[i]);
  return y;
}

void Isosurface::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  evaluate_in_domain(x, values, gradients, {});
}

void Isosurface::evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                    std::span<std::uint8_t> inside) const {
  evaluate_level(*field_, level_, in_input(x), {values, gradients, inside});
  for (double& v : values) v = (level_ - v) / slope_;
  const double scale = -frame_.unit / slope_;
  for (Vec3& g : gradients) g *= scale;
}

void Isosurface::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  parallel_for(0, x.size(), 512,
               [&](std::size_t i) { found[i] = level_range(ranges_.around(x[i], radius), level_, slope_); });
}

void Isosurface::may_pass(std::span<const Vec3> x, double radius, std::span<std::uint8_t> answers) const {
  parallel_for(0, x.size(), 512, [&](std::size_t i) { answers[i] = ranges_.among(x[i], radius, level_); });
}

void Isosurface::spacing(std::span<const Vec3> x, std::span<double> found) const {
  field_->spacing(in_input(x), found);
  for (double& s : found) s = frame_.from_input(s);
}

// ---- Mesh --------------------------------------------------------------------------------------------------------

namespace {

/// Blocks as small as the sample distance (times `scale`) near the surface. Empty if they are too many.
std::optional<BlockTree> iso_blocks(const Isosurface& surface, std::optional<double> cell, double scale,
                                    Progress& progress) {
  const Box3 box = surface.bounds();
  const Vec3 size = box.size();
  // A power of two times the block size, so that repeated halving reaches exactly this size.
  const double finest = scale * (cell ? *cell : kBlock * surface.median_spacing());
  const double least = std::max({size.x, size.y, size.z}) + 2 * kAroundVolume * finest;
  const double edge = finest * std::exp2(std::ceil(std::log2(least / finest)));
  BlockTree tree(box.center() - Vec3{1, 1, 1} * (edge / 2), edge);
  std::vector<std::uint32_t> level{0};
  while (!level.empty()) {
    progress.check();
    std::vector<Vec3> centers(level.size());
    for (std::size_t i = 0; i < level.size(); ++i) centers[i] = tree.block_center(level[i]);
    const double block = tree.block_edge(level[0]);
    std::vector<std::uint8_t> passes(level.size());
    surface.may_pass(centers, kHalfDiagonal * block, passes);
    std::vector<double> wanted(level.size(), scale * cell.value_or(0));
    if (!cell) {
      surface.spacing(centers, wanted);
      for (double& w : wanted) w *= kBlock * scale;
    }
    std::vector<std::uint32_t> divided;
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (!passes[i] || tree[level[i]].level >= kMostDepth) continue;
      const bool coarse = tree[level[i]].level < 3;
      if (coarse || block > kRounding * wanted[i]) divided.push_back(level[i]);
    }
    level = tree.subdivide_all(divided);
    if (tree.size() > kMostIsoBlocks) return std::nullopt;
  }
  return tree;
}

/// Properties of an isosurface as a part of a solid.
class IsosurfaceKnowledge final : public csg::FieldKnowledge {
 public:
  explicit IsosurfaceKnowledge(const Isosurface& surface) : surface_(surface) {}
  double detail(const Vec3& x, double) const override {
    double spacing = 0;
    surface_.spacing({&x, 1}, {&spacing, 1});
    return kBlock * spacing;
  }
  double least(double sign, const Vec3& x, double radius) const override {
    ValueRange range{};
    surface_.ranges({&x, 1}, radius, {&range, 1});
    const double least = sign > 0 ? range.least : -range.most;
    return least > 0 ? least : -std::numeric_limits<double>::infinity();
  }

 private:
  const Isosurface& surface_;
};

/// The solid in the surface's local coordinates.
Solid own_solid(const std::shared_ptr<const Isosurface>& surface) {
  const Solid within = csg::leaf(surface, std::make_shared<IsosurfaceKnowledge>(*surface));
  return csg::intersect(within, csg::leaf(std::shared_ptr<const ScalarField>(surface, &surface->domain())));
}

void measure_iso(const TriangleMesh& mesh, IsosurfaceReport& r) {
  const MeshTopology topology = measure_topology(mesh);
  const MeshSize size = measure_size(mesh);
  r.components = static_cast<std::size_t>(topology.components);
  r.closed = topology.closed();
  r.area = size.area;
  if (r.closed) r.volume = size.volume;
}

}  // namespace

const OptionSchema& IsosurfaceOptions::schema() {
  using O = IsosurfaceOptions;
  static constexpr OptionRow rows[] = {
      option<&O::closed>({.text = "Close the surface at the boundary of the volume, around larger values"}),
      option<&O::cell>({.text = "Edge of the smallest blocks",
                        .unit = "length",
                        .from_data = "the local spacing of the samples",
                        .range = positive()}),
      option<&O::mesh_error>(
          {.text = "Accepted mean distance between mesh and surface", .unit = "length", .range = positive()}),
      option<&O::triangles>({.text = "At most this many triangles", .range = at_least(4)}),
      option<&O::components>({.text = "Parts to keep: auto, all, largest or a number", .unit = "choice"}),
      option<&O::enhance>({.text = "No clustering, smoothing or simplification of triangles"}),
  };
  static constexpr OptionSchema schema{rows};
  return schema;
}

void IsosurfaceOptions::validate() const {
  validate_options(*this);
  if (closed && (mesh_error || triangles || !enhance))
    throw ArgumentError("`mesh_error`, `triangles` and `enhance` are for surfaces that are not `closed`");
  MeshOptions mesh;
  mesh.mesh_error = mesh_error, mesh.triangles = triangles, mesh.enhance = enhance;
  mesh.validate();
}

TriangleMesh mesh_isosurface(const Isosurface& surface, const IsosurfaceOptions& options, Progress& progress,
                             IsosurfaceReport* report) {
  options.validate();
  IsosurfaceReport local;
  IsosurfaceReport& r = report ? *report : local;
  r = {};
  const LocalFrame& frame = surface.frame();
  const double median = surface.median_spacing();
  std::optional<double> cell;
  if (options.cell) cell = frame.from_input(*options.cell);

  if (options.closed) {
    const std::shared_ptr<const Isosurface> borrowed(std::shared_ptr<const void>(), &surface);
    CsgMeshOptions csg;
    csg.cell = cell.value_or(kBlock * median);
    csg.components = options.components;
    CsgMeshReport made;
    TriangleMesh mesh = mesh_csg(own_solid(borrowed), csg, progress, &made);
    r.blocks = made.blocks, r.cell = frame.to_input(made.cell), r.notes = std::move(made.notes);
    move_to_input(mesh, frame);
    measure_iso(mesh, r);
    return mesh;
  }

  progress.begin("find surface");
  double scale = 1;
  std::optional<BlockTree> blocks = iso_blocks(surface, cell, scale, progress);
  while (!blocks) {
    scale *= 2;
    blocks = iso_blocks(surface, cell, scale, progress);
  }
  if (scale > 1)
    r.notes.push_back(
        {.code = "coarse_blocks",
         .text = fmt::format("the surface is so large that blocks are {} times as wide as requested", scale)});
  r.cell = frame.to_input(blocks->edge() / static_cast<double>(1u << blocks->depth()));

  MeshOptions meshing;
  meshing.enhance = options.enhance, meshing.triangles = options.triangles;
  if (options.mesh_error) meshing.mesh_error = frame.from_input(*options.mesh_error);
  const double mesh_error = meshing.mesh_error.value_or(kIsoError * median);
  r.mesh_error = frame.to_input(mesh_error);
  PolygonizeOptions polygonize = detail::meshing_options(meshing, mesh_error, false);
  polygonize.domain = &surface.domain();
  MeshReport made;
  TriangleMesh mesh = detail::cut_out(surface, *blocks, meshing, polygonize, progress, made);
  if (mesh.triangles.empty())
    throw DataError(fmt::format("has no surface of the value {:.6g} in its volume", surface.value()));
  progress.begin("finish mesh");
  detail::choose_components(mesh, options.components, {}, 0, made);
  r.blocks = made.blocks;
  add_notes(r.notes, std::move(made.notes));
  move_to_input(mesh, frame);
  measure_iso(mesh, r);
  if (options.triangles && mesh.triangles.size() > *options.triangles)
    r.notes.push_back(detail::too_many_triangles(mesh.triangles.size(), *options.triangles));
  progress.finish();
  return mesh;
}

Solid isosurface_solid(const std::shared_ptr<const Isosurface>& surface) {
  const LocalFrame frame = surface->frame();
  return csg::place(own_solid(surface), frame);
}

namespace {

constexpr ReportRow kIsosurfaceReportRows[] = {
    reported<&IsosurfaceReport::blocks>({.text = "Blocks"}),
    reported<&IsosurfaceReport::cell>({.text = "Edge of the smallest blocks", .unit = "length"}),
    reported<&IsosurfaceReport::area>({.text = "Area of the mesh", .unit = "length²"}),
    reported<&IsosurfaceReport::volume>({.text = "Volume of the mesh, where it is closed", .unit = "length³"}),
    reported<&IsosurfaceReport::components>({.name = "components", .text = "Connected parts of the mesh"}),
    reported<&IsosurfaceReport::closed>({.name = "closed", .text = "Whether the mesh is closed"})};

}  // namespace

const ReportSchema& IsosurfaceReport::schema() {
  static constexpr ReportSchema schema{kIsosurfaceReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
