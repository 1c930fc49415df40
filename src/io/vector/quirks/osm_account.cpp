#include "osm_account.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string_view>
#include <unordered_set>

#include <fmt/format.h>

#include "core/text.h"
#include "io/file/positioned_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// The tags of an XML file one after the other, without their angle brackets.
class TagReader {
 public:
  explicit TagReader(const fs::path& path) : file_(path) {}

  /// False at the end of the file.
  bool next(std::string& tag) {
    tag.clear();
    for (;;) {
      if (!skip_to('<')) return false;
      if (!read_tag(tag)) return false;
      if (tag != kComment) return true;
      // It may hold anything.
      while (!tag.ends_with("-->")) {
        const int c = get();
        if (c < 0) return false;
        tag += static_cast<char>(c);
      }
      tag.clear();
    }
  }

 private:
  bool skip_to(char wanted) {
    for (int c = get(); c >= 0; c = get())
      if (c == wanted) return true;
    return false;
  }

  static constexpr std::string_view kComment = "!--";

  /// Up to the bracket that is in no attribute, or the beginning of a comment.
  bool read_tag(std::string& tag) {
    char quote = 0;
    for (int c = get(); c >= 0; c = get()) {
      const char character = static_cast<char>(c);
      if (quote == 0 && character == '>') return true;
      if (quote == 0 && (character == '"' || character == '\''))
        quote = character;
      else if (quote == character)
        quote = 0;
      tag += character;
      if (tag == kComment) return true;
    }
    return false;
  }

  int get() {
    if (at_ == buffer_.size()) {
      constexpr std::size_t kChunk = std::size_t{1} << 20;
      buffer_.resize(kChunk);
      buffer_.resize(file_.read(position_, buffer_.data(), kChunk));
      position_ += static_cast<std::int64_t>(buffer_.size());
      at_ = 0;
      if (buffer_.empty()) return -1;
    }
    return static_cast<unsigned char>(buffer_[at_++]);
  }

  PositionedFile file_;
  std::string buffer_;
  std::size_t at_ = 0;
  std::int64_t position_ = 0;
};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string_view name_of(std::string_view tag) {
  std::size_t end = 0;
  while (end < tag.size() && !is_space(tag[end]) && (end == 0 || tag[end] != '/')) ++end;
  return tag.substr(0, end);
}

/// The value of an attribute; empty if it is not there.
std::string_view attribute(std::string_view tag, std::string_view name) {
  tag.remove_prefix(name_of(tag).size());
  for (;;) {
    const std::size_t equals = tag.find('=');
    if (equals == tag.npos) return {};
    std::string_view key = tag.substr(0, equals);
    while (!key.empty() && is_space(key.front())) key.remove_prefix(1);
    while (!key.empty() && is_space(key.back())) key.remove_suffix(1);
    const std::size_t begin = tag.find_first_of("\"'", equals);
    if (begin == tag.npos) return {};
    const std::size_t end = tag.find(tag[begin], begin + 1);
    if (end == tag.npos) return {};
    if (key == name) return tag.substr(begin + 1, end - begin - 1);
    tag.remove_prefix(end + 1);
  }
}

std::int64_t number(std::string_view tag, std::string_view name) {
  const std::string_view text = attribute(tag, name);
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
  explicit OsmReader(const fs::path& path) {
    TagReader tags(path);
    for (std::string tag; tags.next(tag);) read(tag);
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
        account.cornered.push_back(name);
    }
    return account;
  }

 private:
  void read(const std::string& tag) {
    const std::string_view name = name_of(tag);
    if (name == "node") {
      nodes_.push_back(number(tag, "id"));
    } else if (name == "way" || name == "relation") {
      current_ = {};
      current_.id = {name == "relation", number(tag, "id")};
      current_.is_deleted =
          attribute(tag, "action") == "delete" || attribute(tag, "visible") == "false";
    } else if (name == "nd") {
      if (current_.id.first) return;  // of a member's geometry
      current_.parts.push_back(number(tag, "ref"));
    } else if (name == "member") {
      if (attribute(tag, "type") == "way") current_.parts.push_back(number(tag, "ref"));
    } else if (name == "tag") {
      const std::string_view key = attribute(tag, "k"), value = attribute(tag, "v");
      if (key == "building") current_.is_building = lower_case(std::string(value)) != "no";
      if (key == "type") current_.type = value;
    } else if (name == "/way") {
      ways_.insert(current_.id.second);
      keep();
    } else if (name == "/relation") {
      keep();
    }
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
      return fmt::format("a relation of type '{}', which is no area", element.type);
    if (lacking > 0)
      return fmt::format("{} of its {} {} are not in the file", lacking, parts,
                         element.id.first ? "ways" : "nodes");
    if (element.id.first) return "its ways make no outline";
    if (parts < 4) return "a way of fewer than three corners";
    return element.parts.front() == element.parts.back() ? "no area can be made of it"
                                                         : "a way that is not closed";
  }

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
