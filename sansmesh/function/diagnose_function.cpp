#include "sansmesh/function/diagnose_function.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh/components.h"
#include "sansmesh/meshing/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/partition/partition_edit.h"
#include "sansmesh/partition/sheets.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

constexpr double kErrorOverMedian = 6, kErrorOverSpacing = 0.25;
/// Where around a support's foot the gradient is looked at: along the normal, in radii.
constexpr std::array<double, 5> kProbes{-0.6, -0.3, 0, 0.3, 0.6};
/// An edit's ball reaches a little beyond the place.
constexpr double kBallMargin = 1.05;

using Color = std::array<std::uint8_t, 3>;
constexpr Color kSound{205, 205, 200};
constexpr std::array<Color, kSuspicions> kColors{{{236, 190, 48}, {226, 110, 30}, {205, 32, 44}, {126, 60, 170}}};

/// Flags and values of all supports for one kind.
struct Flagged {
  std::vector<std::uint8_t> flag;
  std::vector<double> value;
};

double median(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// Largest gradient around each support's foot, within its own ball.
std::vector<double> steepness(const PartitionOfUnity& field) {
  const PartitionData& data = field.data();
  const std::size_t n = data.supports.size(), probes = kProbes.size();
  std::vector<Vec3> x(n * probes), g(n * probes);
  std::vector<double> f(n * probes);
  parallel_for(0, n, 4096, [&](std::size_t i) {
    const LocalFunction& local = data.functions[i];
    for (std::size_t k = 0; k < probes; ++k)
      x[i * probes + k] =
          data.origin + Vec3(data.supports[i].foot) + Vec3(local.nu) * (kProbes[k] * static_cast<double>(local.radius));
  });
  field.evaluate(x, f, g);
  std::vector<double> steepest(n, 0);
  for (std::size_t i = 0; i < n * probes; ++i) steepest[i / probes] = std::max(steepest[i / probes], norm(g[i]));
  return steepest;
}

/// Flagged supports with touching blocks make a place.
void gather_places(const SurfaceFunction& function, Suspicion kind, const Flagged& flagged, Diagnosis& diagnosis) {
  const PartitionData& data = function.field.data();
  std::vector<std::uint32_t> ids;
  std::vector<Vec3f> feet;
  std::vector<float> reach;
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    if (!flagged.flag[i]) continue;
    ids.push_back(static_cast<std::uint32_t>(i));
    feet.push_back(data.supports[i].foot);
    reach.push_back(1.8f * data.edge / static_cast<float>(1u << data.supports[i].level));
  }
  if (ids.empty()) return;
  const BallTree tree(feet, reach);
  UnionFind sets(ids.size());
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < ids.size(); ++i) {
    tree.touching({feet[i], feet[i]}, near);
    for (const std::uint32_t j : near) sets.join(i, j);
  }
  std::vector<std::int64_t> number(ids.size(), -1);
  std::vector<SuspiciousPlace> places;
  std::vector<Box3f> boxes;
  const bool low = kind == Suspicion::low_coverage;
  for (std::uint32_t i = 0; i < ids.size(); ++i) {
    std::int64_t& k = number[sets.find(i)];
    const double value = flagged.value[ids[i]];
    if (k < 0) {
      k = static_cast<std::int64_t>(places.size());
      places.push_back({kind, {}, 0, 0, value, {}});
      boxes.emplace_back();
    }
    SuspiciousPlace& p = places[static_cast<std::size_t>(k)];
    ++p.supports;
    p.worst = low ? std::min(p.worst, value) : std::max(p.worst, value);
    const float h = 0.5f * reach[i] / 1.8f;
    boxes[static_cast<std::size_t>(k)].extend({feet[i] - Vec3f{h, h, h}, feet[i] + Vec3f{h, h, h}});
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    places[k].position = function.place.to_input(data.origin + Vec3(boxes[k].center()));
    places[k].radius = function.place.to_input(0.5 * static_cast<double>(boxes[k].diagonal()));
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const SuspiciousPlace& a, const SuspiciousPlace& b) { return a.supports > b.supports; });
  diagnosis.found[static_cast<std::size_t>(kind)] = places.size();
  diagnosis.places.insert(diagnosis.places.end(), places.begin(), places.end());
}

/// Samples whose nearest vertex belongs to each component, times the area that each stands for, over its area.
std::vector<double> component_evidence(const TriangleMesh& mesh, const MeshComponents& components,
                                       const SurfaceFunction& function) {
  const PointSet& samples = *function.samples;
  const std::vector<std::size_t> nearest = detail::count_nearest(mesh, components, samples.size(), [&](std::size_t i) {
    return Vec3f(function.place.to_input(Vec3(samples.positions[i]) + samples.origin) - mesh.origin);
  });
  const double spacing = function.place.to_input(function.field.report().spacing);
  std::vector<double> evidence(components.size());
  for (std::size_t c = 0; c < evidence.size(); ++c)
    evidence[c] = static_cast<double>(nearest[c]) * spacing * spacing / components.area[c];
  return evidence;
}

/// Extra components of the mesh: places, and the supports that they run through.
void find_extra_sheets(const SurfaceFunction& function, const KdTree& feet, Diagnosis& diagnosis,
                       std::vector<std::uint8_t>& vertex_flag) {
  const TriangleMesh& mesh = diagnosis.mesh;
  const MeshComponents components = find_components(mesh);
  if (components.size() < 2) return;
  const std::vector<double> evidence = function.samples->size() > 0 ? component_evidence(mesh, components, function)
                                                                    : std::vector<double>(components.size(), 1.0);
  std::vector<std::uint8_t> extra(components.size(), 0);
  // The largest that is vouched for is what the others are measured against.
  double largest = 0;
  for (std::size_t c = 0; c < extra.size(); ++c)
    if (evidence[c] >= kLeastEvidence) largest = std::max(largest, components.area[c]);
  for (std::size_t c = 0; c < extra.size(); ++c)
    extra[c] = evidence[c] < kLeastEvidence || components.area[c] < detail::kSmallComponent * largest;
  std::vector<Box3f> box(components.size());
  std::vector<Vec3f> first(components.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t c = components.of_triangle[i];
    for (const std::uint32_t v : mesh.triangles[i]) {
      if (box[c].empty()) first[c] = mesh.vertices[v];
      box[c].extend(mesh.vertices[v]);
      vertex_flag[v] |= extra[c];
    }
  }
  const PartitionData& data = function.field.data();
  const Sheets sheets = find_sheets(data, function.samples->positions);
  std::vector<SuspiciousPlace> places;
  std::vector<std::uint8_t> proposed(sheets.size(), 0);
  for (std::size_t c = 0; c < extra.size(); ++c) {
    if (!extra[c]) continue;
    SuspiciousPlace p;
    p.kind = Suspicion::extra_sheet;
    p.position = mesh.origin + Vec3(box[c].center());
    p.radius = 0.5 * static_cast<double>(box[c].diagonal());
    p.worst = components.area[c];
    const Vec3 on = mesh.origin + Vec3(first[c]);
    const auto found = feet.nearest(Vec3f(function.place.from_input(on) - data.origin));
    const std::uint32_t sheet = found ? sheets.of_support[found->index] : Sheets::kNone;
    // Only a sheet of its own can be taken away without harm to others.
    if (sheet != Sheets::kNone && sheet != 0 && sheets.area[sheet] < 0.5 * sheets.area[0]) {
      for (const std::uint32_t k : sheets.of_support) p.supports += k == sheet;
    }
    if (p.supports > 0 && !proposed[sheet]) {
      proposed[sheet] = 1;
      Edit edit;
      edit.select.all_but_largest = true;  // whatever other edits have done before
      edit.select.sheet_at = function.place.to_input(data.origin + Vec3(data.supports[found->index].foot));
      edit.action = RemoveSupports{};
      p.edit = edit;
    }
    places.push_back(p);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const SuspiciousPlace& a, const SuspiciousPlace& b) { return a.worst > b.worst; });
  diagnosis.found[static_cast<std::size_t>(Suspicion::extra_sheet)] = places.size();
  diagnosis.places.insert(diagnosis.places.end(), places.begin(), places.end());
}

/// What to try for a place. Planes are what few samples can carry; wide supports are what contradicting ones need.
void suggest(SuspiciousPlace& p, const DiagnoseOptions& options, double error_above) {
  Edit edit;
  edit.select.ball = {p.position, kBallMargin * p.radius};
  if (p.kind == Suspicion::low_coverage) {
    edit.select.coverage_below = options.coverage_below;
    edit.action = SetDegree{1};
  } else if (p.kind == Suspicion::high_error) {
    edit.select.error_above = error_above;
    Refit refit;
    refit.support = 2;
    edit.action = refit;
  } else if (p.kind == Suspicion::steep) {
    edit.action = SetDegree{1};
  } else {
    return;
  }
  p.edit = edit;
}

void color_mesh(const SurfaceFunction& function, const KdTree& feet, std::span<const Flagged> flagged,
                const std::vector<std::uint8_t>& extra, TriangleMesh& mesh) {
  const PartitionData& data = function.field.data();
  mesh.colors.assign(mesh.vertices.size(), kSound);
  parallel_for(0, mesh.vertices.size(), 2048, [&](std::size_t v) {
    const Vec3 x = function.place.from_input(mesh.origin + Vec3(mesh.vertices[v])) - data.origin;
    const auto found = feet.nearest(Vec3f(x));
    for (std::size_t k = 0; found && k < flagged.size(); ++k)
      if (!flagged[k].flag.empty() && flagged[k].flag[found->index]) mesh.colors[v] = kColors[k];
    if (extra[v]) mesh.colors[v] = kColors[static_cast<std::size_t>(Suspicion::extra_sheet)];
  });
}

}  // namespace

const char* suspicion_name(Suspicion kind) {
  switch (kind) {
    case Suspicion::low_coverage:
      return "low coverage";
    case Suspicion::high_error:
      return "high error";
    case Suspicion::extra_sheet:
      return "extra sheet";
    case Suspicion::steep:
      return "steep gradient";
  }
  return "";
}

void DiagnoseOptions::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw ArgumentError(what);
  };
  check_range("coverage_below", coverage_below, 0, 1);
  check(!error_above || (std::isfinite(*error_above) && *error_above > 0), "`error_above` must be a positive length");
  check(std::isfinite(gradient_above) && gradient_above > 1, "`gradient_above` must be larger than 1");
}

std::vector<Edit> Diagnosis::edits() const {
  std::vector<Edit> all;
  for (const SuspiciousPlace& p : places)
    if (p.edit) all.push_back(*p.edit);
  return all;
}

Diagnosis diagnose_function(const SurfaceFunction& function, const DiagnoseOptions& options, Progress& progress) {
  options.validate();
  const PartitionOfUnity& field = function.field;
  const PartitionData& data = field.data();
  const std::size_t n = data.supports.size();
  Diagnosis diagnosis;
  MeshOptions meshing;
  meshing.components.kind = ComponentChoice::Kind::all;
  meshing.carry_colors = false;
  diagnosis.mesh = mesh_function(function, meshing, progress);

  progress.begin("diagnose");
  std::vector<float> errors;
  for (const Support& s : data.supports)
    if (s.state == Support::fitted) errors.push_back(s.error);
  const double error = options.error_above
                           ? function.place.from_input(*options.error_above)
                           : std::max(kErrorOverMedian * median(errors), kErrorOverSpacing * field.report().spacing);
  diagnosis.error_above = function.place.to_input(error);
  const std::vector<double> steepest = steepness(field);
  std::array<Flagged, kSuspicions> flagged;
  for (Flagged& f : flagged) f.flag.assign(n, 0), f.value.assign(n, 0);
  const auto of = [&](Suspicion kind) -> Flagged& { return flagged[static_cast<std::size_t>(kind)]; };
  for (std::size_t i = 0; i < n; ++i) {
    const Support& s = data.supports[i];
    if (s.state != Support::fitted) continue;
    diagnosis.largest_gradient = std::max(diagnosis.largest_gradient, steepest[i]);
    of(Suspicion::low_coverage).flag[i] = static_cast<double>(s.coverage) < options.coverage_below;
    of(Suspicion::low_coverage).value[i] = static_cast<double>(s.coverage);
    of(Suspicion::high_error).flag[i] = static_cast<double>(s.error) > error;
    of(Suspicion::high_error).value[i] = function.place.to_input(static_cast<double>(s.error));
    of(Suspicion::steep).flag[i] = steepest[i] > options.gradient_above;
    of(Suspicion::steep).value[i] = steepest[i];
  }
  std::vector<Vec3f> foot(n);
  for (std::size_t i = 0; i < n; ++i) foot[i] = data.supports[i].foot;
  const KdTree feet(foot);
  std::vector<std::uint8_t> extra(diagnosis.mesh.vertices.size(), 0);
  find_extra_sheets(function, feet, diagnosis, extra);
  for (const Suspicion kind : {Suspicion::low_coverage, Suspicion::high_error, Suspicion::steep})
    gather_places(function, kind, of(kind), diagnosis);
  // At most so many of each kind.
  std::array<std::size_t, kSuspicions> kept{};
  std::erase_if(diagnosis.places,
                [&](const SuspiciousPlace& p) { return ++kept[static_cast<std::size_t>(p.kind)] > options.places; });
  if (function.samples->size() > 0)  // nothing can be fitted again without
    for (SuspiciousPlace& p : diagnosis.places) suggest(p, options, diagnosis.error_above);
  color_mesh(function, feet, flagged, extra, diagnosis.mesh);
  progress.finish();
  return diagnosis;
}

}  // namespace sansmesh
