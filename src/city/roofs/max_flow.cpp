#include "city/roofs/max_flow.h"

#include <algorithm>
#include <limits>

namespace tetropolis {

MaxFlow::MaxFlow(std::size_t nodes)
    : source_(static_cast<Node>(nodes)),
      sink_(static_cast<Node>(nodes + 1)),
      first_(nodes + 2, -1),
      level_(nodes + 2, -1) {}

void MaxFlow::add_arc(Node u, Node v, std::int32_t there, std::int32_t back) {
  const auto a = static_cast<std::int32_t>(arcs_.size());
  arcs_.push_back({v, there, first_[index(u)]});
  arcs_.push_back({u, back, first_[index(v)]});
  first_[index(u)] = a;
  first_[index(v)] = a + 1;
}

void MaxFlow::add_terminal(Node u, std::int32_t from_source, std::int32_t to_sink) {
  // What flows straight through changes no cut.
  const std::int32_t through = std::min(from_source, to_sink);
  if (from_source > through) add_arc(source_, u, from_source - through, 0);
  if (to_sink > through) add_arc(u, sink_, to_sink - through, 0);
}

/// Levels are numbers of arcs from a node to the sink; returns whether the source has one.
bool MaxFlow::find_levels() {
  std::fill(level_.begin(), level_.end(), -1);
  queue_.assign(1, sink_);
  level_[index(sink_)] = 0;
  for (std::size_t k = 0; k < queue_.size(); ++k) {
    const Node u = queue_[k];
    for (std::int32_t a = first_[index(u)]; a >= 0; a = arcs_[index(a)].next) {
      const Node from = arcs_[index(a)].to;
      if (arcs_[index(a ^ 1)].capacity == 0 || level_[index(from)] >= 0) continue;
      level_[index(from)] = level_[index(u)] + 1;
      if (from == source_) return true;  // no way leads through what is as far
      queue_.push_back(from);
    }
  }
  return false;
}

void MaxFlow::find_source_side() {
  on_source_side_.assign(first_.size(), 0);
  queue_.assign(1, source_);
  on_source_side_[index(source_)] = 1;
  for (std::size_t k = 0; k < queue_.size(); ++k)
    for (std::int32_t a = first_[index(queue_[k])]; a >= 0; a = arcs_[index(a)].next) {
      const Arc& arc = arcs_[index(a)];
      if (arc.capacity == 0 || on_source_side_[index(arc.to)] != 0) continue;
      on_source_side_[index(arc.to)] = 1;
      queue_.push_back(arc.to);
    }
}

/// Paths from the source to the sink, each a level nearer with every arc, until there are none.
void MaxFlow::augment() {
  current_ = first_;
  std::vector<std::int32_t> path;
  Node u = source_;
  for (;;) {
    if (u == sink_) {
      std::int32_t most = std::numeric_limits<std::int32_t>::max();
      for (const std::int32_t a : path) most = std::min(most, arcs_[index(a)].capacity);
      std::size_t full = path.size();
      for (std::size_t k = path.size(); k-- > 0;) {
        Arc& arc = arcs_[index(path[k])];
        arc.capacity -= most;
        arcs_[index(path[k] ^ 1)].capacity += most;
        if (arc.capacity == 0) full = k;
      }
      u = arcs_[index(path[full] ^ 1)].to;
      path.resize(full);
      continue;
    }
    std::int32_t& a = current_[index(u)];
    while (a >= 0 && (arcs_[index(a)].capacity == 0 ||
                      level_[index(arcs_[index(a)].to)] != level_[index(u)] - 1))
      a = arcs_[index(a)].next;
    if (a >= 0) {
      path.push_back(a);
      u = arcs_[index(a)].to;
    } else {
      if (path.empty()) return;
      level_[index(u)] = -1;  // a dead end
      u = arcs_[index(path.back() ^ 1)].to;
      path.pop_back();
    }
  }
}

void MaxFlow::run() {
  while (find_levels()) augment();
  find_source_side();
}

}  // namespace tetropolis
