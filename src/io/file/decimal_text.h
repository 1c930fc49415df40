// Numbers as decimal text, for files with millions of them.
#pragma once

#include <string>

namespace tetropolis {

/// Appends the very text of "%.6f".
void append_fixed(std::string& text, double value);

/// Appends the very text of "%.6g".
void append_general(std::string& text, double value);

}  // namespace tetropolis
