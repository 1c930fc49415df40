// Answers of servers that hold more than they sent. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

namespace tetropolis {

/// Servers send what was asked for in pages and say so inside: ArcGIS by "exceededTransferLimit"
/// (GeoJSON and ESRI JSON), WFS 2.0 and OGC API Features by numberMatched above numberReturned or a
/// link to the next page. A clause that says that features are missing and what to do, or "".
/// Looks at the beginning and the end of the file only; of archives and folders nothing is known.
std::string why_incomplete(const std::filesystem::path& path);

}  // namespace tetropolis
