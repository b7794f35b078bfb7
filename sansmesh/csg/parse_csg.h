// Parser of CSG expressions: `a.smf - cylinder(axis=z, r=0.1)`. The grammar is in docs/methods/csg.md.
#pragma once

#include <functional>
#include <string>

#include "sansmesh/csg/solid.h"

namespace sansmesh::inline v1 {

/// Creates the solid of a name in an expression, usually from a file. Called once for each name.
using SolidLoader = std::function<Solid(const std::string& name)>;

/// Throws ArgumentError "expression at N: …" for text that does not follow the grammar or describes an invalid solid; N
/// counts characters from 1. The loader is called only after the whole text has been parsed successfully; its
/// exceptions pass through. Names in offsets and shells, whose values must also be distances far from the surface, use
/// `distance_loader` if given.
Solid parse_csg(const std::string& text, const SolidLoader& loader, const SolidLoader& distance_loader = {});

}  // namespace sansmesh::inline v1
