#include "sansmesh/function/diagnose_function.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/error.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/meshing/mesh_steps.h"
#include "sansmesh/partition/edit/partition_edit.h"
#include "sansmesh/partition/far/sheets.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kErrorOverMedian = 6, kErrorOverSpacing = 0.25;
/// Positions around a support's foot where the gradient is evaluated: along the normal, in radii.
constexpr std::array<double, 5> kProbes{-0.6, -0.3, 0, 0.3, 0.6};
/// A shorter mean of normals has no direction.
constexpr double kOneWay = 0.2;
/// Extent of an edit's ball over that of the region.
constexpr double kBallMargin = 1.05;
/// A sheet is removed if its share of vertices on kept components is at most this.
constexpr double kShared = 0.1;
/// Edits are tried this often, each time without those that were useless, or harmful within this many radii of their
/// regions.
constexpr int kTrials = 6;
constexpr double kHarmMargin = 1.5;
/// A remeshed surface may lose one more sample in this many, those at the limit distance.
constexpr std::size_t kSpared = 20000;

using Color = std::array<std::uint8_t, 3>;
constexpr Color kSound{205, 205, 200};
constexpr std::array<Color, kSuspicions> kColors{{{236, 190, 48}, {226, 110, 30}, {205, 32, 44}, {126, 60, 170}}};

/// Flags and values of all supports for one kind.
struct Flagged {
  std::vector<std::uint8_t> flag;
  std::vector<double> value;
};
using AllFlagged = std::array<Flagged, kSuspicions>;

/// Largest gradient around each support's foot, within its ball.
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

/// Mean of `count` unit normals with this sum.
Vec3 mean_normal(const Vec3& sum, std::size_t count) {
  return norm(sum) > kOneWay * static_cast<double>(count) ? normalized(sum) : Vec3{};
}

/// Flagged supports with touching blocks form a region.
void gather_regions(const FittedFunction& function, Suspicion kind, const Flagged& flagged, Diagnosis& diagnosis) {
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
  std::vector<SuspiciousRegion> regions;
  std::vector<Box3f> boxes;
  const bool low = kind == Suspicion::low_coverage;
  for (std::uint32_t i = 0; i < ids.size(); ++i) {
    std::int64_t& k = number[sets.find(i)];
    const double value = flagged.value[ids[i]];
    if (k < 0) {
      k = static_cast<std::int64_t>(regions.size());
      regions.push_back({kind, {}, {}, 0, 0, value, {}});
      boxes.emplace_back();
    }
    SuspiciousRegion& p = regions[static_cast<std::size_t>(k)];
    ++p.supports;
    p.normal += Vec3(data.functions[ids[i]].nu);
    p.worst = low ? std::min(p.worst, value) : std::max(p.worst, value);
    const float h = 0.5f * reach[i] / 1.8f;
    boxes[static_cast<std::size_t>(k)].extend({feet[i] - Vec3f{h, h, h}, feet[i] + Vec3f{h, h, h}});
  }
  for (std::size_t k = 0; k < regions.size(); ++k) {
    regions[k].normal = mean_normal(regions[k].normal, regions[k].supports);
    regions[k].position = function.frame.to_input(data.origin + Vec3(boxes[k].center()));
    regions[k].radius = function.frame.to_input(0.5 * static_cast<double>(boxes[k].diagonal()));
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const SuspiciousRegion& a, const SuspiciousRegion& b) { return a.supports > b.supports; });
  diagnosis.found[static_cast<std::size_t>(kind)] = regions.size();
  diagnosis.regions.insert(diagnosis.regions.end(), regions.begin(), regions.end());
}

/// Total area of the samples whose nearest vertex belongs to each component, over its area.
std::vector<double> component_evidence(const TriangleMesh& mesh, const MeshComponents& components,
                                       const FittedFunction& function) {
  const PointSet& samples = *function.samples;
  const Vec3f shift(samples.origin - mesh.origin);
  const std::vector<std::size_t> nearest = detail::count_nearest(
      mesh, components, samples.size(), [&](std::size_t i) { return samples.positions[i] + shift; });
  const double spacing = function.field.report().spacing;
  std::vector<double> evidence(components.size());
  for (std::size_t c = 0; c < evidence.size(); ++c)
    evidence[c] = static_cast<double>(nearest[c]) * spacing * spacing / components.area[c];
  return evidence;
}

/// Components that the default mesh leaves out and, beside closed surfaces, those that hardly any samples represent:
/// 1 for each. The mesh is in the coordinates of the field.
std::vector<std::uint8_t> extra_components(const TriangleMesh& mesh, const MeshComponents& components,
                                           const FittedFunction& function) {
  const PartitionReport& report = function.field.report();
  const bool sampled = function.samples->size() > 0, open = report.open_area > 0;
  // A scene has parts of all sizes, which only samples can judge.
  if (open && !sampled) return std::vector<std::uint8_t>(components.size(), 0);
  std::vector<std::uint8_t> extra =
      detail::chosen_components(mesh, components, {}, *function.samples, report.spacing, open);
  for (std::uint8_t& e : extra) e = !e;
  if (open || !sampled) return extra;
  const std::vector<double> evidence = component_evidence(mesh, components, function);
  for (std::size_t c = 0; c < extra.size(); ++c) extra[c] = extra[c] || evidence[c] < kLeastEvidence;
  return extra;
}

/// Finds extra components of the mesh, which is in the coordinates of the field: regions, and the vertices on them.
void find_extra_sheets(const FittedFunction& function, const TriangleMesh& mesh, const KdTree& feet,
                       Diagnosis& diagnosis, std::vector<std::uint8_t>& vertex_flag) {
  const MeshComponents components = find_components(mesh);
  if (components.size() < 2) return;
  const std::vector<std::uint8_t> extra = extra_components(mesh, components, function);
  if (std::find(extra.begin(), extra.end(), 1) == extra.end()) return;
  const PartitionData& data = function.field.data();
  const Sheets sheets = find_sheets(data, function.samples->positions);
  std::vector<std::uint32_t> component(mesh.vertices.size(), 0), nearest(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i]) component[v] = components.of_triangle[i];
  parallel_for(0, nearest.size(), 2048, [&](std::size_t v) {
    const auto found = feet.nearest(Vec3f(mesh.origin + Vec3(mesh.vertices[v]) - data.origin));
    nearest[v] = found ? found->index : 0;
  });
  // For each sheet, the number of vertices on extra and on other components: a sheet may have several components.
  std::vector<std::array<std::size_t, 2>> vertices(sheets.size());
  std::vector<Box3f> box(components.size());
  std::vector<Vec3> normal(components.size());
  std::vector<std::vector<std::uint32_t>> on(components.size());  // supports along extra components
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::uint32_t c = component[v], sheet = data.supports.empty() ? Sheets::kNone : sheets.of_support[nearest[v]];
    vertex_flag[v] = extra[c];
    if (sheet != Sheets::kNone) ++vertices[sheet][extra[c]];
    if (!extra[c]) continue;
    box[c].extend(mesh.vertices[v]);
    normal[c] += Vec3(mesh.normals[v]);
    on[c].push_back(nearest[v]);
  }
  std::vector<SuspiciousRegion> regions;
  std::vector<std::uint8_t> proposed(sheets.size(), 0);
  for (std::size_t c = 0; c < extra.size(); ++c) {
    if (!extra[c]) continue;
    SuspiciousRegion p;
    p.kind = Suspicion::extra_sheet;
    p.position = function.frame.to_input(mesh.origin + Vec3(box[c].center()));
    p.normal = mean_normal(normal[c], on[c].size());
    p.radius = function.frame.to_input(0.5 * static_cast<double>(box[c].diagonal()));
    p.worst = function.frame.to_input(function.frame.to_input(components.area[c]));
    const std::uint32_t at = on[c].empty() ? 0 : on[c].front();
    const std::uint32_t sheet = on[c].empty() ? Sheets::kNone : sheets.of_support[at];
    // Only a separate sheet can be removed without harm to others.
    if (sheet != Sheets::kNone && sheet != 0 && sheets.area[sheet] < 0.5 * sheets.area[0] &&
        static_cast<double>(vertices[sheet][0]) <= kShared * static_cast<double>(vertices[sheet][1])) {
      for (const std::uint32_t k : sheets.of_support) p.supports += k == sheet;
    }
    if (p.supports > 0 && !proposed[sheet]) {
      proposed[sheet] = 1;
      Edit edit;
      edit.select.all_but_largest = true;  // independent of previous edits
      edit.select.sheet_at = function.frame.to_input(data.origin + Vec3(data.supports[at].foot));
      edit.action = RemoveSupports{};
      p.edit = edit;
    }
    regions.push_back(p);
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const SuspiciousRegion& a, const SuspiciousRegion& b) { return a.worst > b.worst; });
  diagnosis.found[static_cast<std::size_t>(Suspicion::extra_sheet)] = regions.size();
  diagnosis.regions.insert(diagnosis.regions.end(), regions.begin(), regions.end());
}

/// Constants are intended, and planes that the published method borrowed for empty blocks cannot be judged.
bool is_looked_at(const PartitionData& data, const Support& s) {
  return s.state == Support::fitted && !(data.paper && s.area == 0);
}

/// Flags the supports beyond the thresholds; `error` in the coordinates of the field.
AllFlagged flag_supports(const FittedFunction& function, const DiagnoseOptions& options, double error) {
  const PartitionData& data = function.field.data();
  const std::size_t n = data.supports.size();
  const std::vector<double> steepest = steepness(function.field);
  AllFlagged flagged;
  for (Flagged& f : flagged) f.flag.assign(n, 0), f.value.assign(n, 0);
  const auto of = [&](Suspicion kind) -> Flagged& { return flagged[static_cast<std::size_t>(kind)]; };
  for (std::size_t i = 0; i < n; ++i) {
    const Support& s = data.supports[i];
    if (!is_looked_at(data, s)) continue;
    // Where samples end, an open sheet ends too: that is no defect.
    of(Suspicion::low_coverage).flag[i] = !s.open && static_cast<double>(s.coverage) < options.coverage_below;
    of(Suspicion::low_coverage).value[i] = static_cast<double>(s.coverage);
    of(Suspicion::high_error).flag[i] = static_cast<double>(s.error) > error;
    of(Suspicion::high_error).value[i] = function.frame.to_input(static_cast<double>(s.error));
    of(Suspicion::steep).flag[i] = steepest[i] > options.gradient_above;
    of(Suspicion::steep).value[i] = steepest[i];
  }
  return flagged;
}

/// Suggests an edit for a region; `refits`: it can be refitted locally. Few samples determine planes only;
/// contradicting ones need wide supports.
void suggest(SuspiciousRegion& p, const DiagnoseOptions& options, double error_above, bool refits) {
  Edit edit;
  edit.select.ball = {p.position, kBallMargin * p.radius};
  if (p.kind == Suspicion::low_coverage) {
    edit.select.coverage_below = options.coverage_below;
    edit.action = SetDegree{1};
  } else if (p.kind == Suspicion::high_error && refits) {
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

/// Samples far from the surface, 1 for each.
std::vector<std::uint8_t> lost_samples_of(const FittedFunction& function, const TriangleMesh& mesh) {
  const PartitionReport& report = function.field.report();
  return far_samples(mesh, *function.samples, lost_beyond(report.spacing, report.noise));
}

/// The function after all proposed edits; nothing if they fail.
std::optional<FittedFunction> repaired(const FittedFunction& function, const Diagnosis& diagnosis, Progress& progress) {
  try {
    FunctionEditor editor(function);
    for (const Edit& edit : diagnosis.edits()) editor.apply(edit, progress);
    return editor.function();
  } catch (const DataError&) {
    return std::nullopt;
  }
}

/// Its default mesh in the coordinates of the field; nothing if there is none.
std::optional<TriangleMesh> repaired_mesh(const FittedFunction& function, Progress& progress) {
  MeshOptions meshing;
  meshing.carry_colors = false;
  try {
    TriangleMesh mesh = mesh_function(function, meshing, progress);
    move_from_input(mesh, function.frame);
    return mesh;
  } catch (const DataError&) {
    return std::nullopt;
  }
}

/// Number of flagged supports of a region that an edit can repair. Where samples cover little, planes are the repair.
std::size_t count_flagged(const FittedFunction& function, const AllFlagged& flagged, const SuspiciousRegion& region) {
  const PartitionData& data = function.field.data();
  const std::vector<std::uint8_t>& flag = flagged[static_cast<std::size_t>(region.kind)].flag;
  const bool planes = region.kind == Suspicion::low_coverage;
  std::size_t count = 0;
  for (std::size_t i = 0; i < flag.size(); ++i) {
    if (!flag[i] || (planes && data.functions[i].degree <= 1)) continue;
    const Vec3 foot = function.frame.to_input(data.origin + Vec3(data.supports[i].foot));
    count += norm(foot - region.position) <= kBallMargin * region.radius;
  }
  return count;
}

/// Reverts the edits that leave doubtful supports in their region. False if there are none.
bool revert_useless(const FittedFunction& before, const AllFlagged& flagged_before, const FittedFunction& after,
                    const DiagnoseOptions& options, double error, Diagnosis& diagnosis) {
  const AllFlagged flagged = flag_supports(after, options, error);
  bool any = false;
  for (SuspiciousRegion& p : diagnosis.regions) {
    if (!p.edit || p.kind == Suspicion::extra_sheet) continue;
    if (count_flagged(before, flagged_before, p) > 0 && count_flagged(after, flagged, p) == 0) continue;
    p.edit.reset(), any = true;
  }
  return any;
}

/// Reverts the edits around which samples lost their surface that had one according to `lost_before`. False if no edit
/// is responsible.
bool revert_harmful(const FittedFunction& function, const std::vector<std::uint8_t>& lost_before,
                    const std::vector<std::uint8_t>& lost, Diagnosis& diagnosis) {
  std::vector<std::uint8_t> harmful(diagnosis.regions.size(), 0);
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (!lost[i] || lost_before[i]) continue;
    const Vec3 x = function.frame.to_input(function.samples->origin + Vec3(function.samples->positions[i]));
    std::size_t nearest = harmful.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < harmful.size(); ++k) {
      const SuspiciousRegion& p = diagnosis.regions[k];
      if (!p.edit) continue;
      const double off = norm(x - p.position) - kHarmMargin * p.radius;
      if (off <= 0) harmful[k] = 1;
      if (off < least) least = off, nearest = k;
    }
    if (nearest < harmful.size()) harmful[nearest] = 1;
  }
  for (std::size_t k = 0; k < harmful.size(); ++k)
    if (harmful[k]) diagnosis.regions[k].edit.reset();
  return std::find(harmful.begin(), harmful.end(), 1) != harmful.end();
}

/// Tries the edits, and reverts those that do not repair their region and those that remove surface near samples.
/// `lost_before`: without edits.
void try_edits(const FittedFunction& function, const AllFlagged& flagged, const std::vector<std::uint8_t>& lost_before,
               const DiagnoseOptions& options, double error, Diagnosis& diagnosis, Progress& progress) {
  const auto most =
      std::count(lost_before.begin(), lost_before.end(), 1) + static_cast<std::ptrdiff_t>(lost_before.size() / kSpared);
  for (int round = 0; round < kTrials && !diagnosis.edits().empty(); ++round) {
    const std::optional<FittedFunction> after = repaired(function, diagnosis, progress);
    if (!after) break;
    if (revert_useless(function, flagged, *after, options, error, diagnosis)) continue;
    const std::optional<TriangleMesh> mesh = repaired_mesh(*after, progress);
    if (!mesh) break;
    const std::vector<std::uint8_t> lost = lost_samples_of(function, *mesh);
    if (std::count(lost.begin(), lost.end(), 1) <= most) return;
    if (!revert_harmful(function, lost_before, lost, diagnosis)) break;
  }
  for (SuspiciousRegion& p : diagnosis.regions) p.edit.reset();
}

void color_mesh(const FittedFunction& function, const KdTree& feet, std::span<const Flagged> flagged,
                const std::vector<std::uint8_t>& extra, TriangleMesh& mesh) {
  const PartitionData& data = function.field.data();
  mesh.colors.assign(mesh.vertices.size(), kSound);
  parallel_for(0, mesh.vertices.size(), 2048, [&](std::size_t v) {
    const Vec3 x = function.frame.from_input(mesh.origin + Vec3(mesh.vertices[v])) - data.origin;
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

std::array<std::uint8_t, 3> suspicion_color(Suspicion kind) { return kColors[static_cast<std::size_t>(kind)]; }

const OptionSchema& DiagnoseOptions::schema() {
  using O = DiagnoseOptions;
  static constexpr OptionRow rows[] = {
      option<&O::coverage_below>({.text = "Supports are suspicious if samples cover less than this share of them",
                                  .unit = "share",
                                  .range = {0, 1},
                                  .old_name = "coverage"}),
      option<&O::error_above>({.text = "Supports are suspicious if the rms distance of their samples exceeds this",
                               .unit = "length",
                               .from_data = "from data",
                               .range = positive(),
                               .old_name = "error"}),
      option<&O::gradient_above>({.text = "Supports are suspicious if the gradient is longer than this, > 1",
                                  .unit = "norm",
                                  .range = {.least = 1, .above = true},
                                  .old_name = "gradient"}),
      option<&O::most_regions>(
          {.text = "Largest number of reported places of each kind", .range = at_least(0), .name = "places"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void DiagnoseOptions::validate() const { validate_options(*this); }

std::vector<Edit> Diagnosis::edits() const {
  std::vector<Edit> all;
  for (const SuspiciousRegion& p : regions)
    if (p.edit) all.push_back(*p.edit);
  return all;
}

Diagnosis diagnose_function(const FittedFunction& function, const DiagnoseOptions& options, Progress& progress) {
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
    if (is_looked_at(data, s)) errors.push_back(s.error);
  const double error = options.error_above ? function.frame.from_input(*options.error_above)
                                           : std::max(kErrorOverMedian * static_cast<double>(median(errors)),
                                                      kErrorOverSpacing * field.report().spacing);
  diagnosis.error_above = function.frame.to_input(error);
  const AllFlagged flagged = flag_supports(function, options, error);
  for (const double gradient : flagged[static_cast<std::size_t>(Suspicion::steep)].value)
    diagnosis.largest_gradient = std::max(diagnosis.largest_gradient, gradient);
  std::vector<Vec3f> foot(n);
  for (std::size_t i = 0; i < n; ++i) foot[i] = data.supports[i].foot;
  const KdTree feet(foot);
  std::vector<std::uint8_t> extra(diagnosis.mesh.vertices.size(), 0);
  TriangleMesh mesh = diagnosis.mesh;
  move_from_input(mesh, function.frame);
  find_extra_sheets(function, mesh, feet, diagnosis, extra);
  for (const Suspicion kind : {Suspicion::low_coverage, Suspicion::high_error, Suspicion::steep})
    gather_regions(function, kind, flagged[static_cast<std::size_t>(kind)], diagnosis);
  // Limits the number of regions of each kind.
  std::array<std::size_t, kSuspicions> kept{};
  std::erase_if(diagnosis.regions, [&](const SuspiciousRegion& p) {
    return ++kept[static_cast<std::size_t>(p.kind)] > options.most_regions;
  });
  if (function.samples->size() > 0)  // nothing can be fitted again without
    for (SuspiciousRegion& p : diagnosis.regions) suggest(p, options, diagnosis.error_above, !data.paper);
  if (function.samples->size() > 0 && !diagnosis.edits().empty()) {
    MeshReport report;
    report.open = field.report().open_area > 0;
    detail::choose_components(mesh, {}, *function.samples, field.report().spacing, report);
    try_edits(function, flagged, lost_samples_of(function, mesh), options, error, diagnosis, progress);
  }
  color_mesh(function, feet, flagged, extra, diagnosis.mesh);
  progress.finish();
  return diagnosis;
}

}  // namespace sansmesh::inline v1
