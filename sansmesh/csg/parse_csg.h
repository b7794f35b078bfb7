// Solids written as text: `a.smf - cylinder(axis=z, r=0.1)`. The grammar is in docs/methods/csg.md.
#pragma once

#include <functional>
#include <string>

#include "sansmesh/csg/solid.h"

namespace sansmesh::inline v1 {

/// Makes the solid that a name in an expression stands for, usually that of a file. Called once for each name.
using SolidLoader = std::function<Solid(const std::string& name)>;

/// Throws ArgumentError "expression at N: …" for text that does not follow the grammar or asks for an impossible solid;
/// N counts characters from 1. Nothing is loaded before the whole text has been found to follow the grammar. What the
/// loader throws passes through. Names in offsets and shells, whose values must be distances far from the surface, too,
/// go to `distance_loader` if there is one.
Solid parse_csg(const std::string& text, const SolidLoader& loader, const SolidLoader& distance_loader = {});

}  // namespace sansmesh::inline v1
