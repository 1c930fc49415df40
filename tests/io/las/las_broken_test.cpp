// LAS files that lie, are cut or broken.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/las/las.h"

#include "las_support.h"
#include "support/bytes.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::all_points;
using testing::bytes_of;
using testing::input_error;
using testing::patched;
using testing::random_cloud;
using testing::read_error;
using testing::read_one;
using testing::same;
using testing::TemporaryFolder;
using testing::write_bytes;

TEST(BrokenLas, HeadersThatLieFailAndNameTheByte) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.las";
  write_points(path, random_cloud(1000, 6), {1000, 2000}, {});
  const std::string good = bytes_of(path);
  const auto error_of = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    return read_error(path);
  };
  const auto mentions = [&](const std::string& bytes, const char* words) {
    const std::string message = error_of(bytes);
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  mentions("", "empty");
  mentions("x,y,z\n1,2,3\n", "LASF");
  mentions(good.substr(0, 100), "cut");
  mentions(good.substr(0, 226), "cut");
  mentions(good.substr(0, good.size() - 1), "ends at point 999 of 1000");
  mentions(good.substr(0, 227 + 28 * 10), "ends at point 10 of 1000");
  mentions(patched(good, 25, std::uint8_t{9}), "LAS 1.9");
  mentions(patched(good, 25, std::uint8_t{4}), "header of 227 bytes");
  mentions(patched(good, 94, std::uint16_t{10}), "byte 94");
  mentions(patched(good, 96, std::uint32_t{100}), "byte 96");
  mentions(patched(good, 96, std::uint32_t{4000000000U}), "before its points start");
  mentions(patched(good, 104, std::uint8_t{11}), "point format");
  mentions(patched(good, 104, std::uint8_t{0x81}), "LASzip records");
  mentions(patched(good, 105, std::uint16_t{27}), "byte 105");
  mentions(patched(good, 105, std::uint16_t{0}), "byte 105");
  mentions(patched(good, 107, std::uint32_t{4000000000U}), "ends at point 1000 of 4000000000");
  mentions(patched(good, 131, 0.0), "scale");
  mentions(patched(good, 131, -0.001), "scale");
  mentions(patched(good, 131, 1e300), "byte 131 gives scale");
  mentions(patched(good, 163, 1e10), "byte 139 gives scale");
  mentions(patched(good, 171, 1e7), "byte 147 gives scale");
  mentions(patched(good, 139, std::numeric_limits<double>::quiet_NaN()), "scale");
  mentions(patched(good, 171, std::numeric_limits<double>::infinity()), "offset");
  write_bytes(path, good);
  EXPECT_EQ(read_one(path).points_read, 1000);
  EXPECT_NE(read_error(folder / "missing.las").find("no such file"), std::string::npos);
  EXPECT_NE(read_error(folder.path()).find("is a folder"), std::string::npos);
  const fs::path pipe = folder / "pipe.laz";  // nobody ever writes to it
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(read_error(pipe).find("ordinary file"), std::string::npos);
}

// The bytes behind the points are a record of another kind.
TEST(BrokenLas, CountsThatReachBeyondThePointsAreNoticed) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.las";
  WritePointsOptions options;
  options.point_format = 6;
  write_points(path, random_cloud(1000, 6), {}, options);
  std::string bytes = bytes_of(path);
  bytes = patched(bytes, 235, std::uint64_t{bytes.size()});
  bytes = patched(bytes, 243, std::uint32_t{1});
  bytes += patched(std::string(60 + 300, '\0'), 20, std::uint64_t{300});
  write_bytes(path, bytes);
  const PointsInput input = read_one(path, all_points());
  EXPECT_EQ(input.points_kept, 1000);
  EXPECT_TRUE(input.warnings.empty());
  write_bytes(path, patched(bytes, 247, std::uint64_t{1002}));
  EXPECT_NE(read_error(path).find("ends at point 1000 of 1002"), std::string::npos)
      << read_error(path);
}

TEST(BrokenLas, MissingCountsAreTakenFromTheFileSize) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.las";
  write_points(path, random_cloud(1000, 6), {}, {});
  write_bytes(path, patched(bytes_of(path), 107, std::uint32_t{0}));
  const PointsInput input = read_one(path);
  EXPECT_EQ(input.points_read, 1000);
  ASSERT_EQ(input.warnings.size(), 1U);
  EXPECT_EQ(input.warnings[0].code, "las_count_missing");
}

TEST(BrokenLas, BrokenVlrCountIsSurvivedInPlainFiles) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.las";
  write_points(path, random_cloud(10, 6), {}, {});
  write_bytes(path, patched(bytes_of(path), 100, std::uint32_t{4000000000U}));
  const PointsInput input = read_one(path);
  EXPECT_EQ(input.points_read, 10);
  ASSERT_EQ(input.warnings.size(), 1U);
  EXPECT_EQ(input.warnings[0].code, "las_vlrs_broken");
}

/// As it is stored in LAS 1.4.
std::string wkt_of(const char* crs) {
  const TemporaryFolder folder;
  WritePointsOptions options;
  options.point_format = 6;
  options.crs = crs;
  write_points(folder / "a.las", {}, {}, options);
  const std::string bytes = bytes_of(folder / "a.las");
  const std::size_t begin = bytes.find("PROJC");
  return bytes.substr(begin, bytes.find('\0', begin) + 1 - begin);
}

/// An extended record.
std::string evlr(const std::string& user_id, std::uint16_t record_id, const std::string& data) {
  std::string head(60, '\0');
  head.replace(2, user_id.size(), user_id);
  return patched(patched(head, 18, record_id), 20, std::uint64_t{data.size()}) + data;
}

// What is cut off may be the reference system, without which feet are metres.
TEST(BrokenLas, ExtendedRecordsThatAreLostAreReported) {
  const TemporaryFolder folder;
  const std::string system = evlr("LASF_Projection", 2112, wkt_of("EPSG:28992"));
  WritePointsOptions options;
  options.point_format = 6;
  for (const char* name : {"a.las", "a.laz"}) {
    SCOPED_TRACE(name);
    const fs::path path = folder / name;
    write_points(path, random_cloud(1000, 6), {}, options);
    const std::string points = bytes_of(path);
    const auto with_records = [&](std::uint32_t count, std::uint64_t start,
                                  const std::string& records) {
      write_bytes(path, patched(patched(points, 235, start), 243, count) + records);
      return read_one(path, all_points());
    };
    const PointsInput whole = with_records(1, points.size(), system);
    EXPECT_EQ(whole.crs, "EPSG:28992");
    EXPECT_TRUE(whole.warnings.empty());
    const auto expect_broken = [&](const PointsInput& input, bool has_system) {
      EXPECT_EQ(input.points_read, 1000);
      EXPECT_EQ(input.crs, has_system ? "EPSG:28992" : "");
      ASSERT_EQ(input.warnings.size(), 1U);
      EXPECT_EQ(input.warnings[0].code, "las_vlrs_broken");
      const std::string& message = input.warnings[0].message;
      EXPECT_NE(message.find("extended variable length records"), std::string::npos) << message;
      EXPECT_EQ(message.find("points_crs") == std::string::npos, has_system) << message;
    };
    for (const std::size_t cut :
         {std::size_t{1}, std::size_t{40}, system.size() - 30, system.size()})
      expect_broken(with_records(1, points.size(), system.substr(0, system.size() - cut)), false);
    expect_broken(with_records(2, points.size(), system + evlr("x", 1, "y").substr(0, 60)), true);
    // Not what writers leave behind the end of a name.
    const std::string sloppy = patched(evlr("x", 1, "y"), 4, std::uint16_t{0xCDCD});
    EXPECT_TRUE(with_records(2, points.size(), sloppy + system).warnings.empty());
    // Where the system is given, nothing is lost.
    with_records(1, points.size(), system.substr(0, 100));
    ReadPointsOptions given;
    given.crs = "EPSG:28992";
    expect_broken(read_one(path, given), true);
  }
}

TEST(BrokenLas, FilesWithoutATableOfChunksAreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.laz";
  for (const int format : {1, 6}) {
    SCOPED_TRACE(format);
    WritePointsOptions options;
    options.point_format = format;
    const PointCloud cloud = random_cloud(120'000, 6);  // three chunks
    write_points(path, cloud, {}, options);
    const std::string good = bytes_of(path);
    std::uint32_t first_point = 0;
    std::memcpy(&first_point, good.data() + 96, sizeof first_point);
    std::int64_t place = 0;
    std::memcpy(&place, good.data() + first_point, sizeof place);
    const auto table = static_cast<std::size_t>(place);
    const auto expect_error = [&](const std::string& bytes, const std::string& words) {
      write_bytes(path, bytes);
      const std::string message = read_error(path);
      EXPECT_NE(message.find(words), std::string::npos) << message;
    };
    for (std::size_t size = table + 7; size >= table - 1; --size)
      expect_error(good.substr(0, size),
                   fmt::format("ends at byte {} without its table of chunks", size));
    expect_error(patched(good, table, std::uint32_t{1524}), "the table at byte");
    expect_error(patched(good, table + 4, std::uint32_t{0}), "has 0 chunks for 120000 points");
    // What LASzip leaves if it is stopped before it has written the table.
    expect_error(patched(good, first_point, std::int64_t{first_point}).substr(0, table),
                 "without its table of chunks");
    const std::string no_place = patched(good, first_point, std::int64_t{-1});
    const std::string piped =
        no_place + std::string(reinterpret_cast<const char*>(&place), sizeof place);
    expect_error(piped.substr(0, piped.size() - 8), "without its table of chunks");
    const auto expect_whole = [&](const std::string& bytes) {
      write_bytes(path, bytes);
      const PointsInput input = read_one(path, all_points());
      EXPECT_EQ(input.points.classification, cloud.classification);
      EXPECT_TRUE(input.warnings.empty());
    };
    expect_whole(good);
    expect_whole(piped);
  }
}

TEST(BrokenLas, WithheldBitAndFlagsAboveTheClass) {
  const TemporaryFolder folder;
  for (const int format : {1, 6}) {
    const fs::path path = folder / "a.las";
    PointCloud cloud{{0, 1, 2}, {0, 1, 2}, {0, 0, 0}, {2, 2, 2}};
    WritePointsOptions options;
    options.point_format = format;
    write_points(path, cloud, {}, options);
    std::string bytes = bytes_of(path);
    // Format 1: synthetic and key-point bits on the first, withheld on the second record.
    const std::size_t flags = bytes.size() - 3 * (format == 1 ? 28 : 30) + 15;
    const std::size_t next = format == 1 ? 28 : 30;
    if (format == 1) {
      bytes[flags] = static_cast<char>(0x60 | 2);
      bytes[flags + next] = static_cast<char>(0x80 | 2);
    } else {
      bytes[flags] = 0x0B;  // Synthetic, key point, overlap.
      bytes[flags + next] = 0x04;
    }
    write_bytes(path, bytes);
    const PointsInput input = read_one(path);
    EXPECT_EQ(input.points_read, 3);
    EXPECT_EQ(input.points.x, (Buffer<PointCoordinate>{0, 2}));
    EXPECT_EQ(input.points_by_class, (std::map<int, std::int64_t>{{2, 2}}));
    ReadPointsOptions keep;
    keep.keep_withheld = true;
    EXPECT_EQ(read_one(path, keep).points_kept, 3);
  }
}

/// An entry of the GeoTIFF key directory.
std::string key_entry(std::uint16_t key, std::uint16_t value) {
  const std::array<std::uint16_t, 4> fields{key, 0, 1, value};
  return {reinterpret_cast<const char*>(fields.data()), sizeof fields};
}

TEST(BrokenLas, TellsTheUnitOfHeights) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.las";
  WritePointsOptions options;
  options.crs = "EPSG:28992";
  write_points(path, random_cloud(10, 6), {}, options);
  const std::string bytes = bytes_of(path);
  EXPECT_EQ(inspect_las(path).vertical_unit, 1);
  // The entry for the kind of system (1024), with other keys in its place.
  const std::size_t at = bytes.find(key_entry(1024, 1));
  ASSERT_NE(at, std::string::npos);
  const auto unit_with = [&](std::uint16_t key, std::uint16_t value) {
    write_bytes(path, std::string(bytes).replace(at, 8, key_entry(key, value)));
    return inspect_las(path).vertical_unit;
  };
  EXPECT_EQ(unit_with(4099, 9001), 1);
  EXPECT_NEAR(unit_with(4099, 9002), 0.3048, 1e-12);
  EXPECT_NEAR(unit_with(4099, 9003), 1200.0 / 3937, 1e-12);
  EXPECT_NEAR(unit_with(4096, 6360), 1200.0 / 3937, 1e-12);  // NAVD88 height (ftUS)
  EXPECT_EQ(unit_with(4096, 5703), 1);                       // NAVD88 height
  EXPECT_EQ(unit_with(4096, 32767), 1);
}

/// GeoKeys rule, but where they say nothing of heights, those of a WKT record beside them do.
TEST(BrokenLas, TellsTheUnitOfHeightsOfAWktBesideGeoKeys) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.las";
  WritePointsOptions options;
  options.crs = "EPSG:26910";
  write_points(path, random_cloud(10, 6), {}, options);
  const std::string plain = bytes_of(path);
  const std::string wkt =
      R"(COMPD_CS["x",PROJCS["NAD83 / UTM zone 10N",GEOGCS["NAD83",DATUM["North_American_Datum_1983",)"
      R"(SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],)"
      R"(UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",-123],)"
      R"(PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],)"
      R"(PARAMETER["false_northing",0],UNIT["metre",1]],VERT_CS["NAVD88 height in feet",)"
      R"(VERT_DATUM["North American Vertical Datum 1988",2005],)"
      R"(UNIT["US survey foot",0.304800609601219]]])";
  for (const char* user : {"LASF_Projection", "liblas"}) {
    std::string record(54, '\0');
    std::copy_n(user, std::strlen(user), record.begin() + 2);
    const std::uint16_t id = 2112, length = static_cast<std::uint16_t>(wkt.size());
    std::memcpy(record.data() + 18, &id, 2);
    std::memcpy(record.data() + 20, &length, 2);
    record += wkt;
    std::string bytes = plain;
    std::uint32_t first_point = 0, records = 0;
    std::memcpy(&first_point, bytes.data() + 96, 4);
    std::memcpy(&records, bytes.data() + 100, 4);
    bytes.insert(first_point, record);
    first_point += static_cast<std::uint32_t>(record.size());
    ++records;
    std::memcpy(bytes.data() + 96, &first_point, 4);
    std::memcpy(bytes.data() + 100, &records, 4);
    write_bytes(path, bytes);
    const LasInfo info = inspect_las(path);
    EXPECT_NEAR(info.vertical_unit, 1200.0 / 3937, 1e-9) << user;
    EXPECT_EQ(info.crs, "EPSG:26910") << user;
  }
}

TEST(BrokenLas, HeightsOfSeveralSystemsAreNotMixedWithoutAWord) {
  const TemporaryFolder folder;
  WritePointsOptions options;
  options.crs = "EPSG:28992";
  const auto write = [&](const char* name, std::uint16_t vertical) {
    const fs::path path = folder / name;
    write_points(path, random_cloud(10 + name[0] - 'a', 6), {}, options);
    std::string bytes = bytes_of(path);
    // In the place of the kind of system.
    if (vertical != 0) bytes.replace(bytes.find(key_entry(1024, 1)), 8, key_entry(4096, vertical));
    write_bytes(path, bytes);
    return path;
  };
  const fs::path nap = write("a.las", 5709), none = write("b.las", 0), nap2 = write("c.las", 5709),
                 other = write("d.las", 5621);  // NAP, EVRF2007
  EXPECT_EQ(inspect_las(nap).vertical_crs, "NAP height");
  EXPECT_EQ(inspect_las(none).vertical_crs, "");
  const auto warnings = [&](std::vector<fs::path> paths, const ReadPointsOptions& how = {}) {
    std::vector<Warning> found = read_points(paths, how).warnings;
    std::erase_if(found, [](const Warning& w) { return w.code != "las_heights_mixed"; });
    return found;
  };
  EXPECT_TRUE(warnings({nap, none, nap2}).empty());
  const std::vector<Warning> mixed = warnings({nap, none, nap2, other});
  ASSERT_EQ(mixed.size(), 1U);
  EXPECT_EQ(mixed[0].count, 1);
  for (const char* part : {"a.las", "NAP height", "d.las", "EVRF2007 height"})
    EXPECT_NE(mixed[0].message.find(part), std::string::npos) << mixed[0].message;
  ReadPointsOptions stated;
  stated.crs = "EPSG:28992";
  EXPECT_TRUE(warnings({nap, other}, stated).empty());
  // Codes of GeoTIFF for heights above an ellipsoid (5030: that of WGS 84), and a system of EPSG's.
  for (const std::uint16_t code : {std::uint16_t{5001}, std::uint16_t{5030}, std::uint16_t{4979}}) {
    const fs::path above = write("e.las", code);
    EXPECT_EQ(inspect_las(above).vertical_crs, "ellipsoidal") << code;
    EXPECT_EQ(warnings({nap, above}).size(), 1U) << code;
  }
}

TEST(BrokenLas, BoxesThatLieAreNotTrusted) {
  const TemporaryFolder folder;
  const PointCloud cloud = random_cloud(1000, 6);
  ReadPointsOptions options;
  options.crop = Bounds2{0, 0, 500, 500};
  for (const char* name : {"a.las", "a.laz"}) {
    const fs::path path = folder / name;
    write_points(path, cloud, {}, {});
    const std::string good = bytes_of(path);
    const std::int64_t kept = read_one(path, options).points_kept;
    EXPECT_GT(kept, 800);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    // xmax, xmin, ymax, ymin at bytes 179, 187, 195, 203.
    const std::vector<std::string> lies = {
        patched(good, 187, nan), patched(patched(good, 187, 2e6), 179, 1e6),
        patched(patched(good, 187, 1e6), 179, 2e6), patched(patched(good, 203, -9e5), 195, -8e5)};
    for (const std::string& lie : lies) {
      write_bytes(path, lie);
      const PointsInput input = read_one(path, options);
      EXPECT_EQ(input.points_kept, kept);
      EXPECT_EQ(input.files_skipped, 0);
      ASSERT_EQ(input.warnings.size(), 1U);
      EXPECT_EQ(input.warnings[0].code, "las_box_untrusted");
    }
    // A sound box elsewhere spares the decoding.
    write_bytes(path, good);
    ReadPointsOptions elsewhere;
    elsewhere.crop = Bounds2{600, 0, 700, 500};
    const PointsInput input = read_one(path, elsewhere);
    EXPECT_EQ(input.files_skipped, 1);
    EXPECT_EQ(input.points_read, 0);
    EXPECT_TRUE(input.warnings.empty());
  }
}

TEST(BrokenLas, TruncatedLazFailsWhereverItIsCut) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  const TemporaryFolder scratch;
  const fs::path path = scratch / "cut.laz";
  for (const char* name : {"laspy/simple.laz", "laspy/simple.copc.laz", "laspy/extra.laz",
                           "laspy/1_4_w_evlr.laz", "lazperf/point10.las.laz"}) {
    const std::string bytes = bytes_of(folder / name);
    const PointCloud whole = read_one(folder / name, all_points()).points;
    for (std::size_t size = 1; size < bytes.size(); size += 1 + bytes.size() / 97) {
      SCOPED_TRACE(std::string(name) + " cut at " + std::to_string(size));
      write_bytes(path, bytes.substr(0, size));
      try {
        // Records behind the last point may be missing without harm.
        EXPECT_TRUE(same(read_one(path, all_points()).points, whole));
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kInput);
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos);
      }
    }
  }
  TETROPOLIS_REQUIRE_DATA(tile, "delft_3dfier/ahn3_cropped_2.laz");
  const std::string bytes = bytes_of(tile);
  write_bytes(path, bytes.substr(0, bytes.size() / 2));
  const std::string message = read_error(path);
  EXPECT_NE(message.find("the file is cut"), std::string::npos) << message;
}

TEST(BrokenLas, FlippedBytesNeverCrash) {
  TETROPOLIS_REQUIRE_DATA(folder, "las_samples");
  const unsigned seed = testing::test_seed();
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const TemporaryFolder scratch;
  for (const char* name : {"laspy/simple.laz", "laspy/simple.copc.laz", "laspy/1_4_w_evlr.laz",
                           "laspy/simple.las", "laspy/1_4_w_evlr.las"}) {
    const std::string good = bytes_of(folder / name);
    const fs::path path = scratch / fs::path(name).filename();
    for (int round = 0; round < 150; ++round) {
      std::string bytes = good;
      // Half of the changes hit header and records, where every byte matters.
      const std::size_t reach =
          round % 2 == 0 ? std::min<std::size_t>(bytes.size(), 1200) : bytes.size();
      for (int k = 0; k < 3; ++k) bytes[4 + random() % (reach - 4)] = static_cast<char>(random());
      write_bytes(path, bytes);
      try {
        read_one(path, all_points());
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace tetropolis
