// What a scene does not say about its body, chosen from the body.
#pragma once

#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/simulate_options.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Metres of the unit of length: what the script says. Of a body of which nobody says a unit, nor anything that is
/// known in absolute units (stiffness, elasticity, density, mass), centimetres or millimetres where it would be more
/// than 20 m large otherwise. `mesh` in the file's unit.
double suited_unit(const SceneScript& script, const TetMesh& mesh);

/// What is not said, from the body: `mesh` in metres, `script` with all that is known, its scene still in the file's
/// unit (script.unit). A body of unknown material is one that bends under its own weight but stands (Young's modulus 25
/// times density, gravity and size; springs as stiff as a tetrahedron's edge of it), a little damped. The step of
/// explicit methods is half of what is stable, else 0.01 s. Throws ArgumentError where none is stable (explicit Euler
/// without damping).
SoftBodyOptions suited_options(const SceneScript& script, const TetMesh& mesh);

}  // namespace sansmesh::inline v1
