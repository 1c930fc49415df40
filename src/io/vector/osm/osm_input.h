// The readers behind read_osm, one per format. Private to this folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "osm_elements.h"

namespace tetropolis {

using OsmVisit = std::function<void(const OsmElement&)>;

/// Whether an element of this name is of a kind, and that.
inline bool is_kind(std::string_view name, OsmKind& kind) {
  if (name == "node")
    kind = OsmKind::kNode;
  else if (name == "way")
    kind = OsmKind::kWay;
  else if (name == "relation")
    kind = OsmKind::kRelation;
  else
    return false;
  return true;
}

/// The bytes of a file, unpacked where its name ends in .gz or .bz2.
class OsmBytes {
 public:
  explicit OsmBytes(const std::filesystem::path& path);
  ~OsmBytes();
  OsmBytes(const OsmBytes&) = delete;
  OsmBytes& operator=(const OsmBytes&) = delete;

  /// Up to `size` bytes; fewer only at the end. Throws Error(kInput).
  std::size_t read(char* data, std::size_t size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

void read_osm_xml(const std::filesystem::path& path, OsmKind kind, const OsmVisit& visit);
void read_osm_pbf(const std::filesystem::path& path, OsmKind kind, const OsmVisit& visit);
void read_osm_json(const std::filesystem::path& path, OsmKind kind, const OsmVisit& visit);

}  // namespace tetropolis
