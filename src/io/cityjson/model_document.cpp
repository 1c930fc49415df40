#include "model_document.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "citygml.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Notes the keys of CityObjects in the order of the file, which the parsed document forgets, and
/// where the text stops to be JSON. (The parser's own call-backs take time quadratic in the length
/// of an array.)
class KeyScan : public nlohmann::json_sax<Json> {
 public:
  std::vector<std::string> keys;
  std::size_t error_byte = 0;
  bool out_of_range = false;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_array() override { return leave(); }
  bool key(string_t& name) override {
    if (depth_ == 1) in_objects_ = name == "CityObjects";
    if (depth_ == 2 && in_objects_) keys.push_back(name);
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&,
                   const nlohmann::detail::exception& error) override {
    error_byte = byte;
    out_of_range = dynamic_cast<const Json::out_of_range*>(&error) != nullptr;
    return false;
  }

 private:
  bool enter() {
    ++depth_;
    return true;
  }
  bool leave() {
    --depth_;
    return true;
  }
  int depth_ = 0;
  bool in_objects_ = false;
};

std::string read_text(const fs::path& path) {
  const PositionedFile file(path);
  return file.head(file.size());
}

/// Adds `by` to every index.
void shift_indices(Json& boundaries, std::size_t by) {
  for (Json& item : boundaries)
    if (item.is_array())
      shift_indices(item, by);
    else if (item.is_number_unsigned())
      item = item.get<std::size_t>() + by;
}

/// A CityJSON text sequence: a line with the transformation, then a line per feature.
ModelDocument parse_sequence(const fs::path& path, const std::string& text) {
  ModelDocument document;
  Json objects = Json::object(), vertices = Json::array();
  std::size_t line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++line;
    if (row.find_first_not_of(" \t\r\x1e") == row.npos) continue;
    Json json =
        Json::parse(row.substr(row.find('{') == row.npos ? 0 : row.find('{')), nullptr, false);
    if (!json.is_object() || !json.contains("type"))
      fail_input(path, fmt::format("line {} is no CityJSON object; the file is cut or broken, get "
                                   "it again",
                                   line));
    if (json["type"] == "CityJSON") {
      if (document.root.is_null()) document.root = std::move(json);
      continue;
    }
    if (json["type"] != "CityJSONFeature" || !json.contains("CityObjects") ||
        !json["CityObjects"].is_object() || !json.contains("vertices") ||
        !json["vertices"].is_array())
      fail_input(path, fmt::format("line {} is no CityJSONFeature; get the file again", line));
    for (auto& [key, object] : json["CityObjects"].items()) {
      if (objects.contains(key))
        fail_input(path, fmt::format("line {}: a second object '{}'", line, key));
      if (object.is_object() && object.contains("geometry") && object["geometry"].is_array())
        for (Json& geometry : object["geometry"])
          if (geometry.is_object() && geometry.contains("boundaries"))
            shift_indices(geometry["boundaries"], vertices.size());
      document.keys.push_back(key);
      objects[key] = std::move(object);
    }
    for (Json& vertex : json["vertices"]) vertices.push_back(std::move(vertex));
  }
  if (document.root.is_null())
    fail_input(path,
               "is a CityJSON sequence without its first line, the one with the transform; "
               "put it before the features");
  document.root["CityObjects"] = std::move(objects);
  document.root["vertices"] = std::move(vertices);
  return document;
}

}  // namespace

ModelDocument read_document(const fs::path& path) {
  if (is_citygml(path)) return read_citygml(path);
  const std::string text = read_text(path);
  if (text.starts_with("PK\3\4") || text.starts_with("\x1f\x8b"))
    fail_input(path, "is packed; unpack it and name the city model that it holds");
  if (text.find("\"CityJSONFeature\"") != std::string::npos) return parse_sequence(path, text);
  KeyScan scan;
  if (!Json::sax_parse(text, &scan)) {
    if (scan.out_of_range)
      fail_input(path, fmt::format("has a number out of range at byte {}; get the file again",
                                   scan.error_byte));
    if (scan.error_byte > text.size())
      fail_input(path, fmt::format("ends at byte {} within its JSON; the file is cut, get it again",
                                   text.size()));
    fail_input(path, fmt::format("is not valid JSON after byte {}; the file is broken or not "
                                 "CityJSON",
                                 scan.error_byte));
  }
  std::unordered_set<std::string> seen;
  for (const std::string& key : scan.keys)
    if (!seen.insert(key).second)
      fail_input(path, fmt::format("/CityObjects has two members '{}'", key));
  return {Json::parse(text), std::move(scan.keys), {}};
}

}  // namespace tetropolis
