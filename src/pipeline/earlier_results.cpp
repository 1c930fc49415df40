#include "earlier_results.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

std::optional<std::string> name_below(const std::string& listed) {
  const fs::path path = fs::path(listed).lexically_normal();
  if (path.empty() || !path.is_relative() || *path.begin() == "..") return std::nullopt;
  return path.string();
}

std::vector<std::string> earlier_results(const fs::path& folder) {
  using Json = nlohmann::json;
  std::error_code error;
  // A pipe would be waited for.
  if (!fs::is_regular_file(folder / results::kReport, error)) return {};
  std::ifstream file(folder / results::kReport);
  constexpr std::array kOurs = {"version", "command", "steps"};
  const auto keep = [&](int depth, Json::parse_event_t event, Json& part) {
    return depth != 1 || event != Json::parse_event_t::key || part == "files" ||
           std::find(kOurs.begin(), kOurs.end(), part) != kOurs.end();
  };
  const Json report = Json::parse(file, keep, false);
  const auto has = [&](const char* name) { return report.contains(name); };
  if (!report.is_object() || !std::all_of(kOurs.begin(), kOurs.end(), has)) return {};
  std::vector<std::string> names;
  for (const Json& listed : report.value("files", Json::array()))
    if (listed.is_string())
      if (std::optional<std::string> name = name_below(listed.get<std::string>()))
        names.push_back(std::move(*name));
  names.emplace_back(results::kReport);
  return names;
}

}  // namespace tetropolis
