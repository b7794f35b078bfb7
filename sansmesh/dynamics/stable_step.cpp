#include "sansmesh/dynamics/stable_step.h"

#include "sansmesh/dynamics/soft_body.h"

namespace sansmesh {

double stable_step(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene) {
  return SoftBody(mesh, options, scene).stable_step();
}

}  // namespace sansmesh
