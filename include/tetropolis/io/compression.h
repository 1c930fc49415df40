// How large arrays lie in files.
#pragma once

namespace tetropolis {

enum class Compression {
  kNone,
  kZlib,  ///< In blocks, by zlib, in parallel; what other programs read without asking.
};

}  // namespace tetropolis
