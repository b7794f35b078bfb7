#include "sansmesh/function/edit_function.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/edit/partition_edit.h"
#include "sansmesh/partition/far/sheets.h"

namespace sansmesh::inline v1 {
namespace {

/// A sheet is also spurious if its area is less than this share of the largest one's; an open sheet only if fewer
/// samples than kFewSamples represent it.
constexpr double kSmallSheet = 0.01, kFewSamples = 5;

/// Boxes of changes are merged if their union is at most this many times larger, and always if there are many of them.
constexpr double kUnitedGrowth = 1.2, kAnyGrowth = 1e30;
constexpr std::size_t kMostBoxes = 500;

/// A point is on a sheet if one of its supports has its foot within this many edges of its block.
constexpr float kSheetReach = 2;

template <class... Bodies>
struct Overloaded : Bodies... {
  using Bodies::operator()...;
};
template <class... Bodies>
Overloaded(Bodies...) -> Overloaded<Bodies...>;

/// kNone if no sheet is near.
std::uint32_t nearest_sheet(const PartitionData& data, const Sheets& sheets, const Vec3f& at) {
  std::uint32_t nearest = Sheets::kNone;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    const float d = squared_norm(data.supports[i].foot - at);
    const float reach = kSheetReach * data.edge / static_cast<float>(1u << data.supports[i].level);
    if (sheets.of_support[i] == Sheets::kNone || d >= least || d > reach * reach) continue;
    least = d, nearest = sheets.of_support[i];
  }
  return nearest;
}

std::optional<std::vector<std::uint8_t>> on_sheets(const FittedFunction& function, const EditSelection& s) {
  if (!s.sheet_at && !s.spurious_sheets && !s.all_but_largest) return std::nullopt;
  const PartitionData& data = function.field.data();
  const Sheets sheets = find_sheets(data, function.samples->positions);
  if (s.spurious_sheets && function.samples->size() == 0)
    throw DataError("its samples were not kept: spurious sheets cannot be detected");
  const std::uint32_t wanted =
      s.sheet_at ? nearest_sheet(data, sheets, Vec3f(function.frame.from_input(*s.sheet_at) - data.origin))
                 : Sheets::kNone;
  std::vector<std::uint8_t> flags(data.supports.size());
  const double few = kFewSamples * data.report.spacing * data.report.spacing;
  const auto spurious = [&](std::size_t i, std::uint32_t k) {
    if (k == 0) return false;
    if (data.supports[i].open) return sheets.evidence[k] * sheets.area[k] < few;
    return sheets.evidence[k] < kLeastEvidence || sheets.area[k] < kSmallSheet * sheets.area[0];
  };
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const std::uint32_t k = sheets.of_support[i];
    flags[i] = k != Sheets::kNone && (!s.sheet_at || k == wanted) && (!s.all_but_largest || k != 0) &&
               (!s.spurious_sheets || spurious(i, k));
  }
  return flags;
}

SupportQuery to_query(const FittedFunction& function, const EditSelection& s) {
  const Vec3 origin = function.field.data().origin;
  const auto local = [&](const Vec3& x) { return Vec3f(function.frame.from_input(x) - origin); };
  SupportQuery q;
  if (s.ball) q.ball = {local(s.ball->center), static_cast<float>(function.frame.from_input(s.ball->radius))};
  if (s.box) q.box = Box3f{local(s.box->lower), local(s.box->upper)};
  if (s.half_space) q.half_space = {local(s.half_space->point), Vec3f(normalized(s.half_space->normal))};
  if (s.coverage_below) q.coverage_below = static_cast<float>(*s.coverage_below);
  q.coverage_fails = s.coverage_fails;
  if (s.error_above) q.error_above = static_cast<float>(function.frame.from_input(*s.error_above));
  if (s.samples_below) q.samples_below = static_cast<std::uint32_t>(*s.samples_below);
  q.level_from = s.level_from, q.level_to = s.level_to;
  q.flags = on_sheets(function, s);
  return q;
}

Box3 to_input(const FittedFunction& function, const Box3f& box) {
  if (box.empty()) return {};
  const Vec3 origin = function.field.data().origin;
  return function.frame.to_input(Box3{origin + Vec3(box.lower), origin + Vec3(box.upper)});
}

PartitionOptions options_of(const FittedFunction& function, const Refit& r) {
  PartitionOptions o = function.field.data().options;
  if (r.max_degree) o.max_degree = *r.max_degree;
  if (r.max_depth) o.max_depth = r.max_depth;
  if (r.error) o.error = function.frame.from_input(*r.error);
  if (r.support) o.support = r.support;
  if (r.sharp) o.sharp = *r.sharp;
  return o;
}

}  // namespace

void EditSelection::validate() const {
  check_argument(!ball || (is_finite(ball->center) && ball->radius > 0 && std::isfinite(ball->radius)),
                 "ball: needs a finite centre and a positive radius");
  check_argument(!box || (is_finite(box->lower) && is_finite(box->upper) && !box->empty()),
                 "box: needs a finite lower corner below the upper one");
  check_argument(!half_space || (is_finite(half_space->point) && norm(half_space->normal) > 0 &&
                                 std::isfinite(norm(half_space->normal))),
                 "half_space: needs a finite point and a normal that is not zero");
  check_argument(!coverage_below || (*coverage_below > 0 && *coverage_below <= 2), "coverage_below must lie in (0, 2]");
  if (coverage_fails)
    for (const double k : *coverage_fails)
      check_argument(k >= 0 && k <= 2, "coverage must lie in 0..2 for each degree");
  check_argument(!error_above || (*error_above >= 0 && std::isfinite(*error_above)), "error_above must be a length");
  check_argument(!samples_below || *samples_below >= 0, "samples_below must be at least 0");
  check_argument(!level_from || (*level_from >= 0 && *level_from <= 20), "level_from must lie in 0..20");
  check_argument(!level_to || (*level_to >= 0 && *level_to <= 20), "level_to must lie in 0..20");
  check_argument(!level_from || !level_to || *level_from <= *level_to, "level_from must not exceed level_to");
  check_argument(!sheet_at || is_finite(*sheet_at), "sheet_at must be finite");
}

FunctionEditor::FunctionEditor(FittedFunction function) : function_(std::move(function)) {}

EditReport FunctionEditor::undo(int steps) {
  if (steps < 1) throw ArgumentError("undo: at least 1 step");
  if (static_cast<std::size_t>(steps) > before_.size())
    throw ArgumentError(fmt::format("undo: there are {} edits to undo, not {}", before_.size(), steps));
  Before& then = before_[before_.size() - static_cast<std::size_t>(steps)];
  EditReport report;
  report.regions = changed_;
  report.changed = bounds_of(changed_);
  report.what = "took back " + counted(static_cast<std::size_t>(steps), "edit");
  function_.field = std::move(then.field);
  function_.history.resize(then.history);
  changed_ = std::move(then.changed);
  before_.erase(before_.end() - steps, before_.end());
  return report;
}

EditReport FunctionEditor::apply(const Edit& edit, Progress& progress) {
  if (const Undo* back = std::get_if<Undo>(&edit.action)) return undo(back->steps);
  edit.select.validate();
  const PartitionData& data = function_.field.data();
  progress.begin("select");
  const Selection chosen = select_supports(data, to_query(function_, edit.select));
  EditReport report;
  report.chosen = chosen.size();
  if (chosen.empty()) {
    report.what = "nothing is selected";
    // An edit without effect can be undone, but is not recorded in the history.
    before_.push_back({function_.field, changed_, function_.history.size()});
    return report;
  }
  const EditSamples samples{function_.samples->positions, function_.samples->normals};
  EditResult result = std::visit(
      Overloaded{[&](const SetDegree& a) {
                   EditResult r = set_degree(data, chosen, a.degree, samples, progress);
                   const std::string which =
                       a.degree == kAutomaticDegree ? "as the samples allow" : std::to_string(a.degree);
                   report.what = fmt::format("degree {} in {}", which, counted(r.changes - r.lower, "support"));
                   if (r.lower > 0) report.what += fmt::format(", a lower one in {}", r.lower);
                   if (r.changes < chosen.size())
                     report.what += fmt::format(", {} left as they were", chosen.size() - r.changes);
                   return r;
                 },
                 [&](const Refit& a) {
                   EditResult r = refit(data, chosen, options_of(function_, a), samples, progress);
                   report.what = fmt::format("{} fitted again, now {}", counted(r.changes, "support"), r.supports);
                   if (r.changes < chosen.size())
                     report.what += fmt::format("; {} left as they were", chosen.size() - r.changes);
                   return r;
                 },
                 [&](const SetConstant& a) {
                   if (a.automatic) {
                     EditResult r = set_automatic_constant(data, chosen);
                     report.what = counted(chosen.size(), "support") + " set to what the others make of " +
                                   (chosen.size() == 1 ? "its centre" : "their centres");
                     return r;
                   }
                   report.what = fmt::format("{} set to {} ({:+g} radii)", counted(chosen.size(), "support"),
                                             a.value > 0 ? "outside" : "inside", a.value);
                   return set_constant(data, chosen, static_cast<float>(a.value));
                 },
                 [&](const RemoveSupports&) {
                   report.what = fmt::format("{} removed", counted(chosen.size(), "support"));
                   return remove_supports(data, chosen);
                 },
                 [&](const Undo&) { return EditResult{}; }},
      edit.action);
  report.supports = result.supports;
  report.changed = to_input(function_, result.changed);
  for (const Box3f& region : result.regions) report.regions.push_back(to_input(function_, region));
  progress.begin("assemble");
  PartitionOfUnity field(std::move(result.data));
  before_.push_back({function_.field, changed_, function_.history.size()});
  function_.history.push_back(report.what);
  changed_.insert(changed_.end(), report.regions.begin(), report.regions.end());
  unite(changed_, changed_.size() > kMostBoxes ? kAnyGrowth : kUnitedGrowth);
  function_.field = std::move(field);
  return report;
}

namespace {

constexpr ReportRow kEditReportRows[] = {
    reported<&EditReport::what>({.text = "The edit as one line of text"}),
    reported<&EditReport::chosen>({.name = "selected", .text = "Supports that were selected"}),
    reported<&EditReport::supports>({.text = "Supports that replaced them"}),
    reported<&EditReport::changed>(
        {.text = "Corners of the box in which the function may have changed", .unit = "length"}),
    reported<&EditReport::regions>({.name = "boxes", .text = "Boxes whose union contains the change"})};

}  // namespace

const ReportSchema& EditReport::schema() {
  static constexpr ReportSchema schema{kEditReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
