#include "sansmesh/solids.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "sansmesh/csg/parse_csg.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/error.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function/function_distance.h"
#include "sansmesh/function/function_solid.h"
#include "sansmesh/function/mesh_solid.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/meshes/solid_parts.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {
namespace {

/// Share of the area that bounds no solid above which a function is reported.
constexpr double kOpenShare = 0.01;

/// A closed and oriented mesh.
struct CheckedMesh {
  std::shared_ptr<const TriangleMesh> mesh;
  bool overlaps = false;  ///< its parts overlap: it has no distance

  Solid distance(const std::string& name, bool rounded) const {
    try {
      if (overlaps) require_no_overlaps(*mesh);
    } catch (const DataError& e) {
      throw FileError(name, e.what());
    }
    return solid_of_checked(*mesh, rounded);
  }
};

/// Reads the files of an expression, each once.
class SolidReader {
 public:
  explicit SolidReader(Progress& progress) : progress_(progress) {}

  std::vector<std::string> files;
  std::map<std::string, SurfaceFunction> functions;
  std::vector<Note> notes;
  std::shared_ptr<const ReferenceSystem> reference;  ///< common to the files; null if unknown
  std::map<std::string, CheckedMesh> meshes;
  bool all_meshes = false;  ///< no functions or volumes: meshes are read as faces

  Solid solid(const std::string& name) {
    if (const auto named = parse_isosurface_name(name)) {
      files.push_back(name);
      VolumeModel volume = open_volume({named->file}, {.array = named->array}, progress_);
      for (Note& note : volume.notes()) notes.push_back(std::move(note));
      return isosurface_solid(volume.isosurface(named->value, progress_, notes));
    }
    return is_function_file(name) ? function_solid(function(name)) : mesh(name, false);
  }

  /// Exact distance, for offsets and shells.
  Solid distance(const std::string& name) {
    if (parse_isosurface_name(name))
      throw ArgumentError(fmt::format(
          "'{}': offsets and shells of isosurfaces need a function: mesh the isosurface and fit one to the mesh",
          name));
    return is_function_file(name) ? function_distance_solid(function(name), progress_) : mesh(name, true);
  }

 private:
  void add_reference(const std::string& name, const std::shared_ptr<const ReferenceSystem>& of_file) {
    if (const auto* const other = systems_.add(name, of_file))
      require_same_system(other->system.get(), other->name, of_file.get(), name);
    reference = systems_.system();
  }

  void add_file(const std::string& name) {
    if (std::find(files.begin(), files.end(), name) == files.end()) files.push_back(name);
  }

  std::shared_ptr<const FittedFunction> function(const std::string& name) {
    auto known = functions.find(name);
    if (known == functions.end()) known = functions.emplace(name, read_function(name)).first;
    add_file(name);
    add_reference(name, known->second.fitted().frame.reference);
    return known->second.shared();
  }

  /// With `all_meshes` the faces alone.
  Solid mesh(const std::string& name, bool rounded) {
    auto known = meshes.find(name);
    if (known == meshes.end()) known = meshes.emplace(name, load_solid(name)).first;
    add_file(name);
    const CheckedMesh& checked = known->second;
    return all_meshes ? csg::face_leaf(checked.mesh, checked.overlaps) : checked.distance(name, rounded);
  }

  CheckedMesh load_solid(const std::string& name) {
    TriangleMesh loaded = load_mesh(name);
    add_reference(name, loaded.reference);
    std::vector<std::string> warnings;
    try {
      CheckedMesh checked;
      checked.mesh = std::make_shared<const TriangleMesh>(
          checked_solid(std::move(loaded), warnings, all_meshes ? &checked.overlaps : nullptr));
      add_notes(notes, "mesh_solid", warnings, name);
      return checked;
    } catch (const DataError& e) {
      throw FileError(name, e.what());
    }
  }

  TriangleMesh load_mesh(const std::string& file) {
    ReadReport report;
    PointSet points = read_points(file, &report);
    if (points.triangles.empty())
      throw FileError(file, "neither a function (.smf) nor a mesh: fit a function to the points first");
    add_notes(notes, "read", report.warnings, file);
    return to_mesh(std::move(points));
  }

  Progress& progress_;
  CommonSystem systems_;
};

}  // namespace

SolidModel::SolidModel(SolidParts parts) : parts_(std::make_shared<const SolidParts>(std::move(parts))) {}

const std::string& SolidModel::expression() const { return parts_->expression; }

const std::vector<std::string>& SolidModel::files() const { return parts_->files; }

Box3 SolidModel::bounds() const { return parts_->outline.bounds(); }

const std::vector<Note>& SolidModel::notes() const { return parts_->notes; }

ComponentChoice SolidModel::default_components() const {
  return {parts_->functions.empty() ? ComponentChoice::Kind::all : ComponentChoice::Kind::automatic, 1};
}

const SurfaceFunction* SolidParts::whole_function() const {
  return functions.size() == 1 && functions.begin()->first == expression ? &functions.begin()->second : nullptr;
}

std::vector<Note> SolidModel::open_notes() const {
  std::vector<Note> found;
  for (const auto& [name, function] : parts_->functions)
    if (is_open(function))
      found.push_back(
          {.code = "open", .text = "its surface bounds no solid: everything behind it in the box is used", .of = name});
  return found;
}

bool is_open(const SurfaceFunction& function) {
  const PartitionReport& fitted = function.fitted().field.report();
  return fitted.open_area > kOpenShare * fitted.area;
}

SolidModel read_solid(const std::string& expression, Progress& progress) {
  progress.begin("read");
  SolidReader reader(progress);
  reader.all_meshes = true;
  parse_csg(expression,
            [&](const std::string& name) {
              if (is_function_file(name) || parse_isosurface_name(name)) reader.all_meshes = false;
              return csg::sphere({}, 1);
            },
            {});
  Solid outline = parse_csg(
      expression, [&](const std::string& name) { return reader.solid(name); },
      [&](const std::string& name) { return reader.distance(name); });
  std::shared_ptr<const LateSolid> whole;
  if (!reader.meshes.empty() && reader.all_meshes)
    whole = std::make_shared<const LateSolid>([expression, meshes = std::move(reader.meshes)] {
      return parse_csg(
          expression, [&](const std::string& name) { return meshes.at(name).distance(name, false); },
          [&](const std::string& name) { return meshes.at(name).distance(name, true); });
    });
  return SolidModel({expression, std::move(outline), whole, std::move(reader.files), std::move(reader.functions),
                     std::move(reader.notes), std::move(reader.reference)});
}

const ReportSchema& SolidModel::schema() {
  static constexpr ReportRow rows[] = {reported<&SolidModel::expression>({.text = "Expression"}),
                                       reported<&SolidModel::files>({.text = "Files in the expression"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
