"""What the measurements were made on, and with."""
import datetime
import os
import pathlib
import platform
import re
import subprocess
import time


def first_line(command):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    except OSError:
        return "unknown"
    return done.stdout.split("\n")[0].strip() or "unknown"


def describe(build):
    """Name -> value, in the order to show them; no paths of this machine."""
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    memory = re.search(r"MemTotal:\s*(\d+)", pathlib.Path("/proc/meminfo").read_text())
    release = re.search(r'PRETTY_NAME="(.*)"', pathlib.Path("/etc/os-release").read_text())
    cache = (pathlib.Path(build) / "CMakeCache.txt").read_text()

    def cached(name):
        found = re.search(rf"^{name}:\w+=(.*)$", cache, re.M)
        return found.group(1) if found else ""

    kind = cached("CMAKE_BUILD_TYPE")
    root = pathlib.Path(__file__).resolve().parents[2]
    commit = first_line(["git", "-C", str(root), "describe", "--always", "--dirty"])
    return {
        "processor": f"{cpu.group(1) if cpu else platform.machine()}, {os.cpu_count()} cores",
        "memory": f"{int(memory.group(1)) / 1e6:.0f} GB" if memory else "unknown",
        "system": f"{release.group(1) if release else 'unknown'}, Linux {platform.release().split('-')[0]}",
        "compiler": first_line([cached("CMAKE_CXX_COMPILER"), "--version"]),
        "flags": f"{kind}: {cached('CMAKE_CXX_FLAGS')} {cached('CMAKE_CXX_FLAGS_' + kind.upper())}".replace("  ", " "),
        "version": f"{(root / 'VERSION').read_text().strip()} ({commit})",
    }


def load(seconds=2):
    """Processors that others keep busy, while we wait. The load average would count the study before."""
    def busy():
        times = [int(t) for t in pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]]
        return sum(times) - times[3] - times[4]  # idle, and waiting for input and output

    before = busy()
    time.sleep(seconds)
    return (busy() - before) / os.sysconf("SC_CLK_TCK") / seconds


def now():
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
