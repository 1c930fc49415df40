// What step 3.6 consists of: measuring the cells and the faces, extracting and checking the
// boundary, and the files. On the random city of 3,096 buildings with a mesh size of 10 m.
//
// Files go to a folder in TMPDIR (default /tmp) and are removed.
#include <filesystem>
#include <functional>
#include <string>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include "tetropolis/core/threads.h"
#include "tetropolis/io/mesh/stl.h"
#include "tetropolis/io/mesh/vtk.h"
#include "tetropolis/io/mesh/xdmf.h"
#include "tetropolis/volume/column/boundary.h"

#include "random_city.h"
#include "volume/quality/measured_mesh.h"

namespace {

using namespace tetropolis;
namespace fs = std::filesystem;

constexpr std::int64_t kBuildings = 3096;
constexpr double kMeshSize = 10;

/// Made at first use.
const ColumnMesh& city_mesh() {
  static const ColumnMesh mesh = mesh_of(random_city_input(kBuildings), kMeshSize);
  return mesh;
}

const SurfaceMesh& city_boundary() {
  static const SurfaceMesh boundary = extract_boundary(city_mesh());
  return boundary;
}

/// Runs `body` with as many threads as the benchmark's argument says; counts cells per second.
/// `prepare` runs before each time and is not timed.
template <typename Body, typename Prepare>
void run(benchmark::State& state, const Body& body, const Prepare& prepare) {
  const auto cells = static_cast<double>(cell_offsets(city_mesh()).back().value());
  city_boundary();
  const ThreadLimit limit(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    state.PauseTiming();
    prepare();
    state.ResumeTiming();
    body();
  }
  state.counters["cells"] = cells;
  state.counters["cells/s"] =
      benchmark::Counter(cells, benchmark::Counter::kIsIterationInvariantRate);
}

template <typename Body>
void run(benchmark::State& state, const Body& body) {
  run(state, body, [] {});
}

/// Waits until the disk has the files of a folder.
void sync_files(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const int file = ::open(entry.path().c_str(), O_RDONLY | O_CLOEXEC);
    ::fsync(file);
    ::close(file);
  }
}

/// The same with files to write, into a new folder each time, whose size is counted too. They
/// replace none, as in a first run: one that replaces another ext4 begins to put on the disk at the
/// rename. Where the second argument is 1, the disk is waited for.
template <typename Write>
void run_writer(benchmark::State& state, const std::string& name, const Write& write) {
  const fs::path folder =
      fs::temp_directory_path() / ("tetropolis_bench_" + std::to_string(::getpid()));
  const auto empty = [&] {
    fs::remove_all(folder);
    fs::create_directory(folder);
  };
  const bool sync = state.range(1) != 0;
  run(
      state,
      [&] {
        write(folder / name);
        if (sync) sync_files(folder);
      },
      empty);
  double bytes = 0;
  for (const auto& file : fs::directory_iterator(folder))
    bytes += static_cast<double>(file.file_size());
  fs::remove_all(folder);
  state.counters["bytes"] = bytes;
  state.counters["bytes/s"] =
      benchmark::Counter(bytes, benchmark::Counter::kIsIterationInvariantRate);
}

void step_3_6_measure(benchmark::State& state) {
  run(state, [] { benchmark::DoNotOptimize(measure_quality(city_mesh(), 10)); });
}

void step_3_6_extract_boundary(benchmark::State& state) {
  run(state, [] { benchmark::DoNotOptimize(extract_boundary(city_mesh())); });
}

void step_3_6_check_topology(benchmark::State& state) {
  run(state, [] { benchmark::DoNotOptimize(check_topology(city_boundary())); });
}

void step_3_6_write_vtu(benchmark::State& state) {
  run_writer(state, "volume.vtu", [](const fs::path& path) { write_vtu(path, city_mesh(), {}); });
}

void step_3_6_write_xdmf(benchmark::State& state) {
  run_writer(state, "volume.xdmf", [](const fs::path& path) {
    write_xdmf(path, path.parent_path() / "boundary.xdmf", city_mesh(), city_boundary(), {});
  });
}

void step_3_6_write_vtp(benchmark::State& state) {
  run_writer(state, "boundary.vtp",
             [](const fs::path& path) { write_vtp(path, city_boundary(), {}); });
}

void step_3_6_write_stl(benchmark::State& state) {
  run_writer(state, "boundary.stl",
             [](const fs::path& path) { write_stl(path, city_surface(city_boundary()), {}); });
}

/// One thread, then two.
void threads(benchmark::internal::Benchmark* bench) {
  bench->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
}

void threads_and_sync(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"threads", "sync"})->ArgsProduct({{1, 2}, {0, 1}});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(step_3_6_measure)->Apply(threads);
BENCHMARK(step_3_6_extract_boundary)->Apply(threads);
BENCHMARK(step_3_6_check_topology)->Apply(threads);
BENCHMARK(step_3_6_write_vtu)->Apply(threads_and_sync);
BENCHMARK(step_3_6_write_xdmf)->Apply(threads_and_sync);
BENCHMARK(step_3_6_write_vtp)->Apply(threads_and_sync);
BENCHMARK(step_3_6_write_stl)->Apply(threads_and_sync);

}  // namespace
