#include "tetropolis/io/mesh/gltf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tetropolis/ground/surfaces.h"

#include "io/file/atomic_file.h"
#include "io/file/chunked_output.h"

namespace tetropolis {

namespace {

static_assert(std::endian::native == std::endian::little, "GLB output writes native byte order");

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kDataChunk = 0x004E4942;  // "BIN"
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;

/// Linear base colour.
std::array<double, 3> colour_of(const PatchInfo& patch) {
  if (patch.name == name_of(SurfaceKind::kWater)) return {0.21, 0.37, 0.52};
  if (patch.name == name_of(SurfaceKind::kRoad)) return {0.37, 0.35, 0.33};
  if (patch.name == name_of(SurfaceKind::kVegetation)) return {0.29, 0.41, 0.20};
  switch (patch.kind) {
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

/// A patch with vertices of its own.
struct Part {
  SurfaceMesh surface;
  std::vector<BuildingIndex> feature;  ///< Per point: its building; empty where none are told.
};

/// The numbers of an accessor.
struct Values {
  std::string_view type;
  int component;
  std::size_t count;
  std::size_t bytes;
  int target;
};

/// What is known of the file while it is described: its JSON and the bytes behind that.
struct Asset {
  Json json;
  std::size_t data_bytes = 0;
};

/// Adds a stretch of the buffer; returns its number.
std::size_t add_view(Asset& file, std::size_t bytes) {
  Json& views = file.json["bufferViews"];
  views.push_back({{"buffer", 0}, {"byteOffset", file.data_bytes}, {"byteLength", bytes}});
  file.data_bytes += bytes;
  return views.size() - 1;
}

/// Adds a stretch of the buffer and what it holds; returns the number of the accessor.
std::size_t add_accessor(Asset& file, const Values& values) {
  const std::size_t view = add_view(file, values.bytes);
  file.json["bufferViews"][view]["target"] = values.target;
  Json& accessors = file.json["accessors"];
  accessors.push_back({{"bufferView", view},
                       {"componentType", values.component},
                       {"count", values.count},
                       {"type", values.type}});
  return accessors.size() - 1;
}

/// Each vertex of the patch belongs to one building.
void split_at_buildings(Part& part) {
  SurfaceMesh& surface = part.surface;
  part.feature.assign(surface.points.size(), kNoBuilding);
  std::map<std::pair<std::int32_t, BuildingIndex>, std::int32_t> copies;
  for (std::size_t f = 0; f < surface.triangles.size(); ++f)
    for (std::int32_t& v : surface.triangles[f]) {
      const BuildingIndex building = surface.building[f];
      BuildingIndex& owner = part.feature[static_cast<std::size_t>(v)];
      if (owner == kNoBuilding) owner = building;
      if (owner == building) continue;
      const auto next = static_cast<std::int32_t>(surface.points.size());
      const auto [copy, is_new] = copies.try_emplace({v, building}, next);
      if (is_new) {
        const auto point = surface.points[static_cast<std::size_t>(v)];
        surface.points.push_back(point);
        part.feature.push_back(building);
      }
      v = copy->second;
    }
}

std::vector<Part> split_by_patch(const SurfaceMesh& surface, bool with_features) {
  std::vector<Part> parts;
  for (const PatchInfo& info : surface.patches) {
    Part part{select_patches(surface, {&info.patch, 1}), {}};
    if (part.surface.triangles.empty()) continue;
    if (with_features && info.of_building()) split_at_buildings(part);
    parts.push_back(std::move(part));
  }
  return parts;
}

void add_part(Asset& file, const Part& part) {
  const SurfaceMesh& surface = part.surface;
  constexpr float inf = std::numeric_limits<float>::infinity();
  std::array<float, 3> low{inf, inf, inf}, high{-inf, -inf, -inf};
  for (const auto& point : surface.points) {
    const auto p = to_gltf(point);
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  const PatchInfo& patch = surface.patch_of(0);
  const std::array<double, 3> colour = colour_of(patch);
  const std::size_t points = surface.points.size(), faces = surface.triangles.size();
  const std::size_t positions =
      add_accessor(file, {"VEC3", kFloat, points, 12 * points, kArrayBuffer});
  file.json["accessors"][positions]["min"] = low;
  file.json["accessors"][positions]["max"] = high;
  Json primitive{{"attributes", {{"POSITION", positions}}}};
  if (!part.feature.empty()) {
    primitive["attributes"]["_FEATURE_ID_0"] =
        add_accessor(file, {"SCALAR", kFloat, points, 4 * points, kArrayBuffer});
    const std::set<BuildingIndex> features(part.feature.begin(), part.feature.end());
    primitive["extensions"]["EXT_mesh_features"]["featureIds"] =
        Json::array({{{"featureCount", features.size()}, {"attribute", 0}, {"propertyTable", 0}}});
  }
  primitive["indices"] =
      add_accessor(file, {"SCALAR", kUnsignedInt, 3 * faces, 12 * faces, kElementArrayBuffer});
  const std::size_t number = file.json["meshes"].size();
  primitive["material"] = number;
  file.json["scenes"][0]["nodes"].push_back(number);
  file.json["nodes"].push_back({{"name", patch.name},
                                {"mesh", number},
                                {"extras", {{"patch", static_cast<std::int32_t>(patch.patch)}}}});
  file.json["meshes"].push_back({{"name", patch.name}, {"primitives", Json::array({primitive})}});
  file.json["materials"].push_back({{"name", patch.name},
                                    {"pbrMetallicRoughness",
                                     {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                                      {"metallicFactor", 0.0},
                                      {"roughnessFactor", 1.0}}}});
}

/// A column of texts: their bytes, and where each begins and the last ends.
struct StringTable {
  std::string bytes;
  std::string offsets = std::string(sizeof(std::uint32_t), '\0');
  void add(const std::string& text) {
    bytes += text;
    append_raw(offsets, static_cast<std::uint32_t>(bytes.size()));
  }
};

/// Describes the table of buildings, whose rows are the features; returns its bytes. Its columns
/// begin at multiples of eight bytes, as EXT_structural_metadata asks for.
std::string add_table(Asset& file, std::span<const Building> buildings) {
  std::string table;
  const auto pad = [&] {
    while (file.data_bytes % 8 != 0) {
      table += '\0';
      ++file.data_bytes;
    }
  };
  const auto add = [&](const std::string& bytes) {
    pad();
    table += bytes.empty() ? std::string(1, '\0') : bytes;  // no view is empty
    return add_view(file, std::max<std::size_t>(bytes.size(), 1));
  };
  StringTable ids, sources;
  std::string source_counts(sizeof(std::uint32_t), '\0'), grounds, roofs;
  std::uint32_t source_count = 0;
  for (const Building& building : buildings) {
    ids.add(building.id);
    for (const std::string& source : building.source_ids) sources.add(source);
    source_count += static_cast<std::uint32_t>(building.source_ids.size());
    append_raw(source_counts, source_count);
    append_raw(grounds, building.h_ground);
    append_raw(roofs, building.h_roof);
  }
  const Json height{{"type", "SCALAR"}, {"componentType", "FLOAT64"}, {"required", true}};
  const Json text{{"type", "STRING"}, {"required", true}};
  Json texts = text;
  texts["array"] = true;
  Json& metadata = file.json["extensions"]["EXT_structural_metadata"];
  metadata["schema"] = {
      {"id", "tetropolis"},
      {"classes",
       {{"building",
         {{"properties",
           {{"id", text}, {"source_ids", texts}, {"h_ground", height}, {"h_roof", height}}}}}}}};
  Json columns;
  columns["id"] = {{"values", add(ids.bytes)}, {"stringOffsets", add(ids.offsets)}};
  columns["source_ids"] = {{"values", add(sources.bytes)},
                           {"arrayOffsets", add(source_counts)},
                           {"stringOffsets", add(sources.offsets)}};
  columns["h_ground"] = {{"values", add(grounds)}};
  columns["h_roof"] = {{"values", add(roofs)}};
  pad();
  metadata["propertyTables"] = Json::array({{{"name", "buildings"},
                                             {"class", "building"},
                                             {"count", buildings.size()},
                                             {"properties", columns}}});
  file.json["extensionsUsed"] = {"EXT_mesh_features", "EXT_structural_metadata"};
  return table;
}

void write_part(AtomicFile& file, const Part& part) {
  const auto write = [&](const auto& items, const auto& append) {
    write_chunked(file, items.size(), kRowsPerChunk,
                  [&](std::size_t begin, std::size_t end, std::string& buffer) {
                    for (std::size_t i = begin; i < end; ++i) append(items[i], buffer);
                  });
  };
  write(part.surface.points, [](const auto& point, std::string& buffer) {
    for (const float x : to_gltf(point)) append_raw(buffer, x);
  });
  write(part.feature, [](BuildingIndex building, std::string& buffer) {
    append_raw(buffer, static_cast<float>(building.value()));
  });
  write(part.surface.triangles, [](const auto& triangle, std::string& buffer) {
    for (const std::int32_t v : triangle) append_raw(buffer, static_cast<std::uint32_t>(v));
  });
}

}  // namespace

void write_glb(const std::filesystem::path& path, const SurfaceMesh& surface,
               const Placement& placement, std::span<const Building> buildings) {
  const std::vector<Part> parts = split_by_patch(surface, !buildings.empty());
  Asset description;
  const auto& [shift, origin] = placement;
  description.json["asset"] = {
      {"version", "2.0"},
      {"generator", "Tetropolis"},
      {"extras", {{"origin", {shift[0] + origin[0], shift[1] + origin[1], shift[2] + origin[2]}}}}};
  description.json["scene"] = 0;
  description.json["scenes"] = Json::array({Json::object()});
  for (const Part& part : parts) add_part(description, part);
  const bool any = std::any_of(parts.begin(), parts.end(),
                               [](const Part& part) { return !part.feature.empty(); });
  const std::string table = any ? add_table(description, buildings) : std::string();
  const std::size_t data_bytes = description.data_bytes;
  if (data_bytes > 0) description.json["buffers"] = Json::array({{{"byteLength", data_bytes}}});
  std::string json = description.json.dump();
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::size_t total = 12 + 8 + json.size() + (data_bytes == 0 ? 0 : 8 + data_bytes);
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw_cannot_write(path, "a GLB file cannot be larger than 4 GiB");

  AtomicFile file(path);
  std::string head;
  for (const std::size_t number :
       {std::size_t{kMagic}, std::size_t{2}, total, json.size(), std::size_t{kJsonChunk}})
    append_raw(head, static_cast<std::uint32_t>(number));
  head += json;
  if (data_bytes > 0) {
    append_raw(head, static_cast<std::uint32_t>(data_bytes));
    append_raw(head, kDataChunk);
  }
  file.write(head);
  for (const Part& part : parts) write_part(file, part);
  file.write(table);
  file.commit();
}

}  // namespace tetropolis
