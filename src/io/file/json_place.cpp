#include "json_place.h"

#include <cmath>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

void Place::fail(std::string_view what) const {
  throw Error(ErrorKind::kInput, fmt::format("{}: {} {}", file_->string(),
                                             where_.empty() ? "the document" : where_, what));
}

std::string Place::without_file(std::string_view message) const {
  const std::string begin = file_->string() + ": ";
  return std::string(message.starts_with(begin) ? message.substr(begin.size()) : message);
}

Place Place::at(const std::string& key) const {
  if (!value_->is_object()) fail("is not an object");
  const auto found = value_->find(key);
  if (found == value_->end()) fail(fmt::format("has no member '{}'", key));
  return Place(*file_, *found, where_ + "/" + key);
}

Place Place::at(std::size_t i) const {
  if (i >= size()) fail(fmt::format("has no item {}", i));
  return Place(*file_, (*value_)[i], where_ + "/" + std::to_string(i));
}

std::size_t Place::size() const {
  if (!value_->is_array()) fail("is not an array");
  return value_->size();
}

double Place::number() const {
  if (!value_->is_number()) fail("is not a number");
  const double result = value_->get<double>();
  if (!std::isfinite(result)) fail("is not a finite number");
  return result;
}

const std::string& Place::text() const {
  if (!value_->is_string()) fail("is not a string");
  return value_->get_ref<const std::string&>();
}

}  // namespace tetropolis
