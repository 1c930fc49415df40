#include "las_chunk_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/file/input_file.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Bytes of a file up to some place, and zeros behind it.
class CodedBytes {
 public:
  CodedBytes(const PositionedFile& file, std::int64_t from, std::int64_t end)
      : file_(file), from_(from), end_(end) {}

  std::uint32_t next() {
    if (at_ == size_ && !refill()) return 0;
    return bytes_[at_++];
  }
  /// Whether more was asked for than there is.
  bool ran_out() const { return ran_out_; }

 private:
  bool refill() {
    const auto most = static_cast<std::int64_t>(bytes_.size());
    const std::int64_t wanted = std::min(most, end_ - from_);
    size_ = wanted > 0 ? file_.read(from_, bytes_.data(), static_cast<std::size_t>(wanted)) : 0;
    from_ += static_cast<std::int64_t>(size_);
    at_ = 0;
    ran_out_ = ran_out_ || size_ == 0;
    return size_ > 0;
  }

  const PositionedFile& file_;
  std::int64_t from_;
  std::int64_t end_;
  std::array<unsigned char, 4096> bytes_{};
  std::size_t at_ = 0;
  std::size_t size_ = 0;
  bool ran_out_ = false;
};

/// How often each of some symbols has come. The constants are LASzip's.
class SymbolModel {
 public:
  static constexpr std::uint32_t kShift = 15;

  explicit SymbolModel(std::uint32_t symbols)
      : counts_(symbols, 1), begins_(symbols, 0), cycle_(symbols) {
    update();
    cycle_ = until_update_ = (symbols + 6) >> 1;
  }

  std::uint32_t last() const { return static_cast<std::uint32_t>(counts_.size()) - 1; }
  /// Of the range of 1 << kShift, where that of the symbol begins.
  std::uint32_t begin_of(std::uint32_t symbol) const { return begins_[symbol]; }
  std::uint32_t symbol_at(std::uint32_t place) const {
    const auto next = std::upper_bound(begins_.begin(), begins_.end(), place);
    return static_cast<std::uint32_t>(next - begins_.begin()) - 1;
  }
  void count(std::uint32_t symbol) {
    ++counts_[symbol];
    if (--until_update_ == 0) update();
  }

 private:
  void update() {
    total_ += cycle_;
    if (total_ > 1U << kShift) {
      total_ = 0;
      for (std::uint32_t& count : counts_) total_ += count = (count + 1) >> 1;
    }
    const std::uint32_t scale = 0x80000000U / total_;
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      begins_[i] = (scale * sum) >> (31 - kShift);
      sum += counts_[i];
    }
    cycle_ = std::min((5 * cycle_) >> 2, (static_cast<std::uint32_t>(counts_.size()) + 6) << 3);
    until_update_ = cycle_;
  }

  std::vector<std::uint32_t> counts_;
  std::vector<std::uint32_t> begins_;
  std::uint32_t total_ = 0;
  std::uint32_t cycle_;
  std::uint32_t until_update_ = 0;
};

/// The same of a bit.
class BitModel {
 public:
  static constexpr std::uint32_t kShift = 13;

  std::uint32_t share_of_zero() const { return share_; }
  void count(std::uint32_t bit) {
    if (bit == 0) ++zeros_;
    if (--until_update_ == 0) update();
  }

 private:
  void update() {
    total_ += cycle_;
    if (total_ > 1U << kShift) {
      total_ = (total_ + 1) >> 1;
      zeros_ = (zeros_ + 1) >> 1;
      if (zeros_ == total_) ++total_;
    }
    share_ = (zeros_ * (0x80000000U / total_)) >> (31 - kShift);
    cycle_ = std::min((5 * cycle_) >> 2, 64U);
    until_update_ = cycle_;
  }

  std::uint32_t zeros_ = 1;
  std::uint32_t total_ = 2;
  std::uint32_t share_ = 1U << (kShift - 1);
  std::uint32_t cycle_ = 4;
  std::uint32_t until_update_ = 4;
};

class ArithmeticDecoder {
 public:
  explicit ArithmeticDecoder(CodedBytes& bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | bytes_.next();
  }

  std::uint32_t symbol(SymbolModel& model) {
    const std::uint32_t whole = length_;
    length_ >>= SymbolModel::kShift;
    const std::uint32_t symbol = model.symbol_at(value_ / length_);
    const std::uint32_t begin = model.begin_of(symbol) * length_;
    const std::uint32_t end = symbol == model.last() ? whole : model.begin_of(symbol + 1) * length_;
    narrow(begin, end);
    model.count(symbol);
    return symbol;
  }
  std::uint32_t bit(BitModel& model) {
    const std::uint32_t zeros = model.share_of_zero() * (length_ >> BitModel::kShift);
    const std::uint32_t bit = value_ >= zeros ? 1 : 0;
    narrow(bit == 0 ? 0 : zeros, bit == 0 ? zeros : length_);
    model.count(bit);
    return bit;
  }
  /// A number of so many bits, no more than 32, all as likely.
  std::uint32_t bits(std::uint32_t count) {
    if (count > 19) {
      const std::uint32_t low = bits(16);
      return bits(count - 16) << 16 | low;
    }
    length_ >>= count;
    const std::uint32_t number = value_ / length_;
    narrow(number * length_, (number + 1) * length_);
    return number;
  }

 private:
  void narrow(std::uint32_t begin, std::uint32_t end) {
    value_ -= begin;
    length_ = end - begin;
    for (; length_ < 1U << 24; length_ <<= 8) value_ = value_ << 8 | bytes_.next();
  }

  CodedBytes& bytes_;
  std::uint32_t value_ = 0;
  std::uint32_t length_ = 0xFFFFFFFFU;
};

/// Numbers of 32 bits, each stored as what it differs by from a guess: how many bits that takes,
/// then these.
class NumberDecoder {
 public:
  explicit NumberDecoder(CodedBytes& bytes) : decoder_(bytes) {
    for (std::uint32_t bits = 1; bits < 32; ++bits)
      highest_.emplace_back(1U << std::min(bits, kModelled));
  }

  std::int32_t next(std::int32_t guess, std::size_t context) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(guess) + difference(context));
  }

 private:
  static constexpr std::uint32_t kModelled = 8;  // highest bits of which the frequency counts

  std::uint32_t difference(std::size_t context) {
    const std::uint32_t bits = decoder_.symbol(lengths_[context]);
    if (bits == 0) return decoder_.bit(lowest_);
    if (bits == 32) return 0x80000000U;
    std::uint32_t number = decoder_.symbol(highest_[bits - 1]);
    if (bits > kModelled) number = number << (bits - kModelled) | decoder_.bits(bits - kModelled);
    return number >= 1U << (bits - 1) ? number + 1 : number - ((1U << bits) - 1);
  }

  ArithmeticDecoder decoder_;
  std::array<SymbolModel, 2> lengths_{SymbolModel(33), SymbolModel(33)};
  std::vector<SymbolModel> highest_;
  BitModel lowest_;
};

}  // namespace

void check_chunk_table(const fs::path& path, const PositionedFile& file,
                       const LazTablePlace& place) {
  const bool states_points = place.chunk_size == UINT32_MAX;
  CodedBytes bytes(file, place.at + 8, place.end);
  NumberDecoder numbers(bytes);
  std::int32_t points = 0, length = 0;
  std::int64_t at = place.first_chunk, counted = 0;
  for (std::uint32_t k = 0; k < place.chunks; ++k) {
    if (states_points) points = numbers.next(points, 0);
    length = numbers.next(length, 1);
    if (bytes.ran_out())
      fail_input(path, fmt::format("ends at byte {} within its table of chunks; the file is cut, "
                                   "get it again",
                                   file.size()));
    if (points < 0 || length < 0 || length > place.at - at)
      fail_input(path, fmt::format("the table of chunks at byte {} gives {} bytes to chunk {}, "
                                   "which starts at byte {}; the file is broken, get it again",
                                   place.at, length, k, at));
    counted += points;
    at += length;
  }
  if (states_points && counted < place.points)
    fail_input(path, fmt::format("the header counts {} points, but the table of chunks {}; get the "
                                 "file again",
                                 place.points, counted));
}

}  // namespace tetropolis
