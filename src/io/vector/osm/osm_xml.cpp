#include <charconv>
#include <string_view>

#include "io/file/input_file.h"
#include "io/file/xml_reader.h"
#include "osm_input.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// The value of an attribute; empty if it is not there.
std::string_view attribute(const XML_Char** attributes, std::string_view name) {
  for (; *attributes != nullptr; attributes += 2)
    if (attributes[0] == name) return attributes[1];
  return {};
}

template <typename Number>
bool parse(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

std::int64_t number(const XML_Char** attributes, std::string_view name) {
  std::int64_t value = 0;
  parse(attribute(attributes, name), value);
  return value;
}

bool place(const XML_Char** attributes, Point2& at) {
  return parse(attribute(attributes, "lon"), at.x) && parse(attribute(attributes, "lat"), at.y);
}

class OsmXmlReader : public XmlReader {
 public:
  OsmXmlReader(OsmKind kind, const OsmVisit& visit) : kind_(kind), visit_(visit) {}

  void read(const fs::path& path) {
    OsmBytes file(path);
    parse(path, [&](char* data, std::size_t size) { return file.read(data, size); });
    if (!is_osm_) fail_input(path, "holds no OpenStreetMap data; name another file");
  }

 private:
  void start(std::string_view name, Attributes attributes) override {
    OsmKind kind{};
    is_osm_ = is_osm_ || name == "osm";
    if (is_kind(name, kind)) {
      inside_ = kind == kind_;
      if (!inside_) return;
      current_ = {};
      current_.kind = kind;
      current_.id = number(attributes, "id");
      current_.is_deleted = attribute(attributes, "action") == "delete" ||
                            attribute(attributes, "visible") == "false";
      if (kind == OsmKind::kNode && !place(attributes, current_.place)) current_.is_deleted = true;
      return;
    }
    if (!inside_) return;
    if (name == "tag" && kind_ != OsmKind::kNode) {
      current_.tags.emplace_back(attribute(attributes, "k"), attribute(attributes, "v"));
    } else if (name == "nd" && kind_ == OsmKind::kWay) {
      current_.nodes.push_back(number(attributes, "ref"));
      if (Point2 at{}; place(attributes, at)) current_.places.push_back(at);
    } else if (name == "member" && kind_ == OsmKind::kRelation) {
      OsmMember member;
      if (is_kind(attribute(attributes, "type"), member.kind)) {
        member.id = number(attributes, "ref");
        member.role = attribute(attributes, "role");
        current_.members.push_back(std::move(member));
      }
    } else if (name == "nd" && kind_ == OsmKind::kRelation && !current_.members.empty()) {
      if (Point2 at{}; place(attributes, at)) current_.members.back().places.push_back(at);
    }
  }

  void end(std::string_view element) override {
    OsmKind kind{};
    if (!is_kind(element, kind)) return;
    if (inside_) visit_(current_);
    inside_ = false;
  }

  OsmKind kind_;
  const OsmVisit& visit_;
  bool is_osm_ = false;
  bool inside_ = false;  ///< An element of the kind.
  OsmElement current_;
};

}  // namespace

void read_osm_xml(const fs::path& path, OsmKind kind, const OsmVisit& visit) {
  OsmXmlReader(kind, visit).read(path);
}

}  // namespace tetropolis
