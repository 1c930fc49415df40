// Decodes every point of a LAS or LAZ file with plain LASzip calls on one thread and does nothing
// with them: the least that reading it can take. Prints points and processor seconds.
//
//   laszip_read FILE
#include <cstdint>
#include <cstdio>
#include <ctime>

#include <laszip/laszip_api.h>

namespace {

/// Points read, or -1 if LASzip fails.
std::int64_t read_all(laszip_POINTER reader, const char* path) {
  laszip_BOOL compressed = 0;
  if (laszip_open_reader(reader, path, &compressed) != 0) return -1;
  laszip_header* header = nullptr;
  laszip_get_header_pointer(reader, &header);
  const std::int64_t count =
      header->number_of_point_records != 0
          ? static_cast<std::int64_t>(header->number_of_point_records)
          : static_cast<std::int64_t>(header->extended_number_of_point_records);
  for (std::int64_t i = 0; i < count; ++i)
    if (laszip_read_point(reader) != 0) return -1;
  laszip_close_reader(reader);
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: laszip_read FILE\n");
    return 2;
  }
  laszip_POINTER reader = nullptr;
  if (laszip_create(&reader) != 0) return 1;
  const std::clock_t begin = std::clock();
  const std::int64_t count = read_all(reader, argv[1]);
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  laszip_destroy(reader);
  if (count < 0) {
    std::fprintf(stderr, "laszip_read: LASzip cannot read %s\n", argv[1]);
    return 3;
  }
  std::printf("%lld %.6f\n", static_cast<long long>(count), seconds);
  return 0;
}
