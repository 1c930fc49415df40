// The public header block and the variable length records of LAS files. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/io/las/las.h"

namespace tetropolis {

/// Where points are, as far as it was checked.
struct LasLayout {
  LasInfo info;
  std::int64_t file_size = 0;
  std::int64_t first_point = 0;  ///< Byte of the first record, or of the LAZ chunk table's pointer.
  std::int64_t points_end = 0;   ///< Byte behind the last record that could be one.
  /// LAZ: points per chunk if all chunks have the same number and the chunk table is in its place,
  /// so that decoding may start at multiples of it. Otherwise 0.
  std::int64_t chunk_size = 0;
  /// LAZ: whether chunks differ in size, as in COPC; LASzip knows where each begins.
  bool variable_chunks = false;
};

/// In CRS coordinates.
inline Point2 position(const LasInfo& info, std::int32_t x, std::int32_t y) {
  return {x * info.scale[0] + info.offset[0], y * info.scale[1] + info.offset[1]};
}

/// One variable length record.
struct Vlr {
  std::string user_id;
  int record_id = 0;
  std::string data;
};

/// Reference systems of files. To find the code of one can take a second, so it is done once for
/// equal records. May be used from several threads.
class LasSystems {
 public:
  struct System {
    std::string crs;           ///< Canonical; "" if none is stated or it is not understood.
    double vertical_unit = 1;  ///< Metres per unit of height; 1 if not stated.
    std::string vertical_crs;  ///< Name of the vertical system; "" if not stated.
  };

  /// `prefer_wkt`: the header says that WKT holds (LAS 1.4 R15, global encoding bit 4).
  System of(const std::vector<Vlr>& vlrs, bool prefer_wkt);

 private:
  std::mutex mutex_;
  std::map<std::string, System> known_;  ///< By the records' bytes.
};

/// Throws as inspect_las. `crs_matters`: whether to warn of a reference system that is not
/// understood or may be lost.
LasLayout read_las_layout(const std::filesystem::path& path, LasSystems& systems,
                          bool crs_matters = true);

/// Record of the LASzip compressor: how the points are packed.
struct LaszipRecord {
  int compressor = 0;  ///< 1 point-wise, 2 chunked, 3 chunked in layers.
  std::uint32_t chunk_size = 0;
};

/// Parses and checks it as strictly as the decoder needs: items that do not add up to the record
/// length would make it write outside its buffers. Returns what is wrong, "" if nothing is.
std::string check_laszip_record(std::string_view data, int record_length, LaszipRecord& record);

}  // namespace tetropolis
