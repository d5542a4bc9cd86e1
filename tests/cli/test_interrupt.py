#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Ctrl-C and SIGTERM: the work stops, and no file is left behind."""
import os
import signal
import subprocess
import tempfile

from support import PROGRAM, Case, main


class Interrupt(Case):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        Case().succeeds("demo", "-o", cls.folder.name, "--frame-count", 16, "--resolution", 48, "--samples", 1, "--quiet")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def interrupt(self, number, task, *arguments):
        """Sends the signal at the first sign of progress on `task`; the finished process and the files that it made."""
        before = set(os.listdir(self.folder.name))
        process = subprocess.Popen([PROGRAM, *arguments, "--progress", "json"], cwd=self.folder.name, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for line in process.stderr:
            if f'"task": "{task}"' in line:
                process.send_signal(number)
                break
        out, rest = process.communicate(timeout=600)
        return process.returncode, out, rest, set(os.listdir(self.folder.name)) - before

    def test_build_stops_at_ctrl_c_and_leaves_nothing(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            code, out, error, made = self.interrupt(number, "building", "build", "creature.obj", "--cache",
                                                    "creature.pc2", "-o", "new.sphm")
            self.assertEqual((code, out, made), (1, "", set()), error)
            self.assertIn("cancelled", error)

    def test_a_file_that_was_there_stays_as_it_was(self):
        path = os.path.join(self.folder.name, "old.sphm")
        with open(path, "w") as file:
            file.write("before")
        code = self.interrupt(signal.SIGINT, "building", "build", "creature.obj", "--cache", "creature.pc2", "-o",
                              "old.sphm")[0]
        with open(path) as file:
            self.assertEqual((code, file.read()), (1, "before"))

    def test_measure_stops_at_ctrl_c(self):
        code, out, error, made = self.interrupt(signal.SIGINT, "measuring", "measure", "creature.obj", "--cache",
                                                "creature.pc2", "--level", "level-60.json", "--samples", "200000")
        self.assertEqual((code, out, made), (1, "", set()), error)
        self.assertIn("cancelled", error)


if __name__ == "__main__":
    main()
