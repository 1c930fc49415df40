// XML, element by element. Private to src/io.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <expat.h>

namespace tetropolis {

/// Readers of one kind of file derive from this and say what its elements mean; what they throw
/// leaves `parse`.
class XmlReader {
 public:
  /// Puts up to `size` bytes into `data`; fewer only at the end.
  using Source = std::function<std::size_t(char* data, std::size_t size)>;

  XmlReader();
  virtual ~XmlReader() = default;
  XmlReader(const XmlReader&) = delete;
  XmlReader& operator=(const XmlReader&) = delete;

  /// To the end of `source`. Throws Error(kInput) with `path` and the line for what is not XML.
  void parse(const std::filesystem::path& path, const Source& source);

 protected:
  /// Names and values in turns, the last is null.
  using Attributes = const XML_Char**;

  virtual void start(std::string_view element, Attributes attributes) = 0;
  virtual void end(std::string_view element) = 0;
  /// Between tags, in pieces.
  virtual void text(std::string_view /*piece*/) {}

  std::uint64_t line() const;

 private:
  template <typename Handle, typename... Arguments>
  void guarded(Handle handle, Arguments... arguments) noexcept;

  struct FreeParser {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };
  std::unique_ptr<XML_ParserStruct, FreeParser> parser_;
  std::exception_ptr thrown_;
};

}  // namespace tetropolis
