#include "earlier_results.h"

#include <algorithm>
#include <array>
#include <fstream>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

std::vector<std::string> names_below(const std::vector<std::string>& listed) {
  std::vector<std::string> names;
  for (const std::string& name : listed) {
    const fs::path path = fs::path(name).lexically_normal();
    if (!path.empty() && path.is_relative() && *path.begin() != "..")
      names.push_back(path.string());
  }
  return names;
}

EarlierRun earlier_run(const fs::path& folder) {
  using Json = nlohmann::json;
  // A pipe would be waited for.
  if (!is_file(folder / results::kReport)) return {};
  std::ifstream file(folder / results::kReport);
  constexpr std::array kOurs = {"version", "command", "steps"};
  const auto keep = [&](int depth, Json::parse_event_t event, Json& part) {
    return depth != 1 || event != Json::parse_event_t::key || part == "files" ||
           part == "started" || std::find(kOurs.begin(), kOurs.end(), part) != kOurs.end();
  };
  const Json report = Json::parse(file, keep, false);
  const auto has = [&](const char* name) { return report.contains(name); };
  if (!report.is_object() || !std::all_of(kOurs.begin(), kOurs.end(), has)) return {};
  EarlierRun run;
  try {
    run.files = names_below(report.value("files", run.files));
    run.started = report.value("started", run.started);
  } catch (const Json::exception&) {  // changed by hand
  }
  run.files.emplace_back(results::kReport);
  return run;
}

}  // namespace tetropolis
