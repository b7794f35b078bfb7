#include "sansmesh/dynamics/stable_step.h"

#include "sansmesh/dynamics/soft_body.h"

namespace sansmesh::inline v1 {

double stable_step(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene) {
  return SoftBody(mesh, options, scene).stable_step();
}

}  // namespace sansmesh::inline v1
