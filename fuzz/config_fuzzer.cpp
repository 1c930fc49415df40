// Bytes as the TOML file of settings.
#include <algorithm>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <toml++/toml.h>

#include "tetropolis/run/config.h"

#include "fuzz_input.h"

namespace {

using namespace tetropolis;
using namespace tetropolis::fuzz;

/// Whether a parser of its own finds nothing but known keys in the text.
bool only_known_keys(const std::filesystem::path& path) {
  const toml::table table = toml::parse_file(path.string());
  return std::all_of(table.begin(), table.end(),
                     [](const auto& entry) { return find_field(entry.first.str()) != nullptr; });
}

/// Ranges and choices of one field.
void claim_valid(const ConfigField& field, const Config& config) {
  const auto in_range = [&](double value) {
    claim(value >= field.min && value <= field.max, std::string(field.name) + " is in range");
  };
  const auto allowed = [&](const std::string& text) {
    claim(field.choices.empty() || text.empty() ||
              std::find(field.choices.begin(), field.choices.end(), text) != field.choices.end(),
          std::string(field.name) + " is one of its choices");
  };
  std::visit(
      [&](const auto member) {
        if constexpr (std::is_same_v<std::decay_t<decltype(member)>, ChoiceMember>) {
          claim(member.get(config) < field.choices.size(),
                std::string(field.name) + " is a choice");
        } else {
          const auto& value = config.*member;
          using Value = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
            in_range(static_cast<double>(value));
          } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
            for (const std::string& text : value) allowed(text);
          }
        }
      },
      field.member);
}

/// Every field as TOML that says the same.
std::string settings_of(const Config& config) {
  std::string text;
  for (const ConfigField& field : config_fields())
    text += std::string(field.name) + " = " + value_text(field, config) + "\n";
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path path = write_scratch("settings.toml", data, size);
  Config config;
  try {
    load_config(config, path);
  } catch (const Error& error) {
    claim_error(error, ErrorKind::kUsage, path.string());
    return 0;
  }
  claim(only_known_keys(path), "an unknown key is an error");
  for (const ConfigField& field : config_fields()) claim_valid(field, config);
  const std::string text = settings_of(config);
  const std::filesystem::path copy =
      write_scratch("copy.toml", reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  Config again;
  load_config(again, copy);
  claim(settings_of(again) == text, "settings come back as they were");
  return 0;
}
