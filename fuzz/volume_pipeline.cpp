// Fuzz target: for any volume from a reader, `info`, `probe`, `isosurface` and `render` end with finite numbers or with
// a one-line error. The input is a small grid of one of the supported kinds, with a formula for values and changes of
// single positions and values.
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/render/volume/volume_picture.h"
#include "sansmesh/volume/grid/volume_boundary.h"
#include "target.h"

using namespace sansmesh;
using fuzz::ByteReader;
using fuzz::demand;

namespace {

constexpr std::size_t kMostChanges = 100;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Grid {
  std::array<std::size_t, 3> n{};
  std::size_t points() const { return n[0] * n[1] * n[2]; }
  std::uint32_t at(std::size_t i, std::size_t j, std::size_t k) const {
    return static_cast<std::uint32_t>(i + n[0] * (j + n[1] * k));
  }
};

/// Adds every box of the grid as cells of one shape, or of all shapes in turn.
void add_cells(GridBlock& block, const Grid& g, std::size_t shape) {
  std::size_t box = 0;
  for (std::size_t k = 0; k + 1 < g.n[2]; ++k)
    for (std::size_t j = 0; j + 1 < g.n[1]; ++j)
      for (std::size_t i = 0; i + 1 < g.n[0]; ++i, ++box) {
        const std::uint32_t c[8] = {
            g.at(i, j, k),     g.at(i + 1, j, k),     g.at(i + 1, j + 1, k),     g.at(i, j + 1, k),
            g.at(i, j, k + 1), g.at(i + 1, j, k + 1), g.at(i + 1, j + 1, k + 1), g.at(i, j + 1, k + 1)};
        const auto add = [&](CellShape s, std::vector<int> corners) {
          std::vector<std::uint32_t> points;
          for (const int corner : corners) points.push_back(c[corner]);
          block.cells.add(s, points);
        };
        switch (shape == 4 ? box % 4 : shape) {
          case 0:
            add(CellShape::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
            break;
          case 1:
            add(CellShape::wedge, {0, 1, 3, 4, 5, 7});
            add(CellShape::wedge, {1, 2, 3, 5, 6, 7});
            break;
          case 2:
            add(CellShape::pyramid, {0, 1, 2, 3, 4});
            add(CellShape::pyramid, {1, 5, 6, 2, 4});
            add(CellShape::pyramid, {3, 2, 6, 7, 4});
            break;
          default:
            for (const auto& [a, b] : {std::pair{1, 2}, {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}})
              add(CellShape::tetrahedron, {0, a, b, 6});
        }
      }
}

double value_of(std::size_t formula, const Vec3& u) {
  switch (formula) {
    case 0:
      return u.x + 2 * u.y - u.z;
    case 1:
      return std::sin(3 * u.x) * std::cos(2 * u.y) + u.z;
    case 2:
      return u.x > 0.5 ? 1 : 0;
    case 3:
      return norm(u - Vec3{0.5, 0.5, 0.5});
    case 4:
      return 1;
    default:
      return static_cast<double>(static_cast<int>(1000 * (u.x + 3 * u.y + 7 * u.z)) % 17);
  }
}

/// Changes single values, positions and corners until the bytes are used up.
void change_some(ByteReader& in, GridBlock& block, std::vector<double>& values) {
  const std::size_t n = values.size();
  for (std::size_t change = 0; change < kMostChanges && !in.at_end(); ++change) {
    const std::size_t p = in.take<std::uint16_t>() % n;
    switch (in.below(5)) {
      case 0:
        values[p] = in.number();
        break;
      case 1:
        if (!block.points.empty()) block.points[p] = in.place();
        break;
      case 2:
        if (!block.points.empty()) block.points[p] = block.points[in.take<std::uint16_t>() % n];
        break;
      case 3:
        if (!block.cells.empty())
          block.cells.corners[in.take<std::uint16_t>() % block.cells.corners.size()] = static_cast<std::uint32_t>(p);
        break;
      default:
        block.hidden_points.resize(n);
        block.hidden_points[p] = 1;
    }
  }
}

/// Sets the array "s" of points or cells, with one of several types.
void set_values(GridBlock& block, std::vector<double> values, double amplitude, std::uint8_t bits) {
  const bool of_cells = (bits & 8) != 0 && !block.cells.empty();
  if (of_cells) {
    values.resize(block.cells.size(), amplitude);
    block.cell_arrays.set("s", std::move(values));
  } else if ((bits & 16) != 0) {
    std::vector<float> floats;
    for (const double v : values) floats.push_back(std::abs(v) <= 3.4e38 ? static_cast<float>(v) : NAN);
    block.point_arrays.set("s", std::move(floats));
  } else if ((bits & 32) != 0) {
    std::vector<std::int16_t> whole;
    for (const double v : values)
      whole.push_back(std::abs(v) < 30000 ? static_cast<std::int16_t>(v) : std::int16_t{-7});
    block.point_arrays.set("s", std::move(whole));
  } else {
    block.point_arrays.set("s", std::move(values));
  }
}

/// A block with an array "s" of points or cells. Positions and values are arbitrary where the kind of grid allows it.
GridBlock block_of(ByteReader& in, std::size_t number) {
  GridBlock block;
  Grid grid;
  for (std::size_t& n : grid.n) n = 1 + in.below(5);
  const std::size_t kind = in.below(5), shape = in.below(5), formula = in.below(6);
  const Vec3 step{in.scale(), in.flag() ? in.scale() : 1, in.flag() ? in.scale() : 1};
  const double amplitude = in.scale(), off = in.flag() ? in.scale() : 0;
  const std::uint8_t bits = in.take<std::uint8_t>();
  const Vec3 shift = Vec3{off, 0, -off} + step * (2.0 * static_cast<double>(number));
  const std::size_t n = grid.points();
  std::vector<Vec3> unit(n);
  for (std::size_t p = 0; p < n; ++p)
    unit[p] = {static_cast<double>(p % grid.n[0]) / 4, static_cast<double>(p / grid.n[0] % grid.n[1]) / 4,
               static_cast<double>(p / (grid.n[0] * grid.n[1])) / 4};
  std::vector<double> values(n);
  for (std::size_t p = 0; p < n; ++p) values[p] = amplitude * value_of(formula, unit[p]);
  if (kind == 0) {
    block.kind = GridKind::lattice;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < grid.n[k]; ++i)
        block.axes[k].push_back(static_cast<double>(bits & 1 ? i * i + i : i) * step[k]);
    block.origin = shift;
    if ((bits & 2) != 0) block.directions = {Vec3{0.6, 0.8, 0}, Vec3{-0.8, 0.6, 0}, Vec3{0, 0, bits & 4 ? -1.0 : 1.0}};
  } else {
    block.points.resize(n);
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t k = 0; k < 3; ++k) block.points[p][k] = 4 * unit[p][k] * step[k] + shift[k];
    block.kind = kind == 1 ? GridKind::curvilinear : kind == 2 ? GridKind::scattered : GridKind::unstructured;
    if (kind == 1) block.dims = grid.n;
    if (kind >= 3) add_cells(block, grid, shape);
  }
  change_some(in, block, values);
  set_values(block, std::move(values), amplitude, bits);
  return block;
}

/// Runs the steps of `info`.
void inform(const SampledVolume& volume, const VolumeDataset& dataset) {
  const VolumeFacts& f = volume.facts;
  const Box3 box = volume.bounds();
  demand(is_finite(box.lower) && is_finite(box.upper) && !box.empty(), "the box of the samples is not finite");
  demand(std::isfinite(f.least_spacing) && std::isfinite(f.median_spacing) && std::isfinite(f.most_spacing) &&
             f.least_spacing >= 0,
         "the spacing is not finite");
  demand(std::isfinite(f.layer) && !std::isnan(f.aspect), "a number of the facts is not finite");
  for (const DatasetArray& a : dataset.arrays()) fuzz::check_message(a.name);
}

void probe(const SampledVolume& volume, const VolumeField& field) {
  const Box3 box = volume.bounds();
  std::vector<Vec3> places{box.lower, box.upper,     box.center(), box.upper + box.size(),
                           {0, 0, 0}, {1e300, 0, 0}, {kNan, 0, 0}, box.lower * 0.7 + box.upper * 0.3};
  for (std::size_t i = 0; i < volume.size() && i < 20; ++i) places.push_back(volume.position(i));
  const std::size_t n = places.size();
  std::vector<double> values(n), spacing(n);
  std::vector<Vec3> gradients(n);
  std::vector<std::uint8_t> inside(n);
  field.evaluate(places, {values, gradients, inside});
  field.spacing(places, spacing);
  for (std::size_t i = 0; i < n; ++i) {
    demand(std::isfinite(values[i]), "a value is not finite");
    demand(is_finite(gradients[i]), "a gradient is not finite");
    demand(inside[i] <= 1, "a place is neither inside nor outside");
    demand(spacing[i] > 0, "a spacing is not positive");
  }
}

void draw(const SampledVolume& volume, const VolumeField& field, std::uint8_t bits) {
  TriangleMesh boundary = volume_boundary(volume);
  VolumeSubject subject;
  subject.samples = volume.positions;
  subject.image = volume.lattice.has_value();
  subject.field = &field;
  if (!boundary.triangles.empty()) subject.boundary = &boundary;
  VolumePictureOptions options;
  options.picture.view.width = options.picture.view.height = 16;
  options.picture.quality.samples = 1;
  options.step = 2;
  options.color_bar = (bits & 1) != 0;
  options.axes = (bits & 2) != 0;
  if ((bits & 4) != 0) options.preset = "flow";
  if ((bits & 8) != 0) options.isos.push_back({0.5, {}, 0.5});
  Progress progress;
  const VolumePicture picture(subject, progress);
  VolumePictureReport report;
  const Image image = picture.render(options, progress, &report);
  for (const Rgba& pixel : image.pixels)
    for (const float level : pixel) demand(std::isfinite(level), "a pixel is not finite");
  for (const std::string& note : report.notes) fuzz::check_message(note);
}

void cut_out(std::shared_ptr<const SampledVolume> volume, std::shared_ptr<const VolumeField> field, double value,
             std::uint8_t bits) {
  const Attribute& values = *volume->attributes.find("s");
  const auto surface = std::make_shared<const Isosurface>(
      volume, std::move(field), [&](std::size_t i) { return values.number(i); }, value);
  IsosurfaceOptions options;
  options.closed = (bits & 1) != 0;
  options.enhance = (bits & 2) != 0;
  Progress progress;
  IsosurfaceReport report;
  const TriangleMesh mesh = mesh_isosurface(*surface, options, progress, &report);
  for (const Vec3f& v : mesh.vertices) demand(is_finite(v), "a vertex is not finite");
  demand(std::isfinite(report.area) && (!report.volume || std::isfinite(*report.volume)),
         "area or volume are not finite");
  for (const Note& note : report.notes) fuzz::check_message(note_line(note));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ThreadScope one(1);
  ByteReader in(data, size);
  const std::size_t task = in.below(4), blocks = 1 + in.below(8) / 7;
  const std::uint8_t bits = in.take<std::uint8_t>();
  const auto methods = VolumeMethod::registry().all();
  const std::size_t method = in.below(methods.size() + 3);
  GridData grid;
  for (std::size_t b = 0; b < blocks; ++b) grid.blocks.push_back(block_of(in, b));
  fuzz::ends_well([&] {
    Progress progress;
    VolumeDataset dataset(std::move(grid));
    const auto samples = dataset.volume("s", progress);
    if (task == 0) return inform(*samples, dataset);
    VolumeReconstructionOptions options;
    if (method < methods.size()) options.method = std::string(methods[method]->name);
    VolumeReconstructionReport report;
    const auto field = dataset.field({"s", {}, false}, options, progress, &report);
    for (const std::string& note : report.notes) fuzz::check_message(note);
    if (task == 1) return probe(*samples, *field);
    if (task == 2) return draw(*samples, *field, bits);
    const DatasetArray& array = dataset.array("s");
    if (std::isnan(array.least[0])) return;
    cut_out(samples, field, 0.5 * array.least[0] + 0.5 * array.most[0], bits);
  });
  return 0;
}
