// Parts of a solid read from an expression.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/note.h"
#include "sansmesh/surface_function.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A solid that is built when it is first used: fields of meshes take longer than operations on their faces.
class LateSolid {
 public:
  explicit LateSolid(std::function<Solid()> make) : make_(std::move(make)) {}
  const Solid& get() const {
    std::call_once(once_, [&] { solid_.emplace(make_()); });
    return *solid_;
  }

 private:
  std::function<Solid()> make_;
  mutable std::once_flag once_;
  mutable std::optional<Solid> solid_;
};

struct SolidParts {
  std::string expression;
  Solid outline;                                          ///< the solid; its meshes may have only faces, and no values
  std::shared_ptr<const LateSolid> whole;                 ///< the solid with all its values
  std::vector<std::string> files = {};                    ///< files in the expression
  std::map<std::string, SurfaceFunction> functions = {};  ///< the functions among them
  std::vector<Note> notes = {};
  std::shared_ptr<const ReferenceSystem> reference = {};  ///< common reference system of the files; null if unknown

  const Solid& solid() const { return whole ? whole->get() : outline; }

  /// The function, if the solid consists of it alone; otherwise null.
  const SurfaceFunction* whole_function() const;
};

/// Whether enough of a function's surface bounds no solid to warrant a warning.
bool is_open(const SurfaceFunction& function);

}  // namespace sansmesh::inline v1
