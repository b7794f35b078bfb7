#include "sansmesh/mesh/face_box_tree.h"

#include "sansmesh/core/parallel.h"
#include "sansmesh/search/space_order.h"

namespace sansmesh::inline v1 {

FaceBoxTree::FaceBoxTree(std::span<const Box3f> boxes) {
  std::vector<Vec3> centers(boxes.size());
  parallel_for(0, centers.size(), 8192, [&](std::size_t t) { centers[t] = Vec3(boxes[t].center()); });
  order_ = space_order(centers);
  while (leaves_ * kLeaf < order_.size()) leaves_ *= 2;
  node_.resize(2 * leaves_);
  box_.resize(order_.size());
  parallel_for(0, order_.size(), 8192, [&](std::size_t i) { box_[i] = boxes[order_[i]]; });
  for (std::size_t i = 0; i < order_.size(); ++i) node_[leaves_ + i / kLeaf].extend(box_[i]);
  for (std::size_t i = leaves_; i-- > 1;)
    for (const std::size_t child : {2 * i, 2 * i + 1}) node_[i].extend(node_[child]);
}

}  // namespace sansmesh::inline v1
