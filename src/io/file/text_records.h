// Whether text files of features have the records that they seem to have. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

namespace tetropolis {

/// Throws Error(kInput) naming the line, if a CSV file has a quote that is not closed before its
/// end, or one within a field that swallows further lines: GDAL makes one feature of all these
/// lines. Quoted fields of several lines are fine. `name`: of the file for GDAL.
/// Source: RFC 4180; GDAL joins lines until the number of their quotes is even.
void require_closed_quotes(const std::filesystem::path& path, const std::string& name);

/// Throws Error(kInput) naming the line, if another JSON object follows after the first of a file
/// or, with `by_line`, of a line (of a record where the file begins with a record separator): GDAL
/// passes over it. Sources: RFC 8259; RFC 8142.
void require_single_objects(const std::filesystem::path& path, const std::string& name,
                            bool by_line);

}  // namespace tetropolis
