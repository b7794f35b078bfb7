// bullet_soft_body TETS STIFFNESS: steps of 0.01 s of Bullet's soft bodies on the edges of tetrahedra, one
// thread.
//
// TETS is text: numbers of vertices and tetrahedra, positions, corners, then the number of fixed vertices and these.
// Prints lines of a name, milliseconds and CPU milliseconds of a step, the medians of the first seven: of Bullet's soft
// body, which moves positions (links without a stiffness in newtons; one iteration is its default), and of its
// deformable body, whose springs of STIFFNESS newtons a metre take implicit Euler steps by at most 40 conjugate
// gradients. (Its corotational elasticity is left out: with these steps it diverges.)
#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <set>
#include <utility>
#include <vector>

namespace {

constexpr btScalar kStep = btScalar(0.01);
const btVector3 kGravity(0, 0, btScalar(-9.81));

struct Mesh {
  std::vector<btVector3> vertices;
  std::vector<std::array<int, 4>> tets;
  std::vector<int> fixed;
};

Mesh read(const char* file) {
  std::ifstream in(file);
  std::size_t n = 0, m = 0, k = 0;
  in >> n >> m;
  Mesh mesh;
  mesh.vertices.resize(n), mesh.tets.resize(m);
  for (btVector3& p : mesh.vertices) in >> p[0] >> p[1] >> p[2];
  for (auto& t : mesh.tets) in >> t[0] >> t[1] >> t[2] >> t[3];
  in >> k;
  mesh.fixed.resize(k);
  for (int& v : mesh.fixed) in >> v;
  if (!in) std::exit(2);
  return mesh;
}

/// The edges as links, 0.2 kg a vertex, stretched by a tenth.
btSoftBody* body_of(const Mesh& mesh, btSoftBodyWorldInfo& info) {
  auto* body = new btSoftBody(&info, static_cast<int>(mesh.vertices.size()), mesh.vertices.data(), nullptr);
  std::set<std::pair<int, int>> edges;
  for (const auto& t : mesh.tets) {
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) edges.insert({std::min(t[a], t[b]), std::max(t[a], t[b])});
    }
  }
  for (const auto& [a, b] : edges) body->appendLink(a, b);
  for (int i = 0; i < body->m_nodes.size(); ++i) body->setMass(i, btScalar(0.2));
  for (const int v : mesh.fixed) body->setMass(v, 0);
  for (int i = 0; i < body->m_nodes.size(); ++i) {
    body->m_nodes[i].m_x.setZ(body->m_nodes[i].m_x.z() * btScalar(1.1));
    body->m_nodes[i].m_q = body->m_nodes[i].m_x;
  }
  return body;
}

template <class Step>
void measure(const char* name, const Step& step) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); };
  std::vector<double> walls, cpus;
  for (int k = 0; k < 7; ++k) {
    const auto before = Clock::now();
    const std::clock_t used = std::clock();
    step();
    walls.push_back(since(before)), cpus.push_back(static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC);
  }
  std::sort(walls.begin(), walls.end()), std::sort(cpus.begin(), cpus.end());
  std::printf("%s %.4f %.4f\n", name, 1000 * walls[walls.size() / 2], 1000 * cpus[cpus.size() / 2]);
  std::fflush(stdout);
}

void by_positions(const Mesh& mesh, const char* name, int iterations) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDefaultSoftBodySolver soft;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration, &soft);
  world.setGravity(kGravity);
  world.getWorldInfo().m_gravity = kGravity;
  btSoftBody* body = body_of(mesh, world.getWorldInfo());
  body->m_cfg.piterations = iterations;
  world.addSoftBody(body);
  measure(name, [&] { world.stepSimulation(kStep, 1, kStep); });
  world.removeSoftBody(body);
  delete body;
}

void implicitly(const Mesh& mesh, const char* name, btScalar stiffness) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btDeformableBodySolver deformable;
  btDeformableMultiBodyConstraintSolver solver;
  solver.setDeformableSolver(&deformable);
  btDeformableMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration, &deformable);
  world.setGravity(kGravity);
  world.getWorldInfo().m_gravity = kGravity;
  world.setImplicit(true);
  world.setUseProjection(true);  // without it nothing moves
  btSoftBody* body = body_of(mesh, world.getWorldInfo());
  body->m_sleepingThreshold = 0;
  world.addSoftBody(body);
  btDeformableGravityForce gravity(kGravity);
  btDeformableMassSpringForce springs(stiffness, 1, true, -1);
  world.addForce(body, &springs);
  world.addForce(body, &gravity);
  measure(name, [&] { world.stepSimulation(kStep, 1, kStep); });
  world.removeSoftBody(body);
  delete body;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const Mesh mesh = read(argv[1]);
  by_positions(mesh, "positions-1", 1);
  by_positions(mesh, "positions-10", 10);
  by_positions(mesh, "positions-40", 40);
  implicitly(mesh, "implicit-springs", static_cast<btScalar>(std::atof(argv[2])));
}
