// Indices that say what they number: a VertexIndex is no TriangleIndex.
#pragma once

#include <cassert>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace tetropolis {

/// The place of something in its table, with the layout and the cost of `Number`. Made from
/// integers explicitly; becomes std::size_t, and nothing else, by itself: the [] of vectors takes
/// it. Compared with its own kind and with integers, and moved by integers; indices of different
/// kinds do not meet. Not set unless initialised, like an int; Index{} is 0.
template <typename Tag, typename Number = std::int32_t>
class Index {
 public:
  using Value = Number;

  Index() = default;
  template <std::integral Integer>
  constexpr explicit Index(Integer value) : value_(static_cast<Number>(value)) {}

  /// Stands for no place.
  static constexpr Index none() { return Index(-1); }
  /// Whether it is a place: not negative.
  constexpr bool valid() const { return value_ >= 0; }

  constexpr Number value() const { return value_; }
  /// Precondition: valid().
  template <std::same_as<std::size_t> Size>
  constexpr operator Size() const {  // NOLINT(google-explicit-constructor): what it is for
    assert(valid());
    return static_cast<std::size_t>(value_);
  }

  /// What fmt prints; from release 10 on it converts nothing by itself.
  friend constexpr Number format_as(Index index) { return index.value_; }

  friend constexpr bool operator==(Index, Index) = default;
  friend constexpr std::strong_ordering operator<=>(Index, Index) = default;
  /// With unsigned integers an index that is not valid is larger than any size.
  template <std::integral Integer>
  friend constexpr bool operator==(Index index, Integer integer) {
    return comparable<Integer>(index) == integer;
  }
  template <std::integral Integer>
  friend constexpr std::strong_ordering operator<=>(Index index, Integer integer) {
    return comparable<Integer>(index) <=> integer;
  }

  constexpr Index& operator++() {
    ++value_;
    return *this;
  }
  constexpr Index operator++(int) { return Index(value_++); }
  template <std::integral Integer>
  constexpr Index& operator+=(Integer steps) {
    value_ += static_cast<Number>(steps);
    return *this;
  }
  template <std::integral Integer>
  friend constexpr Index operator+(Index index, Integer steps) {
    return index += steps;
  }
  template <std::integral Integer>
  friend constexpr Index operator-(Index index, Integer steps) {
    return Index(index.value_ - static_cast<Number>(steps));
  }
  /// Where the rows of a table with so many columns begin.
  template <std::integral Integer>
  friend constexpr std::size_t operator*(Index index, Integer columns) {
    return std::size_t{index} * static_cast<std::size_t>(columns);
  }
  template <std::integral Integer>
  friend constexpr std::size_t operator*(Integer columns, Index index) {
    return index * columns;
  }
  template <typename T>
  friend constexpr T* operator+(T* array, Index index) {
    return array + index.value_;
  }
  friend constexpr Number operator-(Index a, Index b) { return a.value_ - b.value_; }

 private:
  template <typename Integer>
  static constexpr auto comparable(Index index) {
    if constexpr (std::signed_integral<Integer>)
      return index.value_;
    else
      return static_cast<std::size_t>(index.value_);
  }

  Number value_;
};

// Without these, different kinds would meet as std::size_t.
template <typename A, typename M, typename B, typename N>
void operator==(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator<=>(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator<(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator>(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator<=(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator>=(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator+(Index<A, M>, Index<B, N>) = delete;
template <typename A, typename M, typename B, typename N>
void operator-(Index<A, M>, Index<B, N>) = delete;

/// The indices from one to before another, to loop over.
template <typename I>
class IndexRange {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = I;
    using difference_type = std::ptrdiff_t;
    using pointer = const I*;
    using reference = I;

    Iterator() = default;
    constexpr explicit Iterator(I at) : at_(at) {}
    constexpr I operator*() const { return at_; }
    constexpr Iterator& operator++() {
      ++at_;
      return *this;
    }
    constexpr Iterator operator++(int) { return Iterator(at_++); }
    friend constexpr bool operator==(Iterator, Iterator) = default;

   private:
    I at_;
  };

  constexpr IndexRange(I first, I last) : first_(first), last_(last) {}
  constexpr Iterator begin() const { return Iterator(first_); }
  constexpr Iterator end() const { return Iterator(last_); }

 private:
  I first_, last_;
};

/// From 0 to `count` - 1.
template <typename I>
constexpr IndexRange<I> indices(std::size_t count) {
  return {I(0), I(count)};
}

/// From `first` to before `last`, which are of type I, or std::size_t. Precondition: first <= last.
template <typename I>
constexpr IndexRange<I> indices(I first, I last) {
  return {first, last};
}
template <typename I>
constexpr IndexRange<I> indices(std::size_t first, std::size_t last) {
  return {I(first), I(last)};
}

}  // namespace tetropolis
