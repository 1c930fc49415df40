#include "osm_elements.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <zlib.h>
#ifdef TETROPOLIS_HAS_BZIP2
#include <bzlib.h>
#endif

#include "core/text.h"
#include "io/file/input_file.h"
#include "osm_input.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr const char* kGetAgain = "the file is cut or broken, get it again";

bool ends_with(const fs::path& path, std::string_view ending) {
  return lower_case(path.filename().string()).ends_with(ending);
}

/// The beginning of a file that is not packed.
std::string first_block(const fs::path& path) {
  constexpr std::size_t kSize = 4096;
  std::string block(kSize, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(block.data(), static_cast<std::streamsize>(kSize));
  block.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return block;
}

bool is_overpass_json(const fs::path& path) {
  if (!ends_with(path, "json")) return false;
  const std::string block = first_block(path);
  return block.find("\"elements\"") != std::string::npos ||
         (block.find("\"osm3s\"") != std::string::npos &&
          block.find("\"FeatureCollection\"") == std::string::npos);
}

}  // namespace

std::string_view OsmElement::tag(std::string_view key) const {
  for (const auto& [name, value] : tags)
    if (name == key) return value;
  return {};
}

struct OsmBytes::State {
  fs::path path;
  gzFile packed = nullptr;  ///< zlib reads what is not packed as it is.
#ifdef TETROPOLIS_HAS_BZIP2
  std::FILE* file = nullptr;
  BZFILE* blocks = nullptr;
#endif
};

OsmBytes::OsmBytes(const fs::path& path) : state_(std::make_unique<State>()) {
  require_ordinary_file(path);
  state_->path = path;
  if (ends_with(path, ".bz2")) {
#ifdef TETROPOLIS_HAS_BZIP2
    int error = BZ_OK;
    state_->file = std::fopen(path.c_str(), "rb");
    if (state_->file != nullptr)
      state_->blocks = BZ2_bzReadOpen(&error, state_->file, 0, 0, nullptr, 0);
    if (state_->blocks == nullptr) fail_input(path, "cannot be opened; check the path");
    return;
#else
    fail_input(path, "is packed by bzip2, which this build does not read; unpack it with bunzip2");
#endif
  }
  state_->packed = gzopen(path.c_str(), "rb");
  if (state_->packed == nullptr) fail_input(path, "cannot be opened; check the path");
  gzbuffer(state_->packed, 1U << 17);
}

OsmBytes::~OsmBytes() {
  if (state_->packed != nullptr) gzclose(state_->packed);
#ifdef TETROPOLIS_HAS_BZIP2
  int error = BZ_OK;
  if (state_->blocks != nullptr) BZ2_bzReadClose(&error, state_->blocks);
  if (state_->file != nullptr) std::fclose(state_->file);
#endif
}

std::size_t OsmBytes::read(char* data, std::size_t size) {
  std::size_t done = 0;
#ifdef TETROPOLIS_HAS_BZIP2
  while (state_->file != nullptr && done < size) {
    if (state_->blocks == nullptr) return done;
    int error = BZ_OK;
    const int count =
        BZ2_bzRead(&error, state_->blocks, data + done, static_cast<int>(size - done));
    if (error != BZ_OK && error != BZ_STREAM_END) fail_input(state_->path, kGetAgain);
    done += static_cast<std::size_t>(count);
    if (error != BZ_STREAM_END) continue;
    // Parallel packers write one stream after the other.
    void* rest = nullptr;
    int unused = 0;
    BZ2_bzReadGetUnused(&error, state_->blocks, &rest, &unused);
    std::string left(static_cast<const char*>(rest), static_cast<std::size_t>(unused));
    BZ2_bzReadClose(&error, state_->blocks);
    state_->blocks = nullptr;
    const int next = left.empty() ? std::fgetc(state_->file) : 0;
    if (left.empty() && next == EOF) return done;
    if (left.empty()) std::ungetc(next, state_->file);
    state_->blocks = BZ2_bzReadOpen(&error, state_->file, 0, 0, left.data(), unused);
    if (state_->blocks == nullptr) fail_input(state_->path, kGetAgain);
  }
  if (state_->file != nullptr) return done;
#endif
  while (done < size) {
    const int count = gzread(state_->packed, data + done, static_cast<unsigned>(size - done));
    if (count < 0) fail_input(state_->path, kGetAgain);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  // The end of a packed file that is cut is an error that zlib keeps for itself.
  int error = Z_OK;
  gzerror(state_->packed, &error);
  if (error != Z_OK && error != Z_STREAM_END) fail_input(state_->path, kGetAgain);
  return done;
}

bool is_osm_file(const fs::path& path) {
  for (const std::string_view ending : {".osm", ".osm.gz", ".osm.bz2", ".pbf"})
    if (ends_with(path, ending)) return true;
  if (is_overpass_json(path)) return true;
  // The server's own name for them is "map".
  const std::string block = first_block(path);
  const bool is_xml = block.starts_with("<?xml") || block.starts_with("<osm");
  const auto has = [&](const char* text) { return block.find(text) != std::string::npos; };
  return is_xml && (has("<osm ") || has("<osm>"));
}

void read_osm(const fs::path& path, OsmKind kind, const OsmVisit& visit) {
  if (ends_with(path, ".pbf"))
    read_osm_pbf(path, kind, visit);
  else if (ends_with(path, "json"))
    read_osm_json(path, kind, visit);
  else
    read_osm_xml(path, kind, visit);
}

}  // namespace tetropolis
