#include "sansmesh/data/boolean_expression.h"

#include <utility>

namespace sansmesh::inline v1 {

std::uint32_t BooleanExpression::leaf(std::uint32_t set) {
  nodes.push_back({Kind::leaf, set, {}});
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

std::uint32_t BooleanExpression::combine(Kind kind, std::vector<std::uint32_t> children) {
  nodes.push_back({kind, 0, std::move(children)});
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

BooleanState::BooleanState(const BooleanExpression& expression, std::size_t sets)
    : expression_(expression),
      parent_(expression.nodes.size(), kNoParent),
      true_children_(expression.nodes.size(), 0),
      value_(expression.nodes.size(), 0),
      leaves_(sets) {
  for (std::uint32_t i = 0; i < expression.nodes.size(); ++i) {
    const BooleanExpression::Node& node = expression.nodes[i];
    if (node.kind == BooleanExpression::Kind::leaf) leaves_[node.set].push_back(i);
    for (const std::uint32_t child : node.children) {
      parent_[child] = i;
      true_children_[i] += value_[child];
    }
    value_[i] = value_of(i) ? 1 : 0;
  }
}

bool BooleanState::value_of(std::uint32_t node) const {
  switch (expression_.nodes[node].kind) {
    case BooleanExpression::Kind::leaf:
      return value_[node] != 0;
    case BooleanExpression::Kind::any:
      return true_children_[node] > 0;
    case BooleanExpression::Kind::all:
      return true_children_[node] == expression_.nodes[node].children.size();
    case BooleanExpression::Kind::complement:
      return true_children_[node] == 0;
  }
  return false;
}

void BooleanState::set_node(std::uint32_t node, bool value) {
  while ((value_[node] != 0) != value) {
    value_[node] = value ? 1 : 0;
    const std::uint32_t parent = parent_[node];
    if (parent == kNoParent) return;
    true_children_[parent] += value ? 1u : ~0u;
    node = parent;
    value = value_of(node);
  }
}

void BooleanState::put(std::uint32_t set, bool inside) {
  for (const std::uint32_t leaf : leaves_[set]) set_node(leaf, inside);
}

}  // namespace sansmesh::inline v1
