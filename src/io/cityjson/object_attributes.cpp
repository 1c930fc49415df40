#include "object_attributes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>

namespace tetropolis {

namespace {

bool is_scalar(const Json& value) {
  return value.is_string() || value.is_boolean() || value.is_number();
}

AttributeType type_of(const Json& value) {
  if (value.is_boolean()) return AttributeType::kBoolean;
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)
    return AttributeType::kReal;
  if (value.is_number_integer()) return AttributeType::kInteger;
  return value.is_number() ? AttributeType::kReal : AttributeType::kText;
}

AttributeType common_type(AttributeType a, AttributeType b) {
  const auto is_number = [](AttributeType type) {
    return type == AttributeType::kInteger || type == AttributeType::kReal;
  };
  if (a == b) return a;
  return is_number(a) && is_number(b) ? AttributeType::kReal : AttributeType::kText;
}

template <typename Value, typename Get>
std::vector<Value> values_of(std::span<const Json> rows, const AttributeColumn& column,
                             const Get& get) {
  std::vector<Value> values(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (column.known[row]) values[row] = get(rows[row].at(column.name));
  return values;
}

}  // namespace

Json attributes_of(const Json& objects, const std::string& key) {
  const auto own = [&](const std::string& of) {
    const auto object = objects.find(of);
    if (object == objects.end() || !object->is_object()) return Json::object();
    const Json attributes = object->value("attributes", Json::object());
    return attributes.is_object() ? attributes : Json::object();
  };
  Json all = Json::object();
  const Json& object = objects.at(key);
  const Json* parents = nullptr;
  if (object.is_object() && object.contains("parents")) parents = &object.at("parents");
  if (parents != nullptr && parents->is_array() && !parents->empty() &&
      parents->front().is_string()) {
    const auto& parent = parents->front().get_ref<const std::string&>();
    all = own(parent);
    all.emplace("parent", parent);
  }
  const Json more = own(key);
  for (const auto& [name, value] : more.items())
    if (!value.is_null()) all[name] = value;
  return all;
}

std::vector<AttributeColumn> attribute_columns(std::span<const Json> rows) {
  std::map<std::string, AttributeType> types;
  for (const Json& row : rows)
    for (const auto& [name, value] : row.items()) {
      if (!is_scalar(value)) continue;
      const AttributeType type = type_of(value);
      const auto [at, is_new] = types.try_emplace(name, type);
      if (!is_new) at->second = common_type(at->second, type);
    }
  std::vector<AttributeColumn> columns;
  for (const auto& [name, type] : types) {
    AttributeColumn& column = columns.emplace_back(AttributeColumn{name, type});
    for (const Json& row : rows)
      column.known.push_back(row.contains(name) && is_scalar(row.at(name)));
    if (type == AttributeType::kInteger)
      column.values = values_of<std::int64_t>(
          rows, column, [](const Json& value) { return value.get<std::int64_t>(); });
    else if (type == AttributeType::kBoolean)
      column.values = values_of<std::int64_t>(
          rows, column, [](const Json& value) { return value.get<bool>() ? 1 : 0; });
    else if (type == AttributeType::kReal)
      column.values =
          values_of<double>(rows, column, [](const Json& value) { return value.get<double>(); });
    else
      column.values = values_of<std::string>(rows, column, [](const Json& value) {
        return value.is_string() ? value.get<std::string>() : value.dump();
      });
  }
  return columns;
}

}  // namespace tetropolis
