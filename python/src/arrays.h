// NumPy arrays that show the library's own memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

namespace tetropolis::python {

namespace nb = nanobind;

template <typename Number>
using Array1 = nb::ndarray<nb::numpy, Number, nb::ndim<1>>;
template <typename Number, int kColumns>
using Array2 = nb::ndarray<nb::numpy, Number, nb::shape<-1, kColumns>>;

/// How properties return arrays, which know their owners.
inline constexpr auto kArray = nb::rv_policy::automatic;

/// Memory that nobody reads or writes: an array without elements has to be somewhere.
inline void* nowhere() {
  alignas(8) static std::array<unsigned char, 8> memory{};
  return memory.data();
}

/// The elements, which are numbers or indices, as long as `owner` lives. No copy; read-only.
template <typename Number, typename Element>
Array1<const Number> view(const std::vector<Element>& elements, nb::handle owner) {
  static_assert(sizeof(Element) == sizeof(Number));
  const void* data = elements.empty() ? nowhere() : elements.data();
  return {static_cast<const Number*>(data), {elements.size()}, owner};
}

/// The same of elements that are rows of numbers.
template <typename Number, int kColumns, typename Element>
Array2<const Number, kColumns> view_rows(const std::vector<Element>& elements, nb::handle owner) {
  static_assert(sizeof(Element) == kColumns * sizeof(Number));
  const void* data = elements.empty() ? nowhere() : elements.data();
  return {static_cast<const Number*>(data), {elements.size(), kColumns}, owner};
}

/// One member of each element; writing to the array edits the elements.
template <typename Number, typename Element>
Array1<Number> view_member(std::vector<Element>& elements, Number Element::*member,
                           nb::handle owner) {
  static_assert(sizeof(Element) % sizeof(Number) == 0);
  void* data = elements.empty() ? nowhere() : &(elements.front().*member);
  return {static_cast<Number*>(data),
          {elements.size()},
          owner,
          {static_cast<std::int64_t>(sizeof(Element) / sizeof(Number))}};
}

/// A new array that Python owns; `fill` gets the memory of `rows` elements.
template <typename Number, int kColumns, typename Element, typename Fill>
Array2<Number, kColumns> make_rows(std::size_t rows, const Fill& fill) {
  static_assert(sizeof(Element) == kColumns * sizeof(Number));
  auto* data = new Element[rows > 0 ? rows : 1];
  const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<Element*>(p); });
  {
    const nb::gil_scoped_release release;
    fill(data);
  }
  return {data->data(), {rows, kColumns}, owner};
}

template <typename Number, typename Element = Number, typename Fill>
Array1<Number> make_array(std::size_t size, const Fill& fill) {
  static_assert(sizeof(Element) == sizeof(Number));
  auto* data = new Element[size > 0 ? size : 1];
  const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<Element*>(p); });
  {
    const nb::gil_scoped_release release;
    fill(data);
  }
  return {static_cast<Number*>(static_cast<void*>(data)), {size}, owner};
}

}  // namespace tetropolis::python
