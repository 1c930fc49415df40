// Attributes of city objects as columns. Private to src/io.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tetropolis/city/attribute_column.h"

#include "io/file/json_place.h"

namespace tetropolis {

/// Those of an object, and of the one that it is a part of, where it has no other value; that one's
/// id is "parent". An object by their names. `objects`: all of the file.
Json attributes_of(const Json& objects, const std::string& key);

/// A column for each name, by name, with a row per object: of numbers, booleans or text, or of text
/// where values are of several kinds. Lists and objects are left out.
std::vector<AttributeColumn> attribute_columns(std::span<const Json> rows);

}  // namespace tetropolis
