// Which records of a point file are kept, and which its header tells wrongly. Private to src/io.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "tetropolis/io/las/las.h"

#include "las_decode.h"

namespace tetropolis {

inline constexpr NumberRange kAllNumbers{std::numeric_limits<std::int32_t>::min(),
                                         std::numeric_limits<std::int32_t>::max()};

/// Which records of a file become points.
class LasFilter {
 public:
  LasFilter(const ReadPointsOptions& options, const LasInfo& info);

  /// The records to keep, in order: the block as it is, or some of it in `kept`.
  LasBlock keep(const LasBlock& block, LasBlockBuffer& kept) const;

 private:
  bool skips(const LasBlock& block, std::size_t i) const;
  bool keeps_all(const LasBlock& block) const;

  NumberRange x_ = kAllNumbers;
  NumberRange y_ = kAllNumbers;
  bool keep_withheld_;
  ClassTable skipped_;
};

/// Counts the points outside of a header's box. In a file whose bytes have rotted, wrong numbers
/// are all that can be seen: LAS and LAZ have no checksums.
class BoxCheck {
 public:
  explicit BoxCheck(const LasInfo& info);
  std::int64_t count_outside(const LasBlock& block) const;

 private:
  std::array<NumberRange, 3> inside_;
};

}  // namespace tetropolis
