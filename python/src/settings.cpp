#include "settings.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <nanobind/stl/string.h>

#include "tetropolis/core/error.h"

namespace tetropolis::python {

namespace {

/// Which settings a function takes: those of a command in these groups, and these others.
struct Function {
  std::string_view name;
  Command command;
  std::vector<std::string_view> groups;
  std::vector<std::string_view> others = {};
};

const std::vector<Function>& functions() {
  static const std::vector<Function> all{
      {"build_city", kCity, {"Input", "City model", "Run"}},
      {"read_city", kMesh, {}, {"bounds", "terrain_only", "ground_level", "min_building_distance"}},
      {"build_mesh", kMesh, {"Mesh", "Run"}},
      {"save", kMesh, {}, {"building_patches", "building_zones", "coordinates", "compression"}},
      {"synth", kSynth, {"Synthetic city", "Run"}},
  };
  return all;
}

/// What is an argument of its own, or is about a terminal.
constexpr std::array<std::string_view, 5> kNoKeywords{"footprints", "points", "quiet", "verbose",
                                                      "log"};

template <typename List>
bool contains(const List& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<const ConfigField*> fields_of(const std::string& name) {
  const auto function =
      std::find_if(functions().begin(), functions().end(),
                   [&](const Function& candidate) { return candidate.name == name; });
  std::vector<const ConfigField*> fields;
  for (const ConfigField& field : config_fields())
    if ((field.commands & function->command) != 0 && !contains(kNoKeywords, field.name) &&
        (contains(function->groups, field.group) || contains(function->others, field.name)))
      fields.push_back(&field);
  return fields;
}

const char* type_name(const ConfigField& field) {
  return std::visit(
      [](auto member) {
        using Member = decltype(member);
        if constexpr (std::is_same_v<Member, bool Config::*>) return "bool";
        if constexpr (std::is_same_v<Member, int Config::*>) return "int";
        if constexpr (std::is_same_v<Member, double Config::*>) return "float";
        if constexpr (std::is_same_v<Member, std::vector<double> Config::*>)
          return "Sequence[float]";
        if constexpr (std::is_same_v<Member, std::vector<std::string> Config::*>)
          return "Sequence[str]";
        return "str";
      },
      field.member);
}

/// None where it means "not given".
nb::object default_of(const ConfigField& field) {
  static const Config defaults;
  return std::visit(
      [&](auto member) -> nb::object {
        if constexpr (std::is_same_v<decltype(member), ChoiceMember>) {
          const std::string_view word = field.choices[member.get(defaults)];
          return nb::str(word.data(), word.size());
        } else {
          const auto& value = defaults.*member;
          using Value = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, bool>)
            return nb::bool_(value);
          else if constexpr (std::is_same_v<Value, int>)
            return nb::int_(value);
          else if constexpr (std::is_same_v<Value, double>)
            return nb::float_(value);
          else
            return nb::none();  // texts and lists are empty
        }
      },
      field.member);
}

nb::str text(std::string_view view) { return nb::str(view.data(), view.size()); }

/// A value as the text that set_field takes. Numbers of NumPy and paths are what they stand for.
std::string text_of(nb::handle value) {
  nb::object plain = nb::borrow(value);
  if (nb::hasattr(value, "ndim") && nb::cast<int>(value.attr("ndim")) == 0)
    plain = value.attr("item")();
  else if (nb::hasattr(value, "__fspath__"))
    plain = value.attr("__fspath__")();
  if (nb::isinstance<nb::bool_>(plain)) return nb::cast<bool>(plain) ? "true" : "false";
  return nb::str(plain).c_str();
}

bool is_list(nb::handle value) {
  if (nb::isinstance<nb::str>(value) || nb::isinstance<nb::bytes>(value)) return false;
  return nb::hasattr(value, "__iter__") && nb::hasattr(value, "__len__");
}

std::vector<std::string> texts_of(nb::handle value) {
  std::vector<std::string> texts;
  if (is_list(value))
    for (nb::handle element : nb::iter(value)) texts.push_back(text_of(element));
  else
    texts.push_back(text_of(value));
  return texts;
}

[[noreturn]] void throw_unknown(const std::string& function, const std::string& keyword,
                                const std::vector<const ConfigField*>& fields) {
  for (const char* other : {"build_city", "build_mesh"})
    for (const ConfigField* field : fields_of(other))
      if (field->name == keyword)
        throw Error(ErrorKind::kUsage,
                    function + "() has no keyword '" + keyword + "'; it is one of " + other + "()");
  std::vector<std::string> known;
  for (const ConfigField* field : fields) known.emplace_back(field->name);
  const std::string nearest = nearest_name(keyword, known);
  throw Error(ErrorKind::kUsage, function + "() has no keyword '" + keyword + "'" +
                                     (nearest.empty() ? "; see help(tetropolis." + function + ")"
                                                      : "; did you mean '" + nearest + "'?"));
}

}  // namespace

nb::list settings_of(const std::string& function) {
  nb::list list;
  for (const ConfigField* field : fields_of(function)) {
    nb::list choices;
    for (const std::string_view choice : field->choices) choices.append(text(choice));
    list.append(nb::make_tuple(text(field->name), text(field->group), type_name(*field),
                               default_of(*field), text(field->help), text(field->unit),
                               nb::tuple(choices)));
  }
  return list;
}

Config config_of(const std::string& function, const nb::dict& keywords) {
  const std::vector<const ConfigField*> fields = fields_of(function);
  Config config;
  for (const auto& [key, value] : keywords) {
    const std::string name = nb::cast<std::string>(key);
    const auto field = std::find_if(fields.begin(), fields.end(),
                                    [&](const ConfigField* f) { return f->name == name; });
    if (field == fields.end()) throw_unknown(function, name, fields);
    if (!value.is_none()) set_field(config, **field, texts_of(value), name);
  }
  return config;
}

std::string with_keywords(const std::string& message) {
  return respell_settings(message, ",;", [](const ConfigField& field, std::string_view& rest) {
    const std::string name(field.name);
    // "`layering` = uniform" has the sign already; "`mesh_size` 5" is a value, too.
    if (rest.starts_with(" = "))
      rest.remove_prefix(3);
    else if (rest.size() > 1 && rest[0] == ' ' && rest[1] >= '0' && rest[1] <= '9')
      rest.remove_prefix(1);
    return name + (std::holds_alternative<bool Config::*>(field.member) ? "=True" : "=");
  });
}

}  // namespace tetropolis::python
