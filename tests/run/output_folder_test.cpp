#include "tetropolis/run/output_folder.h"

#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tetropolis/core/error.h"

#include "support/bytes.h"
#include "support/errors.h"
#include "support/test_data.h"

namespace tetropolis {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;

std::set<std::string> everything(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    names.insert(fs::relative(entry.path(), folder).string());
  return names;
}

TEST(OutputFolder, AppearsWhenCommittedAndNotBefore) {
  const testing::TemporaryFolder scratch;
  {
    OutputFolder out(scratch / "a/b/result");
    std::ofstream(out / "x.txt") << "x";
    EXPECT_FALSE(fs::exists(scratch / "a/b/result"));
    out.commit();
  }
  EXPECT_EQ(everything(scratch.path()),
            (std::set<std::string>{"a", "a/b", "a/b/result", "a/b/result/x.txt"}));
}

TEST(OutputFolder, LeavesNothingWithoutCommit) {
  const testing::TemporaryFolder scratch;
  {
    OutputFolder out(scratch / "a/b/result");
    std::ofstream(out / "x.txt") << "x";
  }
  EXPECT_TRUE(everything(scratch.path()).empty());
}

TEST(OutputFolder, KeepsAnEarlierResultUntilCommit) {
  const testing::TemporaryFolder scratch;
  fs::create_directory(scratch / "result");
  std::ofstream(scratch / "result/x.txt") << "old";
  std::ofstream(scratch / "result/notes.txt") << "mine";
  {
    OutputFolder out(scratch / "result");
    std::ofstream(out / "x.txt") << "half";
  }
  EXPECT_EQ(bytes_of(scratch / "result/x.txt"), "old");
  {
    OutputFolder out(scratch / "result/", {}, Replaces::kAll, true);
    std::ofstream(out / "x.txt") << "new";
    std::ofstream(out / "report.json") << "{}";
    out.commit();
  }
  EXPECT_EQ(bytes_of(scratch / "result/x.txt"), "new");
  EXPECT_EQ(bytes_of(scratch / "result/notes.txt"), "mine");
  EXPECT_EQ(
      everything(scratch.path()),
      (std::set<std::string>{"result", "result/x.txt", "result/notes.txt", "result/report.json"}));
}

TEST(OutputFolder, AResultThatIsGoneAtTheEndIsNoResult) {
  for (const bool earlier : {false, true})
    for (const char* gone : {"x.txt", "sub/y.txt"}) {
      SCOPED_TRACE(gone);
      const testing::TemporaryFolder scratch;
      if (earlier) {
        fs::create_directory(scratch / "result");
        std::ofstream(scratch / "result/x.txt") << "old";
      }
      {
        OutputFolder out(scratch / "result");
        std::ofstream(out.result("x.txt", {"sub/y.txt"})) << "new";
        fs::create_directory(out / "sub");
        std::ofstream(out / "sub/y.txt") << "comes with it";
        std::ofstream(out.result("report.json")) << "{}";
        fs::remove(out / gone);
        const std::string message = testing::error_of([&] { out.commit(); }, ErrorKind::kInput);
        EXPECT_NE(message.find(std::string(gone) + ": cannot be written: it is gone"),
                  std::string::npos)
            << message;
      }
      EXPECT_EQ(
          everything(scratch.path()),
          (earlier ? std::set<std::string>{"result", "result/x.txt"} : std::set<std::string>{}));
    }
}

TEST(OutputFolder, FoldersWithTheNameOfAResultAreNotReplaced) {
  const testing::TemporaryFolder scratch;
  fs::create_directories(scratch / "result/volume.vtu");
  EXPECT_THROW(OutputFolder(scratch / "result"), Error);
  fs::remove(scratch / "result/volume.vtu");
  {
    OutputFolder out(scratch / "result");
    std::ofstream(out / "x.txt") << "new";
    fs::create_directory(scratch / "result/x.txt");
    EXPECT_THROW(out.commit(), Error);
  }
  EXPECT_EQ(everything(scratch.path()), (std::set<std::string>{"result", "result/x.txt"}));
  EXPECT_TRUE(fs::is_directory(scratch / "result/x.txt"));
}

TEST(OutputFolder, RefusesWhatCannotBeAFolder) {
  const testing::TemporaryFolder scratch;
  std::ofstream(scratch / "file") << "x";
  EXPECT_THROW(OutputFolder(scratch / "file"), Error);
  EXPECT_THROW(OutputFolder(scratch / "file/inside"), Error);
  EXPECT_THROW(OutputFolder(""), Error);
  // Folders made on the way to one that cannot be made are gone again.
  EXPECT_THROW(OutputFolder(scratch / "a/b" / std::string(300, 'c') / "d"), Error);
  EXPECT_THROW(OutputFolder(scratch / "a/b" / std::string(300, 'c')), Error);
  EXPECT_EQ(everything(scratch.path()), (std::set<std::string>{"file"}));
}

constexpr const char* kReport = R"({"version": "0", "command": "build", "steps": [], "files":
    ["dtm.tif", "volume.vtu", "volume.msh", "constant/polyMesh/points", "../elsewhere"]})";

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

TEST(OutputFolder, OnlyAnEarlierRunLeavesLeftovers) {
  for (const bool ours : {false, true}) {
    SCOPED_TRACE(ours);
    const testing::TemporaryFolder scratch;
    write(scratch / "result/report.json", ours ? kReport : R"({"mine": 1})");
    write(scratch / "result/volume.msh", "old");
    write(scratch / "result/constant/polyMesh/points", "old");
    write(scratch / "result/constant/polyMesh/notes", "mine");
    OutputFolder out(scratch / "result", {}, Replaces::kAll, !ours);
    write(out / "surface.stl", "new");
    write(out / "report.json", kReport);
    out.commit();
    std::set<std::string> expected{"report.json", "surface.stl", "constant", "constant/polyMesh",
                                   "constant/polyMesh/notes"};
    if (!ours) expected.insert({"volume.msh", "constant/polyMesh/points"});
    EXPECT_EQ(everything(scratch / "result"), expected);
  }
}

/// Neither before the work nor, if they come during it, after it.
TEST(OutputFolder, ReplacesNobodysFiles) {
  for (const char* name : {"report.json", "surface.stl", "constant/polyMesh/points"})
    for (const bool reported : {false, true}) {
      SCOPED_TRACE(name);
      const testing::TemporaryFolder scratch;
      const bool is_report = name == std::string("report.json");
      if (reported && !is_report)
        write(scratch / "result/report.json",
              R"({"version": "0", "command": "build", "steps": [], "files": ["dtm.tif"]})");
      write(scratch / "result" / name, "mine");
      const auto before = everything(scratch.path());
      const auto refused = [&](const auto& act) {
        const std::string message = testing::error_of(act, ErrorKind::kUsage);
        EXPECT_NE(message.find(std::string("result/") + name + ": "), std::string::npos);
        EXPECT_NE(message.find("`overwrite`"), std::string::npos) << message;
      };
      {
        OutputFolder out(scratch / "result");
        out.require_free({"volume.vtu"});
        refused([&] { out.require_free({"volume.vtu", name}); });
        write(out / name, "new");
        if (!is_report) write(out / "report.json", kReport);
        refused([&] { out.commit(); });
      }
      EXPECT_EQ(everything(scratch.path()), before);
      EXPECT_EQ(bytes_of(scratch / "result" / name), "mine");
      OutputFolder out(scratch / "result", {}, Replaces::kAll, true);
      out.require_free({name});
      write(out / name, "new");
      if (!is_report) write(out / "report.json", kReport);
      out.commit();
      EXPECT_EQ(bytes_of(scratch / "result" / name), "new");
    }
}

/// Made by another program from a result of ours, say.
TEST(OutputFolder, WhatNoRunHasWrittenStays) {
  const testing::TemporaryFolder scratch;
  write(scratch / "result/report.json", kReport);
  write(scratch / "result/volume.vtu", "old");
  write(scratch / "result/surface.ply", "mine");
  write(scratch / "result/volume.h5", "mine");
  OutputFolder out(scratch / "result");
  write(out / "report.json", kReport);
  out.commit();
  EXPECT_EQ(everything(scratch / "result"),
            (std::set<std::string>{"report.json", "surface.ply", "volume.h5"}));
}

/// Of an earlier run what this one reads stays, and is told of with what it writes.
TEST(OutputFolder, TellsWhichFilesAreResults) {
  const testing::TemporaryFolder scratch;
  write(scratch / "result/report.json", kReport);
  for (const char* name : {"dtm.tif", "volume.vtu", "mine.tif"})
    write(scratch / "result" / name, "old");
  write(scratch / "elsewhere", "mine");
  OutputFolder out(scratch / "result");
  for (const char* name : {"dtm.tif", "mine.tif"}) out.keep(scratch / "result" / name);
  write(out / "surface.stl", "new");
  write(out / "constant/polyMesh/faces", "new");
  EXPECT_EQ(out.files(),
            (std::vector<std::string>{"constant/polyMesh/faces", "dtm.tif", "surface.stl"}));
  write(out / "report.json", kReport);
  out.commit();
  EXPECT_TRUE(fs::exists(scratch / "elsewhere"));
  EXPECT_EQ(everything(scratch / "result"),
            (std::set<std::string>{"constant", "constant/polyMesh", "constant/polyMesh/faces",
                                   "dtm.tif", "mine.tif", "report.json", "surface.stl"}));
}

TEST(OutputFolder, ModelsReplaceModelsAndLeaveDataThatIsListedWithThem) {
  const testing::TemporaryFolder scratch;
  const std::string report =
      R"({"version": "", "command": "", "steps": [], "files": ["dtm.tif", "points.laz"]})";
  write(scratch / "result/report.json", report);
  for (const char* name : {"dtm.tif", "points.laz"}) write(scratch / "result" / name, "old");
  {
    OutputFolder out(scratch / "result", {}, Replaces::kModels);
    write(out / "surface.stl", "new");
    EXPECT_EQ(out.files(), (std::vector<std::string>{"points.laz", "surface.stl"}));
    write(out / "report.json", report);
    out.commit();
  }
  EXPECT_EQ(everything(scratch / "result"),
            (std::set<std::string>{"points.laz", "report.json", "surface.stl"}));
  OutputFolder out(scratch / "result");
  write(out / "report.json", report);
  out.commit();
  EXPECT_EQ(everything(scratch / "result"), (std::set<std::string>{"report.json", "surface.stl"}));
}

/// The hidden folder has a longer one, which would be too long.
TEST(OutputFolder, MayHaveTheLongestNameThereIs) {
  const testing::TemporaryFolder scratch;
  const std::string name(251, 'a');
  for (const std::string& end : {std::string("bcde"), std::string("\u00e9\u00e8")}) {
    for (int run = 0; run < 2; ++run) {
      OutputFolder out(scratch / (name + end));
      write(out / "report.json", kReport);
      out.commit();
    }
    EXPECT_EQ(everything(scratch / (name + end)), (std::set<std::string>{"report.json"}));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch.path()), fs::directory_iterator()), 2);
}

TEST(OutputFolder, EmptyFoldersOfAnEarlierResultGo) {
  const testing::TemporaryFolder scratch;
  write(scratch / "result/report.json", kReport);
  write(scratch / "result/constant/polyMesh/points", "old");
  OutputFolder out(scratch / "result");
  write(out / "report.json", kReport);
  out.commit();
  EXPECT_EQ(everything(scratch / "result"), (std::set<std::string>{"report.json"}));
}

TEST(OutputFolder, InputsOfTheRunStay) {
  const testing::TemporaryFolder scratch;
  const auto fill = [&] {
    write(scratch / "result/report.json", kReport);
    write(scratch / "result/dtm.tif", "input");
    write(scratch / "result/constant/polyMesh/points", "old");
  };
  fill();
  {
    OutputFolder out(scratch / "result");
    out.keep(scratch / "result/../result/dtm.tif");
    out.keep(scratch / "elsewhere.tif");
    write(out / "report.json", kReport);
    out.commit();
  }
  EXPECT_EQ(everything(scratch / "result"), (std::set<std::string>{"report.json", "dtm.tif"}));
  EXPECT_EQ(bytes_of(scratch / "result/dtm.tif"), "input");
  fill();
  const std::set<std::string> before = everything(scratch.path());
  {
    OutputFolder out(scratch / "result");
    out.keep(scratch / "result/dtm.tif");
    write(out / "dtm.tif", "result");
    write(out / "report.json", kReport);
    EXPECT_THROW(out.commit(), Error);
  }
  EXPECT_EQ(everything(scratch.path()), before);
  EXPECT_EQ(bytes_of(scratch / "result/dtm.tif"), "input");
}

TEST(OutputFolder, InputsThatAreLinksStay) {
  const testing::TemporaryFolder scratch;
  write(scratch / "result/report.json", kReport);
  write(scratch / "terrain.tif", "input");
  fs::create_symlink("../terrain.tif", scratch / "result/dtm.tif");
  fs::create_directory_symlink("result", scratch / "other name");
  write(scratch / "result/volume.vtu", "old");
  {
    OutputFolder out(scratch / "result");
    out.keep(scratch / "other name/dtm.tif");
    write(out / "report.json", kReport);
    out.commit();
  }
  EXPECT_FALSE(fs::exists(scratch / "result/volume.vtu"));
  EXPECT_TRUE(fs::is_symlink(scratch / "result/dtm.tif"));
  EXPECT_EQ(bytes_of(scratch / "result/dtm.tif"), "input");
}

TEST(OutputFolder, HasTheUsualPermissions) {
  const testing::TemporaryFolder scratch;
  fs::create_directory(scratch / "usual");
  OutputFolder out(scratch / "result");
  std::ofstream(out / "report.json") << "{}";
  out.commit();
  EXPECT_EQ(fs::status(scratch / "result").permissions(),
            fs::status(scratch / "usual").permissions());
}

}  // namespace
}  // namespace tetropolis
