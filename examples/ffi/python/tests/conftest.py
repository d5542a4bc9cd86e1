# SPDX-License-Identifier: MIT
"""Shapes whose answers are known, and results as TAP for whoever runs the tests with --tap."""
import numpy as np
import pytest
import sphmesh


def pytest_addoption(parser):
    parser.addoption("--tap", action="store_true", help="print results as TAP")


class Tap:
    """One line per test, for meson."""

    count = 0

    def line(self, word, report, note=""):
        self.count += 1
        name = report.nodeid.split("::")[-1].removeprefix("test_").replace("_", " ").replace("#", "")
        print(f"{word} {self.count} - {name}{note}", flush=True)

    def pytest_runtest_logreport(self, report):
        if report.failed:
            self.line("not ok", report)
            print("# " + report.longreprtext.replace("\n", "\n# "), flush=True)
        elif report.skipped:
            self.line("ok", report, f" # SKIP {report.longrepr[2]}")
        elif report.when == "call":
            self.line("ok", report)

    def pytest_sessionfinish(self):
        print(f"1..{self.count}", flush=True)


@pytest.hookimpl(trylast=True)  # when the reporter of the terminal is there, which would write between the lines
def pytest_configure(config):
    if config.getoption("--tap"):
        config.pluginmanager.register(Tap())
        config.pluginmanager.unregister(name="terminalreporter")


def closed_grid(rings, sides):
    """Triangles of a torus of vertices [ring, side], counter-clockwise from outside."""
    a = np.arange(rings * sides).reshape(rings, sides)
    b, d = np.roll(a, -1, 0), np.roll(a, -1, 1)
    c = np.roll(b, -1, 1)
    return np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])


def torus(rings=24, sides=12, frames=4):
    """A torus that is drawn out along y from frame to frame: float32 (F, n, 3), and triangles."""
    u, v = np.meshgrid(np.arange(rings) * 2 * np.pi / rings, np.arange(sides) * 2 * np.pi / sides, indexing="ij")
    rest = np.stack([(1 + 0.3 * np.cos(v)) * np.cos(u), (1 + 0.3 * np.cos(v)) * np.sin(u), 0.3 * np.sin(v)], -1)
    stretch = 1 + 0.1 * np.arange(frames)[:, None, None] * [0, 1, 0]
    return (rest.reshape(1, -1, 3) * stretch).astype(np.float32), closed_grid(rings, sides)


def ball(radius=1.0, rings=24, sides=48):
    """A sphere of triangles: positions (n, 3), and triangles."""
    polar, around = np.pi * np.arange(1, rings) / rings, 2 * np.pi * np.arange(sides) / sides
    p, a = np.meshgrid(polar, around, indexing="ij")
    points = np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], -1).reshape(-1, 3)
    points = np.concatenate([points, [[0, 0, 1], [0, 0, -1]]])
    i = np.arange((rings - 1) * sides).reshape(rings - 1, sides)
    j = np.roll(i, -1, 1)
    north, south = np.full(sides, len(points) - 2), np.full(sides, len(points) - 1)
    sheets = [(i[:-1], i[1:], j[1:]), (i[:-1], j[1:], j[:-1]), (north, i[0], j[0]), (south, j[-1], i[-1])]
    return radius * points, np.concatenate([np.stack(s, -1).reshape(-1, 3) for s in sheets])


@pytest.fixture
def animation():
    return sphmesh.Animation(*torus())


@pytest.fixture(scope="session")
def hierarchy():
    return sphmesh.Animation(*torus()).build()


@pytest.fixture
def level(hierarchy):
    return hierarchy.level(20)
