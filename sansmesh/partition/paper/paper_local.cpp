#include "sansmesh/partition/paper/paper_local.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sansmesh/core/morton.h"
#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1 {
namespace {

void set_frame(LocalFunction& f, const Vec3f& nu) {
  f.nu = nu;
  tangent_frame(f.nu, f.xi, f.eta);
}

Vec3 mean_of(std::span<const Vec3f> values, std::span<const std::uint32_t> ids) {
  Vec3 sum;
  for (const std::uint32_t i : ids) sum += Vec3(values[i]);
  return ids.empty() ? sum : sum / static_cast<double>(ids.size());
}

double squared_distances(const LocalFunction& f, std::span<const Vec3f> positions, std::span<const std::uint32_t> ids) {
  double sum = 0;
  for (const std::uint32_t i : ids) {
    const double r = local_value(f, positions[i]);
    sum += r * r;
  }
  return sum;
}

}  // namespace

int paper_degree(const PaperOptions& options, std::size_t samples, double coverage) {
  int degree = 1;
  while (degree < options.max_degree) {
    const auto next = static_cast<std::size_t>(degree) + 1;
    if (samples < static_cast<std::size_t>(paper::kSamplesPerBasis * kBasisSize[next])) break;
    if (coverage < options.coverage[next - 2]) break;
    ++degree;
  }
  return degree;
}

PaperFitter::PaperFitter(std::span<const Vec3f> positions, std::span<const Vec3f> normals, const Vec3f& lower,
                         float edge, const PaperOptions& options, double limit)
    : positions_(positions),
      normals_(normals),
      lower_(lower),
      edge_(edge),
      options_(options),
      limit_(limit),
      nearest_(positions) {}

Vec3f PaperFitter::center(int level, std::uint64_t code) const {
  const std::array<std::uint32_t, 3> cell = morton_cell(code);
  const float h = block_edge(level);
  return lower_ + Vec3f{(static_cast<float>(cell[0]) + 0.5f) * h, (static_cast<float>(cell[1]) + 0.5f) * h,
                        (static_cast<float>(cell[2]) + 0.5f) * h};
}

PaperBlock PaperFitter::child(const PaperBlock& block, unsigned number) const {
  PaperBlock result{block.level + 1, block.code << 3 | number, {}};
  const Vec3f c = center(result.level, result.code);
  const float r = radius(result.level), square = r * r;
  for (const std::uint32_t i : block.ids)
    if (squared_norm(positions_[i] - c) < square) result.ids.push_back(i);
  return result;
}

std::vector<std::uint32_t> PaperFitter::ball(const Vec3f& center, float radius) const {
  std::vector<Neighbour> found;
  nearest_.within(center, radius, found);
  std::vector<std::uint32_t> ids;
  const float square = radius * radius;
  for (const Neighbour& n : found)
    if (squared_norm(positions_[n.index] - center) < square) ids.push_back(n.index);
  std::sort(ids.begin(), ids.end());
  return ids;
}

PaperLocal PaperFitter::approximate(const PaperBlock& block, Workspace& ws, int exactly) const {
  PaperLocal local;
  LocalFunction& f = local.function;
  f.center = center(block.level, block.code);
  f.radius = f.scale = radius(block.level);
  local.support.level = static_cast<std::uint8_t>(block.level);
  local.support.code = block.code;
  local.support.samples = static_cast<std::uint32_t>(block.ids.size());
  if (block.ids.size() < kEnoughForPlane) {
    borrow_plane(local);
    local.squares = squared_distances(f, positions_, block.ids);
    local.good = true;
  } else {
    Vec3 nu = normalized(mean_of(normals_, block.ids));
    if (nu == Vec3{}) nu = Vec3(normals_[block.ids[0]]);  // normals cancel out: two sheets in any frame
    const Vec3f normal(nu);
    for (const std::uint32_t i : block.ids) local.two_sheets |= dot(normals_[i], normal) <= 0;
    fit_polynomial(block, normal, ws, exactly, local);
    local.good = !local.two_sheets && std::sqrt(local.squares / static_cast<double>(block.ids.size())) <= limit_;
  }
  if (!block.ids.empty())
    local.support.error = static_cast<float>(std::sqrt(local.squares / static_cast<double>(block.ids.size())));
  return local;
}

void PaperFitter::fit_polynomial(const PaperBlock& block, const Vec3f& nu, Workspace& ws, int exactly,
                                 PaperLocal& local) const {
  LocalFunction& f = local.function;
  set_frame(f, nu);
  const Vec3 xi(f.xi), eta(f.eta), up(f.nu);
  const double inverse = 1 / static_cast<double>(f.scale);
  ws.u.clear(), ws.v.clear(), ws.w.clear();
  double low_u = 1, high_u = -1, low_v = 1, high_v = -1;
  for (const std::uint32_t i : block.ids) {
    const Vec3 d = Vec3(positions_[i] - f.center) * inverse;
    ws.u.push_back(dot(d, xi)), ws.v.push_back(dot(d, eta)), ws.w.push_back(dot(d, up));
    low_u = std::min(low_u, ws.u.back()), high_u = std::max(high_u, ws.u.back());
    low_v = std::min(low_v, ws.v.back()), high_v = std::max(high_v, ws.v.back());
  }
  const double coverage = (high_u - low_u) * (high_v - low_v) / std::numbers::pi;
  local.support.coverage = static_cast<float>(coverage);
  const std::size_t n = block.ids.size();
  int most = exactly >= 0 ? exactly : paper_degree(options_, n, coverage);
  while (most > 1 && n < static_cast<std::size_t>(paper::kSamplesPerBasis * kBasisSize[static_cast<std::size_t>(most)]))
    --most;
  const double limit = limit_ * inverse;
  ws.fit.reset({{ws.u, ws.v}, ws.w}, ApproximationFrame<2>{});
  // Raising the degree keeps all previous results. The accepted degree is at least 1.
  const int first = exactly >= 0 ? exactly : 1;
  while (ws.fit.degree() < most && ws.fit.raise())
    if (ws.fit.degree() >= first && ws.fit.squared_error() <= limit * limit * static_cast<double>(n)) break;
  f.degree = std::clamp(ws.fit.degree(), 0, most);
  std::array<double, kBasisSize[kMaxDegree]> a{};
  ws.fit.monomial_coefficients(a);
  for (std::size_t j = 0; j < a.size(); ++j)
    f.coefficient[j] =
        j < static_cast<std::size_t>(kBasisSize[static_cast<std::size_t>(f.degree)]) ? static_cast<float>(a[j]) : 0;
  local.squares = ws.fit.squared_error() * static_cast<double>(f.scale) * static_cast<double>(f.scale);
}

void PaperFitter::borrow_plane(PaperLocal& local) const {
  LocalFunction& f = local.function;
  const auto nearest = nearest_.nearest(f.center);
  std::array<Neighbour, paper::kCluster> found;
  const std::size_t n = nearest_.nearest(positions_[nearest->index], found);
  std::array<std::uint32_t, paper::kCluster> ids;
  for (std::size_t k = 0; k < n; ++k) ids[k] = found[k].index;
  const std::span<const std::uint32_t> cluster(ids.data(), n);
  const Vec3 mean = mean_of(positions_, cluster);
  Vec3 normal = normalized(mean_of(normals_, cluster));
  if (normal == Vec3{}) normal = Vec3(normals_[nearest->index]);
  Symmetric3 spread;
  for (const std::uint32_t i : cluster) spread.add(Vec3(positions_[i]) - mean);
  // A least-squares plane may be perpendicular to the surface if the samples are in a row: then the mean normal is
  // used.
  const Vec3 axis = principal_axes(spread).axes[0];
  const double cosine = dot(axis, normal);
  if (std::abs(cosine) >= paper::kCosBorrowed) normal = cosine > 0 ? axis : -axis;
  set_frame(f, Vec3f(normalized(normal)));
  f.degree = 1;
  f.coefficient[0] = static_cast<float>(dot(mean - Vec3(f.center), Vec3(f.nu)) / static_cast<double>(f.scale));
}

FittedLeaf leaf_of(const PaperFitter& fitter, const PaperLocal& local) {
  FittedLeaf leaf{local.function, {}, local.support};
  const float h = fitter.block_edge(leaf.support.level);
  set_surface_patch(leaf.function, leaf.function.center - Vec3f{h, h, h} * 0.5f, h, leaf.support);
  // A plane borrowed from far away is no surface in this block.
  if (leaf.support.samples == 0) leaf.support.area = 0;
  return leaf;
}

}  // namespace sansmesh::inline v1
