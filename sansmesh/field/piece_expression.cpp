#include "sansmesh/field/piece_expression.h"

namespace sansmesh::inline v1 {

void PieceExpression::active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const {
  std::vector<double> value(nodes_.size());
  std::vector<std::uint32_t> from(nodes_.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      const Node& n = nodes_[k];
      if (n.kind == Node::Kind::piece) {
        evaluate_piece(n.a, x.subspan(i, 1), {&value[k], 1}, {});
        from[k] = n.a;
        continue;
      }
      const bool first = n.kind == Node::Kind::least ? value[n.a] <= value[n.b] : value[n.a] >= value[n.b];
      value[k] = value[first ? n.a : n.b];
      from[k] = from[first ? n.a : n.b];
    }
    piece[i] = from.back();
  }
}

void PieceExpression::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  std::vector<std::uint32_t> piece(x.size());
  active(x, piece);
  for (std::size_t i = 0; i < x.size(); ++i)
    evaluate_piece(piece[i], x.subspan(i, 1), values.subspan(i, 1),
                   gradients.empty() ? gradients : gradients.subspan(i, 1));
}

}  // namespace sansmesh::inline v1
