// Benchmark of displacement maps of 64³ to 256³ points by moving least squares on 15 handles, for each kind: seconds,
// beside table 6.2 of tejada2008, 6.4, and errors of single precision and of the lattice. Then the experiment of
// figure 6.12: rotations by a plain singular value decomposition jump and flip, those of the library do not.
//
//   benchmark_deformation [largest size, default 256]
//   benchmark_deformation picture FILE.png   a plate through both, plain singular values on the left
#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/deform/maps/folds.h"
#include "sansmesh/deform/mls/mls_deformation.h"
#include "sansmesh/deform/mls/rotation_fit.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/meshing/mesh_csg.h"
#include "sansmesh/progress.h"
#include "sansmesh/render_options.h"
#include "timing.h"

namespace {

using namespace sansmesh;

constexpr int kRounds = 3;

/// 15 handles in −1..1 as in figure 6.8: most are fixed, some move up to half a unit.
std::vector<Handle> fifteen_handles() {
  std::mt19937 random(15);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Handle> handles(15);
  for (std::size_t i = 0; i < handles.size(); ++i) {
    handles[i].p = handles[i].q = {u(random), u(random), u(random)};
    if (i % 3 == 0) handles[i].p += Vec3{u(random), u(random), u(random)} * 0.3;
  }
  return handles;
}

struct Row {
  const char* name;
  DeformationKind kind;
  int degree;
  std::array<double, 6> thesis;  ///< CPU and GPU seconds for 64³, 128³, 256³; 0: not given
};

void time_maps(std::size_t largest) {
  const Row rows[] = {
      {"affine", DeformationKind::affine, 2, {.633, .004, 4.868, .015, 38.55, .104}},
      {"rigid", DeformationKind::rigid, 2, {1.125, .008, 8.779, .045, 69.97, .325}},
      {"similarity", DeformationKind::similarity, 2, {1.133, .008, 8.976, .045, 70.55, .325}},
      {"nonlinear, degree 2", DeformationKind::nonlinear, 2, {9.27, .102, 117.18, .46, 793, .73}},
      {"nonlinear, degree 3 (30 handles)", DeformationKind::nonlinear, 3, {}},
  };
  const Box3 box{{-1, -1, -1}, {1, 1, 1}};
  fmt::print("Displacement maps, 15 handles, {} threads: wall seconds (CPU seconds), best of {}; thesis: CPU, GPU\n\n",
             thread_count(), kRounds);
  fmt::print(
      "| kind | size | seconds | thesis CPU | thesis GPU | error of floats / box |\n|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    std::vector<Handle> handles = fifteen_handles();
    if (row.degree == 3) {
      for (Handle h : fifteen_handles()) h.q = h.q * -0.7, h.p = h.p * -0.7, handles.push_back(h);
    }
    MlsDeformationOptions options;
    options.kind = row.kind, options.degree = row.degree;
    const MlsDeformation map(handles, options);
    for (std::size_t n = 64, column = 0; n <= largest; n *= 2, column += 2) {
      double wall = 1e9, cpu = 1e9, worst = 0;
      for (int round = 0; round < (row.degree == 3 && n > 128 ? 1 : kRounds); ++round) {
        Progress progress;
        const Time start = now();
        const DisplacementMap lattice = displacement_map(map, box, {n, n, n}, progress);
        const Time time = now() - start;
        wall = std::min(wall, time.wall), cpu = std::min(cpu, time.cpu);
        if (round > 0 || n > 128) continue;
        std::vector<Vec3> x;
        for (std::size_t i = 0; i < n * n * n; i += 101) {
          const double last = static_cast<double>(n - 1);
          x.push_back({2 * static_cast<double>(i % n) / last - 1, 2 * static_cast<double>(i / n % n) / last - 1,
                       2 * static_cast<double>(i / n / n) / last - 1});
        }
        std::vector<Vec3> exact(x.size()), looked_up(x.size());
        map.map(x, {exact, {}, {}, {}});
        lattice.map(x, {looked_up, {}, {}, {}});
        for (std::size_t i = 0; i < x.size(); ++i)
          worst = std::max(worst, norm(exact[i] - looked_up[i]) / box.diagonal());
      }
      fmt::print("| {} | {}³ | {:.3f} ({:.3f}) | {} | {} | {} |\n", row.name, n, wall, cpu,
                 row.thesis[column] > 0 ? fmt::format("{:.3g}", row.thesis[column]) : "–",
                 row.thesis[column] > 0 ? fmt::format("{:.3g}", row.thesis[column + 1]) : "–",
                 worst > 0 ? fmt::format("{:.1e}", worst) : "–");
    }
  }
}

/// Times Jacobians, which are evaluated point by point.
void time_folds() {
  fmt::print("\nDeterminants of Jacobians on 64³ places (find_folds), 15 handles: wall seconds (CPU seconds)\n\n");
  for (const auto& [name, kind] :
       {std::pair("affine", DeformationKind::affine), std::pair("rigid", DeformationKind::rigid),
        std::pair("similarity", DeformationKind::similarity),
        std::pair("nonlinear, degree 2", DeformationKind::nonlinear)}) {
    MlsDeformationOptions options;
    options.kind = kind;
    const MlsDeformation map(fifteen_handles(), options);
    Progress progress;
    const Time start = now();
    const FoldReport report = find_folds(map, {{-1, -1, -1}, {1, 1, 1}}, {64, 64, 64}, progress);
    const Time time = now() - start;
    fmt::print("{}: {:.3f} ({:.3f}); folded {:.2f} % in {} places\n", name, time.wall, time.cpu, 100 * report.share,
               report.folds.size());
  }
}

/// Largest jump of a rotation between lattice neighbours, and number of reflections.
struct Noise {
  std::size_t mirrored = 0, jumps = 0;
  double largest = 0;
};

using Turn = detail::Rows3 (*)(const detail::Rows3&);

/// U Vᵀ by plain singular values: orthogonal, not always a rotation.
detail::Rows3 plain_svd(const detail::Rows3& b) {
  Eigen::Matrix3d m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m(static_cast<int>(i), static_cast<int>(j)) = b[i][j];
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d r = svd.matrixU() * svd.matrixV().transpose();
  detail::Rows3 rows;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) rows[i][j] = r(static_cast<int>(i), static_cast<int>(j));
  return rows;
}

/// Σ w q̂ p̂ᵀ at a point, with the means.
struct Moment {
  detail::Rows3 b{};
  Vec3 q, p;
};
Moment moment_at(const std::vector<Handle>& handles, const Vec3& x, bool weighted) {
  Moment m;
  double sum = 0;
  std::vector<double> w;
  for (const Handle& h : handles) {
    w.push_back(1 / (squared_norm(x - h.q) + 1e-12));
    sum += w.back(), m.q += h.q * w.back(), m.p += h.p * w.back();
  }
  m.q = m.q / sum, m.p = m.p / sum;
  for (std::size_t h = 0; h < handles.size(); ++h)
    for (std::size_t k = 0; k < 3; ++k)
      m.b[k] += (handles[h].q - m.q) * ((weighted ? w[h] : 1) * (handles[h].p - m.p)[k]);
  return m;
}

Noise noise_of(Turn turn, const std::vector<Handle>& handles, bool weighted, double thickness, std::size_t n) {
  std::vector<detail::Rows3> turns(n * n * n);
  Noise noise;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double last = static_cast<double>(n - 1);
    const Vec3 x{2 * static_cast<double>(i % n) / last - 1, 2 * static_cast<double>(i / n % n) / last - 1,
                 (2 * static_cast<double>(i / n / n) / last - 1) * std::max(thickness, 0.2)};
    turns[i] = turn(moment_at(handles, x, weighted).b);
    const detail::Rows3& r = turns[i];
    noise.mirrored += dot(r[0], cross(r[1], r[2])) < 0;
    const auto compare = [&](std::size_t other) {
      double square = 0;
      for (std::size_t k = 0; k < 3; ++k) square += squared_norm(r[k] - turns[other][k]);
      noise.largest = std::max(noise.largest, std::sqrt(square));
      noise.jumps += square > 1;
    };
    if (i % n > 0) compare(i - 1);
    if (i / n % n > 0) compare(i - n);
    if (i / n / n > 0) compare(i - n * n);
  }
  return noise;
}

void count_flips() {
  fmt::print(
      "\nRotations on 48³ places (figure 6.12): mirrored ones, jumps of more than 1 (norm of the difference) "
      "between neighbours, the largest\n\n");
  fmt::print("| handles | rotations | mirrored | jumps | largest |\n|---|---|---|---|---|\n");
  for (const double thickness : {1.0, 0.05, 0.0}) {
    std::vector<Handle> handles = fifteen_handles();
    for (std::size_t i = 0; i < handles.size(); ++i) {
      handles[i].q.z *= thickness;
      handles[i].p = handles[i].q + (handles[i].p - handles[i].q) * (thickness < 1 ? 0.5 : 2.5);
    }
    const std::string name = thickness == 1 ? "all around" : fmt::format("{} thick", thickness);
    const auto line = [&](const char* how, const Noise& noise) {
      fmt::print("| {} | {} | {} | {} | {:.3f} |\n", name, how, noise.mirrored, noise.jumps, noise.largest);
    };
    line("singular values, unweighted", noise_of(&plain_svd, handles, false, thickness, 48));
    line("singular values, weighted", noise_of(&plain_svd, handles, true, thickness, 48));
    line("quartic (library)", noise_of(&detail::best_rotation, handles, true, thickness, 48));
  }
}

/// The rigid map with rotations by plain singular values.
class PlainSvdMap : public SpaceMap {
 public:
  explicit PlainSvdMap(std::vector<Handle> handles) : handles_(std::move(handles)) {}
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
    for (std::size_t i = 0; i < x.size() && !wanted.positions.empty(); ++i) {
      const Moment m = moment_at(handles_, x[i], true);
      const detail::Rows3 r = plain_svd(m.b);
      wanted.positions[i] = m.p + Vec3{dot(r[0], x[i] - m.q), dot(r[1], x[i] - m.q), dot(r[2], x[i] - m.q)};
    }
    std::fill(wanted.jacobians.begin(), wanted.jacobians.end(), Jacobian{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  }

 private:
  std::vector<Handle> handles_;
};

/// Draws a plate with holes and 15 handles in its middle plane, deformed by rotations from plain singular values and by
/// ours.
void draw_noise(const std::string& file) {
  std::vector<Handle> handles = fifteen_handles();
  for (Handle& h : handles) {
    h.q.z = 0;
    h.p = h.q + (h.p - h.q) * 0.8;
  }
  Solid plate = csg::box({-1, -1, -0.15}, {1, 1, 0.15}, 0.05);
  for (const double a : {-0.5, 0.5})
    for (const double b : {-0.5, 0.5}) plate = csg::subtract(plate, csg::cylinder({a, b, 0}, {0, 0, 1}, 0.25));
  Progress progress;
  CsgMeshOptions options;
  options.resolution = 160;
  options.simplify = 0;
  TriangleMesh mesh = mesh_csg(plate, options, progress);
  mesh.normals.clear();
  RenderOptions look;
  look.view.width = 480, look.view.height = 400;
  look.view.direction = {30, 40};
  look.view.up = UpAxis::z;
  const PlainSvdMap plain(handles);
  const MlsDeformation ours(handles, {});
  Image both(2 * look.view.width, look.view.height);
  int column = 0;
  for (const SpaceMap* map : {static_cast<const SpaceMap*>(&plain), static_cast<const SpaceMap*>(&ours)}) {
    TriangleMesh moved = deform_mesh(mesh, *map);
    moved.normals.clear();
    const Image image = render_mesh(moved, look);
    for (int y = 0; y < look.view.height; ++y)
      for (int x = 0; x < look.view.width; ++x) both.at(column + x, y) = image.at(x, y);
    column += look.view.width;
  }
  write_image(file, both);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "picture") {
    draw_noise(argv[2]);
    return 0;
  }
  time_maps(argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 256);
  time_folds();
  count_flips();
}
