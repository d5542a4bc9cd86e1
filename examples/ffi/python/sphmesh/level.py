# SPDX-License-Identifier: MIT
"""One level of detail: K animated spheres, and the edges and triangles over which they are interpolated."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import _abi
from ._arrays import Floats, Indices, address, indices, lent, tight
from ._calls import Context, Handle, Owned, Progress, Record, choice, default_context, options, sized
from ._library import lib
from .animation import Animation, PathLike, encoded

if TYPE_CHECKING:
    from .measure import Measurement
    from .query import Query
    from .skin import Skin
    from .surface import Surface


class Level(Owned):
    """A level: from Hierarchy.level(), a file, or your own arrays. It never changes.

    Args:
        centers: shape (F, K, 3), or (K, 3) for one frame.
        radii: shape (K,), or (F, K) where they change from frame to frame.
        edges: shape (e, 2): sphere indices, of no triangle.
        triangles: shape (m, 3): sphere indices.
        labels: shape (n,): for every input vertex its sphere, or NO_SPHERE.
    """

    def __init__(self, centers: ArrayLike, radii: ArrayLike, edges: Optional[ArrayLike] = None,
                 triangles: Optional[ArrayLike] = None, labels: Optional[ArrayLike] = None, *,
                 context: Optional[Context] = None):
        places = np.asarray(centers, np.float32)
        places = tight(places[np.newaxis] if places.ndim == 2 else places, np.float32, -1, -1, 3)
        frames, spheres = places.shape[:2]
        sizes = np.asarray(radii, np.float32)
        sizes = tight(sizes, np.float32, *((frames, spheres) if sizes.ndim == 2 else (spheres,)))
        made = sized(_abi.sph_level_arrays)
        made.sphere_count, made.frame_count, made.radii_per_frame = spheres, frames, int(sizes.ndim == 2)
        made.centers, made.radii = address(places), address(sizes)
        lines = indices([] if edges is None else edges, 2)
        faces = indices([] if triangles is None else triangles, 3)
        made.edge_count, made.edges = len(lines), address(lines)
        made.triangle_count, made.triangles = len(faces), address(faces)
        if labels is not None:
            marks = tight(labels, np.uint32, -1)
            made.label_count, made.labels = len(marks), address(marks)
        self.context = context or default_context()
        pointer = self.context.make(lib.sph_level_create_from_arrays, self.context._handle.pointer, ctypes.byref(made))
        self._handle = Handle(pointer, lib.sph_level_destroy, self.context._handle)

    @classmethod
    def load(cls, path: PathLike, *, context: Optional[Context] = None) -> Level:
        """Reads a level from .sphm or .json."""
        context = context or default_context()
        pointer = context.make(lib.sph_io_load_level, context._handle.pointer, encoded(path))
        return cls._own(context, pointer, lib.sph_level_destroy)

    def save(self, path: PathLike) -> None:
        """Writes .sphm, .json, .obj, .ply or .glb, as the name's ending says."""
        self.context.run(lib.sph_io_save_level, self.context._handle.pointer, self._pointer, encoded(path))

    @classmethod
    def from_bytes(cls, data: bytes, *, context: Optional[Context] = None) -> Level:
        """What to_bytes() wrote, or the content of a .sphm file."""
        context = context or default_context()
        held = np.frombuffer(data, np.uint8)
        pointer = context.make(lib.sph_level_read, context._handle.pointer, address(held), len(held))
        return cls._own(context, pointer, lib.sph_level_destroy)

    def to_bytes(self) -> bytes:
        """The level as .sphm."""
        from .hierarchy import written

        return written(self.context, lib.sph_level_write, self._pointer)

    @property
    def _arrays(self) -> Any:
        out = sized(_abi.sph_level_arrays)
        self.context.check(lib.sph_level_get_arrays(self._pointer, ctypes.byref(out)))
        return out

    @property
    def sphere_count(self) -> int:
        """K"""
        return int(lib.sph_level_sphere_count(self._pointer))

    @property
    def frame_count(self) -> int:
        """F"""
        return int(lib.sph_level_frame_count(self._pointer))

    @property
    def centers(self) -> Floats:
        """Shape (F, K, 3); read-only, not copied, as are the other arrays."""
        a = self._arrays
        return lent(self._held, a.centers, (a.frame_count, a.sphere_count, 3), np.float32)

    @property
    def radii(self) -> Floats:
        """Shape (K,), or (F, K) where radii change from frame to frame."""
        a = self._arrays
        shape = (a.frame_count, a.sphere_count) if a.radii_per_frame else (a.sphere_count,)
        return lent(self._held, a.radii, shape, np.float32)

    @property
    def edges(self) -> Indices:
        """Shape (e, 2): wire edges, of no triangle."""
        a = self._arrays
        return lent(self._held, a.edges, (a.edge_count, 2), np.uint32)

    @property
    def triangles(self) -> Indices:
        """Shape (m, 3)"""
        a = self._arrays
        return lent(self._held, a.triangles, (a.triangle_count, 3), np.uint32)

    @property
    def labels(self) -> Indices:
        """Shape (n,): for every input vertex its sphere; empty where the level has no labels."""
        a = self._arrays
        return lent(self._held, a.labels, (a.label_count,), np.uint32)

    def optimized(self, animation: Animation, *, progress: Optional[Progress] = None) -> Level:
        """The same spheres with better edges, triangles and labels for `animation`, which the level is of."""
        copy = Level(self.centers, self.radii, self.edges, self.triangles, self.labels, context=self.context)
        self.context.run(lib.sph_level_optimize_connectivity, copy._pointer, animation._pointer, progress=progress)
        return copy

    def query(self, frame: float = 0, *, search: str = "auto") -> Query:
        """The level in one pose, ready to be asked: see Query."""
        from .query import Query

        return Query(self, frame, search=search)

    def surface(self, **how: Any) -> Surface:
        """The outer surface as triangles: see Surface."""
        from .surface import Surface

        return Surface(self, **how)

    def measure(self, animation: Animation, **how: Any) -> Measurement:
        """Distances to the animated mesh: see measure_level()."""
        from .measure import measure_level

        return measure_level(animation, self, **how)

    def skin(self, *animations: Animation, **how: Any) -> Skin:
        """A skin whose bones are the spheres: see Skin.decompose()."""
        from .skin import Skin

        return Skin.decompose(self, *animations, **how)

    def coverage(self, animation: Animation, *, progress: Optional[Progress] = None) -> Record:
        """How far vertices stick out: fields `distance`, `frame`, `vertex` and `uncovered_count`."""
        out = sized(_abi.sph_coverage)
        self.context.run(lib.sph_coverage_measure, animation._pointer, self._pointer, ctypes.byref(out),
                         progress=progress)
        return Record(out)

    def inflated(self, animation: Animation, **how: Any) -> Level:
        """A level with radii just so large that it contains every vertex in every frame: the first of inflate()."""
        return self.inflate(animation, **how)[0]

    def inflate(self, animation: Animation, *, margin: float = 0, rounds: Optional[int] = None,
                progress: Optional[Progress] = None) -> Tuple[Level, Record]:
        """A level that contains every vertex in every frame, and what that took.

        Args:
            margin: how deep vertices shall lie in it.
            rounds: passes that look for small radii.

        Returns:
            the level, and `grown_count`, `max_growth`, `mean_growth`, `volume_before`, `volume_after` and `rounds`.
        """
        how, told = options(_abi.sph_inflation_options, margin=margin, rounds=rounds), sized(_abi.sph_inflation)
        pointer = self.context.make(lib.sph_coverage_inflate, animation._pointer, self._pointer, ctypes.byref(how),
                                    ctypes.byref(told), progress=progress)
        return self._own(self.context, pointer, lib.sph_level_destroy), Record(told)

    def export(self, path: PathLike, *, format: str = "by_name", first_frame: int = 0, frame_step: int = 1,
               frame_limit: int = 0, cover_solid: bool = False, gap: float = 0, name: Optional[str] = None,
               coverage: Optional[Record] = None, progress: Optional[Progress] = None) -> Record:
        """Writes the level for other tools.

        Args:
            format: "by_name" (of the file's ending), "primitives" (.json), "ma", "srdf", "yaml", "urdf" or "glb".
            first_frame, frame_step, frame_limit: which frames, or which pose.
            cover_solid: of lists of spheres: spheres contain the solid, instead of lying in it.
            gap: of lists of spheres: how far they may be off, model units; 0: 1/50 of the diagonal.
            name: of the robot and its link.
            coverage: what coverage() told, for the file to say.

        Returns:
            what was written: `frame_count`, `sphere_count`, `capsule_count`, `triangle_count` and `gap`.
        """
        how = options(_abi.sph_io_export_options, format=choice("SPH_IO_EXPORT_", format), first_frame=first_frame,
                      frame_step=frame_step, frame_limit=frame_limit, cover_solid=int(cover_solid), gap=gap,
                      name=None if name is None else name.encode())
        if coverage is not None:
            said = sized(_abi.sph_coverage)
            for field in ("frame", "vertex", "distance", "uncovered_count"):
                setattr(said, field, getattr(coverage, field))
            how.coverage = ctypes.pointer(said)
        out = sized(_abi.sph_io_export_report)
        self.context.run(lib.sph_io_export_level, self.context._handle.pointer, self._pointer, encoded(path),
                         ctypes.byref(how), ctypes.byref(out), progress=progress)
        return Record(out)
