// What an earlier synthetic city left in a folder.
#pragma once

#include <filesystem>
#include <vector>

namespace tetropolis {

/// The files of an earlier synthetic city of any kind in `folder`, as far as its report.json and
/// manifest.json vouch for them, other than those `staged` holds anew. Two cities must not mix, so
/// they are to be removed once the new one is in its place. Files of the user are not among them.
std::vector<std::filesystem::path> left_by_earlier_city(const std::filesystem::path& folder,
                                                        const std::filesystem::path& staged);

}  // namespace tetropolis
