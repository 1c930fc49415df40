"""Runs of the program, what they report, and medians over them."""
import ctypes.util
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import time

# A case is run again until its runs have taken this long in all, seconds.
CASE_BUDGET = 25


class BenchError(Exception):
    """Something that ends the benchmark with one line."""


class Bench:
    """The programs, a scratch folder, and every run made so far."""

    def __init__(self, build, scratch, repeat, say):
        self.build = pathlib.Path(build)
        self.program = self.build / "tetropolis"
        if not self.program.exists():
            raise BenchError(f"{self.program} is missing; run make build, or name a build folder with --build")
        self.scratch = pathlib.Path(scratch)
        self.repeat = repeat
        self.say = say
        self.seen = {}
        shutil.rmtree(self.scratch, ignore_errors=True)
        self.scratch.mkdir(parents=True)

    def close(self):
        shutil.rmtree(self.scratch, ignore_errors=True)

    def run_once(self, arguments):
        """Runs the program and returns its report, with the process's wall time added. The result goes into a
        new folder: ext4 begins at once to put files that replace others on the disk."""
        out = self.scratch / "result"
        shutil.rmtree(out, ignore_errors=True)
        command = [str(self.program), *map(str, arguments), "--out", str(out), "--quiet"]
        os.sync()  # What an earlier run has left to be written would slow this one down.
        begin = time.monotonic()
        process = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        wall = time.monotonic() - begin
        if process.returncode != 0:
            raise BenchError(f"{' '.join(command)} failed: {process.stderr.strip()}")
        report = json.loads((out / "report.json").read_text())
        report["wall"] = wall
        report["bytes_written"] = sum(f.stat().st_size for f in out.iterdir() if f.is_file())
        return report

    def case(self, arguments, repeat=None):
        """The median run of a case: the same as an earlier one if it was asked for before."""
        key = tuple(map(str, arguments))
        if key not in self.seen:
            self.say(" ".join(key).replace(str(self.scratch) + os.sep, ""))
            runs = []
            begin = time.monotonic()
            while len(runs) < (repeat or self.repeat):
                runs.append(self.run_once(arguments))
                if time.monotonic() - begin > CASE_BUDGET:
                    break
            self.seen[key] = median_of(runs)
        return self.seen[key]

    def city(self, buildings, size=2500, density=1, options=()):
        """City model and terrain of a random city; the folder they are in, and the report."""
        folder = self.scratch / f"city-{buildings}-{size}"
        case = ["city", *self.inputs(self.synth(buildings, size, density)), *options]
        if not folder.exists():
            self.seen.pop(tuple(map(str, case)), None)  # whatever ran last left its result there
        row = self.case(case)
        if not folder.exists():
            (self.scratch / "result").rename(folder)
        return folder, row

    def synth(self, buildings, size=2500, density=1):
        """Footprints and points of a random city; the folder they are in."""
        folder = self.scratch / f"input-{buildings}-{size}"
        if not folder.exists():
            self.run_once(["synth", "--buildings", buildings, "--size", size, "--point-density", density])
            (self.scratch / "result").rename(folder)
        return folder

    @staticmethod
    def inputs(source):
        return ["--footprints", source / "footprints.shp", "--points", source / "points.laz",
                "--lod", "block"]  # as in the paper

    def mesh(self, folder, mesh_size, layering="graded", threads=0, repeat=None):
        """Step 3 on a folder made by city()."""
        return self.case(["mesh", "--city", folder / "city.city.json", "--dtm", folder / "dtm.tif",
                          "--mesh-size", mesh_size, "--layering", layering, "--threads", threads], repeat)

    def microbenchmarks(self, pattern):
        """Google benchmarks whose names match: name -> its JSON."""
        program = self.build / "bench" / "tetropolis_bench"
        if not program.exists():
            raise BenchError(f"{program} is missing; configure with -DTETROPOLIS_BENCH=ON")
        self.say(f"microbenchmarks {pattern}")
        process = subprocess.run(
            [str(program), f"--benchmark_filter={pattern}", "--benchmark_format=json",
             f"--benchmark_repetitions={self.repeat}"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            env={**os.environ, "TMPDIR": str(self.scratch)})
        if process.returncode != 0:
            raise BenchError(f"{program} failed")
        return {b["run_name"]: b for b in json.loads(process.stdout)["benchmarks"]
                if b.get("aggregate_name", "median") == "median"}

    def plain_laszip(self, path, threads):
        """Processor seconds that decoding every point of a file with LASzip alone takes one thread, while as
        many do the same."""
        program = self.build / "bench" / "laszip_read"
        done = subprocess.run([str(program), str(path), str(threads)], stdout=subprocess.PIPE, text=True, check=True)
        return float(done.stdout.split()[1])

    def empty_process(self):
        """Wall seconds of a run that loads the libraries a build does, and does nothing."""
        begin = time.monotonic()
        subprocess.run([str(self.program), "--version"], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "LD_PRELOAD": ctypes.util.find_library("gdal") or ""})
        return time.monotonic() - begin

    def disk_speed(self, size, sync, turns=None):
        """Bytes per second of dd writing a file of `size` bytes, waiting for the disk if `sync`."""
        target = self.scratch / "dd"
        speeds = []
        for _ in range(turns or max(3, self.repeat)):
            os.sync()
            begin = time.monotonic()
            subprocess.run(["dd", "if=/dev/zero", f"of={target}", "bs=1M", f"count={max(1, size >> 20)}",
                            *(["conv=fsync"] if sync else [])], check=True, stderr=subprocess.DEVNULL)
            speeds.append(size / (time.monotonic() - begin))
            target.unlink()
        return statistics.median(speeds)


def median_of(runs):
    """One flat row for several reports of the same case: medians of times, the rest from the last."""
    last = runs[-1]

    def median(value):
        return statistics.median(value(r) for r in runs)

    row = {"runs": len(runs), "threads": last["threads"], "wall_s": median(lambda r: r["wall"]),
           "peak_bytes": max(r["peak_rss_bytes"] for r in runs), "bytes_written": last["bytes_written"]}
    # The parts of a step have entries of their own with its id.
    for step_id in {step["id"]: None for step in last["steps"]}:
        def spent(report, key):
            return sum(s[key] for s in report["steps"] if s["id"] == step_id)

        row[f"s_{step_id}"] = median(lambda r: spent(r, "seconds"))
        row[f"cpu_{step_id}"] = median(lambda r: spent(r, "cpu_seconds"))
    if "volume_mesh" in last:
        row["triangles"] = last["ground_mesh"]["triangles"]
        row["cells"] = last["volume_mesh"]["cells"]
        row["s_3.1_to_3.5"] = median(lambda r: sum(s["seconds"] for s in r["steps"]
                                                   if s["id"][0] == "3" and s["id"] != "3.6"))
        for solve in last["solver"]:
            row[f"iterations_{solve['step']}"] = solve["iterations"]
    if "city" in last and last["city"]:
        row["raw_buildings"] = last["city"].get("raw_buildings")
        row["buildings_after"] = last["city"].get("buildings")
    return row
