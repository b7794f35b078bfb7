// Cuts of deformations, as users write them.
#pragma once

#include <memory>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/deform/occluder.h"

namespace sansmesh::inline v1 {

/// "half-plane(x,y,z; x,y,z; x,y,z)": a point of its edge, its normal, and where it extends to; "polygon(x,y,z; …)"
/// with "|" before each hole; or the name of a mesh. `domain` holds handles and what is deformed. Throws ArgumentError,
/// FileError.
std::shared_ptr<const Occluder> read_cut(const std::string& text, const Box3& domain);

}  // namespace sansmesh::inline v1
