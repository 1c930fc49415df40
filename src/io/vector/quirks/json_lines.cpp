#include "json_lines.h"

#include <cstdint>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "io/deferred/gdal_functions.h"
#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

bool are_lines_of_collections(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension != ".geojsonl" && extension != ".geojsons" && extension != ".geojsonseq" &&
      extension != ".jsonl" && extension != ".ndjson")
    return false;
  std::string begin(256, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin.find("\"FeatureCollection\"") != std::string::npos;
}

std::string copy_features_of_lines(const fs::path& path, const gdal::MemoryFolder& folder) {
  std::string name = folder.path("a.geojson");
  VSILFILE* const out = VSIFOpenL(name.c_str(), "wb");
  if (out == nullptr) fail_input(path, "GDAL cannot hold its features in memory");
  const auto write = [&](const std::string& text) {
    if (VSIFWriteL(text.data(), 1, text.size(), out) != text.size())
      fail_input(path, "GDAL cannot hold its features in memory");
  };
  std::ifstream file(path, std::ios::binary);
  std::string line, fault;
  // A collection, as GDAL takes lines for such only if they begin with the type.
  const char* before = R"({"type":"FeatureCollection","features":[)";
  for (std::int64_t number = 1; fault.empty() && std::getline(file, line); ++number) {
    const std::size_t begin = line.find('{');
    if (begin == std::string::npos) continue;
    nlohmann::json json = nlohmann::json::parse(line.substr(begin), nullptr, false);
    if (!json.is_object()) {
      fault = fmt::format("line {} is no JSON; the file is cut or broken, get it again", number);
      break;
    }
    nlohmann::json features = nlohmann::json::array();
    if (json.contains("features") && json["features"].is_array())
      features = std::move(json["features"]);
    else
      features.push_back(std::move(json));
    for (const nlohmann::json& feature : features) {
      write(before + feature.dump());
      before = ",\n";
    }
  }
  write("]}");
  VSIFCloseL(out);
  if (!fault.empty()) fail_input(path, fault);
  return name;
}

}  // namespace tetropolis
