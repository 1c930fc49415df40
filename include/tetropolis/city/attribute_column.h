// Attributes of the input's features, which are passed on.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace tetropolis {

enum class AttributeType : std::uint8_t {
  kInteger,
  kBoolean,  ///< Integers 0 and 1.
  kReal,
  kText,
  kDate,      ///< Text: "2019-03-05".
  kDateTime,  ///< Text: "2019-03-05T12:30:00.000", then "Z", an offset like "+01:00", or nothing.
};

/// One attribute of all features: a value per feature in their order, of the kind that `type` says.
struct AttributeColumn {
  std::string name;  ///< As in the file, UTF-8; may be empty or the same as another.
  AttributeType type = AttributeType::kText;
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values =
      {};
  std::vector<bool> known = {};  ///< False where the feature has none.
};

}  // namespace tetropolis
