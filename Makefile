# The two commands a newcomer needs are `make demo` and `make test`.
.PHONY: demo test test-quick test-asan fuzz build deps bench microbench survey simplification-report docs format \
  check-format clean

# Only what it needs: the tests take most of a full build.
demo: deps
	@scripts/build release tetropolis_cli
	@echo "demo: a synthetic city of 500 m x 500 m, its LiDAR points, and a mesh of both, in out/demo"
	@rm -rf out/demo out/demo-input
	@build/tetropolis synth --kind blocks --size 500 --seed 7 --out out/demo-input --quiet
	@build/tetropolis build --footprints out/demo-input/footprints.shp --points out/demo-input \
	  --id-attribute id --mesh-size 10 --out out/demo
	@build/tetropolis check out/demo
	@echo "demo: open out/demo/surface.vtp in ParaView, or out/demo/surface.stl in any 3D viewer"

test: build
	@scripts/run-tests build

# Two minutes after a build: without whole runs of the program, faults from outside and counts of work.
test-quick: build
	@scripts/run-tests build -E '^(faults|work)\.|^run\.(Cli|QualityFloor|Fenicsx|survey|CheckMesh|Cities|same_bytes_random|install)'

# Everything under address and undefined-behaviour sanitizers. .ci/run does the suites that find most.
test-asan:
	@scripts/build asan
	@scripts/run-tests build-asan

# make fuzz SECONDS=600 TARGETS="las cityjson"
fuzz:
	@scripts/run-fuzzers $(or $(SECONDS),600) $(TARGETS)

build: deps
	@scripts/build release

deps:
	@scripts/install-deps

bench: build
	@scripts/bench

microbench: build
	@build/bench/tetropolis_bench

# make survey N=200 SEED=1
survey: build
	@scripts/survey $(or $(N),2000) --first $(or $(SEED),1)

# Needs TETROPOLIS_DATA, the folder of real data.
simplification-report: build
	@scripts/simplification-report --update

docs: build
	@scripts/write-reference-pages

format:
	@scripts/format

check-format:
	@scripts/format --check
	@scripts/check-includes
	@scripts/check-layers
	@scripts/check-links

clean:
	rm -rf build build-* out
