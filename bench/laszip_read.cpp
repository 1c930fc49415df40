// Decodes every point of a LAS or LAZ file with plain LASzip calls and does nothing with them: the
// least that reading it can take. Prints points and processor seconds.
//
//   laszip_read FILE [THREADS]
//
// With several threads (default 1) each reads the whole file for itself, and the seconds are those
// of one of them: LASzip reads bytes through stdio, which takes locks in such a program.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <thread>
#include <vector>

#include <laszip/laszip_api.h>

namespace {

/// What one thread read; -1 points if LASzip failed.
struct Reading {
  std::int64_t points = -1;
  double seconds = 0;
};

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::int64_t read_points(laszip_POINTER reader, const char* path) {
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

Reading read_all(const char* path) {
  Reading reading;
  laszip_POINTER reader = nullptr;
  if (laszip_create(&reader) != 0) return reading;
  const double begin = thread_seconds();
  reading.points = read_points(reader, path);
  reading.seconds = thread_seconds() - begin;
  laszip_destroy(reader);
  return reading;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::fprintf(stderr, "usage: laszip_read FILE [THREADS]\n");
    return 2;
  }
  const int count = argc == 3 ? std::atoi(argv[2]) : 1;
  std::vector<Reading> readings(count > 1 ? static_cast<std::size_t>(count) : 1);
  // The first thread of all reads, too: with one there is no other, and no lock.
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < readings.size(); ++i)
    others.emplace_back([&readings, i, argv] { readings[i] = read_all(argv[1]); });
  readings[0] = read_all(argv[1]);
  for (std::thread& other : others) other.join();
  double seconds = 0;
  for (const Reading& reading : readings) {
    if (reading.points < 0) {
      std::fprintf(stderr, "laszip_read: LASzip cannot read %s\n", argv[1]);
      return 3;
    }
    seconds += reading.seconds / static_cast<double>(readings.size());
  }
  std::printf("%lld %.6f\n", static_cast<long long>(readings[0].points), seconds);
  return 0;
}
