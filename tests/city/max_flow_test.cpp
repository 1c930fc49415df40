// Minimum cuts against all cuts.
#include "city/roofs/max_flow.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/test_data.h"

namespace tetropolis {
namespace {

/// A small graph whose capacities are often alike, so that several cuts are least.
struct Graph {
  struct Arc {
    std::int32_t from, to, there, back;
  };
  std::size_t nodes;
  std::vector<Arc> arcs;
  std::vector<std::int32_t> from_source, to_sink;

  explicit Graph(std::mt19937& random) {
    const auto number = [&](std::int32_t most) {
      return std::uniform_int_distribution<std::int32_t>(0, most)(random);
    };
    nodes = static_cast<std::size_t>(1 + number(7));
    const auto last = static_cast<std::int32_t>(nodes) - 1;
    for (std::size_t u = 0; u < nodes; ++u) {
      from_source.push_back(number(3));
      to_sink.push_back(number(3));
    }
    for (std::int32_t k = number(2 * last); k > 0; --k) {
      const std::int32_t u = number(last), v = number(last);
      if (u != v) arcs.push_back({u, v, number(2), number(2)});
    }
  }

  /// `source_side`: a bit per node.
  std::int32_t cut(std::size_t source_side) const {
    const auto at_source = [&](std::int32_t u) { return (source_side >> u & 1) != 0; };
    std::int32_t sum = 0;
    for (std::size_t u = 0; u < nodes; ++u)
      sum += at_source(static_cast<std::int32_t>(u)) ? to_sink[u] : from_source[u];
    for (const Arc& arc : arcs) {
      if (at_source(arc.from) && !at_source(arc.to)) sum += arc.there;
      if (!at_source(arc.from) && at_source(arc.to)) sum += arc.back;
    }
    return sum;
  }
};

TEST(MaxFlow, FindsTheLeastCutWithTheFewestNodesAtTheSource) {
  std::mt19937 random(testing::test_seed());
  for (int k = 0; k < 500; ++k) {
    const Graph graph(random);
    MaxFlow flow(graph.nodes);
    for (const Graph::Arc& arc : graph.arcs) flow.add_arc(arc.from, arc.to, arc.there, arc.back);
    for (std::size_t u = 0; u < graph.nodes; ++u)
      flow.add_terminal(static_cast<MaxFlow::Node>(u), graph.from_source[u], graph.to_sink[u]);
    flow.run();
    std::size_t found = 0;
    for (std::size_t u = 0; u < graph.nodes; ++u)
      if (flow.on_source_side(static_cast<MaxFlow::Node>(u))) found |= std::size_t{1} << u;
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    std::size_t in_all = 0;  // nodes on the source's side of every least cut
    for (std::size_t side = 0; side < std::size_t{1} << graph.nodes; ++side) {
      const std::int32_t cut = graph.cut(side);
      if (cut <= least) in_all = cut < least ? side : in_all & side;
      least = std::min(least, cut);
    }
    EXPECT_EQ(graph.cut(found), least);
    EXPECT_EQ(found, in_all) << "seed " << testing::test_seed();
  }
}

}  // namespace
}  // namespace tetropolis
