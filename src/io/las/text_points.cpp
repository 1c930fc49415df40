#include "text_points.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are read as they lie");

/// Takes the numbers at the beginning of a line, three at most.
std::size_t take_numbers(std::string_view line, std::array<double, 3>& numbers) {
  const char* at = line.data();
  const char* const end = at + line.size();
  std::size_t count = 0;
  while (count < numbers.size()) {
    while (at != end && (*at == ' ' || *at == '\t' || *at == ',' || *at == ';' || *at == '\r'))
      ++at;
    const auto [next, error] = std::from_chars(at, end, numbers[count]);
    if (error != std::errc{}) break;
    ++count;
    at = next;
  }
  return count;
}

PlainPoints read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  PlainPoints points;
  std::string line;
  for (std::int64_t number = 1; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::array<double, 3> xyz{};
    if (take_numbers(line, xyz) == xyz.size())
      points.xyz.push_back(xyz);
    else if (!points.xyz.empty())
      fail_input(path, fmt::format("line {} is no point x y z; correct it, or remove it", number));
  }
  if (points.xyz.empty()) fail_input(path, "has no line with a point x y z; name a point cloud");
  return points;
}

struct Property {
  std::string name;
  std::size_t size = 0;
  bool is_float = false;
  bool is_signed = false;
};

Property property_of(const fs::path& path, const std::string& type, const std::string& name) {
  const std::pair<std::string_view, Property> kTypes[] = {
      {"char", {name, 1, false, true}},    {"int8", {name, 1, false, true}},
      {"uchar", {name, 1, false, false}},  {"uint8", {name, 1, false, false}},
      {"short", {name, 2, false, true}},   {"int16", {name, 2, false, true}},
      {"ushort", {name, 2, false, false}}, {"uint16", {name, 2, false, false}},
      {"int", {name, 4, false, true}},     {"int32", {name, 4, false, true}},
      {"uint", {name, 4, false, false}},   {"uint32", {name, 4, false, false}},
      {"float", {name, 4, true, true}},    {"float32", {name, 4, true, true}},
      {"double", {name, 8, true, true}},   {"float64", {name, 8, true, true}}};
  for (const auto& [known, property] : kTypes)
    if (known == type) return property;
  fail_input(path, fmt::format("has vertices with a property of type '{}'; write it with numbers",
                               first_bytes(type, 40)));
}

double value_of(const Property& property, const char* at) {
  const auto read = [at](auto number) {
    std::memcpy(&number, at, sizeof number);
    return static_cast<double>(number);
  };
  if (property.is_float) return property.size == 8 ? read(double{}) : read(float{});
  if (property.size == 1) return property.is_signed ? read(std::int8_t{}) : read(std::uint8_t{});
  if (property.size == 2) return property.is_signed ? read(std::int16_t{}) : read(std::uint16_t{});
  return property.is_signed ? read(std::int32_t{}) : read(std::uint32_t{});
}

PlainPoints read_ply(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line, format, element;
  std::vector<Property> properties;
  std::int64_t count = -1;
  bool is_first = true;
  std::getline(file, line);
  if (!line.starts_with("ply")) fail_input(path, "is no PLY file; name a point cloud");
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word;
    if (word == "end_header") break;
    if (word == "format") words >> format;
    if (word == "element") {
      words >> element;
      if (element == "vertex") words >> count;
      if (count < 0) is_first = false;
    }
    if (word == "property" && element == "vertex") {
      words >> type >> name;
      properties.push_back(property_of(path, type, name));
    }
  }
  const bool text = format == "ascii";
  if (count < 0 || !is_first || (!text && format != "binary_little_endian"))
    fail_input(path, "is PLY whose first element is not vertex, or big-endian; write it again");
  constexpr std::size_t kNone = ~std::size_t{0};
  const auto find = [&](std::initializer_list<const char*> names) {
    for (std::size_t p = 0; p < properties.size(); ++p)
      for (const char* known : names)
        if (lower_case(properties[p].name) == known) return p;
    return kNone;
  };
  const std::array<std::size_t, 4> wanted{
      find({"x"}), find({"y"}), find({"z"}),
      find({"classification", "class", "scalar_classification"})};
  if (std::find(wanted.begin(), wanted.begin() + 3, kNone) != wanted.begin() + 3)
    fail_input(path, "has vertices without x, y, z; name a point cloud");
  std::size_t size = 0;
  for (const Property& property : properties) size += property.size;
  PlainPoints points;
  std::vector<double> values(properties.size());
  std::string record(size, '\0');
  for (std::int64_t k = 0; k < count; ++k) {
    bool good = true;
    if (text) {
      for (double& value : values) good = good && static_cast<bool>(file >> value);
    } else {
      good = static_cast<bool>(file.read(record.data(), static_cast<std::streamsize>(size)));
      std::size_t at = 0;
      for (std::size_t p = 0; good && p < properties.size(); at += properties[p++].size)
        values[p] = value_of(properties[p], record.data() + at);
    }
    if (!good)
      fail_input(
          path, fmt::format("ends after {} of {} points; the file is cut, get it again", k, count));
    points.xyz.push_back({values[wanted[0]], values[wanted[1]], values[wanted[2]]});
    if (wanted[3] != kNone)
      points.classification.push_back(
          static_cast<std::uint8_t>(std::clamp(values[wanted[3]], 0.0, 255.0)));
  }
  return points;
}

}  // namespace

bool is_plain_points(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  for (const std::string_view known : {".xyz", ".txt", ".csv", ".asc", ".pts", ".ply"})
    if (extension == known) return true;
  return false;
}

PlainPoints read_plain_points(const fs::path& path) {
  require_ordinary_file(path);
  return lower_case(path.extension().string()) == ".ply" ? read_ply(path) : read_text(path);
}

}  // namespace tetropolis
