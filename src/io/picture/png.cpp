#include "tetropolis/io/picture/png.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

#include <zlib.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/file/write_file.h"

#include "core/parallel.h"
#include "io/file/deflate.h"

namespace tetropolis {

namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
constexpr int kLevel = 7;
constexpr std::size_t kChannels = 3;

void add_number(std::string& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255U);
}

void add_chunk(std::string& file, std::string_view type, std::string_view data) {
  add_number(file, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = file.size();
  file.append(type).append(data);
  const auto* bytes = reinterpret_cast<const Bytef*>(file.data() + begin);
  add_number(file,
             static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(file.size() - begin))));
}

/// What filter `kind` predicts from the bytes left, above, and left above.
int predicted(int kind, int a, int b, int c) {
  switch (kind) {
    case 1:
      return a;
    case 2:
      return b;
    case 3:
      return (a + b) / 2;
    case 4: {
      const int da = std::abs(b - c), db = std::abs(a - c), dc = std::abs(a + b - 2 * c);
      return da <= db && da <= dc ? a : db <= dc ? b : c;
    }
    default:
      return 0;
  }
}

/// A row behind the number of the filter that leaves the least.
void filter_row(const std::uint8_t* row, const std::uint8_t* above, std::size_t size, char* out) {
  std::string best, tried(size, '\0');
  long least = std::numeric_limits<long>::max();
  for (int kind = 0; kind <= 4; ++kind) {
    long sum = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const bool is_first = i < kChannels;
      const int a = is_first ? 0 : row[i - kChannels], b = above == nullptr ? 0 : above[i];
      const int c = is_first || above == nullptr ? 0 : above[i - kChannels];
      const auto rest = static_cast<std::uint8_t>(row[i] - predicted(kind, a, b, c));
      tried[i] = static_cast<char>(rest);
      sum += std::min<int>(rest, 256 - rest);
    }
    if (sum >= least) continue;
    least = sum;
    out[0] = static_cast<char>(kind);
    best.swap(tried);
    tried.resize(size);
  }
  std::copy(best.begin(), best.end(), out + 1);
}

void require_png_or_nothing(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return;
  std::ifstream file(path, std::ios::binary);
  std::array<char, kSignature.size()> head{};
  file.read(head.data(), head.size());
  const std::string_view begin(head.data(), static_cast<std::size_t>(file.gcount()));
  if (!begin.empty() && begin != kSignature)
    throw Error(ErrorKind::kInput,
                path.string() + ": is there already and no PNG picture; choose another name");
}

}  // namespace

void write_png(const std::filesystem::path& path, const Picture& picture) {
  require_png_or_nothing(path);
  const std::size_t row = static_cast<std::size_t>(picture.width) * kChannels;
  const auto rows = static_cast<std::size_t>(picture.height);
  std::string raw((row + 1) * rows, '\0');
  parallel_chunks(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      filter_row(picture.rgb.data() + y * row,
                 y == 0 ? nullptr : picture.rgb.data() + (y - 1) * row, row,
                 raw.data() + y * (row + 1));
  });
  std::string header;
  add_number(header, static_cast<std::uint32_t>(picture.width));
  add_number(header, static_cast<std::uint32_t>(picture.height));
  header +=
      std::string("\x08\x02\0\0\0", 5);  // 8 bits, RGB, deflate, adaptive filters, no interlace
  std::string file(kSignature);
  add_chunk(file, "IHDR", header);
  add_chunk(file, "sRGB", std::string_view("\0", 1));
  add_chunk(file, "IDAT", deflated(raw, kLevel));
  add_chunk(file, "IEND", "");
  write_file(path, file);
}

}  // namespace tetropolis
