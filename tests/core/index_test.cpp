#include "tetropolis/core/index.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "tetropolis/core/indexed_vector.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {
namespace {

template <typename A, typename B>
concept Comparable = requires(A a, B b) {
  a == b;
}
|| requires(A a, B b) { a < b; }
|| requires(A a, B b) { b > a; }
|| requires(A a, B b) { a <= b; }
|| requires(A a, B b) { b >= a; }
|| requires(A a, B b) { a <=> b; };
template <typename A, typename B>
concept Addable = requires(A a, B b) {
  a + b;
};
template <typename A, typename B>
concept Subtractable = requires(A a, B b) {
  a - b;
};
template <typename Table, typename I>
concept ReadBy = requires(Table table, I i) {
  table[i];
};

// Different kinds do not meet.
template <typename A, typename B>
constexpr bool kNeverMeet =
    !std::convertible_to<A, B> && !std::constructible_from<B, A> && !std::assignable_from<B&, A> &&
    !Comparable<A, B> && !Addable<A, B> && !Subtractable<A, B> &&
    !ReadBy<IndexedVector<B, int>, A> && !ReadBy<const IndexedVector<B, int>, A>;
static_assert(kNeverMeet<VertexIndex, TriangleIndex>);
static_assert(kNeverMeet<TriangleIndex, VertexIndex>);
static_assert(kNeverMeet<BuildingIndex, RegionIndex>);
static_assert(kNeverMeet<RegionIndex, BuildingIndex>);
static_assert(kNeverMeet<EdgeIndex, TriangleIndex>);
static_assert(kNeverMeet<NodeIndex, CellIndex>);
static_assert(kNeverMeet<VertexIndex, NodeIndex>);

// Integers become indices by name only, and indices std::size_t only.
static_assert(!std::convertible_to<int, VertexIndex> && !std::assignable_from<VertexIndex&, int>);
static_assert(!std::convertible_to<std::size_t, VertexIndex>);
static_assert(std::constructible_from<VertexIndex, int>);
static_assert(std::convertible_to<VertexIndex, std::size_t>);
static_assert(!std::convertible_to<VertexIndex, int> &&
              !std::convertible_to<NodeIndex, std::int64_t>);
static_assert(!std::convertible_to<VertexIndex, double> && !std::convertible_to<VertexIndex, bool>);

// What is allowed.
static_assert(Comparable<VertexIndex, VertexIndex> && Comparable<VertexIndex, std::size_t>);
static_assert(Addable<VertexIndex, int> && !Addable<VertexIndex, VertexIndex>);
static_assert(ReadBy<IndexedVector<VertexIndex, int>, VertexIndex>);
static_assert(ReadBy<const IndexedVector<VertexIndex, int>, std::size_t>);
static_assert(ReadBy<std::vector<int>, VertexIndex>);

// They cost nothing.
static_assert(sizeof(VertexIndex) == 4 && sizeof(NodeIndex) == 8);
static_assert(std::is_trivially_copyable_v<VertexIndex> &&
              std::is_trivially_default_constructible_v<VertexIndex>);
static_assert(sizeof(std::array<VertexIndex, 3>) == 12);

TEST(Index, ComparesAsNumbersDo) {
  const VertexIndex two(2), three(3);
  EXPECT_TRUE(two < three && two <= three && three > two && two != three && two == VertexIndex(2));
  EXPECT_TRUE(two < 3 && two == 2 && 2 == two && 1 < two && two >= -1);
  EXPECT_TRUE(two < std::size_t{3} && std::size_t{2} == two && two < std::uint64_t{1} << 40);
  EXPECT_EQ(std::max(two, three), three);
}

TEST(Index, NoneIsNegativeAndBeyondEverySize) {
  EXPECT_EQ(VertexIndex{}, 0);
  EXPECT_EQ(kNoVertex.value(), -1);
  EXPECT_FALSE(kNoVertex.valid());
  EXPECT_TRUE(VertexIndex(0).valid());
  EXPECT_TRUE(kNoVertex < 0 && kNoVertex < VertexIndex(0));
  EXPECT_FALSE(kNoVertex < std::size_t{100});
  EXPECT_TRUE(NodeIndex::none() >= ~std::size_t{0});
}

TEST(Index, MovesByIntegers) {
  VertexIndex v(5);
  EXPECT_EQ(v + 2, 7);
  EXPECT_EQ(v - 2U, 3);
  EXPECT_EQ(v + 7 - v, 7);
  EXPECT_EQ(v - (v + 7), -7);
  EXPECT_EQ(v++, 5);
  EXPECT_EQ(++v, 7);
  EXPECT_EQ(v += 3, 10);
  EXPECT_EQ(v * 4, std::size_t{40});
  EXPECT_EQ(std::size_t{3} * v, std::size_t{30});
  EXPECT_EQ(NodeIndex(std::int64_t{1} << 40) * 2, std::size_t{1} << 41);
  const std::array<int, 3> numbers{7, 8, 9};
  EXPECT_EQ(*(numbers.data() + VertexIndex(2)), 9);
}

TEST(Index, RangesGoFromFirstToBeforeLast) {
  const auto listed = [](const auto& range) {
    std::vector<std::size_t> list;
    for (const auto i : range) list.push_back(i);
    return list;
  };
  using List = std::vector<std::size_t>;
  EXPECT_EQ(listed(indices<VertexIndex>(3)), (List{0, 1, 2}));
  EXPECT_EQ(listed(indices<VertexIndex>(4, 6)), (List{4, 5}));
  EXPECT_EQ(listed(indices(VertexIndex(7), VertexIndex(9))), (List{7, 8}));
  EXPECT_EQ(listed(indices<NodeIndex>(0)), List{});
  const IndexedVector<TriangleIndex, char> table{'a', 'b'};
  EXPECT_EQ(listed(table.indices()), (List{0, 1}));
  EXPECT_EQ(table.next(), 2);
  EXPECT_EQ(table[TriangleIndex(1)], 'b');
}

}  // namespace
}  // namespace tetropolis
