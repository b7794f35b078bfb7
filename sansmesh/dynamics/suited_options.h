// Defaults of simulations that depend on the body.
#pragma once

#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/simulate_options.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Metres per unit of length: the script's unit, if given. Without a unit and without any value in absolute units
/// (stiffness, elasticity, density, mass), a body that would be larger than 20 m is taken to be in centimetres or
/// millimetres. `mesh` is in the file's unit.
double suited_unit(const SceneScript& script, const TetMesh& mesh);

/// Options with defaults for everything that the script leaves out. `mesh` is in metres; the script's scene is still in
/// the file's unit (script.unit). The default material bends under its own weight but stands (Young's modulus 25 times
/// density, gravity and size; springs as stiff as a tetrahedron's edge of that material), with slight damping. The step
/// of explicit methods is half of the stable one, else 0.01 s. Throws ArgumentError if no step is stable (explicit
/// Euler without damping).
SoftBodyOptions suited_options(const SceneScript& script, const TetMesh& mesh);

}  // namespace sansmesh::inline v1
