#include "text_records.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <cpl_vsi.h>
#include <fmt/format.h>

#include "input_file.h"

namespace tetropolis {

namespace {

struct CloseFile {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// Calls visit(byte) for all bytes of a file that GDAL can open.
template <typename Visit>
void for_each_byte(const std::filesystem::path& path, const std::string& name, const Visit& visit) {
  const std::unique_ptr<VSILFILE, CloseFile> file(VSIFOpenL(name.c_str(), "rb"));
  if (file == nullptr) fail_input(path, "cannot be read; check its permissions");
  std::vector<char> block(1 << 20);
  while (const std::size_t count = VSIFReadL(block.data(), 1, block.size(), file.get()))
    for (std::size_t i = 0; i < count; ++i) visit(block[i]);
}

/// Follows the quotes of the lines that GDAL joins to a record.
class QuoteScan {
 public:
  explicit QuoteScan(const std::filesystem::path& path) : path_(path) {}

  void add(char c) {
    if (c == '"') {
      // The first of a field opens it, and one within it closes it, unless it is doubled.
      if (!open_) mistaken_ = !closed_ && !at_start_;
      open_ = !open_;
      closed_ = !open_;
      at_start_ = false;
      return;
    }
    if (c == '\n') {
      ++line_;
      if (!open_) finish();
      if (open_ && mistaken_) fail();
      return;
    }
    if (open_) return;
    const bool separates = std::string_view(",;\t|").find(c) != std::string_view::npos;
    const bool blank = c == ' ' || c == '\r';
    const bool mark = static_cast<unsigned char>(c) >= 0xBB && line_ == 0;  // of byte order
    closed_ = closed_ && blank;
    at_start_ = separates || blank || (at_start_ && mark);
  }

  void end() const {
    if (open_) fail();
  }

 private:
  void finish() {
    first_ = line_;
    closed_ = false;
    at_start_ = true;
  }

  [[noreturn]] void fail() const {
    fail_input(path_, fmt::format("line {}: has a quote that is not closed, so that further lines "
                                  "are part of it; close it, or write quotes within a field twice",
                                  first_ + 1));
  }

  const std::filesystem::path& path_;
  bool open_ = false;       // within quotes
  bool mistaken_ = false;   // which opened within a field
  bool closed_ = false;     // just behind the closing one
  bool at_start_ = true;    // of a field
  std::int64_t line_ = 0;   // lines that have ended
  std::int64_t first_ = 0;  // at the beginning of the record
};

/// Follows the brackets of the objects of a file.
class ObjectScan {
 public:
  ObjectScan(const std::filesystem::path& path, bool by_line) : path_(path), by_line_(by_line) {}

  void add(char c) {
    constexpr char kSeparator = '\x1e';
    if (c == '\n') {
      ++line_;
      // Whatever was wrong with a line, the next is another.
      if (by_line_ && !separated_) {
        in_string_ = escaped_ = complete_ = false;
        depth_ = 0;
      }
    }
    if (in_string_) {
      if (!escaped_ && c == '"') in_string_ = false;
      escaped_ = !escaped_ && c == '\\';
      return;
    }
    if (c == kSeparator && by_line_ && depth_ == 0) {
      separated_ = true;
      complete_ = false;
      return;
    }
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0') return;
    // Scripts put signs around an object, which are no features.
    if (complete_ && (c == '{' || c == '[')) fail();
    if (c == '"') in_string_ = true;
    if (c == '{' || c == '[') ++depth_;
    if (c == '}' || c == ']') complete_ = --depth_ == 0;
  }

 private:
  [[noreturn]] void fail() const {
    fail_input(path_, fmt::format("line {}: another object follows after the end of one, which "
                                  "would be passed over; write each feature on a line of its own, "
                                  "or all in one FeatureCollection",
                                  line_ + 1));
  }

  const std::filesystem::path& path_;
  bool by_line_;
  bool in_string_ = false;
  bool escaped_ = false;
  bool separated_ = false;  // by record separators
  bool complete_ = false;   // the object of this line, record or file
  std::int64_t depth_ = 0;
  std::int64_t line_ = 0;
};

}  // namespace

void require_closed_quotes(const std::filesystem::path& path, const std::string& name) {
  QuoteScan scan(path);
  for_each_byte(path, name, [&](char c) { scan.add(c); });
  scan.end();
}

void require_single_objects(const std::filesystem::path& path, const std::string& name,
                            bool by_line) {
  ObjectScan scan(path, by_line);
  for_each_byte(path, name, [&](char c) { scan.add(c); });
}

}  // namespace tetropolis
