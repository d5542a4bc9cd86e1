# SPDX-License-Identifier: MIT
"""Frames of an object as Blender plays it: all modifiers, constraints and drivers evaluated, in the space of the world."""
import numpy as np


class CaptureError(Exception):
    """The object cannot be followed; the text is for the user."""


class Capture:
    """An animated mesh as it is captured, frame by frame.

    Attributes:
        frames: the numbers of the frames.
        positions: float32 (F, n, 3), as far as captured.
        triangles: (m, 3), counter-clockwise from outside; edges: (e, 2), those of no face.
        mirrored: the object's scale turns its faces inside out.
    """

    def __init__(self, thing, frames):
        if not frames:
            raise CaptureError("The range has no frames")
        self.thing, self.frames = thing, list(frames)
        self.positions = self.triangles = self.edges = self.topology = self.mirrored = None

    def add(self, context, index):
        """Plays frame number `index` and takes the mesh."""
        frame = self.frames[index]
        context.scene.frame_set(int(frame), subframe=frame - int(frame))
        graph = context.evaluated_depsgraph_get()
        evaluated = self.thing.evaluated_get(graph)
        mesh = evaluated.to_mesh(preserve_all_data_layers=False, depsgraph=graph)
        if mesh is None:
            raise CaptureError(f"{self.thing.name!r} has no mesh in frame {frame}")
        try:
            self._take(mesh, np.array(evaluated.matrix_world), index, frame)
        finally:
            evaluated.to_mesh_clear()

    def _take(self, mesh, matrix, index, frame):
        count = len(mesh.vertices)
        if count == 0:
            raise CaptureError(f"{self.thing.name!r} has no vertices in frame {frame}")
        topology = (count, _read(mesh.polygons, "loop_start", np.int32), _read(mesh.loops, "vertex_index", np.int32))
        if self.topology is None:
            self.topology = topology
            self.positions = np.empty((len(self.frames), count, 3), np.float32)
            mesh.calc_loop_triangles()
            self.triangles = _read(mesh.loop_triangles, "vertices", np.int32, 3)
            self.mirrored = np.linalg.det(matrix[:3, :3]) < 0
            if self.mirrored:
                self.triangles = np.ascontiguousarray(self.triangles[:, ::-1])
            edges = _read(mesh.edges, "vertices", np.int32, 2)
            self.edges = edges[_read(mesh.edges, "is_loose", bool)]
        else:
            self._compare(topology, frame)
        local = _read(mesh.vertices, "co", np.float32, 3)
        self.positions[index] = local @ matrix[:3, :3].T + matrix[:3, 3]
        if not np.isfinite(self.positions[index]).all():
            vertex = int(np.argwhere(~np.isfinite(self.positions[index]).all(axis=1))[0, 0])
            raise CaptureError(f"Frame {frame}: vertex {vertex} is nowhere (not a number)")

    def _compare(self, topology, frame):
        first = f"frame {self.frames[0]}"
        why = "Modifiers that add or remove vertices from frame to frame cannot be followed: turn them off."
        if topology[0] != self.topology[0]:
            raise CaptureError(f"Frame {frame} has {topology[0]} vertices, {first} has {self.topology[0]}. {why}")
        if any(len(a) != len(b) or (a != b).any() for a, b in zip(topology[1:], self.topology[1:])):
            raise CaptureError(f"Frame {frame} has other faces than {first}. {why}")


def _read(collection, name, kind, width=1):
    out = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, out)
    return out.reshape(-1, width) if width > 1 else out
