#include "sansmesh/render/volume/bake_options.h"

#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

void BakeOptions::validate() const {
  check_range("tolerance", tolerance, 1e-6, 1);
  if (memory < std::size_t{1} << 20) throw ArgumentError("`memory` must be at least 1 MB (1048576)");
}

}  // namespace sansmesh::inline v1
