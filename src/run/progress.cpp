#include "tetropolis/run/progress.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "options_of.h"

namespace tetropolis {

namespace {

enum Stage : std::size_t { kInventing, kReading, kTerrain, kBuildings, kMeshing, kWriting };
constexpr std::array<std::string_view, 6> kNames = {"Inventing", "Reading", "Terrain",
                                                    "Buildings", "Meshing", "Writing"};

struct Step {
  std::string_view id;
  std::string_view name;  ///< How it begins.
  Stage stage;
  unsigned commands;
  double weight;        ///< Per cent of the time of runs on Delft, Amsterdam and synthetic cities.
  bool solves = false;  ///< There with uniform layers or a free top only.
};

constexpr unsigned kReaders = kBuild | kCity, kMeshers = kBuild | kMesh;

/// In the order of a run. The last row of a stage takes in what has none of its own.
constexpr std::array kSteps = {
    Step{"0.1", "", kInventing, kSynth, 60},
    Step{"1.2", "", kReading, kReaders | kMesh, 3},
    Step{"1.1", "", kReading, kReaders, 35},
    Step{"1.3", "ground outliers", kTerrain, kReaders, 4},
    Step{"1.3", "", kTerrain, kReaders, 3},
    Step{"1.5", "", kBuildings, kReaders, 4},
    Step{"2.1", "", kBuildings, kReaders, 6},
    Step{"1.7", "", kBuildings, kReaders, 5},
    Step{"1.", "", kBuildings, kReaders, 0.5},
    Step{"2.", "", kBuildings, kReaders, 1.5},
    Step{"3.1", "", kMeshing, kMeshers, 3},
    Step{"3.3", "smooth", kMeshing, kMeshers, 20, true},
    Step{"3.5", "smooth", kMeshing, kMeshers, 20, true},
    Step{"3.5", "improve", kMeshing, kMeshers, 3},
    Step{"3.6", "measure", kMeshing, kMeshers, 11},
    Step{"3.6", "write page", kWriting, kReaders | kMesh, 8},
    Step{"3.6", "write", kWriting, kMeshers, 8},
    Step{"3.", "", kMeshing, kMeshers, 5},
    Step{"0.2", "", kWriting, kSynth, 40},
};

std::size_t find_step(const StepTime& step, unsigned command) {
  const auto found = std::find_if(kSteps.begin(), kSteps.end(), [&](const Step& known) {
    return (known.commands & command) != 0 && step.id.starts_with(known.id) &&
           step.name.starts_with(known.name);
  });
  return static_cast<std::size_t>(found - kSteps.begin());
}

}  // namespace

RunProgress::RunProgress(Command command, const Config& config)
    : command_(command),
      solves_(solves_laplace(mesh_options(config))),
      step_(kSteps.size()),
      done_(kSteps.size(), 0) {
  while ((kSteps[stage_].commands & command) == 0) ++stage_;  // rows so far have a stage each
  stage_ = kSteps[stage_].stage;
}

double RunProgress::weight(std::size_t step) const {
  const Step& known = kSteps[step];
  return (known.commands & command_) != 0 && (!known.solves || solves_) ? known.weight : 0;
}

RunProgress::Ended RunProgress::begin(const StepTime& step) {
  step_ = find_step(step, command_);
  Ended ended;
  if (step_ < kSteps.size() && kSteps[step_].stage > stage_) {
    ended = finish();
    stage_ = kSteps[step_].stage;
    seconds_ = 0;
  }
  update(0);
  return ended;
}

void RunProgress::update(double fraction) {
  // Steps may come again, or have no row of their own: a row never goes back.
  if (step_ < kSteps.size()) done_[step_] = std::max(done_[step_], fraction);
  double before = 0, here = 0, done = 0, all = 0;
  for (std::size_t i = 0; i < kSteps.size(); ++i) {
    all += weight(i);
    if (kSteps[i].stage < stage_) before += weight(i);
    if (kSteps[i].stage != stage_) continue;
    here += weight(i);
    done += weight(i) * done_[i];
  }
  share_ = std::max(share_, (before + std::min(done, here)) / all);
}

void RunProgress::end(const StepTime& step) {
  seconds_ += step.seconds;
  update(1);
}

RunProgress::Ended RunProgress::finish() const { return {stage(), seconds_}; }

std::string_view RunProgress::stage() const { return kNames[stage_]; }

std::string RunProgress::time_left() const {
  constexpr double kLeastShare = 0.02, kLeastSeconds = 0.5;
  const double spent =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (share_ < kLeastShare || spent < kLeastSeconds) return "";
  const double left = spent * (1 - share_) / share_;
  if (left < 100) return fmt::format("{:.0f} s left", std::ceil(left));
  if (left < 6000) return fmt::format("{:.0f} min left", left / 60);
  return fmt::format("{:.1f} h left", left / 3600);
}

}  // namespace tetropolis
