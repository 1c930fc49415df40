#include "tetropolis/io/mesh/gltf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "GLB output writes native byte order");

using Json = nlohmann::ordered_json;

constexpr std::size_t kGrain = 32768;
constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kDataChunk = 0x004E4942;  // "BIN"
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

/// Linear base colour.
std::array<double, 3> colour_of(PatchKind kind) {
  switch (kind) {
    case PatchKind::kGround:
      return {0.33, 0.36, 0.27};
    case PatchKind::kRoof:
      return {0.50, 0.14, 0.08};
    case PatchKind::kWall:
      return {0.65, 0.58, 0.46};
    case PatchKind::kTop:
      return {0.40, 0.60, 0.80};
    case PatchKind::kSide:
    case PatchKind::kOther:
      break;
  }
  return {0.45, 0.50, 0.55};
}

std::array<float, 3> to_gltf(const std::array<double, 3>& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[2]), static_cast<float>(-p[1])};
}

/// Adds a stretch of the buffer and what it holds; returns the accessor.
Json& add_accessor(Json& gltf, std::size_t& offset, std::size_t count, std::size_t item_bytes,
                   int target) {
  const std::size_t view = gltf["bufferViews"].size();
  gltf["bufferViews"].push_back({{"buffer", 0},
                                 {"byteOffset", offset},
                                 {"byteLength", count * item_bytes},
                                 {"target", target}});
  offset += count * item_bytes;
  const bool points = target == kArrayBuffer;
  gltf["accessors"].push_back({{"bufferView", view},
                               {"componentType", points ? kFloat : kUnsignedInt},
                               {"count", points ? count : 3 * count},
                               {"type", points ? "VEC3" : "SCALAR"}});
  return gltf["accessors"].back();
}

void add_patch(Json& gltf, std::size_t& offset, const SurfaceMesh& part) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  std::array<float, 3> low{inf, inf, inf}, high{-inf, -inf, -inf};
  for (const auto& point : part.points) {
    const auto p = to_gltf(point);
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  const std::string& name = part.patch_of(0).name;
  const std::array<double, 3> colour = colour_of(part.patch_of(0).kind);
  const std::size_t number = gltf["meshes"].size();
  const std::size_t accessor = gltf["accessors"].size();
  Json& points = add_accessor(gltf, offset, part.points.size(), 12, kArrayBuffer);
  points["min"] = low;
  points["max"] = high;
  add_accessor(gltf, offset, part.triangles.size(), 12, kElementArrayBuffer);
  gltf["scenes"][0]["nodes"].push_back(number);
  gltf["nodes"].push_back({{"name", name}, {"mesh", number}});
  gltf["meshes"].push_back({{"name", name},
                            {"primitives",
                             {{{"attributes", {{"POSITION", accessor}}},
                               {"indices", accessor + 1},
                               {"material", number}}}}});
  gltf["materials"].push_back({{"name", name},
                               {"pbrMetallicRoughness",
                                {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                                 {"metallicFactor", 0.0},
                                 {"roughnessFactor", 1.0}}}});
}

std::vector<SurfaceMesh> split_by_patch(const SurfaceMesh& surface) {
  std::vector<SurfaceMesh> parts;
  for (const PatchInfo& info : surface.patches) {
    SurfaceMesh part = select_patches(surface, {&info.patch, 1});
    if (!part.triangles.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

Json describe(const std::vector<SurfaceMesh>& parts, const Placement& placement,
              std::size_t& data_bytes) {
  Json gltf;
  const auto& [shift, origin] = placement;
  gltf["asset"] = {
      {"version", "2.0"},
      {"generator", "Tetropolis"},
      {"extras", {{"origin", {shift[0] + origin[0], shift[1] + origin[1], shift[2] + origin[2]}}}}};
  gltf["scene"] = 0;
  gltf["scenes"] = Json::array({Json::object()});
  for (const SurfaceMesh& part : parts) add_patch(gltf, data_bytes, part);
  if (!parts.empty()) gltf["buffers"] = Json::array({{{"byteLength", data_bytes}}});
  return gltf;
}

void write_part(AtomicFile& file, const SurfaceMesh& part) {
  write_chunked(file, part.points.size(), kGrain,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t i = begin; i < end; ++i)
                    for (const float x : to_gltf(part.points[i])) append_raw(buffer, x);
                });
  write_chunked(file, part.triangles.size(), kGrain,
                [&](std::size_t begin, std::size_t end, std::string& buffer) {
                  for (std::size_t f = begin; f < end; ++f)
                    for (const std::int32_t v : part.triangles[f])
                      append_raw(buffer, static_cast<std::uint32_t>(v));
                });
}

}  // namespace

void write_glb(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement) {
  const std::vector<SurfaceMesh> parts = split_by_patch(surface);
  std::size_t data_bytes = 0;
  std::string json = describe(parts, placement, data_bytes).dump();
  json.append((4 - json.size() % 4) % 4, ' ');
  // All numbers are of four bytes, so the data need no padding.
  const std::size_t total = 12 + 8 + json.size() + (parts.empty() ? 0 : 8 + data_bytes);
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw_cannot_write(path, "a GLB file cannot be larger than 4 GiB");

  AtomicFile file(path);
  std::string head;
  for (const std::size_t number :
       {std::size_t{kMagic}, std::size_t{2}, total, json.size(), std::size_t{kJsonChunk}})
    append_raw(head, static_cast<std::uint32_t>(number));
  head += json;
  if (!parts.empty()) {
    append_raw(head, static_cast<std::uint32_t>(data_bytes));
    append_raw(head, kDataChunk);
  }
  file.write(head);
  for (const SurfaceMesh& part : parts) write_part(file, part);
  file.commit();
}

}  // namespace tetropolis
