#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the program says before it does any work: help, and usage that is wrong."""
import os
import subprocess
import tempfile

from support import PROGRAM, Case, main, run

COMMANDS = ["build", "info", "level", "measure", "convert", "surface", "cast", "export", "demo", "skin"]
if run("help", "render").returncode == 0:  # not where the program was built without libpng
    COMMANDS.append("render")
COMMANDS.append("pose")


class Help(Case):
    def test_every_command_has_a_help_page_that_fits_on_a_screen_and_has_an_example(self):
        for command in COMMANDS:
            page = self.succeeds(command, "--help").stdout
            self.assertEqual(page, self.succeeds("help", command).stdout)
            self.assertIn(f"usage: sphmesh {command}", page)
            self.assertIn("example", page)
            self.assertLessEqual(page.count("\n"), 36)
            self.assertLessEqual(max(map(len, page.splitlines())), 80)

    def test_the_general_help_names_every_command(self):
        page = self.succeeds("--help").stdout
        self.assertEqual(page, self.succeeds("help").stdout)
        for command in COMMANDS:
            self.assertIn(f"\n  {command} ", page)

    def test_help_wins_over_other_options_being_wrong_after_it(self):
        self.succeeds("build", "--help", "--nonsense")

    def test_version_is_three_numbers(self):
        self.assertRegex(self.succeeds("--version").stdout, r"^sphmesh \d+\.\d+\.\d+\n$")


class WrongUsage(Case):
    def test_no_command_is_wrong_usage(self):
        self.refuses(2, "no command")

    def test_an_unknown_command_is_refused_and_the_likely_one_suggested(self):
        self.refuses(2, "'mesure' (did you mean 'measure'?)", "mesure")
        self.refuses(2, "'xyzzy'", "xyzzy")

    def test_an_unknown_option_is_refused_and_the_likely_one_suggested(self):
        self.refuses(2, "'--wled' (did you mean '--weld'?)", "build", "a.obj", "-o", "a.sphm", "--wled")
        self.refuses(2, "'--optimise-connectivity' (did you mean '--optimize-connectivity'?)", "level", "a.sphm",
                     "--optimise-connectivity")
        self.refuses(2, "'--xyzzy'", "info", "a.obj", "--xyzzy=3")
        self.refuses(2, "'-z'", "info", "a.obj", "-z")

    def test_bad_values_are_refused_by_the_option_s_name(self):
        for option, value in [("--radius", "sometimes"), ("--importance", "7"), ("--up", "x"), ("--threads", "-1"),
                              ("--threads", "1.5"), ("--threads", "9999999999999999999999"), ("--radius-factor", "-1"),
                              ("--radius-factor", "nan"), ("--radius-factor", "1e999"), ("--radius-factor", "1x"),
                              ("--temporal-coherence", "inf"), ("--width-directions", "2"), ("--frames", "5:3"),
                              ("--frames", "0:9:0"), ("--frames", "a"), ("--frames", "1:2:3:4"), ("--scale", "0"),
                              ("--progress", "fancy"), ("--cache", "")]:
            self.refuses(2, f"{option}: ", "build", "a.obj", "-o", "a.sphm", option, value)
            self.refuses(2, f"{option}: ", "build", "a.obj", "-o", "a.sphm", f"{option}={value}")
        self.refuses(2, "did you mean 'per-frame'", "build", "a.obj", "-o", "a.sphm", "--radius", "perframe")

    def test_a_missing_value_and_a_value_too_many_are_refused(self):
        self.refuses(2, "--output: the value is missing", "build", "a.obj", "-o")
        self.refuses(2, "--weld takes no value", "build", "a.obj", "-o", "a.sphm", "--weld=yes")

    def test_what_a_command_needs_is_asked_for(self):
        self.refuses(2, "no input", "build", "-o", "a.sphm")
        self.refuses(2, "-o is missing", "build", "a.obj")
        self.refuses(2, "does not end in .sphm", "build", "a.obj", "-o", "a.obj")
        self.refuses(2, "--cache", "build", "a.obj", "b.obj", "--cache", "c.pc2", "-o", "a.sphm")
        self.refuses(2, "one of --spheres and --max-error", "level", "a.sphm", "-o", "a.json")
        self.refuses(2, "one of --spheres and --max-error", "level", "a.sphm", "-o", "a.json", "--spheres", 4,
                     "--max-error", 1)
        self.refuses(2, "--spheres: '0'", "level", "a.sphm", "-o", "a.json", "--spheres", 0)
        self.refuses(2, "--max-error: '-1'", "level", "a.sphm", "-o", "a.json", "--max-error=-1")
        self.refuses(2, "'a.txt' does not end in", "level", "a.sphm", "-o", "a.txt", "--spheres", 4)
        self.refuses(2, "one hierarchy", "level", "-o", "a.json", "--spheres", 4)
        self.refuses(2, "--level is missing", "measure", "a.obj")
        self.refuses(2, "-o is missing", "convert", "a.obj")
        self.refuses(2, "no input", "convert", "-o", "b.obj")
        self.refuses(2, "'b.ply' does not end in", "convert", "a.obj", "-o", "b.ply")
        self.refuses(2, "--fps: '0'", "convert", "a.obj", "-o", "b.mdd", "--fps", 0)
        self.refuses(2, "--samples: '0'", "measure", "a.obj", "--level", "a.json", "--samples", 0)
        self.refuses(2, "--resolution: '3'", "demo", "--resolution", 3)
        self.refuses(2, "'folder'", "demo", "folder")


class Failures(Case):
    def test_files_that_are_not_there_are_named(self):
        for arguments in (["info", "nowhere.obj"], ["info", "nowhere.sphm"], ["info", "nowhere.json"],
                          ["build", "nowhere.obj", "-o", "a.sphm"],
                          ["convert", "nowhere.stl", "-o", "a.obj"],
                          ["level", "nowhere.sphm", "--spheres", "4", "-o", "a.json"],
                          ["measure", "a.obj", "--level", "nowhere.json"]):
            done = self.refuses(1, "nowhere.", *arguments)
            self.assertIn("No such file", done.stderr)

    def test_files_that_are_something_else_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("junk.obj", "junk.sphm", "junk.json", "junk.xyz"):
                with open(os.path.join(folder, name), "wb") as file:
                    file.write(b"\x00\xff this is no mesh\n" * 40)
                self.refuses(1, name, "info", name, cwd=folder)

    def test_a_full_disk_is_not_success(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        with open("/dev/full", "w") as full:
            done = subprocess.run([PROGRAM, "--help"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("standard output", done.stderr)

    def test_a_name_after_two_dashes_is_no_option(self):
        self.assertIn("--weld", run("info", "--", "--weld.obj").stderr)


if __name__ == "__main__":
    main()
