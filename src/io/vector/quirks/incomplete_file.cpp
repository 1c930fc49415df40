#include "incomplete_file.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/files.h"
#include "core/text.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kEnd = 65536;  // bytes at either end: what is not among the features

/// The values of a key in JSON ("key": value) or XML (key="value"), each with all that follows it.
std::vector<std::string_view> values_of(std::string_view text, std::string_view key) {
  std::vector<std::string_view> values;
  for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
    std::string_view rest = text.substr(at + key.size());
    const auto skip = [&](std::string_view unwanted) {
      rest.remove_prefix(std::min(rest.find_first_not_of(unwanted), rest.size()));
    };
    skip("\" \t\r\n");
    if (rest.empty() || (rest.front() != ':' && rest.front() != '=')) continue;
    rest.remove_prefix(1);
    skip("\"' \t\r\n");
    values.push_back(rest);
  }
  return values;
}

bool has_value(std::string_view text, std::string_view key, std::string_view value) {
  const std::vector<std::string_view> values = values_of(text, key);
  return std::any_of(values.begin(), values.end(),
                     [&](std::string_view v) { return v.starts_with(value); });
}

std::optional<std::int64_t> number_of(std::string_view text, std::string_view key) {
  const std::vector<std::string_view> values = values_of(text, key);
  if (values.empty()) return std::nullopt;
  const std::string_view value = values.front();
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

}  // namespace

std::string why_incomplete(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  const bool is_json = extension == ".json" || extension == ".geojson";
  const bool is_xml = extension == ".gml" || extension == ".xml";
  if ((!is_json && !is_xml) || !is_file(path)) return {};
  const PositionedFile file(path);
  std::string text = file.head(kEnd);
  if (file.size() > kEnd) {
    std::string end(static_cast<std::size_t>(std::min(kEnd, file.size() - kEnd)), '\0');
    end.resize(
        file.read(file.size() - static_cast<std::int64_t>(end.size()), end.data(), end.size()));
    text += '\n' + end;
  }
  constexpr std::string_view kMend = "is one page of the server's features; get the others, too";
  if (is_json && has_value(text, "\"exceededTransferLimit\"", "true"))
    return fmt::format("{} (exceededTransferLimit is true)", kMend);
  const auto matched = number_of(text, "numberMatched");
  const auto returned = number_of(text, "numberReturned");
  if (matched && returned && *matched > *returned)
    return fmt::format("{} (it returned {} features of {})", kMend, *returned, *matched);
  if (is_json && has_value(text, "\"rel\"", "next\""))
    return fmt::format("{} (it links to the next)", kMend);
  return {};
}

}  // namespace tetropolis
