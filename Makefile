# The two commands a newcomer needs are `make demo` and `make test`.
.PHONY: demo python-env test test-quick test-asan fuzz build deps bench microbench survey simplification-report docs site \
  format check-format check-viewer viewer package clean

# CITY=synthetic meshes an invented city instead.
CITY = delft
demo:
	@scripts/demo $(CITY)

test: python-env build
	@scripts/run-tests build

# Packages of Python that tests read results with, and that the Python package is built and tested with.
python-env:
	@{ scripts/install-deps python && scripts/python-env; } || echo "make: tests in Python will be skipped"

# Two minutes after a build: without whole runs of the program, faults from outside and counts of work.
test-quick: build
	@scripts/run-tests build -E '^(faults|work)\.|^run\.(Cli|QualityFloor|Fenicsx|survey|CheckMesh|Cities|same_bytes_random|install)|^python\.notebook'

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

# The page of src/io/page. check-viewer: what is in the repository is what its sources make.
viewer:
	@scripts/build-viewer

check-viewer:
	@scripts/build-viewer --check

docs: build
	@scripts/write-reference-pages

site:
	@scripts/site

# A Debian package of the program, and one of the library.
package:
	@scripts/install-deps package
	@scripts/build package
	@cd build-package && cpack -G DEB >/dev/null && ls $$PWD/*.deb

format:
	@scripts/format

check-format:
	@scripts/format --check
	@scripts/check-includes
	@scripts/check-layers
	@scripts/check-names
	@scripts/check-links

clean:
	rm -rf build build-* out
