#include "sansmesh/mesh/repair/handle_loops.h"

#include <algorithm>
#include <queue>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/parallel_collect.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTwinGrain = 4096;
/// Sources of a search: a least number, and a share of all, because each search begins with a pass over the vertices.
constexpr std::size_t kSourceChunk = 512, kSourceShare = 64;

}  // namespace

HandleClasses::HandleClasses(const TriangleMesh& mesh) : mesh_(mesh), corners_(mesh.triangles, mesh.vertices.size()) {
  join_twins();
  find_components();
  check_fans();
  trace_borders();
  for (const Component& c : components_) genus_ += c.genus();
  if (genus_ > 0) label_edges();
}

void HandleClasses::join_twins() {
  twin_.assign(3 * mesh_.triangles.size(), kNone);
  parallel_ranges(0, mesh_.vertices.size(), kTwinGrain, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> ahead, behind;  // vertices that half-edges from and to v join it with
    for (std::size_t v = first; v < last; ++v) {
      const auto at = std::span(corners_.entries).subspan(corners_.first[v], corners_.first[v + 1] - corners_.first[v]);
      ahead.clear(), behind.clear();
      for (const std::uint32_t h : at) {
        const Triangle& t = mesh_.triangles[h / 3];
        ahead.push_back(t[next(h) % 3]), behind.push_back(t[previous(h) % 3]);
      }
      for (std::size_t k = 0; k < at.size(); ++k) {
        const auto twin = std::find(behind.begin(), behind.end(), ahead[k]);
        if (twin == behind.end() || std::find(twin + 1, behind.end(), ahead[k]) != behind.end()) continue;
        if (std::count(ahead.begin(), ahead.end(), ahead[k]) > 1) continue;
        twin_[at[k]] = previous(at[static_cast<std::size_t>(twin - behind.begin())]);
      }
    }
  });
}

void HandleClasses::find_components() {
  const std::size_t count = mesh_.triangles.size();
  component_of_.assign(count, kNone);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (component_of_[seed] != kNone) continue;
    const auto c = static_cast<std::uint32_t>(components_.size());
    Component component{.first = seed};
    component_of_[seed] = c;
    queue.assign(1, seed);
    long halves = 0, borders = 0;
    for (std::size_t at = 0; at < queue.size(); ++at)
      for (std::uint32_t h = 3 * queue[at]; h < 3 * queue[at] + 3; ++h) {
        if (twin_[h] == kNone) {
          ++borders;
          continue;
        }
        ++halves;
        const std::uint32_t t = twin_[h] / 3;
        if (component_of_[t] == kNone) component_of_[t] = c, queue.push_back(t);
      }
    component.euler = static_cast<long>(queue.size()) - halves / 2 - borders;
    components_.push_back(component);
  }
}

/// Adds the vertices to the Euler numbers. A vertex of several fans spoils the components around it, as does an edge
/// that has no twin although it is no border.
void HandleClasses::check_fans() {
  for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
    const std::uint32_t begin = corners_.first[v], end = corners_.first[v + 1];
    if (begin == end) continue;
    const std::uint32_t start = corners_.entries[begin];
    std::uint32_t seen = 0, h = start;
    do {
      ++seen;
      h = twin_[previous(h)];
    } while (h != kNone && h != start);
    if (h == kNone)
      for (h = start; twin_[h] != kNone; h = next(twin_[h])) ++seen;
    ++components_[component_of_[start / 3]].euler;
    if (seen != end - begin)
      for (std::uint32_t k = begin; k < end; ++k)
        components_[component_of_[corners_.entries[k] / 3]].is_surface = false;
  }
}

void HandleClasses::trace_borders() {
  for (std::uint32_t start = 0; start < twin_.size(); ++start) {
    if (twin_[start] != kNone) continue;
    if (border_of_.empty()) border_of_.assign(twin_.size(), kNone);
    Component& component = components_[component_of_[start / 3]];
    if (border_of_[start] != kNone || !component.is_surface) continue;
    const auto border = static_cast<std::uint32_t>(borders_.size());
    borders_.emplace_back();
    ++component.borders;
    std::uint32_t h = start;
    do {
      border_of_[h] = border;
      borders_.back().push_back(h);
      for (h = next(h); twin_[h] != kNone;) h = next(twin_[h]);
    } while (border_of_[h] == kNone);
  }
}

void HandleClasses::set_label(std::uint32_t h, std::uint64_t label) {
  label_[h] = label;
  if (twin_[h] != kNone) label_[twin_[h]] = label;
}

/// Nodes of the dual graph are the triangles, followed by a face for each boundary loop.
struct LabelSearch {
  LabelSearch(std::size_t nodes, std::size_t half_edges, std::size_t vertices)
      : parent(nodes, kNoVertex), entered(nodes), sum(nodes, 0), crossed(half_edges, 0), tree(vertices) {}
  std::vector<std::uint32_t> parent, entered;  ///< dual tree: parent of each node and a half-edge between the two
  std::vector<std::uint64_t> sum;              ///< XOR of the labels that end in the subtree of each node
  std::vector<std::uint8_t> crossed;           ///< 1 for half-edges that the dual tree crosses
  UnionFind tree;                              ///< tree of the vertices
};

void HandleClasses::label_edges() {
  label_.assign(twin_.size(), 0);
  LabelSearch search(mesh_.triangles.size() + borders_.size(), twin_.size(), mesh_.vertices.size());
  for (std::uint32_t c = 0; c < components_.size(); ++c)
    if (components_[c].genus() > 0) label_component(c, search);
}

/// A breadth-first tree of the dual graph and a tree of the vertices that it does not cross leave two edges for each
/// handle. Each of them closes a cycle with the dual tree, and gives a random number to the edges that the cycle
/// crosses. A loop separates if and only if it crosses every such cycle an even number of times.
void HandleClasses::label_component(std::uint32_t component, LabelSearch& search) {
  const auto triangles = static_cast<std::uint32_t>(mesh_.triangles.size());
  const auto beyond = [&](std::uint32_t h) { return twin_[h] != kNone ? twin_[h] / 3 : triangles + border_of_[h]; };
  std::vector<std::uint32_t> order{components_[component].first};
  const auto enter = [&](std::uint32_t parent, std::uint32_t h, std::uint32_t node) {
    if (node == order[0] || search.parent[node] != kNone) return;
    search.parent[node] = parent;
    search.entered[node] = h;
    search.crossed[h] = 1;
    if (twin_[h] != kNone) search.crossed[twin_[h]] = 1;
    order.push_back(node);
  };
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::uint32_t node = order[at];
    if (node >= triangles)
      for (const std::uint32_t h : borders_[node - triangles]) enter(node, h, h / 3);
    else
      for (std::uint32_t h = 3 * node; h < 3 * node + 3; ++h) enter(node, h, beyond(h));
  }
  for (const std::uint32_t node : order) {
    if (node >= triangles) continue;
    for (std::uint32_t h = 3 * node; h < 3 * node + 3; ++h) {
      if (search.crossed[h] || (twin_[h] != kNone && twin_[h] < h)) continue;
      if (search.tree.join(from(h), to(h))) continue;
      const std::uint64_t label = scrambled(h);
      set_label(h, label);
      search.sum[node] ^= label;
      search.sum[beyond(h)] ^= label;
    }
  }
  for (std::size_t at = order.size() - 1; at > 0; --at) {
    const std::uint32_t node = order[at];
    if (search.sum[node] == 0) continue;
    set_label(search.entered[node], search.sum[node]);
    search.sum[search.parent[node]] ^= search.sum[node];
  }
}

template <class Visit>
void HandleClasses::each_edge_at(std::uint32_t v, const Visit& visit) const {
  for (std::uint32_t k = corners_.first[v]; k < corners_.first[v + 1]; ++k) {
    const std::uint32_t h = corners_.entries[k], before = previous(h);
    visit(h, to(h));
    if (twin_[before] == kNone) visit(before, from(before));
  }
}

/// Memory of searches on one thread.
struct LoopSearch {
  struct Reached {
    std::uint32_t vertex, parent;
    double distance;
    std::uint64_t label;
    bool settled;
  };
  using Entry = std::pair<double, std::uint32_t>;

  explicit LoopSearch(std::size_t vertices) : index(vertices, kNoVertex) {}
  void start(std::uint32_t source) {
    for (const Reached& r : reached) index[r.vertex] = kNoVertex;
    reached.assign(1, {source, kNoVertex, 0, 0, false});
    index[source] = 0;
    queue = {};
    queue.emplace(0, 0);
  }

  std::vector<std::uint32_t> index;  ///< position of each vertex in `reached`
  std::vector<Reached> reached;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
};

/// Dijkstra's algorithm with the label of each path. An edge between two reached vertices closes a loop; its label is
/// the XOR of the paths' labels and the edge's.
HandleLoop HandleClasses::shortest_through(std::uint32_t source, double longest, LoopSearch& search) const {
  search.start(source);
  auto& [index, reached, queue] = search;
  double best = longest;
  std::pair<std::uint32_t, std::uint32_t> closing{kNone, kNone};
  std::uint64_t label = 0;
  while (!queue.empty() && 2 * queue.top().first <= best) {
    const auto [distance, i] = queue.top();
    queue.pop();
    if (reached[i].settled) continue;
    reached[i].settled = true;
    const std::uint32_t v = reached[i].vertex;
    each_edge_at(v, [&](std::uint32_t h, std::uint32_t w) {
      const double length = norm(Vec3(mesh_.vertices[v]) - Vec3(mesh_.vertices[w]));
      const double far = distance + length;
      const std::uint64_t path = reached[i].label ^ label_[h];
      if (index[w] == kNoVertex) {
        index[w] = static_cast<std::uint32_t>(reached.size());
        reached.push_back({w, i, far, path, false});
        queue.emplace(far, index[w]);
        return;
      }
      LoopSearch::Reached& other = reached[index[w]];
      if (other.settled) {
        if (other.label != path && far + other.distance <= best &&
            (closing.first == kNone || far + other.distance < best))
          best = far + other.distance, closing = {i, index[w]}, label = other.label ^ path;
      } else if (far < other.distance) {
        other.distance = far, other.parent = i, other.label = path;
        queue.emplace(far, index[w]);
      }
    });
  }
  HandleLoop loop;
  if (closing.first == kNone) return loop;
  std::vector<std::uint32_t> to_first, to_second;
  for (std::uint32_t i = closing.first; i != kNone; i = reached[i].parent) to_first.push_back(reached[i].vertex);
  for (std::uint32_t i = closing.second; i != kNone; i = reached[i].parent) to_second.push_back(reached[i].vertex);
  // Both end at the source; their common part is no part of the loop.
  while (to_first.size() > 1 && to_second.size() > 1 &&
         to_first[to_first.size() - 2] == to_second[to_second.size() - 2])
    to_first.pop_back(), to_second.pop_back();
  loop.vertices = std::move(to_first);
  loop.vertices.insert(loop.vertices.end(), to_second.rbegin() + 1, to_second.rend());
  for (std::size_t i = 0; i < loop.vertices.size(); ++i)
    loop.length += norm(Vec3(mesh_.vertices[loop.vertices[i]]) -
                        Vec3(mesh_.vertices[loop.vertices[(i + 1) % loop.vertices.size()]]));
  loop.component = component_at(source);
  loop.label = label;
  return loop;
}

std::vector<HandleLoop> HandleClasses::short_loops(
    const std::function<double(std::uint32_t, std::uint32_t)>& longest) const {
  std::vector<HandleLoop> found;
  if (genus_ == 0) return found;
  std::vector<std::uint32_t> sources;
  for (std::uint32_t h = 0; h < label_.size(); ++h)
    if (label_[h] != 0) sources.push_back(std::min(from(h), to(h)));
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  found = parallel_collect<HandleLoop>(sources.size(), std::max(kSourceChunk, sources.size() / kSourceShare),
                                       [&](std::size_t first, std::size_t last, std::vector<HandleLoop>& part) {
                                         LoopSearch search(mesh_.vertices.size());
                                         for (std::size_t i = first; i < last; ++i) {
                                           HandleLoop loop = shortest_through(
                                               sources[i], longest(component_at(sources[i]), sources[i]), search);
                                           if (!loop.vertices.empty()) part.push_back(std::move(loop));
                                         }
                                       });
  std::stable_sort(found.begin(), found.end(),
                   [](const HandleLoop& a, const HandleLoop& b) { return a.length < b.length; });
  return found;
}

}  // namespace sansmesh::inline v1
