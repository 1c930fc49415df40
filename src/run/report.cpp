#include "tetropolis/run/report.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "options_of.h"
#include "report_fields.h"
#include "result_files.h"

namespace tetropolis {

template <typename Json, typename Tag, typename Number>
void to_json(Json& json, Index<Tag, Number> index) {
  json = index.value();
}

template <typename Json, typename Tag, typename Number>
void from_json(const Json& json, Index<Tag, Number>& index) {
  index = Index<Tag, Number>(json.template get<Number>());
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <typename T>
struct IsVector : std::false_type {};
template <typename T>
struct IsVector<std::vector<T>> : std::true_type {};

/// Whether fields_of has a list of the type's members.
struct NoField {
  template <typename... Arguments>
  void operator()(Arguments&&...) const {}
};
template <typename T>
concept HasFields = requires(T& value) {
  fields_of(value, NoField{});
};

/// Calls visit(json, last part of the key) in the object that a key with dots is a member of;
/// `descend(json, part)` returns the member of an object, or nullptr.
template <typename Node, typename Descend, typename Visit>
void at_key(Node* json, std::string_view key, const Descend& descend, const Visit& visit) {
  for (std::size_t dot; json != nullptr && (dot = key.find('.')) != std::string_view::npos;
       key.remove_prefix(dot + 1))
    json = descend(*json, std::string(key.substr(0, dot)));
  visit(json, std::string(key));
}

// Writing.

template <typename T>
Json json_of(T& value);

Json config_json(const Config& config) {
  Json json = Json::object();
  for (const ConfigField& field : config_fields())
    std::visit(
        [&](auto member) {
          Json& value = json[std::string(field.name)];
          if constexpr (std::is_same_v<decltype(member), ChoiceMember>)
            value = field.choices[member.get(config)];
          else
            value = config.*member;
        },
        field.member);
  return json;
}

/// Adds members to an object.
struct Writer {
  Json& json;

  template <typename T>
  void operator()(std::string_view key, T& value, std::string_view, std::string_view) const {
    if constexpr (IsOptional<T>::value) {
      if (value) json[std::string(key)] = json_of(*value);
    } else {
      at_key(
          &json, key, [](Json& object, const std::string& part) { return &object[part]; },
          [&](Json* object, const std::string& last) { (*object)[last] = json_of(value); });
    }
  }
};

template <typename T>
Json json_of(T& value) {
  if constexpr (std::is_same_v<T, Config>) {
    return config_json(value);
  } else if constexpr (std::is_same_v<T, Point2>) {
    return {value.x, value.y, 0.0};
  } else if constexpr (std::is_same_v<T, Bounds2>) {
    return {value.xmin, value.ymin, value.xmax, value.ymax};
  } else if constexpr (std::is_same_v<T, std::map<int, std::int64_t>>) {
    Json json = Json::object();
    for (const auto& [code, count] : value) json[std::to_string(code)] = count;
    return json;
  } else if constexpr (std::is_same_v<T, std::vector<PatchCount>>) {
    Json json = Json::object();
    for (const auto& [name, faces] : value) json[name] = faces;
    return json;
  } else if constexpr (IsVector<T>::value) {
    Json json = Json::array();
    for (auto& element : value) json.push_back(json_of(element));
    return json;
  } else if constexpr (HasFields<T>) {
    Json json = Json::object();
    fields_of(value, Writer{json});
    return json;
  } else {
    return value;
  }
}

// Reading.

/// Sets members from an object, and notes those that it lacks.
struct Reader {
  const Json& json;
  std::string path;
  std::vector<std::string>& missing;

  template <typename T>
  void operator()(std::string_view key, T& value, std::string_view, std::string_view) const {
    const auto descend = [](const Json& object, const std::string& part) -> const Json* {
      const auto member = object.find(part);
      return member == object.end() ? nullptr : &*member;
    };
    at_key(&json, key, descend, [&](const Json* object, const std::string& last) {
      const Json* member = object == nullptr ? nullptr : descend(*object, last);
      std::string place = path + '/' + std::string(key);
      std::replace(place.begin() + std::ssize(path), place.end(), '.', '/');
      if (member == nullptr)
        missing.push_back(place);
      else
        read(*member, value, place);
    });
  }

  template <typename T>
  void read(const Json& from, T& value, const std::string& place) const {
    if constexpr (IsOptional<T>::value) {
      read(from, value.emplace(), place);
    } else if constexpr (std::is_same_v<T, Config>) {
      read_config(from, value, place);
    } else if constexpr (std::is_same_v<T, Point2>) {
      value = {from.at(0).template get<double>(), from.at(1).template get<double>()};
    } else if constexpr (std::is_same_v<T, Bounds2>) {
      const auto box = from.template get<std::array<double, 4>>();
      value = {box[0], box[1], box[2], box[3]};
    } else if constexpr (std::is_same_v<T, std::map<int, std::int64_t>>) {
      for (const auto& [code, count] : from.items())
        value[std::stoi(code)] = count.template get<std::int64_t>();
    } else if constexpr (std::is_same_v<T, std::vector<PatchCount>>) {
      for (const auto& [name, faces] : from.items())
        value.push_back({name, faces.template get<std::int64_t>()});
    } else if constexpr (IsVector<T>::value) {
      if constexpr (HasFields<typename T::value_type>) {
        for (const Json& element : from) {
          const std::string number = std::to_string(value.size());
          read(element, value.emplace_back(), place + '/' + number);
        }
      } else {
        value = from.template get<T>();
      }
    } else if constexpr (HasFields<T>) {
      if (!from.is_object()) throw Json::type_error::create(302, "no object", &from);
      fields_of(value, Reader{from, place, missing});
    } else if constexpr (std::is_same_v<T, std::string_view>) {
      // A literal of the writer; nobody asks for it.
    } else if constexpr (std::is_same_v<T, double>) {
      value = from.is_null() ? kInfinity : from.get<double>();
    } else {
      value = from.template get<T>();
    }
  }

  void read_config(const Json& from, Config& config, const std::string& place) const {
    if (!from.is_object()) throw Json::type_error::create(302, "no object", &from);
    for (const ConfigField& field : config_fields()) {
      const auto member = from.find(std::string(field.name));
      if (member == from.end()) {
        missing.push_back(place + '/' + std::string(field.name));
        continue;
      }
      std::visit(
          [&](auto target) {
            if constexpr (std::is_same_v<decltype(target), ChoiceMember>) {
              const auto choice =
                  std::find(field.choices.begin(), field.choices.end(), member->get<std::string>());
              if (choice != field.choices.end())
                target.set(config,
                           static_cast<std::size_t>(std::distance(field.choices.begin(), choice)));
            } else {
              member->get_to(config.*target);
            }
          },
          field.member);
    }
  }
};

/// What reports of a command have not: it is no loss.
bool is_optional(const std::string& command, std::string_view pointer) {
  const bool makes_city = command == "build" || command == "city";
  const bool makes_mesh = command == "build" || command == "mesh";
  if (pointer == "/place") return true;
  if (pointer == "/preflight") return !makes_city;
  if (pointer == "/sources") return command != "mesh";
  if (pointer == "/input") return command == "mesh";
  if (pointer == "/city") return command == "synth";
  if (pointer == "/ground_mesh" || pointer == "/volume_mesh" || pointer == "/surface_mesh")
    return !makes_mesh;
  return !makes_city && !makes_mesh;  // `synth`: nothing is compared
}

// Documentation.

template <typename T>
struct Inner {
  using Type = T;
};
template <typename T>
struct Inner<std::optional<T>> : Inner<T> {};
template <typename T>
struct Inner<std::vector<T>> {
  using Type = T;
};

struct Table {
  std::string& text;
  std::string prefix;

  template <typename T>
  void operator()(std::string_view key, T&, std::string_view type, std::string_view meaning) const {
    const std::string whole = prefix + std::string(key);
    using Element = typename Inner<T>::Type;
    if constexpr (HasFields<Element>) {
      Element example{};
      fields_of(example, Table{text, whole + (IsVector<T>::value ? "[]." : ".")});
    } else {
      text += fmt::format("| `{}` | {} | {} |\n", whole, type, meaning);
    }
  }
};

}  // namespace

std::string to_json(Report report) {
  Json json = Json::object();
  report_fields(report, Writer{json});
  if (report.sources.empty()) json.erase("sources");
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string account_line(const Report& report) {
  return report.city ? account_in_words(*report.city, city_options(report.config)) : std::string();
}

ReadReport report_from_json(const std::string& text, const std::string& source) {
  try {
    const Json json = Json::parse(text);
    ReadReport result;
    if (json.is_object() && json.contains("command")) {
      report_fields(result.report, Reader{json, "", result.missing});
      std::erase_if(result.missing, [&](const std::string& pointer) {
        return is_optional(result.report.command, pointer);
      });
      result.has_origin = json.contains("origin");
      result.has_domain = json.contains("domain");
      result.has_crs = json.contains("crs");
      return result;
    }
  } catch (const Json::exception&) {        // no JSON, or members of other types than a report's
  } catch (const std::invalid_argument&) {  // a class that is no number
  } catch (const std::out_of_range&) {
  }
  throw Error(ErrorKind::kInput, source + ": not a report of tetropolis");
}

std::optional<ReadReport> read_report(const fs::path& folder) {
  const fs::path path = folder / results::kReport;
  std::error_code error;
  if (fs::is_fifo(path, error))  // which would be waited for
    throw Error(ErrorKind::kInput, path.string() + ": is not an ordinary file");
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    const int reason = errno;
    if (!fs::exists(path, error)) return std::nullopt;
    throw Error(ErrorKind::kInput, path.string() + ": cannot be read: " + std::strerror(reason));
  }
  std::string text;
  try {
    text.assign(std::istreambuf_iterator<char>(file), {});
  } catch (const std::ios_base::failure&) {  // not even a file
  }
  return report_from_json(text, path.string());
}

std::string report_markdown() {
  std::string text = "| key | type, unit | meaning |\n|---|---|---|\n";
  Report report;
  report_fields(report, Table{text, ""});
  return text;
}

}  // namespace tetropolis
