#include <charconv>
#include <exception>
#include <new>
#include <string_view>

#include <expat.h>
#include <fmt/format.h>

#include "io/file/input_file.h"
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

class XmlReader {
 public:
  XmlReader(OsmKind kind, const OsmVisit& visit)
      : parser_(XML_ParserCreate(nullptr)), kind_(kind), visit_(visit) {
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* reader, const XML_Char* name, const XML_Char** attributes) {
          static_cast<XmlReader*>(reader)->guarded(&XmlReader::start, name, attributes);
        },
        [](void* reader, const XML_Char* name) {
          static_cast<XmlReader*>(reader)->guarded(&XmlReader::end, name);
        });
  }

  void read(const fs::path& path) {
    OsmBytes file(path);
    std::string block(std::size_t{1} << 20, '\0');
    for (std::size_t size = block.size(); size > 0;) {
      size = file.read(block.data(), block.size());
      const XML_Status status =
          XML_Parse(parser_.get(), block.data(), static_cast<int>(size), size == 0 ? 1 : 0);
      if (thrown_) std::rethrow_exception(thrown_);
      if (status != XML_STATUS_OK)
        fail_input(path, fmt::format("line {}: {}; get the file again",
                                     XML_GetCurrentLineNumber(parser_.get()),
                                     XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
    if (!is_osm_) fail_input(path, "holds no OpenStreetMap data; name another file");
  }

 private:
  /// Expat is C: no exception may pass it.
  template <typename Handle, typename... Arguments>
  void guarded(Handle handle, Arguments... arguments) noexcept {
    try {
      (this->*handle)(arguments...);
    } catch (...) {
      thrown_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  static bool is_kind(std::string_view name, OsmKind& kind) {
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

  void start(const XML_Char* element, const XML_Char** attributes) {
    const std::string_view name = element;
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
    }
  }

  void end(const XML_Char* element) {
    OsmKind kind{};
    if (!is_kind(element, kind)) return;
    if (inside_) visit_(current_);
    inside_ = false;
  }

  struct FreeParser {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };

  std::unique_ptr<XML_ParserStruct, FreeParser> parser_;
  std::exception_ptr thrown_;
  OsmKind kind_;
  const OsmVisit& visit_;
  bool is_osm_ = false;
  bool inside_ = false;  ///< An element of the kind.
  OsmElement current_;
};

}  // namespace

void read_osm_xml(const fs::path& path, OsmKind kind, const OsmVisit& visit) {
  XmlReader(kind, visit).read(path);
}

}  // namespace tetropolis
