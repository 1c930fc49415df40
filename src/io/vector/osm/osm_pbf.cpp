#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "io/file/input_file.h"
#include "osm_input.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// What is wrong with a message; caught where path and place are known.
struct Broken {};

/// A message of protocol buffers, field by field.
class Message {
 public:
  explicit Message(std::string_view bytes) : rest_(bytes) {}

  /// The next field; false at the end.
  bool next() {
    if (rest_.empty()) return false;
    const std::uint64_t key = varint();
    field_ = static_cast<int>(key >> 3U);
    switch (key & 7U) {
      case 0:
        value_ = varint();
        bytes_ = {};
        break;
      case 1:
        bytes_ = take(8);
        break;
      case 2:
        bytes_ = take(varint());
        break;
      case 5:
        bytes_ = take(4);
        break;
      default:
        throw Broken{};
    }
    return true;
  }
  int field() const { return field_; }
  std::uint64_t value() const { return value_; }
  std::string_view bytes() const { return bytes_; }

  bool empty() const { return rest_.empty(); }
  /// Of packed numbers.
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (rest_.empty()) throw Broken{};
      const auto byte = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 127U) << shift;
      if (byte < 128) return value;
    }
    throw Broken{};
  }
  std::int64_t zigzag() { return unzigzag(varint()); }
  static std::int64_t unzigzag(std::uint64_t value) {
    return static_cast<std::int64_t>(value >> 1U) ^ -static_cast<std::int64_t>(value & 1U);
  }

 private:
  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) throw Broken{};
    const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(static_cast<std::size_t>(size));
    return taken;
  }

  std::string_view rest_;
  int field_ = 0;
  std::uint64_t value_ = 0;
  std::string_view bytes_;
};

/// The content of a blob, unpacked.
std::string content_of(std::string_view blob, const fs::path& path) {
  std::string_view raw, packed;
  std::uint64_t size = 0;
  for (Message message(blob); message.next();) {
    if (message.field() == 1) raw = message.bytes();
    if (message.field() == 2) size = message.value();
    if (message.field() == 3) packed = message.bytes();
    if (message.field() > 3)
      fail_input(path, "is packed in another way than by zlib; write it again with osmium cat");
  }
  if (packed.empty()) return std::string(raw);
  constexpr std::uint64_t kMost = std::uint64_t{64} << 20;  // of the format: 32 MiB
  if (size > kMost) throw Broken{};
  std::string content(static_cast<std::size_t>(size), '\0');
  auto length = static_cast<uLongf>(size);
  if (uncompress(reinterpret_cast<Bytef*>(content.data()), &length,
                 reinterpret_cast<const Bytef*>(packed.data()),
                 static_cast<uLong>(packed.size())) != Z_OK ||
      length != size)
    throw Broken{};
  return content;
}

class Block {
 public:
  Block(std::string_view content, OsmKind kind, const OsmVisit& visit)
      : kind_(kind), visit_(visit) {
    std::vector<std::string_view> groups;
    for (Message message(content); message.next();) switch (message.field()) {
        case 1:
          for (Message table(message.bytes()); table.next();) strings_.push_back(table.bytes());
          break;
        case 2:
          groups.push_back(message.bytes());
          break;
        case 17:
          granularity_ = static_cast<double>(message.value());
          break;
        case 19:
          north_ = static_cast<double>(static_cast<std::int64_t>(message.value()));
          break;
        case 20:
          east_ = static_cast<double>(static_cast<std::int64_t>(message.value()));
          break;
        default:
          break;
      }
    for (const std::string_view group : groups)
      for (Message message(group); message.next();) {
        if (kind == OsmKind::kNode && message.field() == 1) node(message.bytes());
        if (kind == OsmKind::kNode && message.field() == 2) dense(message.bytes());
        if (kind == OsmKind::kWay && message.field() == 3) way(message.bytes());
        if (kind == OsmKind::kRelation && message.field() == 4) relation(message.bytes());
      }
  }

 private:
  Point2 place(std::int64_t longitude, std::int64_t latitude) const {
    // Whole nanodegrees, so that a place is the double nearest to its decimals.
    return {(east_ + granularity_ * static_cast<double>(longitude)) / 1e9,
            (north_ + granularity_ * static_cast<double>(latitude)) / 1e9};
  }
  std::string text(std::uint64_t index) const {
    if (index >= strings_.size()) throw Broken{};
    return std::string(strings_[static_cast<std::size_t>(index)]);
  }
  void tags(std::string_view keys, std::string_view values, OsmElement& element) const {
    Message k(keys), v(values);
    while (!k.empty() && !v.empty()) {
      std::string key = text(k.varint());
      element.tags.emplace_back(std::move(key), text(v.varint()));
    }
  }
  void node(std::string_view bytes) const {
    OsmElement element;
    std::int64_t longitude = 0, latitude = 0;
    for (Message message(bytes); message.next();) {
      if (message.field() == 1) element.id = Message::unzigzag(message.value());
      if (message.field() == 8) latitude = Message::unzigzag(message.value());
      if (message.field() == 9) longitude = Message::unzigzag(message.value());
    }
    element.place = place(longitude, latitude);
    visit_(element);
  }
  void dense(std::string_view bytes) const {
    std::string_view ids, latitudes, longitudes;
    for (Message message(bytes); message.next();) {
      if (message.field() == 1) ids = message.bytes();
      if (message.field() == 8) latitudes = message.bytes();
      if (message.field() == 9) longitudes = message.bytes();
    }
    Message id(ids), latitude(latitudes), longitude(longitudes);
    OsmElement element;
    std::int64_t x = 0, y = 0;
    while (!id.empty()) {
      element.id += id.zigzag();
      x += longitude.zigzag();
      y += latitude.zigzag();
      element.place = place(x, y);
      visit_(element);
    }
  }
  void way(std::string_view bytes) const {
    OsmElement element;
    element.kind = kind_;
    std::string_view keys, values;
    for (Message message(bytes); message.next();) {
      if (message.field() == 1) element.id = static_cast<std::int64_t>(message.value());
      if (message.field() == 2) keys = message.bytes();
      if (message.field() == 3) values = message.bytes();
      if (message.field() != 8) continue;
      std::int64_t id = 0;
      for (Message refs(message.bytes()); !refs.empty();)
        element.nodes.push_back(id += refs.zigzag());
    }
    tags(keys, values, element);
    visit_(element);
  }
  void relation(std::string_view bytes) const {
    OsmElement element;
    element.kind = kind_;
    std::string_view keys, values, roles, ids, types;
    for (Message message(bytes); message.next();) switch (message.field()) {
        case 1:
          element.id = static_cast<std::int64_t>(message.value());
          break;
        case 2:
          keys = message.bytes();
          break;
        case 3:
          values = message.bytes();
          break;
        case 8:
          roles = message.bytes();
          break;
        case 9:
          ids = message.bytes();
          break;
        case 10:
          types = message.bytes();
          break;
        default:
          break;
      }
    Message role(roles), member(ids), type(types);
    std::int64_t id = 0;
    while (!member.empty()) {
      id += member.zigzag();
      const std::uint64_t kind = type.varint();
      if (kind > 2) throw Broken{};
      element.members.push_back({static_cast<OsmKind>(kind), id, text(role.varint()), {}});
    }
    tags(keys, values, element);
    visit_(element);
  }

  OsmKind kind_;
  const OsmVisit& visit_;
  std::vector<std::string_view> strings_;
  double granularity_ = 100, north_ = 0, east_ = 0;
};

void require_features(std::string_view content, const fs::path& path) {
  for (Message message(content); message.next();)
    if (message.field() == 4 && message.bytes() != "OsmSchema-V0.6" &&
        message.bytes() != "DenseNodes" && message.bytes() != "HistoricalInformation")
      fail_input(path, fmt::format("needs '{}', which is not read; write it again with osmium cat",
                                   message.bytes()));
}

}  // namespace

void read_osm_pbf(const fs::path& path, OsmKind kind, const OsmVisit& visit) {
  OsmBytes file(path);
  std::int64_t at = 0;
  std::string bytes;
  const auto broken = [&] {
    fail_input(path, fmt::format("byte {}: the file is cut or broken, get it again", at));
  };
  const auto take = [&](std::size_t size) {
    bytes.resize(size);
    if (file.read(bytes.data(), size) != size) broken();
    return std::string_view(bytes);
  };
  for (;;) {
    std::array<char, 4> length{};
    const std::size_t got = file.read(length.data(), length.size());
    if (got == 0) break;
    if (got < length.size()) broken();
    std::uint32_t size = 0;
    for (const char c : length) size = size << 8U | static_cast<unsigned char>(c);
    constexpr std::uint32_t kMostHeader = 64U << 10U, kMostBlob = 64U << 20U;
    if (size > kMostHeader) broken();
    std::string type;
    std::uint64_t data = 0;
    try {
      for (Message header(take(size)); header.next();) {
        if (header.field() == 1) type = header.bytes();
        if (header.field() == 3) data = header.value();
      }
      if (data > kMostBlob) throw Broken{};
      const std::string_view blob = take(static_cast<std::size_t>(data));
      if (type == "OSMHeader") require_features(content_of(blob, path), path);
      if (type == "OSMData") {
        const std::string content = content_of(blob, path);
        Block(content, kind, visit);
      }
    } catch (const Broken&) {
      broken();
    }
    at += static_cast<std::int64_t>(length.size() + size + data);
  }
  if (at == 0) fail_input(path, "the file is empty; get it again");
}

}  // namespace tetropolis
