// A JSON document whose values know where they are.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace tetropolis {

using Json = nlohmann::json;

/// A value in the document with the way to it, for messages. Refers to both; what it is asked for
/// and has not is an Error(kInput) that names file and way.
class Place {
 public:
  Place(const std::filesystem::path& file, const Json& value) : file_(&file), value_(&value) {}

  const Json& value() const { return *value_; }

  [[noreturn]] void fail(std::string_view what) const;

  /// What `fail` says, without the name of the file.
  std::string without_file(std::string_view message) const;

  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }

  Place at(const std::string& key) const;
  Place at(std::size_t i) const;

  /// Of an array.
  std::size_t size() const;

  /// A finite number.
  double number() const;

  const std::string& text() const;

 private:
  Place(const std::filesystem::path& file, const Json& value, std::string where)
      : file_(&file), value_(&value), where_(std::move(where)) {}

  const std::filesystem::path* file_;
  const Json* value_;
  std::string where_;
};

}  // namespace tetropolis
