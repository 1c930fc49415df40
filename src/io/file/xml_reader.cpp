#include "xml_reader.h"

#include <new>

#include <fmt/format.h>

#include "input_file.h"

namespace tetropolis {

/// Expat is C: no exception may pass it.
template <typename Handle, typename... Arguments>
void XmlReader::guarded(Handle handle, Arguments... arguments) noexcept {
  try {
    (this->*handle)(arguments...);
  } catch (...) {
    thrown_ = std::current_exception();
    XML_StopParser(parser_.get(), XML_FALSE);
  }
}

XmlReader::XmlReader() : parser_(XML_ParserCreate(nullptr)) {
  if (parser_ == nullptr) throw std::bad_alloc();
  XML_SetUserData(parser_.get(), this);
  XML_SetElementHandler(
      parser_.get(),
      [](void* self, const XML_Char* name, Attributes attributes) {
        static_cast<XmlReader*>(self)->guarded(&XmlReader::start, name, attributes);
      },
      [](void* self, const XML_Char* name) {
        static_cast<XmlReader*>(self)->guarded(&XmlReader::end, name);
      });
  XML_SetCharacterDataHandler(parser_.get(), [](void* self, const XML_Char* piece, int length) {
    static_cast<XmlReader*>(self)->guarded(
        &XmlReader::text, std::string_view(piece, static_cast<std::size_t>(length)));
  });
}

void XmlReader::parse(const std::filesystem::path& path, const Source& source) {
  std::string block(std::size_t{1} << 20, '\0');
  for (std::size_t size = block.size(); size > 0;) {
    size = source(block.data(), block.size());
    const XML_Status status =
        XML_Parse(parser_.get(), block.data(), static_cast<int>(size), size == 0 ? 1 : 0);
    if (thrown_) std::rethrow_exception(thrown_);
    if (status != XML_STATUS_OK)
      fail_input(path, fmt::format("line {}: {}; the file is cut or broken, get it again", line(),
                                   XML_ErrorString(XML_GetErrorCode(parser_.get()))));
  }
}

std::uint64_t XmlReader::line() const { return XML_GetCurrentLineNumber(parser_.get()); }

}  // namespace tetropolis
