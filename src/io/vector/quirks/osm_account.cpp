#include "osm_account.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <string_view>
#include <unordered_set>

#include <expat.h>
#include <fmt/format.h>

#include "core/text.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// The value of an attribute; empty if it is not there.
std::string_view attribute(const XML_Char** attributes, std::string_view name) {
  for (; *attributes != nullptr; attributes += 2)
    if (attributes[0] == name) return attributes[1];
  return {};
}

std::int64_t number(const XML_Char** attributes, std::string_view name) {
  const std::string_view text = attribute(attributes, name);
  std::int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// A way or relation.
struct Element {
  OsmId id;
  bool is_building = false;
  bool is_deleted = false;          ///< In an editor's file, where it stays until it is uploaded.
  std::string type;                 ///< Of a relation.
  std::vector<std::int64_t> parts;  ///< Nodes of a way; ways of a relation.
};

/// Relations that hold the outline and the parts of a building, or a site, which have areas of
/// their own.
bool is_group(const Element& element) {
  return element.type == "building" || element.type == "site";
}

class OsmReader {
 public:
  explicit OsmReader(const fs::path& path) : parser_(XML_ParserCreate(nullptr)) {
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* reader, const XML_Char* name, const XML_Char** attributes) {
          static_cast<OsmReader*>(reader)->guarded(&OsmReader::start, name, attributes);
        },
        [](void* reader, const XML_Char* name) {
          static_cast<OsmReader*>(reader)->guarded(&OsmReader::end, name);
        });
    const PositionedFile file(path);
    std::string block(std::size_t{1} << 20, '\0');
    std::size_t size = block.size();
    for (std::int64_t at = 0; size > 0; at += static_cast<std::int64_t>(size)) {
      size = file.read(at, block.data(), block.size());
      const XML_Status status =
          XML_Parse(parser_.get(), block.data(), static_cast<int>(size), size == 0 ? 1 : 0);
      if (thrown_) std::rethrow_exception(thrown_);
      if (status != XML_STATUS_OK)
        fail_input(path, fmt::format("line {}: {}; get the file again",
                                     XML_GetCurrentLineNumber(parser_.get()),
                                     XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
    std::sort(nodes_.begin(), nodes_.end());
  }

  OsmAccount compare(const std::set<OsmId>& read) const {
    std::unordered_set<std::int64_t> of_relations;
    for (const Element& element : elements_)
      if (element.id.first && read.contains(element.id))
        of_relations.insert(element.parts.begin(), element.parts.end());
    OsmAccount account;
    std::set<OsmId> seen;  // merged extracts may hold one twice
    for (const Element& element : elements_) {
      if (!element.is_building || element.is_deleted || is_group(element)) continue;
      const auto [is_relation, id] = element.id;
      if (!is_relation && of_relations.contains(id)) continue;
      if (!seen.insert(element.id).second) continue;
      const std::string name = fmt::format("{}/{}", is_relation ? "relation" : "way", id);
      if (!read.contains(element.id))
        account.lost.push_back({name, why_lost(element)});
      else if (!is_relation && missing(element) > 0)
        account.incomplete.push_back(name);
    }
    return account;
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

  void start(const XML_Char* element, const XML_Char** attributes) {
    const std::string_view name = element;
    if (name == "node") {
      nodes_.push_back(number(attributes, "id"));
    } else if (name == "way" || name == "relation") {
      current_ = {};
      current_.id = {name == "relation", number(attributes, "id")};
      current_.is_deleted = attribute(attributes, "action") == "delete" ||
                            attribute(attributes, "visible") == "false";
    } else if (name == "nd") {
      // Overpass gives relations the geometry of their members.
      if (!current_.id.first) current_.parts.push_back(number(attributes, "ref"));
    } else if (name == "member") {
      if (attribute(attributes, "type") == "way")
        current_.parts.push_back(number(attributes, "ref"));
    } else if (name == "tag") {
      const std::string_view key = attribute(attributes, "k"), value = attribute(attributes, "v");
      if (key == "building") current_.is_building = lower_case(std::string(value)) != "no";
      if (key == "type") current_.type = value;
    }
  }

  void end(const XML_Char* element) {
    const std::string_view name = element;
    if (name != "way" && name != "relation") return;
    if (name == "way") ways_.insert(current_.id.second);
    keep();
  }

  /// Relations without the tag may have it from their outer way.
  void keep() {
    if (current_.is_building || current_.id.first) elements_.push_back(std::move(current_));
    current_ = {};
  }

  /// How many of its nodes or ways are not in the file.
  std::ptrdiff_t missing(const Element& element) const {
    return std::count_if(element.parts.begin(), element.parts.end(), [&](std::int64_t part) {
      return element.id.first ? !ways_.contains(part)
                              : !std::binary_search(nodes_.begin(), nodes_.end(), part);
    });
  }

  std::string why_lost(const Element& element) const {
    const auto parts = std::ssize(element.parts), lacking = missing(element);
    if (element.id.first && element.type != "multipolygon" && element.type != "boundary")
      return fmt::format("a relation of type '{}', not an area", element.type);
    if (lacking > 0)
      return fmt::format("the file lacks {} of its {} {}", lacking, parts,
                         element.id.first ? "ways" : "nodes");
    if (element.id.first) return "its ways form no outline";
    if (parts < 4) return "a way of fewer than three corners";
    return element.parts.front() == element.parts.back() ? "it forms no area"
                                                         : "a way that is not closed";
  }

  struct FreeParser {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };

  std::unique_ptr<XML_ParserStruct, FreeParser> parser_;
  std::exception_ptr thrown_;
  Element current_;
  std::vector<Element> elements_;
  std::vector<std::int64_t> nodes_;
  std::unordered_set<std::int64_t> ways_;
};

}  // namespace

OsmAccount account_of_osm(const fs::path& path, const std::set<OsmId>& read) {
  return OsmReader(path).compare(read);
}

}  // namespace tetropolis
