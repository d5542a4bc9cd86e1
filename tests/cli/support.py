# SPDX-License-Identifier: MIT
"""Runs the program, and unittest's cases as TAP: usage of a test is `test_x.py PROGRAM`."""
import json
import os
import subprocess
import sys
import unittest

PROGRAM = os.path.abspath(sys.argv[1])


def run(*arguments, cwd=None):
    """The finished process; output as text, a failure to end within ten minutes as an exception."""
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=600)


class Case(unittest.TestCase):
    maxDiff = None

    def succeeds(self, *arguments, cwd=None):
        done = run(*arguments, cwd=cwd)
        self.assertEqual(done.returncode, 0, f"{arguments}: {done.stderr}")
        return done

    def json(self, *arguments, cwd=None):
        done = self.succeeds(*arguments, "--json", cwd=cwd)
        return json.loads(done.stdout, parse_constant=lambda word: self.fail(f"{word} is no JSON"))

    def refuses(self, code, culprit, *arguments, cwd=None):
        """Exits with `code`, names `culprit` on stderr, prints nothing on stdout."""
        done = run(*arguments, cwd=cwd)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}{done.stderr}")
        self.assertIn(culprit, done.stderr)
        self.assertEqual(done.stdout, "")
        return done


class Tap(unittest.TestResult):
    count = 0

    def line(self, word, test, note=""):
        self.count += 1
        name = test.id().split(".")[-1].removeprefix("test_").replace("_", " ")
        print(f"{word} {self.count} - {name}{note}", flush=True)

    def addSuccess(self, test):
        self.line("ok", test)

    def addSkip(self, test, reason):
        self.line("ok", test, f" # SKIP {reason}")

    def addFailure(self, test, error):
        super().addFailure(test, error)
        self.line("not ok", test)
        print("# " + self.failures[-1][1].replace("\n", "\n# "), flush=True)

    def addError(self, test, error):
        super().addError(test, error)
        self.line("not ok", test)
        print("# " + self.errors[-1][1].replace("\n", "\n# "), flush=True)


def main():
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])
    result = Tap()
    suite.run(result)
    print(f"1..{result.count}")
    sys.exit(0 if result.wasSuccessful() else 1)
