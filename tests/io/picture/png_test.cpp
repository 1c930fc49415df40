#include "tetropolis/io/picture/png.h"

#include <cstddef>
#include <memory>
#include <random>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "support/bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

using testing::bytes_of;
using testing::TemporaryFolder;

/// Half noise, half a gradient, so that every filter is best somewhere.
Picture picture_of(int width, int height) {
  std::mt19937 random(testing::test_seed());
  Picture picture{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        picture.rgb.push_back(static_cast<std::uint8_t>(
            x < width / 2 ? random() % 256 : (x * (c + 1) + 2 * y) % 256));
  return picture;
}

TEST(Png, IsReadBackByGdal) {
  if (GetGDALDriverManager()->GetDriverByName("PNG") == nullptr) GDALAllRegister();
  if (GetGDALDriverManager()->GetDriverByName("PNG") == nullptr) GTEST_SKIP() << "no PNG in GDAL";
  const TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 5}, std::pair{300, 200}}) {
    const Picture picture = picture_of(width, height);
    const auto path = folder / "picture.png";
    write_png(path, picture);
    const std::unique_ptr<GDALDataset> read(
        GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR));
    ASSERT_TRUE(read);
    ASSERT_EQ(read->GetRasterXSize(), width);
    ASSERT_EQ(read->GetRasterYSize(), height);
    ASSERT_EQ(read->GetRasterCount(), 3);
    std::vector<std::uint8_t> rgb(picture.rgb.size());
    ASSERT_EQ(read->RasterIO(GF_Read, 0, 0, width, height, rgb.data(), width, height, GDT_Byte, 3,
                             nullptr, 3, 3 * static_cast<GSpacing>(width), 1, nullptr),
              CE_None);
    EXPECT_EQ(rgb, picture.rgb) << "seed " << testing::test_seed();
  }
}

TEST(Png, ReplacesPicturesOnly) {
  const TemporaryFolder folder;
  const auto path = folder / "notes";
  testing::write_bytes(path, "mine");
  const std::string message =
      testing::input_error(path, [&] { write_png(path, picture_of(4, 4)); });
  EXPECT_NE(message.find("no PNG"), std::string::npos) << message;
  EXPECT_EQ(bytes_of(path), "mine");
  const auto picture = folder / "picture.png";
  write_png(picture, picture_of(4, 4));
  const std::string before = bytes_of(picture);
  write_png(picture, picture_of(5, 4));
  EXPECT_NE(bytes_of(picture), before);
}

}  // namespace
}  // namespace tetropolis
