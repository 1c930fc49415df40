// A small synthetic city, built: what other programs are given to read.
#pragma once

#include <string>

#include "tetropolis/run/run.h"

#include "support/test_data.h"

namespace tetropolis::testing {

/// Builds a city of blocks of 300 m into `folder`/result, with meshes in `format`.
inline Report build_blocks(const TemporaryFolder& folder, const std::string& format) {
  Config synth;
  synth.kind = SynthKind::kBlocks;
  synth.size = 300;
  synth.out = folder / "input";
  run_synth(synth);
  Config build;
  build.footprints = {folder / "input/footprints.shp"};
  build.points.push_back(folder / "input/points.laz");
  build.formats = {format};
  build.out = folder / "result";
  return run_build(build);
}

}  // namespace tetropolis::testing
