// Compression by zlib.
#pragma once

#include <new>
#include <string>
#include <string_view>

#include <zlib.h>

namespace tetropolis {

/// A zlib stream of the bytes. `level`: from 1, the fastest, to 9.
inline std::string deflated(std::string_view bytes, int level) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  // It fails for lack of memory only.
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), level) != Z_OK)
    throw std::bad_alloc();
  result.resize(size);
  return result;
}

}  // namespace tetropolis
