#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts the test cases of a meson build directory after `meson test`.

Prints "PASSED FAILED SKIPPED", then one line per failed or skipped case. A TAP program counts with its cases; a test that
ended badly without a failed case (a crash, a timeout) is one failure more.
"""
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

GOOD = {"OK", "EXPECTEDFAIL"}


def cases_of_tap_tests(junit):
    """{test name: [(case, state)]} of the tests that reported cases."""
    found = {}
    for suite in xml.parse(junit).getroot().iter("testsuite"):
        cases = []
        for case in suite.iter("testcase"):
            kinds = {child.tag for child in case}
            state = "failed" if kinds & {"failure", "error"} else "skipped" if "skipped" in kinds else "passed"
            cases.append((case.get("name"), state))
        found[suite.get("name")] = cases
    return found


def main(build):
    logs = pathlib.Path(build) / "meson-logs"
    suites = cases_of_tap_tests(logs / "testlog.junit.xml")
    count = {"passed": 0, "failed": 0, "skipped": 0}
    notes = []

    def add(name, state):
        count[state] += 1
        if state != "passed":
            notes.append(f"{state}: {name}")

    for line in (logs / "testlog.json").read_text().splitlines():
        test = json.loads(line)
        name = test["name"].split(" / ")[-1]  # "project:suite / test", or the test alone
        whole = "passed" if test["result"] in GOOD else "skipped" if test["result"] == "SKIP" else "failed"
        cases = suites.get(f"sphmesh.{test['name']}", [])
        if not cases and re.search(r"^(not )?ok \d", test.get("stdout", ""), re.M):
            sys.exit(f"the cases of {name} are not in {logs / 'testlog.junit.xml'}")
        for case, state in cases:
            add(f"{name}: {case}", state)
        if not cases or (whole == "failed" and all(state != "failed" for _, state in cases)):
            add(f"{name} ({test['result']})", whole)
    print(count["passed"], count["failed"], count["skipped"])
    print("\n".join(notes))


if __name__ == "__main__":
    main(sys.argv[1])
