#include "sansmesh/io/vtk/vtk_blocks.h"

#include <vtkAMRBox.h>
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellIterator.h>
#include <vtkCellType.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataArray.h>
#include <vtkDataObjectTree.h>
#include <vtkDataObjectTreeIterator.h>
#include <vtkDataSetAttributes.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMatrix3x3.h>
#include <vtkOverlappingAMR.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkSmartPointer.h>
#include <vtkStructuredGrid.h>
#include <vtkUniformGrid.h>
#include <vtkUniformGridAMR.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "sansmesh/core/index_in.h"
#include "sansmesh/io/vtk/linear_cells.h"
#include "sansmesh/io/vtk/vtk_values.h"

namespace sansmesh::inline v1::io {
namespace {

[[noreturn]] void fail(const std::string& cause) { throw std::runtime_error(cause); }

/// Arrays of `expected` rows; only `rows` of them if given.
void add_arrays(vtkDataSetAttributes& from, std::size_t expected, const std::vector<std::uint32_t>* rows, bool of_cells,
                VtkSink& sink, GridBlock& block, GridData& data) {
  for (int a = 0; a < from.GetNumberOfArrays(); ++a) {
    vtkDataArray* const array = from.GetArray(a);
    if (!array || array->GetNumberOfComponents() < 1) continue;
    std::string name = array->GetName() ? array->GetName() : "";
    if (name == vtkDataSetAttributes::GhostArrayName()) continue;
    if (name.empty()) name = "array_" + std::to_string(a + 1);
    if (static_cast<std::size_t>(array->GetNumberOfTuples()) != expected) {
      if (array->GetNumberOfTuples() == 0) continue;
      data.notes.push_back("the array " + name + " has " + std::to_string(array->GetNumberOfTuples()) +
                           " rows instead of " + std::to_string(expected) + " and was left out");
      continue;
    }
    sink.add(block, of_cells,
             {name, values_of(*array, rows), static_cast<std::size_t>(array->GetNumberOfComponents())});
  }
}

std::vector<std::uint8_t> flagged(vtkUnsignedCharArray* ghosts, std::size_t n, unsigned flags,
                                  const std::vector<std::uint32_t>* rows) {
  if (!ghosts || static_cast<std::size_t>(ghosts->GetNumberOfTuples()) != n) return {};
  std::vector<std::uint8_t> hidden(rows ? rows->size() : n);
  bool any = false;
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const unsigned v = ghosts->GetValue(static_cast<vtkIdType>(rows ? (*rows)[i] : i));
    any |= (hidden[i] = (v & flags) != 0) != 0;
  }
  if (!any) hidden.clear();
  return hidden;
}

/// Marks hidden points and cells. Ghost copies of another process's points stay, because cells that are not copies use
/// them.
void add_hidden(vtkDataSet& set, const std::vector<std::uint32_t>* cell_rows, GridBlock& block) {
  const unsigned cells = vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::REFINEDCELL |
                         vtkDataSetAttributes::EXTERIORCELL | vtkDataSetAttributes::HIDDENCELL;
  block.hidden_points = flagged(set.GetPointGhostArray(), static_cast<std::size_t>(set.GetNumberOfPoints()),
                                vtkDataSetAttributes::HIDDENPOINT, nullptr);
  block.hidden_cells =
      flagged(set.GetCellGhostArray(), static_cast<std::size_t>(set.GetNumberOfCells()), cells, cell_rows);
}

void add_all_arrays(vtkDataSet& set, VtkSink& sink, GridBlock& block, GridData& data) {
  add_arrays(*set.GetPointData(), static_cast<std::size_t>(set.GetNumberOfPoints()), nullptr, false, sink, block, data);
  add_arrays(*set.GetCellData(), static_cast<std::size_t>(set.GetNumberOfCells()), nullptr, true, sink, block, data);
  add_hidden(set, nullptr, block);
}

void take_points(vtkPoints* points, GridBlock& block) {
  const std::size_t n = points ? static_cast<std::size_t>(points->GetNumberOfPoints()) : 0;
  if (n >= std::numeric_limits<std::uint32_t>::max()) fail("holds more points than can be counted in 32 bits");
  block.points.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    double p[3];
    points->GetPoint(static_cast<vtkIdType>(i), p);
    block.points[i] = {p[0], p[1], p[2]};
  }
}

void add_image(vtkImageData& image, VtkSink& sink, GridBlock& block, GridData& data) {
  int extent[6];
  double spacing[3], origin[3];
  image.GetExtent(extent);
  image.GetSpacing(spacing);
  image.GetOrigin(origin);
  const vtkMatrix3x3* const turn = image.GetDirectionMatrix();
  block.kind = GridKind::lattice;
  block.origin = {origin[0], origin[1], origin[2]};
  for (int k = 0; k < 3; ++k) {
    const std::size_t axis = static_cast<std::size_t>(k);
    const std::size_t n = static_cast<std::size_t>(extent[2 * k + 1] - extent[2 * k] + 1);
    block.dims[axis] = n;
    Vec3 direction{turn->GetElement(0, k), turn->GetElement(1, k), turn->GetElement(2, k)};
    double step = spacing[k];
    if (!std::isfinite(step) || !(norm(direction) > 0)) fail("its spacing or directions are not numbers");
    // Images of one layer may have no spacing across it.
    if (step == 0) {
      if (n > 1) fail("has no spacing along an axis");
      step = 1;
    }
    int first = extent[2 * k];
    direction = normalized(direction);
    if (step < 0) step = -step, direction = -direction;
    block.directions[axis] = direction;
    for (std::size_t i = 0; i < n; ++i) block.axes[axis].push_back((first + static_cast<double>(i)) * step);
  }
  add_all_arrays(image, sink, block, data);
}

void add_rectilinear(vtkRectilinearGrid& grid, VtkSink& sink, GridBlock& block, GridData& data) {
  vtkDataArray* const coordinates[3] = {grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates()};
  std::array<std::vector<double>, 3> axes;
  bool lattice = true;
  std::array<double, 3> sign{1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const vtkIdType n = coordinates[k] ? coordinates[k]->GetNumberOfTuples() : 0;
    for (vtkIdType i = 0; i < n; ++i) axes[k].push_back(coordinates[k]->GetComponent(i, 0));
    if (axes[k].size() != static_cast<std::size_t>(grid.GetDimensions()[k]))
      fail("its coordinates do not fit its size");
    const auto increasing = [&] { return std::is_sorted(axes[k].begin(), axes[k].end(), std::less_equal<>()); };
    const auto finite = std::all_of(axes[k].begin(), axes[k].end(), [](double v) { return std::isfinite(v); });
    if (finite && axes[k].size() > 1 && axes[k].front() > axes[k].back()) {
      sign[k] = -1;
      for (double& v : axes[k]) v = -v;
    }
    lattice = lattice && finite && increasing();
  }
  block.dims = {axes[0].size(), axes[1].size(), axes[2].size()};
  if (lattice) {
    block.kind = GridKind::lattice;
    for (std::size_t k = 0; k < 3; ++k) block.directions[k] = block.directions[k] * sign[k];
    block.axes = std::move(axes);
  } else {
    block.kind = GridKind::curvilinear;
    for (const double z : axes[2]) {
      for (const double y : axes[1]) {
        for (const double x : axes[0]) block.points.push_back({x * sign[0], y * sign[1], z * sign[2]});
      }
    }
  }
  add_all_arrays(grid, sink, block, data);
}

void add_structured(vtkStructuredGrid& grid, VtkSink& sink, GridBlock& block, GridData& data) {
  block.kind = GridKind::curvilinear;
  take_points(grid.GetPoints(), block);
  int dims[3];
  grid.GetDimensions(dims);
  std::size_t n = 1;
  for (std::size_t k = 0; k < 3; ++k)
    block.dims[k] = static_cast<std::size_t>(std::max(dims[k], 0)), n *= block.dims[k];
  if (n != block.points.size())
    fail("holds " + std::to_string(block.points.size()) + " points instead of " + std::to_string(n));
  add_all_arrays(grid, sink, block, data);
}

/// Points and arrays of a block of cells, or only its points if it has no cells.
void finish_cells(vtkPointSet& set, LinearCells& linear, VtkSink& sink, GridBlock& block, GridData& data) {
  const std::size_t cells = static_cast<std::size_t>(set.GetNumberOfCells());
  const std::vector<std::string> notes = linear.notes();
  data.notes.insert(data.notes.end(), notes.begin(), notes.end());
  add_arrays(*set.GetPointData(), block.points.size(), nullptr, false, sink, block, data);
  if (linear.cells.empty() && linear.flat_cells.empty()) {
    block.kind = GridKind::scattered;
    add_hidden(set, nullptr, block);
    block.hidden_cells.clear();
    return;
  }
  block.kind = GridKind::unstructured;
  const bool solid = !linear.cells.empty();
  std::vector<std::uint32_t>& rows = solid ? linear.rows : linear.flat_rows;
  if (solid) {
    block.cells = std::move(linear.cells);
    if (std::adjacent_find(rows.begin(), rows.end()) != rows.end()) block.piece_of = rows;
    if (!linear.higher.empty()) {
      block.higher = std::move(linear.higher);
      block.higher.of_piece.resize(block.cells.size(), HigherOrderCells::kNone);
    }
  } else {
    block.flat_cells = std::move(linear.flat_cells);
  }
  bool same = rows.size() == cells;
  for (std::size_t i = 0; i < rows.size() && same; ++i) same = rows[i] == i;
  const std::vector<std::uint32_t>* const taken = same ? nullptr : &rows;
  add_arrays(*set.GetCellData(), cells, taken, true, sink, block, data);
  add_hidden(set, taken, block);
}

std::uint32_t checked_node(vtkIdType id, std::size_t points, vtkIdType cell) {
  if (id < 0 || static_cast<std::size_t>(id) >= points) {
    fail("cell " + std::to_string(cell) + " names point " + std::to_string(id) + ", but there are " +
         std::to_string(points));
  }
  return static_cast<std::uint32_t>(id);
}

void check_offsets(vtkCellArray* cells, vtkIdType expected) {
  if (!cells) return;
  const vtkIdType n = cells->GetNumberOfCells(), size = cells->GetNumberOfConnectivityIds();
  if (n != expected) fail("holds " + std::to_string(n) + " cells instead of " + std::to_string(expected));
  vtkIdType before = 0;
  for (vtkIdType c = 0; c <= n && n > 0; ++c) {
    const vtkIdType at = cells->GetOffset(c);
    if (at < before || at > size || (c == 0 && at != 0))
      fail("cell " + std::to_string(c) + " begins beyond the list of cells");
    before = at;
  }
}

/// Degrees of a Lagrange cell along its axes, if the file states them.
std::array<int, 3> degrees_of(vtkUnstructuredGrid& grid, vtkIdType cell) {
  vtkDataArray* const all = grid.GetCellData()->GetHigherOrderDegrees();
  if (!all || all->GetNumberOfComponents() != 3 || cell >= all->GetNumberOfTuples()) return {};
  std::array<int, 3> degrees{};
  for (int k = 0; k < 3; ++k) {
    const double d = all->GetComponent(cell, k);
    degrees[static_cast<std::size_t>(k)] = d >= 1 && d <= 1000 ? static_cast<int>(d) : 0;
  }
  return degrees;
}

void add_unstructured(vtkUnstructuredGrid& grid, VtkSink& sink, GridBlock& block, GridData& data) {
  take_points(grid.GetPoints(), block);
  const std::size_t points = block.points.size();
  const vtkIdType n = grid.GetNumberOfCells();
  if (static_cast<std::uint64_t>(n) >= std::numeric_limits<std::uint32_t>::max())
    fail("holds more cells than can be counted in 32 bits");
  check_offsets(grid.GetCells(), n);
  LinearCells linear(block.points);
  std::vector<std::uint32_t> nodes;
  const auto ids = vtkSmartPointer<vtkIdList>::New();
  for (vtkIdType c = 0; c < n; ++c) {
    const int type = grid.GetCellType(c);
    const std::uint32_t row = static_cast<std::uint32_t>(c);
    if (type == VTK_POLYHEDRON) {
      grid.GetFaceStream(c, ids);  // number of faces, then of each its size and its points
      std::vector<std::vector<std::uint32_t>> faces;
      vtkIdType at = 1;
      for (vtkIdType f = 0; ids->GetNumberOfIds() > 0 && f < ids->GetId(0); ++f) {
        if (at >= ids->GetNumberOfIds()) fail("polyhedron " + std::to_string(c) + " has fewer faces than it announces");
        const vtkIdType size = ids->GetId(at++);
        if (size < 0 || size > ids->GetNumberOfIds() - at)
          fail("polyhedron " + std::to_string(c) + " has a face that does not end");
        std::vector<std::uint32_t>& face = faces.emplace_back();
        for (vtkIdType k = 0; k < size; ++k) face.push_back(checked_node(ids->GetId(at++), points, c));
      }
      linear.add_polyhedron(faces, row);
      continue;
    }
    vtkIdType size = 0;
    const vtkIdType* list = nullptr;
    grid.GetCellPoints(c, size, list, ids);
    nodes.clear();
    for (vtkIdType k = 0; k < size; ++k) nodes.push_back(checked_node(list[k], points, c));
    if (type == VTK_CONVEX_POINT_SET) {
      const auto corners = vtkSmartPointer<vtkPoints>::New();
      grid.GetCell(c)->Triangulate(0, ids, corners);
      nodes.clear();
      for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k) nodes.push_back(checked_node(ids->GetId(k), points, c));
      linear.add_tetrahedra(nodes, row);
    } else if (!linear.add(type, nodes, row, degrees_of(grid, c))) {
      fail("cell " + std::to_string(c) + " has " + std::to_string(nodes.size()) + " points, too few for its type (" +
           std::to_string(type) + ")");
    }
  }
  finish_cells(grid, linear, sink, block, data);
}

void add_polygons(vtkPolyData& set, VtkSink& sink, GridBlock& block, GridData& data) {
  take_points(set.GetPoints(), block);
  LinearCells linear(block.points);
  std::vector<std::uint32_t> nodes;
  std::uint32_t row = 0;
  const auto ids = vtkSmartPointer<vtkIdList>::New();
  const auto add = [&](vtkCellArray* cells, int type) {
    if (!cells) return;
    check_offsets(cells, cells->GetNumberOfCells());
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c, ++row) {
      vtkIdType size = 0;
      const vtkIdType* list = nullptr;
      cells->GetCellAtId(c, size, list, ids);
      nodes.clear();
      for (vtkIdType k = 0; k < size; ++k) nodes.push_back(checked_node(list[k], block.points.size(), row));
      if (!linear.add(type, nodes, row)) linear.leave_out("polygon of fewer than three points");
    }
  };
  // Order of the rows of cell data.
  add(set.GetVerts(), VTK_POLY_VERTEX);
  add(set.GetLines(), VTK_POLY_LINE);
  add(set.GetPolys(), VTK_POLYGON);
  add(set.GetStrips(), VTK_TRIANGLE_STRIP);
  finish_cells(set, linear, sink, block, data);
}

void add_data_set(vtkDataSet& set, const std::string& name, int level, VtkSink& sink, GridData& data) {
  if (set.GetNumberOfPoints() == 0) return;
  GridBlock block;
  block.name = name;
  block.level = level;
  if (auto* const image = vtkImageData::SafeDownCast(&set))
    add_image(*image, sink, block, data);
  else if (auto* const rectilinear = vtkRectilinearGrid::SafeDownCast(&set))
    add_rectilinear(*rectilinear, sink, block, data);
  else if (auto* const structured = vtkStructuredGrid::SafeDownCast(&set))
    add_structured(*structured, sink, block, data);
  else if (auto* const unstructured = vtkUnstructuredGrid::SafeDownCast(&set))
    add_unstructured(*unstructured, sink, block, data);
  else if (auto* const polygons = vtkPolyData::SafeDownCast(&set))
    add_polygons(*polygons, sink, block, data);
  else
    return data.notes.push_back(std::string("a part of the kind ") + set.GetClassName() + " was left out");
  data.blocks.push_back(std::move(block));
}

/// Cells of a box that boxes of the next level cover.
std::vector<std::uint8_t> covered_cells(vtkOverlappingAMR& amr, unsigned level, unsigned index, vtkUniformGrid& grid) {
  if (level + 1 >= amr.GetNumberOfLevels()) return {};
  int ratio = amr.GetRefinementRatio(level);
  if (ratio < 2) {
    double coarse[3], fine[3];
    amr.GetSpacing(level, coarse);
    amr.GetSpacing(level + 1, fine);
    ratio = fine[0] > 0 ? whole_part<int>(std::round(coarse[0] / fine[0])) : 2;
  }
  const vtkAMRBox box = amr.GetAMRBox(level, index);
  int dims[3];
  grid.GetDimensions(dims);
  for (int& d : dims) d = std::max(1, d - 1);
  std::vector<std::uint8_t> hidden(static_cast<std::size_t>(grid.GetNumberOfCells()));
  if (hidden.size() !=
      static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(dims[2]))
    return {};
  bool any = false;
  for (unsigned child = 0; child < amr.GetNumberOfDataSets(level + 1); ++child) {
    if (!amr.GetDataSet(level + 1, child)) continue;
    vtkAMRBox fine = amr.GetAMRBox(level + 1, child);
    fine.Coarsen(ratio);
    int first[3], last[3];
    for (int k = 0; k < 3; ++k) {
      const bool flat = box.EmptyDimension(k);
      first[k] = flat ? 0 : std::max(0, fine.GetLoCorner()[k] - box.GetLoCorner()[k]);
      last[k] = flat ? dims[k] - 1 : std::min(dims[k] - 1, fine.GetHiCorner()[k] - box.GetLoCorner()[k]);
    }
    for (int k = first[2]; k <= last[2]; ++k) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int i = first[0]; i <= last[0]; ++i, any = true)
          hidden[static_cast<std::size_t>(i + dims[0] * (j + dims[1] * k))] = 1;
      }
    }
  }
  if (!any) hidden.clear();
  return hidden;
}

void add_levels(vtkUniformGridAMR& amr, const std::string& name, VtkSink& sink, GridData& data) {
  auto* const overlapping = vtkOverlappingAMR::SafeDownCast(&amr);
  std::size_t missing = 0;
  for (unsigned level = 0; level < amr.GetNumberOfLevels(); ++level) {
    for (unsigned index = 0; index < amr.GetNumberOfDataSets(level); ++index) {
      vtkUniformGrid* const grid = amr.GetDataSet(level, index);
      if (!grid || grid->GetNumberOfPoints() == 0) {
        ++missing;
        continue;
      }
      const std::string own = "level " + std::to_string(level) + " box " + std::to_string(index);
      const std::size_t before = data.blocks.size();
      add_data_set(*grid, name.empty() ? own : name + "/" + own, static_cast<int>(level), sink, data);
      if (!overlapping || data.blocks.size() == before) continue;
      const std::vector<std::uint8_t> covered = covered_cells(*overlapping, level, index, *grid);
      std::vector<std::uint8_t>& hidden = data.blocks.back().hidden_cells;
      if (hidden.empty()) {
        hidden = covered;
      } else if (!covered.empty()) {
        for (std::size_t c = 0; c < hidden.size(); ++c) hidden[c] |= covered[c];
      }
    }
  }
  if (missing > 0) fail(std::to_string(missing) + " of its boxes cannot be read");
}

}  // namespace

void add_blocks(vtkDataObject& object, const std::string& name, VtkSink& sink, GridData& data) {
  if (auto* const set = vtkDataSet::SafeDownCast(&object)) return add_data_set(*set, name, 0, sink, data);
  if (auto* const amr = vtkUniformGridAMR::SafeDownCast(&object)) return add_levels(*amr, name, sink, data);
  auto* const tree = vtkDataObjectTree::SafeDownCast(&object);
  if (!tree) fail(std::string("holds data of the kind ") + object.GetClassName() + ", which is not a volume");
  // Visits the children separately, each with the name from its parent.
  const auto at = vtkSmartPointer<vtkDataObjectTreeIterator>::Take(tree->NewTreeIterator());
  at->TraverseSubTreeOff();
  at->VisitOnlyLeavesOff();
  at->SkipEmptyNodesOn();
  for (at->InitTraversal(); !at->IsDoneWithTraversal(); at->GoToNextItem()) {
    std::string own;
    if (at->HasCurrentMetaData() && at->GetCurrentMetaData()->Has(vtkCompositeDataSet::NAME()))
      own = at->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME());
    const bool both = !name.empty() && !own.empty();
    if (vtkDataObject* const child = at->GetCurrentDataObject())
      add_blocks(*child, both ? name + "/" + own : name + own, sink, data);
  }
}

void tidy_blocks(GridData& data) {
  const auto has_volume = [](const GridBlock& b) {
    if (b.kind == GridKind::unstructured) return !b.cells.empty();
    return b.kind != GridKind::scattered && std::count(b.dims.begin(), b.dims.end(), std::size_t{1}) == 0;
  };
  const auto has_surface = [&](const GridBlock& b) { return b.kind != GridKind::scattered; };
  const auto keep = [&](const auto& wanted, const char* others) {
    const auto left =
        std::count_if(data.blocks.begin(), data.blocks.end(), [&](const GridBlock& b) { return !wanted(b); });
    if (left == 0 || left == static_cast<std::ptrdiff_t>(data.blocks.size())) return;
    std::erase_if(data.blocks, [&](const GridBlock& b) { return !wanted(b); });
    data.notes.push_back(std::to_string(left) + (left == 1 ? " block of " : " blocks of ") + others +
                         (left == 1 ? " was left out" : " were left out"));
  };
  keep(has_surface, "points without cells");
  keep(has_volume, "surfaces");
  std::vector<std::string> notes;
  std::map<std::string, std::size_t> times;
  for (const std::string& note : data.notes) {
    if (++times[note] == 1) notes.push_back(note);
  }
  for (std::string& note : notes) {
    if (times[note] > 1) note += " (in " + std::to_string(times[note]) + " blocks)";
  }
  data.notes = std::move(notes);
}

}  // namespace sansmesh::inline v1::io
