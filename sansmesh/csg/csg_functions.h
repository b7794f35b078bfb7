// Functions of CSG expressions: names, parameters and implementations.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "sansmesh/csg/solid.h"

namespace sansmesh::inline v1 {

struct CsgParameter {
  enum class Kind {
    number,
    vector,     ///< (x, y, z)
    direction,  ///< x, y, z, -x, … or a vector
    size,       ///< a vector, or one number for all three
    side,       ///< both, inside or outside
  };
  const char* name;
  Kind kind = Kind::number;
  bool required = false;
};

/// Value of a parameter in a call.
struct CsgArgument {
  bool given = false;
  double number = 0;
  Vec3 vector;
  csg::ShellSide side = csg::ShellSide::both;
};

class CsgArguments;

struct CsgFunction {
  const char* name;
  std::size_t least_solids, most_solids;  ///< solids precede the parameters
  std::vector<CsgParameter> parameters;   ///< in the order of unnamed arguments
  Solid (*make)(const CsgArguments&);     ///< throws ArgumentError
  bool distances = false;                 ///< the values of its solids must also be distances far from their surfaces
};

/// One call of a function.
class CsgArguments {
 public:
  explicit CsgArguments(const CsgFunction& function) : function_(function), values_(function.parameters.size()) {}

  std::vector<Solid> solids;
  std::vector<CsgArgument>& values() { return values_; }

  /// `name` is one of the function's parameters.
  const CsgArgument& operator[](std::string_view name) const;
  double number(std::string_view name, double otherwise) const;
  Vec3 vector(std::string_view name, const Vec3& otherwise = {}) const;

 private:
  const CsgFunction& function_;
  std::vector<CsgArgument> values_;
};

/// All functions.
std::span<const CsgFunction> csg_functions();

/// Union or intersection of all, as a balanced tree: distant parts of it need not be evaluated.
Solid combine_all(std::span<const Solid> solids, bool intersection);

}  // namespace sansmesh::inline v1
