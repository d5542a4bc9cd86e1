# SPDX-License-Identifier: MIT
"""Errors, what the library calls back, threads, and who keeps what alive."""
import concurrent.futures
import ctypes
import gc
import logging
import os
import signal
import sys
import threading

import numpy as np
import pytest
import sphmesh
from conftest import torus
from sphmesh import _abi, _calls, errors

FRAMES, TRIANGLES = torus()


def test_each_status_has_a_class_of_its_own():
    statuses = {value for name, value in vars(_abi).items() if name.startswith("SPH_E_")}
    assert set(errors.BY_STATUS) == statuses
    assert len({kind for kind in errors.BY_STATUS.values()}) == len(statuses)
    assert all(issubclass(kind, sphmesh.SphmeshError) for kind in errors.BY_STATUS.values())


def test_a_vertex_that_is_not_finite_is_named():
    frames = FRAMES.copy()
    frames[2, 7, 1] = np.nan
    with pytest.raises(sphmesh.InvalidError, match="frame 2, vertex 7"):
        sphmesh.Animation(frames, TRIANGLES).build()
    assert sphmesh.Animation(frames, TRIANGLES).check().first_non_finite_vertex == 7


@pytest.mark.parametrize("rows, error", [([[0, 1, 288]], "vertex 288"), ([[0, 1, -1]], "-1"), ([[0, 1]], "shape"),
                                         ([[0, 1.5, 2]], "whole numbers"), ([[0, 1, 1 << 40]], "out of range")])
def test_triangles_that_cannot_be_are_refused(rows, error):
    with pytest.raises(ValueError, match=error):
        sphmesh.Animation(FRAMES, rows)


def test_files_raise_what_python_programs_expect(tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        sphmesh.open_animation(tmp_path / "nowhere.obj")
    (tmp_path / "torn.sphm").write_bytes(b"SPHM and no more")
    with pytest.raises(sphmesh.FormatError, match="torn"):
        sphmesh.load(tmp_path / "torn.sphm")
    with pytest.raises(sphmesh.UnsupportedError, match="level.odd"):
        sphmesh.Level([[0, 0, 0]], [1]).save(tmp_path / "level.odd")


def test_a_memory_limit_is_kept_and_told():
    tight = sphmesh.Context(threads=1, memory_limit=200_000)
    with pytest.raises(MemoryError):
        sphmesh.Animation(FRAMES, TRIANGLES, context=tight).build()
    assert tight.memory_peak <= 200_000


def test_a_limit_and_a_state_are_told(level):
    with pytest.raises(sphmesh.LimitError):
        level.surface(resolution=64, memory_limit=1000)
    with pytest.raises(sphmesh.StateError):
        sphmesh.Skin([[0, 0, 0]], [[0]], [[1]]).errors()


def test_words_that_are_none_are_refused_with_those_that_are(animation):
    with pytest.raises(ValueError, match="constant, per_frame, zero"):
        animation.build(radius="large")


def test_progress_rises_to_one_and_names_stages(animation):
    told = []
    animation.build(progress=lambda stage, fraction: told.append((stage, fraction)))
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions) and fractions[-1] == 1
    assert "decimation" in {stage for stage, _ in told}


def test_progress_cancels_and_the_context_goes_on(animation):
    calls = []

    def stop(stage, fraction):
        calls.append(fraction)
        return len(calls) < 3

    with pytest.raises(sphmesh.CancelledError):
        animation.build(progress=stop)
    assert len(calls) == 3
    assert animation.build().vertex_count == 288


def test_a_context_has_progress_of_its_own():
    told = []
    context = sphmesh.Context(progress=lambda *what: told.append(what))
    sphmesh.Animation(FRAMES, TRIANGLES, context=context).build()
    assert told


def test_what_progress_raises_comes_out(animation):
    with pytest.raises(ZeroDivisionError) as caught:
        animation.build(progress=lambda stage, fraction: 1 / 0)
    assert "<lambda>" in [entry.name for entry in caught.traceback]


def test_what_a_frame_source_raises_comes_out():
    def read(frame, xyz):
        if frame == 2:
            raise EOFError("the tape is torn")
        xyz[:] = FRAMES[frame]

    animation = sphmesh.Animation.from_source(read, 288, 4, TRIANGLES)
    assert np.array_equal(animation.read_frame(1), FRAMES[1])
    with pytest.raises(EOFError, match="the tape is torn"):
        animation.build()
    with pytest.raises(EOFError):
        animation.bounding_diagonal()


def test_a_source_that_returns_frames_of_another_shape_is_told():
    animation = sphmesh.Animation.from_source(lambda frame, xyz: FRAMES[frame][1:], 288, 4, TRIANGLES)
    with pytest.raises(ValueError, match="287, 3"):
        animation.build()


def test_a_source_may_call_the_library_itself(hierarchy):
    inner = sphmesh.Animation(FRAMES, TRIANGLES)
    asked = []
    outer = sphmesh.Animation.from_source(lambda frame, xyz: inner.read_frame(frame, out=xyz), 288, 4, TRIANGLES)
    built = outer.build(progress=lambda *what: asked.append(what))
    assert built.to_bytes() == hierarchy.to_bytes() and asked


def test_what_a_step_of_the_solver_raises_comes_out(level, animation):
    steps = []
    level.skin(animation, step=lambda *what: steps.append(what), rounds=2)
    assert steps[0][:2] == (0, "start") and {"transforms", "weights"} <= {what for _, what, _ in steps}
    with pytest.raises(LookupError):
        level.skin(animation, step=lambda *_: {}[0])


def test_an_interrupt_ends_a_long_call(capfd, monkeypatch):
    ignored = []
    monkeypatch.setattr(sys, "unraisablehook", ignored.append)
    animation = sphmesh.Animation(*torus(96, 48, 8))
    timer = threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            animation.build()
    timer.join()
    assert not ignored
    assert sys.unraisablehook == ignored.append


def test_an_interrupt_before_the_first_line_of_a_callback_is_not_lost(animation):
    # What ctypes does with an exception that no line of ours can catch.
    def interrupted(*arguments):
        _calls.sys.unraisablehook(type("Told", (), {"exc_value": KeyboardInterrupt(), "exc_type": KeyboardInterrupt}))
        return 0

    with pytest.raises(KeyboardInterrupt):
        animation.context.run(interrupted)


def test_messages_go_to_logging(caplog):
    caplog.set_level(logging.DEBUG, "sphmesh")
    context = sphmesh.default_context()
    sphmesh.lib.sph_context_log(context._handle.pointer, _abi.SPH_LOG_WARNING, "what é says".encode())
    assert caplog.record_tuples == [("sphmesh", logging.WARNING, "what é says")]


def test_arrays_outlive_what_they_came_from(hierarchy):
    with hierarchy.level(20) as level:
        centers, labels = level.centers, level.labels
        expected = centers.copy()
    gc.collect()
    hierarchy.level(20), hierarchy.level(21)  # what was freed would be used again
    assert np.array_equal(centers, expected)
    assert not centers.flags.writeable and labels.max() == 19
    with pytest.raises(sphmesh.StateError, match="closed"):
        level.radii


def test_a_cursor_outlives_the_hierarchy_that_was_closed():
    hierarchy = sphmesh.Animation(FRAMES, TRIANGLES).build()
    cursor = hierarchy.cursor()
    hierarchy.close()
    gc.collect()
    nodes, edges, triangles = cursor.move(10).read()
    assert len(nodes) == 10


def test_all_memory_comes_back():
    context = sphmesh.Context(threads=1)
    empty = context.memory_used
    animation = sphmesh.Animation(FRAMES, TRIANGLES, context=context)
    hierarchy = animation.build()
    level = hierarchy.level(12)
    everything = [level.query(), level.surface(resolution=16), level.inflated(animation), hierarchy.cursor(),
                  level.optimized(animation), level.skin(animation, rounds=1)]
    everything += [everything[-1].deformer(), everything[-1].skeleton(), level.triangles, everything[1][0]]
    circle = [everything]
    circle.append(circle)  # goes with the collector, in any order
    assert context.memory_used > empty
    del animation, hierarchy, level, everything, circle
    gc.collect()
    assert context.memory_used == empty


def test_frames_that_suit_are_not_copied():
    context = sphmesh.Context(threads=1)
    frames = FRAMES.copy()
    animation = sphmesh.Animation(frames, context=context)
    assert context.memory_used < frames.nbytes
    frames[3, 5] = 41
    assert np.array_equal(animation.read_frame(3)[5], [41, 41, 41])


@pytest.mark.parametrize("view", [
    lambda f: f.astype(np.float64), lambda f: np.asfortranarray(f), lambda f: f[::-1][::-1].copy()[::1],
    lambda f: np.concatenate([f, f], 2)[:, :, :3], lambda f: np.repeat(f, 2, 1)[:, ::2], lambda f: np.repeat(f, 2, 0)[::2],
    lambda f: f[::-1].copy()[::-1], lambda f: f.tolist()])
def test_frames_may_lie_in_any_way(view, hierarchy):
    assert sphmesh.Animation(view(FRAMES), TRIANGLES).build().to_bytes() == hierarchy.to_bytes()


def test_many_threads_ask_at_once_and_get_the_same(level):
    query = level.query(1.5)
    points = np.random.default_rng(1).normal(size=(2000, 3)).astype(np.float32)
    expected = query.nearest(points)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for found in pool.map(query.nearest, [points] * 8):
            assert found.tobytes() == expected.tobytes()


def test_errors_in_other_threads_are_their_own(level):
    def ask(value):
        with pytest.raises(sphmesh.InvalidError) as caught:
            level.query().nearest([[0, 0, 0]] * value + [[np.nan, 0, 0]])
        return str(caught.value)

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for value, message in zip(range(40), pool.map(ask, range(40))):
            assert str(value) in message


def test_a_struct_that_is_told_cannot_be_changed():
    record = sphmesh.Animation(FRAMES, TRIANGLES).check()
    with pytest.raises(AttributeError):
        record.component_count = 2
    with pytest.raises(AttributeError):
        record.nothing
    assert "component_count=1" in repr(record) and ctypes.sizeof(_abi.sph_animation_report) > 0
