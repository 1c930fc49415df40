// viewer/dist/viewer.html, part of the program. Private to src/io/page.
#pragma once

#include <string_view>

namespace tetropolis {

/// The page without a run: "@@TETROPOLIS@@" stands where its data go.
std::string_view page_template();

}  // namespace tetropolis
