// Reading datasets of an HDF5 file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hdf5_handle.h"
#include "hdf5_output.h"

namespace tetropolis {

/// Element of a row, and how many there are: a number is a row of one.
template <typename Row>
struct Hdf5Row {
  using Number = Row;
  static constexpr std::uint64_t columns = 0;
};
template <typename Value, std::size_t Width>
struct Hdf5Row<std::array<Value, Width>> {
  using Number = Value;
  static constexpr std::uint64_t columns = Width;
};

template <typename Number>
inline constexpr Hdf5Type kHdf5Type{};
template <>
inline constexpr Hdf5Type kHdf5Type<double> = Hdf5Type::kFloat64;
template <>
inline constexpr Hdf5Type kHdf5Type<std::int64_t> = Hdf5Type::kInt64;
template <>
inline constexpr Hdf5Type kHdf5Type<std::int32_t> = Hdf5Type::kInt32;

/// An open file. Used from one thread at a time. Errors are Error(kInput) and name the file.
class Hdf5Input {
 public:
  explicit Hdf5Input(std::filesystem::path path);

  /// Number of rows of the dataset `name` ("/group/name"). Row is double, std::int64_t,
  /// std::int32_t, or an array of one of them. Checked: the dataset has that type, shape, and as
  /// many bytes in the file as its rows need (so it is safe to make room for them).
  template <typename Row>
  std::uint64_t rows(const std::string& name) const {
    return rows_of(wanted<Row>(name));
  }

  /// All of them.
  template <typename Row>
  std::vector<Row> read(const std::string& name) const {
    std::vector<Row> result(rows<Row>(name));
    read_all(wanted<Row>(name), result.data());
    return result;
  }

  [[noreturn]] void fail(const std::string& what) const;

 private:
  template <typename Row>
  static Hdf5Dataset wanted(const std::string& name) {
    return {name, kHdf5Type<typename Hdf5Row<Row>::Number>, 0, Hdf5Row<Row>::columns};
  }
  Hdf5Handle open(const Hdf5Dataset& wanted) const;
  std::uint64_t rows_of(const Hdf5Dataset& wanted) const;
  void read_all(const Hdf5Dataset& wanted, void* rows) const;

  std::filesystem::path path_;
  Hdf5Handle file_;
};

}  // namespace tetropolis
