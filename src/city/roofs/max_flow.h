// Minimum cuts. Private to src/city.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetropolis {

/// A graph with a source and a sink whose minimum cut is found by a maximum flow, in whole numbers
/// and so without tolerances. Method: E. A. Dinic, "Algorithm for solution of a problem of maximum
/// flow in networks with power estimation" (1970).
class MaxFlow {
 public:
  using Node = std::int32_t;

  explicit MaxFlow(std::size_t nodes);

  /// An arc from u to v and one back. Capacities >= 0.
  void add_arc(Node u, Node v, std::int32_t there, std::int32_t back);
  /// Arcs from the source to u and from u to the sink.
  void add_terminal(Node u, std::int32_t from_source, std::int32_t to_sink);

  void run();
  /// After run(): whether u is on the source's side of the cut with the fewest nodes on it.
  bool on_source_side(Node u) const { return on_source_side_[index(u)] != 0; }

 private:
  struct Arc {
    Node to;
    std::int32_t capacity;
    std::int32_t next;  ///< Of the same node; -1: none.
  };
  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  bool find_levels();
  void augment();
  void find_source_side();

  Node source_, sink_;
  std::vector<std::int32_t> first_, current_, level_;
  std::vector<Arc> arcs_;  ///< Arc a and its reverse a ^ 1.
  std::vector<Node> queue_;
  std::vector<std::uint8_t> on_source_side_;
};

}  // namespace tetropolis
