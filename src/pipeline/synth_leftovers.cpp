#include "synth_leftovers.h"

#include <fstream>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

namespace tetropolis {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// null if it is not there or no object.
Json read_object(const fs::path& path) {
  std::ifstream file(path);
  if (!file) return nullptr;
  Json json = Json::parse(file, nullptr, false);
  return json.is_object() ? json : nullptr;
}

Json member(const Json& json, const char* name) {
  return json.is_object() ? json.value(name, Json()) : Json();
}

}  // namespace

std::vector<fs::path> left_by_earlier_city(const fs::path& folder, const fs::path& staged) {
  std::vector<fs::path> names;
  const Json report = read_object(folder / "report.json");
  const Json kind = member(member(report, "config"), "kind");
  if (member(report, "command") == "synth" && (kind == "random" || kind == "blocks"))
    names = {"footprints.shp", "footprints.shx", "footprints.dbf",
             "footprints.prj", "footprints.cpg", "points.laz"};
  const Json manifest = read_object(folder / "manifest.json");
  if (member(manifest, "kind") == "adversarial" && manifest.contains("files")) {
    names.emplace_back("manifest.json");
    for (const Json& name : manifest["files"]) {
      if (!name.is_string()) continue;
      const fs::path path = name.get<std::string>();
      if (path == path.filename()) names.push_back(path);  // only plain names are believed
    }
  }
  std::vector<fs::path> left;
  std::error_code ignored;
  for (const fs::path& name : names)
    if (!fs::exists(staged / name, ignored)) left.push_back(folder / name);
  return left;
}

}  // namespace tetropolis
