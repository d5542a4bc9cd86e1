# SPDX-License-Identifier: MIT
"""Skinned meshes: a rest pose whose vertices follow bones, and the bones' poses."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Callable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _abi
from ._arrays import SKIN_ERROR, Doubles, Floats, Indices, address, indices, lent, strided, struct_at, tight
from ._calls import Context, Handle, Owned, Progress, Record, choice, default_context, options, report, sized
from ._library import lib
from .animation import Animation, PathLike, encoded
from .level import Level

if TYPE_CHECKING:
    from .implicit import Implicit
    from .pose import Deformer, Skeleton
    from .simplify import Progressive

STEPS = {getattr(_abi, name): name[14:].lower() for name in vars(_abi) if name.startswith("SPH_SKIN_STEP_")}
Step = Callable[[int, str, float], Any]


class Clip(NamedTuple):
    """A range of frames with a name."""

    name: str
    first_frame: int
    frame_count: int
    frames_per_second: float = 0  #: 0: not known


def sources_of(animations: Sequence[Animation], names: Sequence[str], fps: float) -> Any:
    """An array of sph_skin_source, which keeps what it needs."""
    made = (_abi.sph_skin_source * len(animations))()
    for i, animation in enumerate(animations):
        made[i].animation = animation._pointer
        made[i].name = names[i].encode() if i < len(names) else None
        made[i].frames_per_second = fps
    return made


class Skin(Owned):
    """A skinned mesh: from an animation by decompose(), from a glTF by open(), or from your own arrays.

    Args:
        rest: shape (n, 3): the rest pose.
        bones: shape (n, k): for every vertex the bones that move it.
        weights: shape (n, k): how much; of sum 1.
        transforms: shape (F, J, 3, 4), or (F, J, 4, 4) as long as the last row is 0 0 0 1: from the rest pose to each
            frame; none if not given.
        pivots: shape (J, 3): where bones are in the rest pose.
        radii: shape (J,): of the bones' spheres.
        triangles: shape (m, 3).
        links: shape (l, 2): bones that touch.
        clips: follow one another, and cover all frames.
        bone_count: if there are bones beyond those that `bones` names, and neither transforms nor pivots.
    """

    def __init__(self, rest: ArrayLike, bones: ArrayLike, weights: ArrayLike, transforms: Optional[ArrayLike] = None, *,
                 pivots: Optional[ArrayLike] = None, radii: Optional[ArrayLike] = None,
                 triangles: Optional[ArrayLike] = None, links: Optional[ArrayLike] = None, clips: Sequence[Clip] = (),
                 bone_count: Optional[int] = None, context: Optional[Context] = None):
        points = tight(rest, np.float32, -1, 3)
        weight = tight(weights, np.float32, len(points), -1)
        bone = indices(bones, weight.shape[1])
        if len(bone) != len(points):
            raise ValueError(f"bones of {len(bone)} vertices for a rest pose of {len(points)}")
        made, keep = sized(_abi.sph_skin_arrays), []

        def given(values: Optional[ArrayLike], kind: Any, *shape: int) -> Optional[NDArray[Any]]:
            if values is None:
                return None
            keep.append(tight(values, kind, *shape))
            return keep[-1]

        moves = None if transforms is None else given(rows(transforms, 4), np.float64, -1, -1, 3, 4)
        centers = given(pivots, np.float64, -1, 3)
        if bone_count is None:
            bone_count = (moves.shape[1] if moves is not None else len(centers) if centers is not None else
                          int(bone.max(initial=0)) + 1)
        if moves is not None and moves.shape[1] != bone_count or centers is not None and len(centers) != bone_count:
            raise ValueError(f"transforms or pivots are not of {bone_count} bones")
        faces, pairs = (indices([] if a is None else a, n) for a, n in ((triangles, 3), (links, 2)))
        made.vertex_count, made.bone_count, made.influence_count = len(points), bone_count, weight.shape[1]
        made.rest, made.bones, made.weights = address(points), address(bone), address(weight)
        made.frame_count, made.transforms = 0 if moves is None else len(moves), address(moves)
        made.pivots, made.radii = address(centers), address(given(radii, np.float64, bone_count))
        made.triangle_count, made.triangles = len(faces), address(faces)
        made.link_count, made.links = len(pairs), address(pairs)
        named = (_abi.sph_skin_clip * len(clips))(*[_abi.sph_skin_clip(c[0].encode(), *c[1:]) for c in clips])
        made.clip_count, made.clips = len(clips), ctypes.cast(named, type(made.clips)) if clips else None
        self.context = context or default_context()
        pointer = self.context.make(lib.sph_skin_create_from_arrays, self.context._handle.pointer, ctypes.byref(made))
        self._handle = Handle(pointer, lib.sph_skin_destroy, self.context._handle)

    @classmethod
    def decompose(cls, level: Level, *animations: Animation, names: Sequence[str] = (), fps: float = 0,
                  mode: str = "mixed", influences: int = 4, rings: Optional[int] = None, rounds: Optional[int] = None,
                  rest_interval: Optional[int] = None, tolerance: Optional[float] = None,
                  error_limit: Optional[float] = None, smoothness: Optional[float] = None,
                  filter_radius: Optional[float] = None, minor_bone: Optional[float] = None, uniform: bool = False,
                  initial: Optional[Tuple[ArrayLike, ArrayLike]] = None,
                  initial_transforms: Optional[ArrayLike] = None, locked_bones: Optional[ArrayLike] = None,
                  locked_vertices: Optional[ArrayLike] = None, step: Optional[Step] = None,
                  progress: Optional[Progress] = None) -> Skin:
        """Makes animations of one mesh into a skin whose bones are the spheres of a level.

        Args:
            level: with labels; of the first animation.
            animations: one clip each.
            names, fps: of the clips.
            mode: "mixed": geometric weights, learned from the animation where that tells; "animation": the least error;
                "geometric": initial weights stay.
            influences: most bones per vertex.
            rings: how many cells away from a vertex's own a bone may be.
            rounds, rest_interval, tolerance, error_limit: when to stop, and how often the rest pose is optimised.
            smoothness, filter_radius, minor_bone: of the weights, see sph_skin_options.
            uniform: all vertices count alike, not by area.
            initial: bones and weights, each of shape (n, k), to start from.
            initial_transforms: shape (F, J, 3, 4), rigid, to start from.
            locked_bones, locked_vertices: shape (J,) and (n,): True where these stay as they are given.
            step: told step(round, what, energy) after each step of the solver.
        """
        flags = _abi.SPH_SKIN_UNIFORM if uniform else 0
        how = options(_abi.sph_skin_options, mode=choice("SPH_SKIN_", mode), flags=flags, influence_limit=influences,
                      rings=rings, round_limit=rounds, rest_interval=rest_interval, tolerance=tolerance,
                      error_limit=error_limit, smoothness=smoothness, filter_radius=filter_radius,
                      minor_bone=minor_bone)
        keep: List[Any] = []
        if initial is not None:
            weight = tight(initial[1], np.float32, -1, -1)
            bone = indices(initial[0], weight.shape[1])
            how.initial_influence_count, how.initial_bones, how.initial_weights = (weight.shape[1], address(bone),
                                                                                   address(weight))
            keep += [bone, weight]
        if initial_transforms is not None:
            keep.append(tight(rows(initial_transforms, 4), np.float64, -1, level.sphere_count, 3, 4))
            how.initial_transforms = address(keep[-1])
        for name, marks, count in (("locked_bones", locked_bones, level.sphere_count),
                                   ("locked_vertices", locked_vertices, len(level.labels))):
            if marks is not None:
                keep.append(tight(np.asarray(marks, np.bool_), np.bool_, count))
                setattr(how, name, address(keep[-1]))

        def told(user: Optional[int], round: int, what: int, energy: float) -> None:
            try:
                assert step is not None
                step(round, STEPS.get(what, str(what)), energy)
            except BaseException as error:
                report(error)

        if step is not None:
            how.step = _abi.sph_skin_step_fn(told)
        pointer = level.context.make(lib.sph_skin_create, level._pointer, sources_of(animations, names, fps),
                                     len(animations), ctypes.byref(how), progress=progress)
        return cls._own(level.context, pointer, lib.sph_skin_destroy)

    @classmethod
    def open(cls, path: PathLike, *, clip: Optional[str] = None, fps: float = 0, first_frame: int = 0,
             end_frame: int = 0, frame_step: int = 1, progress: Optional[Progress] = None,
             context: Optional[Context] = None) -> Skin:
        """Reads the skinned mesh of a glTF: its rest pose, weights, and its joints' transforms in every frame; see Rig."""
        from .rig import Rig

        return Rig(path, clip=clip, fps=fps, first_frame=first_frame, end_frame=end_frame, frame_step=frame_step,
                   progress=progress, context=context).skin

    def save(self, path: PathLike, *, weights: str = "float", fps: float = 30, skeleton: Optional[Skeleton] = None,
             progress: Optional[Progress] = None) -> None:
        """Writes a skinned, animated glTF: .glb, or .gltf with .bin. Weights are "float", "u8" or "u16"."""
        how = options(_abi.sph_io_rig_options, weights=choice("SPH_IO_WEIGHTS_", weights), frames_per_second=fps)
        self.context.run(lib.sph_io_save_rig, self.context._handle.pointer, self._pointer,
                         None if skeleton is None else skeleton._pointer, ctypes.byref(how), encoded(path),
                         progress=progress)

    @property
    def _arrays(self) -> Any:
        out = sized(_abi.sph_skin_arrays)
        self.context.check(lib.sph_skin_get_arrays(self._pointer, ctypes.byref(out)))
        return out

    def _array(self, name: str, kind: Any, *shape: Any) -> NDArray[Any]:
        a = self._arrays
        return lent(self._held, getattr(a, name), tuple(getattr(a, s) if isinstance(s, str) else s for s in shape), kind)

    @property
    def vertex_count(self) -> int:
        """n"""
        return int(lib.sph_skin_vertex_count(self._pointer))

    @property
    def bone_count(self) -> int:
        """J"""
        return int(lib.sph_skin_bone_count(self._pointer))

    @property
    def influence_count(self) -> int:
        """k: slots per vertex"""
        return int(lib.sph_skin_influence_count(self._pointer))

    @property
    def frame_count(self) -> int:
        """F: frames of all clips"""
        return int(lib.sph_skin_frame_count(self._pointer))

    @property
    def rigid(self) -> bool:
        """Whether every transform is a rotation and a translation."""
        return bool(self._arrays.rigid)

    @property
    def rest(self) -> Floats:
        """Shape (n, 3): the rest pose; read-only, not copied, as are the other arrays."""
        return self._array("rest", np.float32, "vertex_count", 3)

    @property
    def bones(self) -> Indices:
        """Shape (n, k)"""
        return self._array("bones", np.uint32, "vertex_count", "influence_count")

    @property
    def weights(self) -> Floats:
        """Shape (n, k), falling along the slots, of sum exactly 1."""
        return self._array("weights", np.float32, "vertex_count", "influence_count")

    @property
    def transforms(self) -> Doubles:
        """Shape (F, J, 3, 4): from the rest pose to each frame, rows of [linear | translation]."""
        return self._array("transforms", np.float64, "frame_count", "bone_count", 3, 4)

    @property
    def pivots(self) -> Doubles:
        """Shape (J, 3): where bones are in the rest pose."""
        return self._array("pivots", np.float64, "bone_count", 3)

    @property
    def radii(self) -> Doubles:
        """Shape (J,): of the bones' spheres."""
        return self._array("radii", np.float64, "bone_count")

    @property
    def triangles(self) -> Indices:
        """Shape (m, 3)"""
        return self._array("triangles", np.uint32, "triangle_count", 3)

    @property
    def links(self) -> Indices:
        """Shape (l, 2): bones that touch."""
        return self._array("links", np.uint32, "link_count", 2)

    @property
    def clips(self) -> List[Clip]:
        """The clips, one after another."""
        a = self._arrays
        if not a.clip_count:
            return []
        listed = ctypes.cast(a.clips, ctypes.POINTER(_abi.sph_skin_clip * a.clip_count)).contents
        return [Clip((c.name or b"").decode(), c.first_frame, c.frame_count, c.frames_per_second) for c in listed]

    def errors(self) -> Tuple[Record, NDArray[Any]]:
        """The errors that decompose() ended with: overall, and of each frame an entry of SKIN_ERROR."""
        overall, frames = _abi.sph_skin_error(), np.zeros(self.frame_count, SKIN_ERROR)
        self.context.check(lib.sph_skin_get_errors(self._pointer, ctypes.byref(overall),
                                                   struct_at(_abi.sph_skin_error, frames)))
        return Record(overall), frames

    def measure(self, *animations: Animation, progress: Optional[Progress] = None) -> Tuple[Record, NDArray[Any]]:
        """What the skin is off animations of as many frames: as errors()."""
        overall, frames = _abi.sph_skin_error(), np.zeros(self.frame_count, SKIN_ERROR)
        self.context.run(lib.sph_skin_measure, self._pointer, sources_of(animations, (), 0), len(animations),
                         ctypes.byref(overall), struct_at(_abi.sph_skin_error, frames), progress=progress)
        return Record(overall), frames

    def skeleton(self, **how: Any) -> Skeleton:
        """The bones as a tree of joints: see Skeleton."""
        from .pose import Skeleton

        return Skeleton(self, **how)

    def simplified(self, **how: Any) -> Progressive:
        """Levels of detail of the mesh, on the same bones: see Progressive."""
        from .simplify import Progressive

        return Progressive(self, **how)

    def implicit(self, **how: Any) -> Implicit:
        """The solids of the skin's parts, which correct poses: see Implicit."""
        from .implicit import Implicit

        return Implicit(self, **how)

    def deformer(self, normals: Optional[ArrayLike] = None) -> Deformer:
        """What moves the vertices to new poses: see Deformer."""
        from .pose import Deformer

        return Deformer(self, normals)

    def pose_from_spheres(self, centers: ArrayLike, reference: Optional[ArrayLike] = None) -> Doubles:
        """Transforms, shape (J, 3, 4), from new centres of the bones' spheres, shape (J, 3): rotations follow.

        Args:
            reference: shape (J, 3, 4): the pose that is edited; the rest pose if not given.
        """
        places = tight(centers, np.float64, self.bone_count, 3)
        before = None if reference is None else tight(rows(reference, 3), np.float64, self.bone_count, 3, 4)
        out = np.empty((self.bone_count, 3, 4))
        self.context.check(lib.sph_pose_from_spheres(self._pointer, address(before), address(places), address(out)))
        return out


def open_rig_options(clip: Optional[str], fps: float, first_frame: int, end_frame: int, frame_step: int) -> Any:
    """Which frames of a glTF."""
    return options(_abi.sph_io_open_rig_options, clip=None if clip is None else clip.encode(), fps=fps,
                   first_frame=first_frame, end_frame=end_frame, frame_step=frame_step)


def nothing(pointer: int) -> None:
    """For a handle that belongs to another."""


def rows(transforms: ArrayLike, dimensions: int) -> NDArray[Any]:
    """Transforms without the last row of 0 0 0 1, if they have one."""
    array = np.asarray(transforms, np.float64)
    if array.ndim == dimensions and array.shape[-2:] == (4, 4):
        if not np.array_equal(array[..., 3, :], np.broadcast_to([0, 0, 0, 1], array[..., 3, :].shape)):
            raise ValueError("the last row of a transform is not 0 0 0 1")
        return array[..., :3, :]
    return array
