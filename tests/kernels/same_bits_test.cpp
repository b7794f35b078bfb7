// Results are bit-identical on all instruction sets.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "render/analytic_volumes.h"
#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "sansmesh/deform/mls/mls_deformation.h"
#include "sansmesh/partition/far/global_sign.h"
#include "sansmesh/partition/fit/local_fit.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "sansmesh/render/surface/ball_segments.h"
#include "sansmesh/render/volume/baked_volume.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/bilateral_normals.h"
#include "sansmesh/surface/implicit_surface.h"
#include "sansmesh/surface/projection_surface.h"
#include "support/clouds.h"
#include "support/simd_targets.h"
#include "volume/volume_checks.h"

namespace sansmesh::test {
namespace {

/// Collects the bytes of results.
class Found {
 public:
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + values.size_bytes());
    if (!values.empty()) std::memcpy(bytes_.data() + at, values.data(), values.size_bytes());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }
  void add(double value) { add(std::span<const double>(&value, 1)); }
  std::size_t size() const { return bytes_.size(); }
  friend bool operator==(const Found&, const Found&) = default;

 private:
  std::vector<unsigned char> bytes_;
};

/// `answer` fills a Found with the results of kernels for one problem.
template <class F>
void expect_same_bits(const F& answer) {
  const std::vector<std::int64_t> targets = simd_targets();
  Found first;
  for (const std::int64_t target : targets) {
    const OnTarget here(target);
    Found found;
    answer(found);
    ASSERT_GT(found.size(), 0u);
    if (target == targets.front()) first = found;
    EXPECT_TRUE(found == first) << hwy::TargetName(target) << " differs from " << hwy::TargetName(targets.front());
  }
}

std::vector<Vec3> places(std::size_t n, double spread, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-spread, spread);
  std::vector<Vec3> x(n);
  for (Vec3& p : x) p = {u(random), u(random), u(random)};
  return x;
}

/// At samples of a cloud and next to them.
std::vector<Vec3> places_near(const PointSet& cloud, double spread, std::size_t every) {
  std::vector<Vec3> x = places(cloud.size() / every, spread, 7);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += Vec3(cloud.positions[i * every]);
  return x;
}

TEST(SameBits, NeighboursAndBalls) {
  const PointSet cloud = sphere(2000, 0.02);
  const std::vector<Vec3> x = places(100, 1.2, 3);
  expect_same_bits([&](Found& found) {
    const KdTree tree(cloud.positions);
    const BallTree balls(cloud.positions, std::vector<float>(cloud.size(), 0.11f));
    std::vector<std::uint32_t> near;
    std::vector<Neighbour> neighbours;
    for (const Vec3& p : x) {
      const Vec3f q(p);
      neighbours.resize(20);
      neighbours.resize(tree.nearest(q, neighbours));
      found.add(neighbours);
      tree.within(q, 0.3f, neighbours);
      found.add(neighbours);
      balls.touching({q, q + Vec3f{0.1f, 0.2f, 0.3f}}, near);
      found.add(near);
    }
  });
}

TEST(SameBits, LocalFits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> u(-1, 1), weight(0.01f, 1);
  for (const std::size_t n : {std::size_t{3}, std::size_t{17}, std::size_t{90}, std::size_t{1001}}) {
    LocalSamples samples;
    for (std::size_t i = 0; i < n; ++i) {
      const float a = u(random), b = u(random), c = u(random);
      samples.add(a, b, c, weight(random));
    }
    expect_same_bits([&](Found& found) {
      const DegreeFits fits = fit_all_degrees(samples, 4);
      found.add(fits.weight_sum), found.add(fits.effective_count);
      for (int degree = 0; degree <= fits.highest; ++degree) {
        found.add(fits.mean_square[static_cast<std::size_t>(degree)]);
        const std::array<float, 15> c = monomial_coefficients(fits, degree);
        found.add(std::span<const float>(c));
      }
    });
  }
}

TEST(SameBits, FarField) {
  const PointSet cloud = sphere(3000);
  std::vector<OrientedPatch> patches;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    patches.push_back({cloud.positions[i], cloud.normals[i] * 0.004f, i % 3 == 0 ? 0.01f : 0.0f});
  std::vector<Vec3f> x;
  for (const double spread : {1.5, 30.0, 1e6})
    for (const Vec3& p : places(301, spread, 4)) x.emplace_back(p);
  x.push_back(cloud.positions[0]);
  expect_same_bits([&](Found& found) {
    const GlobalSign sign(patches);
    std::vector<float> values(x.size());
    std::vector<Vec3f> gradients(x.size());
    sign.winding_number(x, values);
    found.add(values);
    sign.signed_distance(x, values);
    found.add(values);
    sign.signed_distance(x, values, gradients);
    found.add(values), found.add(gradients);
  });
}

TEST(SameBits, PartitionOfUnity) {
  for (const PointSet& cloud : {sphere(6000, 0.004), cube(6000)}) {
    std::vector<Vec3> x = places_near(cloud, 0.1, 4);
    for (const Vec3& p : places(400, 3, 8)) x.push_back(p);
    expect_same_bits([&](Found& found) {
      Progress progress;
      const PartitionOfUnity field = fit_partition_of_unity(cloud, {}, progress);
      std::vector<double> values(x.size());
      std::vector<Vec3> gradients(x.size());
      field.evaluate(x, values);
      found.add(values);
      field.evaluate(x, values, gradients);
      found.add(values), found.add(gradients);
      // Fewer points than lanes of a vector, and remainders after full vectors.
      for (std::size_t n = 1; n <= 40; ++n) {
        field.evaluate(std::span(x).first(n), std::span(values).first(n), std::span(gradients).first(n));
        found.add(values), found.add(gradients);
      }
    });
  }
}

/// Dense on one side, coarse on the other: points of one batch use different samples.
PointSet of_two_densities() {
  PointSet cloud;
  for (const std::size_t n : {std::size_t{200}, std::size_t{8000}}) {
    const PointSet all = sphere(n, 0.001);
    for (std::size_t i = 0; i < n; ++i) {
      if ((all.positions[i].x > 0) != (n > 1000)) continue;
      cloud.positions.push_back(all.positions[i]);
      cloud.normals.push_back(all.normals[i]);
    }
  }
  return cloud;
}

TEST(SameBits, ImplicitSurfaces) {
  const PointSet cloud = of_two_densities();
  const std::vector<Vec3> x = places_near(cloud, 0.1, 3);
  for (const std::string_view name : kImplicitMethods)
    for (const double smoothing : {1.2, 2.5}) {
      SCOPED_TRACE(name);
      const auto method = implicit_method(name);
      ImplicitOptions options{.method = method, .smoothing = smoothing};
      if (options.method == ImplicitMethod::amls) options.order = smoothing < 2 ? 4 : 6, options.iterations = 3;
      expect_same_bits([&](Found& found) {
        Progress progress;
        const ImplicitSurface f = make_implicit_surface(prepare_samples(cloud, progress), options, progress);
        std::vector<double> values(x.size());
        std::vector<Vec3> gradients(x.size());
        f.evaluate(x, values);
        found.add(values);
        f.evaluate(x, values, gradients);
        found.add(values), found.add(gradients);
      });
    }
}

TEST(SameBits, Projections) {
  const PointSet cloud = sphere(1500, 0.004);
  const std::vector<Vec3> x = places_near(cloud, 0.05, 3);
  using Diffusion = SurfaceDiffusion;
  for (const std::string_view name : kProjectionMethods)
    for (const Diffusion diffusion : {Diffusion::none, Diffusion::soft, Diffusion::hard}) {
      SCOPED_TRACE(name);
      const auto method = projection_method(name);
      const ProjectionOptions options{.method = method, .diffusion = diffusion};
      if (diffusion != Diffusion::none && options.method != ProjectionMethod::curvature) continue;
      expect_same_bits([&](Found& found) {
        Progress progress;
        const ProjectionSurface p = make_projection_surface(prepare_samples(cloud, progress), options, progress);
        std::vector<FootPoint> feet(x.size());
        p.project(x, feet);
        for (const FootPoint& f : feet) {  // without its padding
          found.add(f.defined ? 1.0 : 0.0);
          found.add(std::span<const Vec3>(&f.position, 1)), found.add(std::span<const Vec3>(&f.normal, 1));
          found.add(f.xx), found.add(f.xy), found.add(f.yy);
        }
      });
    }
}

TEST(SameBits, BilateralNormals) {
  const PointSet cloud = cube(3000);
  const std::vector<Vec3> x = places_near(cloud, 0.02, 2);
  expect_same_bits([&](Found& found) {
    Progress progress;
    const BilateralNormals normals(prepare_samples(cloud, progress), {});
    std::vector<Vec3> n(x.size());
    std::vector<double> heights(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) n[i] = normalized(x[i]);
    normals.refine(x, n, heights);
    found.add(n), found.add(heights);
  });
}

TEST(SameBits, OrthogonalPolynomials) {
  std::vector<double> columns[4];
  for (const Vec3& p : places(203, 2, 9)) {
    columns[0].push_back(p.x), columns[1].push_back(p.y);
    columns[2].push_back(std::sin(p.x + 2 * p.y)), columns[3].push_back(2 + p.z);
  }
  ApproximationSamples<2> samples;
  samples.positions = {columns[0], columns[1]};
  samples.values = columns[2];
  samples.weights = columns[3];
  expect_same_bits([&](Found& found) {
    OrthogonalFit<2> fit;
    fit.reset(samples);
    while (fit.degree() < 6 && fit.raise()) found.add(fit.squared_error());
    found.add(fit.weighted_residuals());
    for (std::size_t i = 0; i < columns[0].size(); ++i) found.add(fit.value({columns[0][i] * 0.9, columns[1][i]}));
  });
}

TEST(SameBits, RaysInBalls) {
  const PointSet cloud = sphere(3000);
  BallUnion union_of_balls;
  union_of_balls.centers = cloud.positions;
  union_of_balls.radii.assign(cloud.size(), 0.07f);
  std::vector<SegmentQuery> queries;
  for (const Vec3& p : places(1000, 1, 2))
    queries.push_back({Vec3f{0, 0, 0}, normalized(Vec3f(p)), static_cast<float>(std::abs(p.x)), 5});
  expect_same_bits([&](Found& found) {
    const BallSegments segments(union_of_balls);
    std::vector<BallSegment> answers(queries.size());
    segments.first(queries, answers);
    for (const BallSegment& s : answers) found.add(s.found), found.add(s.entry), found.add(s.exit), found.add(s.radius);
  });
}

TEST(SameBits, BakedVolume) {
  FormulaVolume field = ball_volume({0.3, 0.4, 0.45});
  const std::vector<Vec3> x = places_near(sphere(500, 0.1), 0.3, 3);
  expect_same_bits([&](Found& found) {
    Progress progress;
    const BakedVolume baked(field, {}, progress);
    std::vector<double> values(x.size());
    std::vector<Vec3> gradients(x.size());
    baked.evaluate(x, {values, gradients});
    found.add(values), found.add(gradients);
  });
}

TEST(SameBits, Deformations) {
  const std::vector<Vec3> q = places(21, 1, 5), way = places(21, 0.3, 6), x = places(333, 1.2, 7),
                          many = places(10'000, 1.2, 8);
  std::vector<Handle> handles(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) handles[i].q = q[i], handles[i].p = q[i] + way[i];
  expect_same_bits([&](Found& found) {
    std::vector<Vec3> positions(x.size());
    for (const DeformationKind kind :
         {DeformationKind::affine, DeformationKind::similarity, DeformationKind::rigid, DeformationKind::nonlinear}) {
      for (const double alpha : {0.5, 1.0, 1.7}) {
        MlsDeformationOptions options;
        options.kind = kind, options.alpha = alpha;
        MlsDeformation(handles, options).map(x, {positions, {}, {}, {}});
        found.add(positions);
      }
    }
    // Thin sets, mirrored or not, need extra steps in some lanes of a vector.
    for (const double thin : {0.15, 0.1, -0.15, -0.1}) {
      std::vector<Handle> flat(handles.begin(), handles.begin() + 12);
      for (Handle& h : flat) h.q.y *= thin, h.q.z *= thin, h.p.y *= thin, h.p.z *= std::abs(thin);
      for (const DeformationKind kind : {DeformationKind::similarity, DeformationKind::rigid}) {
        MlsDeformationOptions options;
        options.kind = kind;
        std::vector<Vec3> images(many.size());
        MlsDeformation(flat, options).map(many, {images, {}, {}, {}});
        found.add(images);
      }
    }
  });
}

TEST(SameBits, Volumes) {
  const auto hills = [](const Vec3& x) { return std::sin(5 * x.x) * std::cos(4 * x.y - x.z) + 0.3 * x.z; };
  for (const auto& data :
       {lattice_grid({6, 5, 7}, hills), bent_grid({6, 7, 5}, hills, 1.4), mixed_grid({7, 4, 4}, hills),
        tetrahedra_grid({5, 4, 6}, hills), two_level_amr(8, hills), scattered_grid(200, hills)})
    expect_same_bits([&](Found& found) {
      const auto volume = volume_of(data);
      const std::vector<Vec3> x = points_within(*volume, 100);
      for (const auto method : {"linear", "mls", "mls-detail", "amls"}) {
        std::vector<double> values(x.size());
        std::vector<Vec3> gradients(x.size());
        field_of(volume, method)->evaluate(x, {values, gradients});
        found.add(values), found.add(gradients);
      }
    });
}

}  // namespace
}  // namespace sansmesh::test
