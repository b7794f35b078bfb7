#include "sansmesh/partition/paper/paper_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/assemble.h"
#include "sansmesh/partition/fit/leaf_fit.h"
#include "sansmesh/partition/fit/sorted_samples.h"
#include "sansmesh/partition/paper/paper_local.h"

namespace sansmesh::inline v1 {
namespace {

/// Decision on a block.
struct Decision {
  enum Kind : std::uint8_t { leaf, kept, two_sheets, too_many, not_good, not_worse } kind = leaf;
  bool above = false;  ///< a leaf that is not good
  FittedLeaf fitted;   ///< leaves only
  std::vector<PaperBlock> children;
};

class PaperTree {
 public:
  explicit PaperTree(const PaperFitter& fitter) : fitter_(fitter) {}

  /// Leaves in the order of the Morton curve.
  std::vector<FittedLeaf> grow(PaperBlock root, Progress& progress) {
    std::vector<PaperBlock> blocks;
    blocks.push_back(std::move(root));
    std::vector<FittedLeaf> leaves;
    progress.begin("fit blocks", static_cast<std::size_t>(fitter_.options().max_depth) + 1);
    while (!blocks.empty()) {
      progress.advance();
      std::vector<Decision> decisions(blocks.size());
      parallel_ranges(0, blocks.size(), 16, [&](std::size_t first, std::size_t last) {
        PaperFitter::Workspace ws;
        progress.check();
        for (std::size_t b = first; b < last; ++b) decisions[b] = decide(blocks[b], ws);
      });
      Level& here = levels_.emplace_back();
      std::vector<PaperBlock> next;
      for (Decision& d : decisions) {
        count(d);
        here.first_child.push_back(static_cast<std::uint32_t>(next.size()));
        here.code.push_back(d.children.empty() ? d.fitted.support.code : d.children[0].code >> 3);
        for (PaperBlock& child : d.children) next.push_back(std::move(child));
        if (d.children.empty()) leaves.push_back(std::move(d.fitted));
      }
      here.first_child.push_back(static_cast<std::uint32_t>(next.size()));
      blocks = std::move(next);
    }
    std::sort(leaves.begin(), leaves.end(), [](const FittedLeaf& a, const FittedLeaf& b) {
      return curve_position(a.support.level, a.support.code) < curve_position(b.support.level, b.support.code);
    });
    return leaves;
  }

  int depth() const { return static_cast<int>(levels_.size()) - 1; }
  const PaperReport& report() const { return report_; }

  /// Tree for the polygoniser: subdivided blocks have an infinite gap, leaves a sufficiently small one.
  std::vector<PartitionData::Flatness> take_levels() {
    std::vector<PartitionData::Flatness> result(levels_.size());
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      const std::vector<std::uint32_t>& child = levels_[l].first_child;
      std::vector<float> gap(levels_[l].code.size());
      for (std::size_t c = 0; c < gap.size(); ++c)
        gap[c] = child[c + 1] > child[c] ? std::numeric_limits<float>::infinity() : 0;
      result[l].gap = std::move(gap);
      result[l].code = std::move(levels_[l].code);
      if (l + 1 < levels_.size()) result[l].child = std::move(levels_[l].first_child);
    }
    return result;
  }

 private:
  struct Level {
    std::vector<std::uint64_t> code;
    std::vector<std::uint32_t> first_child;  ///< one more than there are codes
  };

  std::vector<PaperBlock> children_of(const PaperBlock& block) const {
    std::vector<PaperBlock> children;
    children.reserve(8);
    for (unsigned k = 0; k < 8; ++k) children.push_back(fitter_.child(block, k));
    return children;
  }

  Decision decide(const PaperBlock& block, PaperFitter::Workspace& ws) const {
    const bool deepest = block.level >= fitter_.options().max_depth;
    Decision d;
    if (!deepest && block.ids.size() > paper::kMany) {
      d.kind = Decision::too_many;
      d.children = children_of(block);
      return d;
    }
    const PaperLocal local = fitter_.approximate(block, ws);
    if (!local.good && !deepest) {
      d.kind = local.two_sheets ? Decision::two_sheets : Decision::not_good;
      d.children = children_of(block);
      if (!local.two_sheets && block.ids.size() < paper::kFew) {
        d.kind = are_worse(d.children, local, ws) ? Decision::kept : Decision::not_worse;
        if (d.kind == Decision::kept) d.children.clear();
      }
      if (!d.children.empty()) return d;
    }
    d.above = !local.good;
    d.fitted = leaf_of(fitter_, local);
    return d;
  }

  /// Whether the children's approximations have a larger mean squared distance from their samples than the parent's
  /// from its own. Children without samples have no error.
  bool are_worse(const std::vector<PaperBlock>& children, const PaperLocal& parent, PaperFitter::Workspace& ws) const {
    double squares = 0;
    std::size_t n = 0;
    for (const PaperBlock& child : children) {
      if (child.ids.empty()) continue;
      squares += fitter_.approximate(child, ws).squares;
      n += child.ids.size();
    }
    return squares * static_cast<double>(parent.support.samples) > parent.squares * static_cast<double>(n);
  }

  void count(const Decision& d) {
    ++report_.blocks;
    report_.two_sheets += d.kind == Decision::two_sheets;
    report_.too_many += d.kind == Decision::too_many;
    report_.not_worse += d.kind == Decision::not_worse;
    report_.kept += d.kind == Decision::kept;
    if (!d.children.empty()) return;
    report_.above += d.above;
    ++(is_borrowed(d.fitted.support) ? report_.borrowed : report_.fitted);
  }

  const PaperFitter& fitter_;
  std::vector<Level> levels_;
  PaperReport report_;
};

/// Fills in the report of the whole fit: all residuals count as noise.
void report_on(PartitionData& data, std::size_t samples, double limit) {
  double squares = 0, n = 0;
  for (const Support& s : data.supports) {
    squares += static_cast<double>(s.error) * static_cast<double>(s.error) * s.samples;
    n += s.samples;
  }
  data.report.error = limit;
  data.report.noise = data.report.accuracy = n > 0 ? std::sqrt(squares / n) : 0;
  // If no plane passes through its block, there is no area to divide.
  const double area =
      data.report.area > 0 ? data.report.area : limit / data.paper->threshold * limit / data.paper->threshold;
  data.report.spacing = std::sqrt(area / static_cast<double>(samples));
  data.basis.variance = data.report.noise * data.report.noise;
  data.basis.accepted = limit;
}

/// The equivalent options of the default method, where they exist.
PartitionOptions in_common(const PaperOptions& o, double limit) {
  PartitionOptions common;
  common.max_depth = o.max_depth;
  common.error = limit;
  common.support = o.support;
  common.max_degree = o.max_degree;
  common.min_samples = static_cast<int>(kEnoughForPlane);
  common.max_samples = static_cast<int>(paper::kMany);
  for (std::size_t d = 2; d <= kMaxDegree; ++d) common.coverage[d] = o.coverage[d - 2];
  common.sharp = false;
  return common;
}

std::size_t leaves_to_balance(const PartitionOfUnity& field) {
  BlockTree tree = field.mesh_blocks(0);
  const std::size_t before = tree.size();
  tree.balance();
  // Only leaves that existed before can have been subdivided first.
  std::size_t count = 0;
  for (std::size_t b = 0; b < before; ++b)
    count += !tree.is_leaf(b) && static_cast<std::size_t>(tree[b].first_child) >= before;
  return count;
}

}  // namespace

PartitionOfUnity fit_paper_partition(PointSet points, const PaperOptions& options, Progress& progress, PointSet* sorted,
                                     PaperReport* report) {
  options.validate();
  PartitionData data;
  data.paper = options;
  const Box3f box = set_root_cube(points, data);
  const double limit = options.threshold * box.diagonal();
  data.options = in_common(options, limit);

  progress.begin("sort samples");
  data.basis.sort_depth = std::max(options.max_depth, 10);
  SampleTree tree = sort_samples(points, data, sorted);
  const PaperFitter fitter(tree.positions(), tree.normals(), data.lower, data.edge, options, limit);
  PaperBlock root;
  root.ids.resize(tree.positions().size());
  std::iota(root.ids.begin(), root.ids.end(), 0u);
  PaperTree blocks(fitter);
  std::vector<FittedLeaf> leaves = blocks.grow(std::move(root), progress);

  progress.begin("assemble");
  data.basis.finest = data.basis.tried = blocks.depth();
  data.basis.support = data.basis.fit = options.support;
  data.flatness = blocks.take_levels();
  std::vector<LeafRef> all;
  all.reserve(leaves.size());
  for (const FittedLeaf& leaf : leaves) all.push_back(ref_of(leaf));
  assemble(all, data);
  report_on(data, tree.positions().size(), limit);
  take_samples(tree, sorted);
  PartitionOfUnity field(std::move(data));
  if (report) {
    *report = blocks.report();
    report->balanced = leaves_to_balance(field);
  }
  progress.finish();
  return field;
}

namespace {

constexpr ReportRow kPaperReportRows[] = {
    reported<&PaperReport::blocks>({.text = "Blocks of the tree of fits, all levels"}),
    reported<&PaperReport::fitted>({.text = "Leaves with a polynomial of their own samples"}),
    reported<&PaperReport::borrowed>({.text = "Leaves with a plane of the nearest samples"}),
    reported<&PaperReport::two_sheets>({.text = "Blocks that were subdivided for two sheets"}),
    reported<&PaperReport::too_many>({.text = "Blocks that were subdivided without a fit"}),
    reported<&PaperReport::not_worse>({.text = "Blocks with few samples that were subdivided"}),
    reported<&PaperReport::kept>(
        {.text = "Blocks with few samples that were not subdivided, since their children are worse"}),
    reported<&PaperReport::above>({.text = "Leaves above the threshold"}),
    reported<&PaperReport::balanced>({.text = "Leaves that only balance subdivides"})};

}  // namespace

const ReportSchema& PaperReport::schema() {
  static constexpr ReportSchema schema{kPaperReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
