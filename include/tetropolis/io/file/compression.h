// How large arrays are stored in files.
#pragma once

namespace tetropolis {

enum class Compression {
  kNone,
  kZlib,  ///< In blocks, by zlib, in parallel; other programs read it as it is.
};

}  // namespace tetropolis
