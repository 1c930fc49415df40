"""The judge is judged: the survey must see what a broken program does.

    survey_test.py PROGRAM SOURCE_FOLDER

Each case puts a script in the place of the program that does one thing wrong and otherwise runs PROGRAM.
"""
import csv
import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()

# What the stand-in does in place of, or after, the real program. $1 is the command, $real the program.
FAULTS = {
    "crash": ('[ "$1" = build ] && kill -SEGV $$\nexec "$real" "$@"', "SIGSEGV"),
    "exit 1": ('[ "$1" = build ] && exit 1\nexec "$real" "$@"', "build: exit 1"),
    "refusal without need": ('[ "$1" = build ] && { echo no >&2; exit 3; }\nexec "$real" "$@"',
                             "refused without need"),
    "failed check": ('[ "$1" = check ] && exit 1\nexec "$real" "$@"', "check:"),
    "violated guarantee": ('[ "$1" = check ] && { echo volume.vtu; echo "  12 cells"; '
                           'echo "  VIOLATED: inverted cells (2); first: cell 7"; exit 1; }\n'
                           'exec "$real" "$@"', "check: VIOLATED: inverted cells (2)"),
    "sanitizer": ('[ "$1" = build ] && echo "x.cpp:1: runtime error: overflow" >&2\nexec "$real" "$@"',
                  "runtime error"),
    "lost feature": ('"$real" "$@" || exit $?\n'
                     '[ "$1" != build ] || sed -i s/\\"s1\\"/\\"lost\\"/ out/*.json\n',
                     "account:"),
    "other bytes": ('"$real" "$@" || exit $?\n[ ! -d again ] || echo >> again/surface.stl\n',
                    "surface.stl"),
    "results left behind": ('[ "$1" = build ] && { mkdir out; exit 3; }\nexec "$real" "$@"',
                            "exit 3, but left behind: out"),
    "hidden folder left behind": ('[ "$1" = build ] && { mkdir .out.part-abcdef; exit 3; }\n'
                                  'exec "$real" "$@"', "exit 3, but left behind: .out.part-abcdef"),
    "hidden folder beside the result": ('[ "$1" = build ] && mkdir -p .out.part-abcdef\n'
                                        'exec "$real" "$@"',
                                        "exit 0, but left behind: .out.part-abcdef"),
    "hang": ('[ "$1" = build ] && exec sleep 30\nexec "$real" "$@"', "still running"),
}


def survey(program, out, *options):
    return subprocess.run([sys.executable, SOURCE / "scripts/survey", *options, "--jobs", "1",
                           "--program", program, "--out", out], text=True, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


class Survey(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def stand_in(self, body):
        path = self.folder / "stand-in"
        path.write_text(f"#!/bin/sh\nreal='{PROGRAM}'\n{body}\n")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def test_sound_cities_pass(self):
        out = self.folder / "out"
        done = survey(PROGRAM, out, "6", "--first", "5")
        self.assertEqual(done.stdout.splitlines()[-1], "6 passed, 0 failed", done.stdout)
        self.assertEqual(done.returncode, 0)
        with open(out / "table.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["seed"] for row in rows], [str(seed) for seed in range(5, 11)])
        for row in rows:
            self.assertIn(row["outcome"], ("ok", "refused"))
        meshed = [row for row in rows if row["outcome"] == "ok"]
        self.assertGreater(len(meshed), 3)
        for row in meshed:
            self.assertGreater(int(row["cells"]), 0)
            self.assertEqual(row["inverted"], "0")
        names = {path.name for path in out.iterdir()}
        self.assertEqual(names, {"table.csv", "summary.txt", "time.svg", "memory.svg",
                                 "dihedral_min.svg", "dihedral_p0_01.svg", "dihedral_max.svg"})

    def test_the_floor_counts_only_when_asked(self):
        # No mesh passes a floor that is above what is possible.
        code = ("import sys; sys.path.insert(0, sys.argv[1]); import survey_report as s;"
                "row = dict(dihedral_min=9, dihedral_p0_01=13, dihedral_max=150, "
                "non_orthogonality=69, skewness=3.9);"
                "print(s.below_floor(row), s.below_floor(row | dict(dihedral_min=7.9)),"
                "s.below_floor(row | dict(dihedral_p0_01=11.9)),"
                "s.below_floor(row | dict(dihedral_max=160.1)), "
                "s.below_floor(row | dict(non_orthogonality=70.1)), "
                "s.below_floor(row | dict(skewness=4)))")
        done = subprocess.run([sys.executable, "-c", code, SOURCE / "scripts"], text=True,
                              check=True, stdout=subprocess.PIPE)
        self.assertEqual(done.stdout.split(), ["False"] + 5 * ["True"])

    def test_one_city_below_the_floor_fails_only_when_asked(self):
        # A report that tells of a face beyond the floor, and a check that does not mind.
        body = ('[ "$1" != check ] || { echo every guarantee holds; exit 0; }\n"$real" "$@" || exit $?\n[ "$1" != build ] || sed -i '
                """'/"skewness"/,/}/s/"max": [0-9.]*/"max": 4.5/' out/report.json\n""")
        for options, code in (((), 0), (("--floor",), 1)):
            with self.subTest(options):
                keep = self.folder / f"city{code}"
                done = survey(self.stand_in(body), self.folder, "--seed", "1", "--keep", keep, *options)
                self.assertIn("below_floor        True", done.stdout)
                self.assertEqual(done.returncode, code, done.stdout)

    def test_faults_are_seen_and_kept(self):
        for name, (body, sign) in FAULTS.items():
            with self.subTest(name):
                out = self.folder / name.replace(" ", "-")
                done = survey(self.stand_in(body), out, "1", "--first", "10",
                              "--limit", "10" if name == "hang" else "60")
                self.assertEqual(done.stdout.splitlines()[-1], "0 passed, 1 failed", done.stdout)
                self.assertEqual(done.returncode, 1)
                self.assertIn(sign, (out / "summary.txt").read_text())
                kept = out / "failures/10"
                self.assertTrue((kept / "input/report.json").exists())
                self.assertIn("tetropolis synth", (kept / "repeat.sh").read_text())

    def test_a_kept_failure_repeats(self):
        out = self.folder / "out"
        survey(self.stand_in(FAULTS["failed check"][0]), out, "1", "--first", "10")
        script = out / "failures/10/repeat.sh"
        done = subprocess.run(["sh", script], env={"TETROPOLIS": str(PROGRAM), "PATH": "/usr/bin:/bin"},
                              text=True, check=False, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("every guarantee holds", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
