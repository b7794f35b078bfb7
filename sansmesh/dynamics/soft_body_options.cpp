#include "sansmesh/simulate_options.h"

#include <cmath>
#include <string>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

bool is_positive(double x) { return std::isfinite(x) && x > 0; }
bool is_not_negative(double x) { return std::isfinite(x) && x >= 0; }

[[noreturn]] void bad_entry(const char* list, std::size_t entry, const std::string& cause) {
  throw ArgumentError("`" + std::string(list) + "` " + std::to_string(entry) + " (counted from 0): " + cause);
}

void check_vertices(const char* list, std::size_t entry, const std::vector<std::uint32_t>& vertices, std::size_t n) {
  for (const std::uint32_t v : vertices) {
    if (v >= n) {
      bad_entry(list, entry,
                "there is no vertex " + std::to_string(v) + ", the mesh has 0.." + std::to_string(n ? n - 1 : 0));
    }
  }
}

void check_handle(std::size_t entry, const PulledHandle& handle) {
  constexpr const char* kList = "handles";
  if (handle.vertices.empty()) bad_entry(kList, entry, "it has no vertices");
  if (handle.keys.empty()) bad_entry(kList, entry, "it has no `keys`");
  for (std::size_t k = 0; k < handle.keys.size(); ++k) {
    const HandleKey& key = handle.keys[k];
    if (!std::isfinite(key.time) || !is_finite(key.displacement) || !is_finite(key.turn)) {
      bad_entry(kList, entry, "key " + std::to_string(k) + " is not finite");
    }
    if (k > 0 && !(key.time > handle.keys[k - 1].time))
      bad_entry(kList, entry, "the times of its `keys` must increase");
  }
  if (handle.center && !is_finite(*handle.center)) bad_entry(kList, entry, "its `center` is not finite");
  if (handle.stiffness && !is_positive(*handle.stiffness)) bad_entry(kList, entry, "its `stiffness` must be positive");
}

}  // namespace

void SoftBodyOptions::validate() const {
  const Registry<BodyIntegrator>& known = BodyIntegrator::registry();
  if (!known.find(integrator))
    throw ArgumentError(ArgumentFault{.field = "integrator",
                                      .value = "'" + printable(integrator, 60) + "'",
                                      .allowed = "one of " + known.names(),
                                      .remedy = {}});
  check_argument(is_positive(step), "`step` must be a positive time");
  check_argument(is_positive(stiffness), "`stiffness` must be positive");
  check_argument(is_not_negative(damping), "`damping` must be at least 0");
  check_argument(is_positive(young), "`young` must be positive");
  check_range("poisson", poisson, 0, 0.49);
  check_argument(is_not_negative(mass_damping), "`mass_damping` must be at least 0");
  check_argument(is_not_negative(stiffness_damping), "`stiffness_damping` must be at least 0");
  check_argument(is_positive(density), "`density` must be positive");
  check_argument(!total_mass || is_positive(*total_mass), "`total_mass` must be positive");
  check_argument(is_finite(gravity), "`gravity` must be finite");
  check_range("tolerance", tolerance, 1e-14, 0.1);
  check_argument(iterations >= 1, "`iterations` must be at least 1");
  check_range("halvings", halvings, 0, 20);
}

void DynamicsScene::validate(std::size_t vertices) const {
  std::vector<std::uint8_t> taken(vertices, 0);
  const auto take = [&](const char* list, std::size_t entry, const std::vector<std::uint32_t>& held) {
    check_vertices(list, entry, held, vertices);
    for (const std::uint32_t v : held) {
      if (taken[v]) bad_entry(list, entry, "vertex " + std::to_string(v) + " is fixed or pulled already");
      taken[v] = 1;
    }
  };
  for (std::size_t k = 0; k < fixed.size(); ++k) {
    if (fixed[k] >= vertices) check_vertices("fixed", k, {fixed[k]}, vertices);
    taken[fixed[k]] = 1;  // duplicates are allowed
  }
  for (std::size_t k = 0; k < handles.size(); ++k) {
    check_handle(k, handles[k]);
    take("handles", k, handles[k].vertices);
  }
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const VertexForce& f = forces[k];
    if (f.vertices.empty()) bad_entry("forces", k, "it has no vertices");
    check_vertices("forces", k, f.vertices, vertices);
    if (!is_finite(f.force)) bad_entry("forces", k, "its `force` is not finite");
    if (!(f.from < f.until)) bad_entry("forces", k, "`from` must be before `until`");
  }
  for (std::size_t k = 0; k < floors.size(); ++k) {
    const FloorObstacle& f = floors[k];
    if (!is_finite(f.point) || !is_finite(f.normal) || !(norm(f.normal) > 0)) {
      bad_entry("floors", k, "it needs a finite `point` and a `normal` that has a length");
    }
    if (!is_not_negative(f.friction)) bad_entry("floors", k, "its `friction` must be at least 0");
  }
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    const SphereObstacle& s = spheres[k];
    if (!is_finite(s.center) || !is_positive(s.radius)) {
      bad_entry("spheres", k, "it needs a finite `center` and a positive `radius`");
    }
    if (!is_not_negative(s.friction)) bad_entry("spheres", k, "its `friction` must be at least 0");
  }
}

}  // namespace sansmesh::inline v1
