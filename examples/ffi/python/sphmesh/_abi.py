# SPDX-License-Identifier: MIT
"""Written by examples/ffi/declarations.py from the public headers: do not edit, run `ninja ffi-declarations`."""
from __future__ import annotations

import ctypes as c
from typing import Any, Dict, List, Tuple

SPH_OK = 0
SPH_E_INVALID = 1
SPH_E_NOMEM = 2
SPH_E_CANCELLED = 3
SPH_E_VERSION = 4
SPH_E_IO = 5
SPH_E_FORMAT = 6
SPH_E_UNSUPPORTED = 7
SPH_E_LIMIT = 8
SPH_E_STATE = 9
SPH_LOG_WARNING = 1
SPH_LOG_INFO = 2
SPH_LOG_DEBUG = 3
SPH_IMPORTANCE_NONE = 0
SPH_IMPORTANCE_CURVATURE = 1
SPH_IMPORTANCE_CALLER = 2
SPH_RADIUS_CONSTANT = 0
SPH_RADIUS_PER_FRAME = 1
SPH_RADIUS_ZERO = 2
SPH_ORIENTATION_OUTWARD = 0
SPH_ORIENTATION_AS_GIVEN = 1
SPH_LABELS_VERTICES = 0
SPH_LABELS_NONE = 1
SPH_SKIN_MIXED = 0
SPH_SKIN_ANIMATION = 1
SPH_SKIN_GEOMETRIC = 2
SPH_SKIN_UNIFORM = 1
SPH_SKIN_STEP_START = 0
SPH_SKIN_STEP_TRANSFORMS = 1
SPH_SKIN_STEP_WEIGHTS = 2
SPH_SKIN_STEP_REST = 3
SPH_SKIN_STEP_AHEAD = 4
SPH_POSE_LINEAR = 0
SPH_POSE_DUAL_QUATERNION = 1
SPH_OPERATION_UNION = 0
SPH_OPERATION_BLEND = 1
SPH_OPERATION_BULGE = 2
SPH_EVALUATION_TABLE = 0
SPH_EVALUATION_EXACT = 1
SPH_TRACKER_UNGUARDED = 1
SPH_TRACKER_UNSMOOTHED = 2
SPH_TRACKER_COUNTED = 4
SPH_SEARCH_AUTO = 0
SPH_SEARCH_EXHAUSTIVE = 1
SPH_SEARCH_TREE = 2
SPH_SIMPLEX_NONE = 0
SPH_SIMPLEX_SPHERE = 1
SPH_SIMPLEX_EDGE = 2
SPH_SIMPLEX_TRIANGLE = 3
SPH_CAVITY_SOLID = 0
SPH_CAVITY_SPACE = 1
SPH_SIMPLIFY_SKINNED = 0
SPH_SIMPLIFY_POSITION = 1
SPH_SIMPLIFY_PULLED_BACK = 2
SPH_SIMPLIFY_REST = 3
SPH_SKELETON_TREE = 0
SPH_SKELETON_FLAT = 1
SPH_ROOT_CENTER = 0
SPH_ROOT_HEAVIEST = 1
SPH_ROOT_GIVEN = 2
SPH_UP_Y = 0
SPH_UP_Z = 1
SPH_IO_WELD_AUTO = 0
SPH_IO_WELD_NONE = 1
SPH_IO_WELD_ALL = 2
SPH_IO_SPACE_LOCAL = 0
SPH_IO_SPACE_WORLD = 1
SPH_IO_HIERARCHY = 1
SPH_IO_LEVEL = 2
SPH_IO_IMPLICIT = 3
SPH_IO_WEIGHTS_FLOAT = 0
SPH_IO_WEIGHTS_U8 = 1
SPH_IO_WEIGHTS_U16 = 2
SPH_IO_EXPORT_BY_NAME = 0
SPH_IO_EXPORT_PRIMITIVES = 1
SPH_IO_EXPORT_MA = 2
SPH_IO_EXPORT_SRDF = 3
SPH_IO_EXPORT_YAML = 4
SPH_IO_EXPORT_URDF = 5
SPH_IO_EXPORT_GLB = 6
SPH_BULGE_LIMIT = 0.5
SPH_IO_SPILL_LEAST = 16777216
SPH_NO_JOINT = 4294967295
SPH_NO_SPHERE = 4294967295
SPH_SKIN_AUTO = 4294967295
SPH_SURFACE_LEAST_RADIUS = 0.56
SPH_VERSION = 1000
SPH_VERSION_MAJOR = 0
SPH_VERSION_MINOR = 1
SPH_VERSION_PATCH = 0



class sph_allocator(c.Structure):
    _fields_ = [
        ("user", c.c_void_p),
        ("allocate", c.CFUNCTYPE(c.c_void_p, c.c_void_p, c.c_size_t, c.c_size_t)),
        ("release", c.CFUNCTYPE(None, c.c_void_p, c.c_void_p, c.c_size_t)),
    ]

sph_range_fn = c.CFUNCTYPE(None, c.c_void_p, c.c_size_t, c.c_size_t)


class sph_executor(c.Structure):
    _fields_ = [
        ("user", c.c_void_p),
        ("parallel_for", c.CFUNCTYPE(None, c.c_void_p, c.c_size_t, c.c_size_t, sph_range_fn, c.c_void_p)),
    ]

sph_log_fn = c.CFUNCTYPE(None, c.c_void_p, c.c_int32, c.c_char_p)

sph_progress_fn = c.CFUNCTYPE(c.c_bool, c.c_void_p, c.c_char_p, c.c_double)


class sph_context_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("allocator", sph_allocator),
        ("executor", sph_executor),
        ("log", sph_log_fn),
        ("log_user", c.c_void_p),
        ("progress", sph_progress_fn),
        ("progress_user", c.c_void_p),
        ("thread_count", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("memory_limit", c.c_uint64),
    ]


class sph_frame_source(c.Structure):
    _fields_ = [
        ("user", c.c_void_p),
        ("read_frame", c.CFUNCTYPE(c.c_int32, c.c_void_p, c.c_uint32, c.c_void_p)),
        ("destroy", c.CFUNCTYPE(None, c.c_void_p)),
    ]


class sph_animation_report(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("non_finite_count", c.c_uint64),
        ("first_non_finite_frame", c.c_uint32),
        ("first_non_finite_vertex", c.c_uint32),
        ("repeated_index_count", c.c_uint64),
        ("first_repeated_index", c.c_uint64),
        ("duplicate_triangle_count", c.c_uint64),
        ("zero_area_count", c.c_uint64),
        ("first_zero_area_frame", c.c_uint32),
        ("first_zero_area_triangle", c.c_uint32),
        ("boundary_edge_count", c.c_uint64),
        ("non_manifold_edge_count", c.c_uint64),
        ("inconsistent_edge_count", c.c_uint64),
        ("wire_edge_count", c.c_uint64),
        ("component_count", c.c_uint64),
        ("isolated_vertex_count", c.c_uint64),
        ("coincident_vertex_count", c.c_uint64),
        ("inward_component_count", c.c_uint64),
    ]


class sph_hierarchy_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("importance", c.c_int32),
        ("radius_mode", c.c_int32),
        ("radius_factor", c.c_double),
        ("temporal_coherence", c.c_double),
        ("width_directions", c.c_uint32),
        ("orientation", c.c_int32),
        ("importance_weights", c.c_void_p),
        ("importance_frame_stride", c.c_size_t),
    ]


class sph_collapse(c.Structure):
    _fields_ = [
        ("u", c.c_uint32),
        ("v", c.c_uint32),
        ("node", c.c_uint32),
        ("forced", c.c_uint32),
        ("cost", c.c_double),
        ("error", c.c_double),
    ]

sph_write_fn = c.CFUNCTYPE(c.c_int32, c.c_void_p, c.c_void_p, c.c_size_t)


class sph_level_arrays(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("sphere_count", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("radii_per_frame", c.c_uint32),
        ("centers", c.c_void_p),
        ("radii", c.c_void_p),
        ("edge_count", c.c_size_t),
        ("edges", c.c_void_p),
        ("triangle_count", c.c_size_t),
        ("triangles", c.c_void_p),
        ("label_count", c.c_size_t),
        ("labels", c.c_void_p),
    ]


class sph_level_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("first_frame", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("labels", c.c_int32),
    ]


class sph_coverage(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("frame", c.c_uint32),
        ("vertex", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("distance", c.c_double),
        ("uncovered_count", c.c_uint64),
    ]


class sph_inflation_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("rounds", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("margin", c.c_double),
    ]


class sph_inflation(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("rounds", c.c_uint32),
        ("grown_count", c.c_uint64),
        ("max_growth", c.c_double),
        ("mean_growth", c.c_double),
        ("volume_before", c.c_double),
        ("volume_after", c.c_double),
    ]


class sph_skin_clip(c.Structure):
    _fields_ = [
        ("name", c.c_char_p),
        ("first_frame", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("frames_per_second", c.c_double),
    ]


class sph_skin_arrays(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("vertex_count", c.c_uint32),
        ("bone_count", c.c_uint32),
        ("influence_count", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("clip_count", c.c_uint32),
        ("rest", c.c_void_p),
        ("bones", c.c_void_p),
        ("weights", c.c_void_p),
        ("transforms", c.c_void_p),
        ("clips", c.POINTER(sph_skin_clip)),
        ("pivots", c.c_void_p),
        ("radii", c.c_void_p),
        ("triangle_count", c.c_size_t),
        ("triangles", c.c_void_p),
        ("link_count", c.c_size_t),
        ("links", c.c_void_p),
        ("rigid", c.c_uint32),
        ("reserved0", c.c_uint32),
    ]

sph_skin_step_fn = c.CFUNCTYPE(None, c.c_void_p, c.c_uint32, c.c_int32, c.c_double)


class sph_skin_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("mode", c.c_int32),
        ("influence_limit", c.c_uint32),
        ("rings", c.c_uint32),
        ("round_limit", c.c_uint32),
        ("rest_interval", c.c_uint32),
        ("initial_influence_count", c.c_uint32),
        ("tolerance", c.c_double),
        ("error_limit", c.c_double),
        ("smoothness", c.c_double),
        ("filter_radius", c.c_double),
        ("minor_bone", c.c_double),
        ("initial_bones", c.c_void_p),
        ("initial_weights", c.c_void_p),
        ("initial_transforms", c.c_void_p),
        ("locked_bones", c.c_void_p),
        ("locked_vertices", c.c_void_p),
        ("step", sph_skin_step_fn),
        ("step_user", c.c_void_p),
    ]


class sph_skin_source(c.Structure):
    _fields_ = [
        ("animation", c.c_void_p),
        ("name", c.c_char_p),
        ("frames_per_second", c.c_double),
    ]


class sph_skin_error(c.Structure):
    _fields_ = [
        ("mse", c.c_double),
        ("rmse", c.c_double),
        ("max", c.c_double),
        ("rmse_percent", c.c_double),
        ("max_percent", c.c_double),
        ("diagonal", c.c_double),
        ("max_vertex", c.c_uint32),
        ("max_frame", c.c_uint32),
    ]


class sph_deformer_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("normals", c.c_void_p),
    ]


class sph_theta_curve(c.Structure):
    _fields_ = [
        ("angles", c.c_double * 3),
        ("thetas", c.c_double * 3),
        ("exponents", c.c_double * 2),
    ]


class sph_implicit_joint(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("operation", c.c_int32),
        ("bones", c.c_uint32 * 2),
        ("position", c.c_double * 3),
        ("strength", c.c_double),
        ("curve", sph_theta_curve),
    ]


class sph_implicit_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("sample_count", c.c_uint32),
        ("operation", c.c_int32),
        ("table_size", c.c_uint32),
        ("operator_table_size", c.c_uint32),
        ("joint_gap", c.c_double),
        ("parents", c.c_void_p),
        ("parts", c.c_void_p),
        ("joints", c.POINTER(sph_implicit_joint)),
        ("joint_count", c.c_size_t),
    ]


class sph_implicit_part(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("vertex_count", c.c_uint32),
        ("sample_count", c.c_uint32),
        ("closing_count", c.c_uint32),
        ("radius", c.c_double),
        ("low", c.c_double * 3),
        ("high", c.c_double * 3),
        ("samples", c.c_void_p),
        ("normals", c.c_void_p),
    ]


class sph_tracker_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("method", c.c_int32),
        ("evaluation", c.c_int32),
        ("iteration_limit", c.c_uint32),
        ("smoothing_rounds", c.c_uint32),
        ("step", c.c_double),
        ("contact_angle", c.c_double),
        ("tolerance", c.c_double),
        ("reach", c.c_double),
    ]


class sph_tracker_report(c.Structure):
    _fields_ = [
        ("moved", c.c_uint32),
        ("contacts", c.c_uint32),
        ("held_back", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("farthest", c.c_double),
        ("pairs_before", c.c_uint64),
        ("pairs_after", c.c_uint64),
    ]


class sph_measure_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("samples", c.c_uint32),
        ("seed", c.c_uint32),
        ("first_frame", c.c_uint32),
        ("frame_step", c.c_uint32),
        ("frame_limit", c.c_uint32),
        ("reserved0", c.c_uint32),
    ]


class sph_distances(c.Structure):
    _fields_ = [
        ("hausdorff", c.c_double),
        ("mean12", c.c_double),
        ("mean21", c.c_double),
        ("max12", c.c_double),
        ("max21", c.c_double),
        ("area1", c.c_double),
        ("area2", c.c_double),
    ]


class sph_quadric_minimum(c.Structure):
    _fields_ = [
        ("radius", c.c_double),
        ("lambda", c.c_double),
        ("cost", c.c_double),
        ("degenerate_frames", c.c_uint32),
        ("reserved0", c.c_uint32),
    ]


class sph_query_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("search", c.c_int32),
        ("reserved0", c.c_uint32),
    ]


class sph_contact(c.Structure):
    _fields_ = [
        ("point", c.c_double * 3),
        ("normal", c.c_double * 3),
        ("weights", c.c_double * 3),
        ("spheres", c.c_uint32 * 3),
        ("simplex", c.c_uint32),
        ("kind", c.c_uint32),
        ("reserved0", c.c_uint32),
    ]


class sph_sweep(c.Structure):
    _fields_ = [
        ("from", c.c_float * 3),
        ("to", c.c_float * 3),
        ("radius", c.c_float),
        ("reserved0", c.c_uint32),
    ]


class sph_hit(c.Structure):
    _fields_ = [
        ("s", c.c_double),
        ("depth", c.c_double),
        ("hit", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("contact", sph_contact),
    ]


class sph_nearest(c.Structure):
    _fields_ = [
        ("distance", c.c_double),
        ("contact", sph_contact),
    ]


class sph_gap(c.Structure):
    _fields_ = [
        ("s", c.c_double),
        ("distance", c.c_double),
        ("hit", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("first", sph_contact),
        ("second", sph_contact),
    ]


class sph_simplify_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("method", c.c_int32),
        ("influence_limit", c.c_uint32),
        ("pose_limit", c.c_uint32),
        ("pose_count", c.c_uint32),
        ("poses", c.c_void_p),
        ("border_weight", c.c_double),
        ("tolerance", c.c_double),
        ("round_limit", c.c_uint32),
        ("attribute_count", c.c_uint32),
        ("attributes", c.c_void_p),
        ("normals", c.c_void_p),
        ("groups", c.c_void_p),
        ("locked", c.c_void_p),
    ]


class sph_progressive_level(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("collapse_count", c.c_uint32),
        ("vertex_count", c.c_uint32),
        ("point_count", c.c_uint32),
        ("triangle_count", c.c_uint32),
        ("forced", c.c_uint32),
        ("error", c.c_double),
        ("max_error", c.c_double),
    ]


class sph_skeleton_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("layout", c.c_int32),
        ("root", c.c_int32),
        ("root_bone", c.c_uint32),
        ("single_root", c.c_uint32),
    ]


class sph_skeleton_arrays(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("bone_count", c.c_uint32),
        ("joint_count", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("parents", c.c_void_p),
        ("order", c.c_void_p),
        ("positions", c.c_void_p),
        ("rest", c.c_void_p),
        ("inverse_bind", c.c_void_p),
        ("gaps", c.c_void_p),
    ]


class sph_surface_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("resolution", c.c_uint32),
        ("first_frame", c.c_uint32),
        ("frame_step", c.c_uint32),
        ("frame_limit", c.c_uint32),
        ("memory_limit", c.c_uint64),
    ]


class sph_io_open_rig_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("clip", c.c_char_p),
        ("fps", c.c_double),
        ("first_frame", c.c_uint32),
        ("end_frame", c.c_uint32),
        ("frame_step", c.c_uint32),
        ("reserved0", c.c_uint32),
    ]


class sph_io_rig_arrays(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("bone_count", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("morphs", c.c_uint32),
        ("names", c.POINTER(c.c_char_p)),
        ("nodes", c.c_void_p),
        ("parents", c.c_void_p),
        ("inverse_bind", c.c_void_p),
        ("joints_rest", c.c_void_p),
        ("joints", c.c_void_p),
        ("edge_count", c.c_size_t),
        ("edges", c.c_void_p),
    ]


class sph_io_frames(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("vertex_count", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("positions", c.c_void_p),
        ("triangle_count", c.c_size_t),
        ("triangles", c.c_void_p),
        ("frames_per_second", c.c_double),
        ("name", c.c_char_p),
    ]


class sph_io_spill_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("memory_limit", c.c_uint64),
        ("least_size", c.c_uint64),
        ("folder", c.c_char_p),
    ]


class sph_io_spill_figures(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("live_bytes", c.c_uint64),
        ("peak_live_bytes", c.c_uint64),
        ("file_bytes", c.c_uint64),
        ("resident_bytes", c.c_uint64),
        ("trims", c.c_uint64),
    ]


class sph_io_open_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("cache_path", c.c_char_p),
        ("first_frame", c.c_uint32),
        ("end_frame", c.c_uint32),
        ("frame_step", c.c_uint32),
        ("up_axis", c.c_int32),
        ("scale", c.c_double),
        ("fps", c.c_double),
        ("clip", c.c_char_p),
        ("weld", c.c_int32),
        ("space", c.c_int32),
        ("object", c.c_char_p),
    ]


class sph_io_description(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("file_count", c.c_uint32),
        ("format", c.c_char_p),
        ("point_count", c.c_uint32),
        ("frame_count", c.c_uint32),
    ]


class sph_io_clip(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("name", c.c_char_p),
        ("duration", c.c_double),
    ]

sph_io_clip_fn = c.CFUNCTYPE(None, c.c_void_p, c.POINTER(sph_io_clip))


class sph_io_archive(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("version", c.c_uint32),
        ("application", c.c_char_p),
        ("library", c.c_char_p),
        ("date", c.c_char_p),
        ("description", c.c_char_p),
    ]


class sph_io_object(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("sample_count", c.c_uint32),
        ("path", c.c_char_p),
        ("kind", c.c_char_p),
        ("vertex_count", c.c_uint64),
        ("face_count", c.c_uint64),
        ("first_time", c.c_double),
        ("last_time", c.c_double),
        ("chosen", c.c_uint32),
        ("hidden", c.c_uint32),
    ]

sph_io_archive_fn = c.CFUNCTYPE(None, c.c_void_p, c.POINTER(sph_io_archive))

sph_io_object_fn = c.CFUNCTYPE(None, c.c_void_p, c.POINTER(sph_io_object))


class sph_io_rig_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("weights", c.c_int32),
        ("reserved0", c.c_uint32),
        ("frames_per_second", c.c_double),
    ]


class sph_io_export_options(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("flags", c.c_uint32),
        ("format", c.c_int32),
        ("first_frame", c.c_uint32),
        ("frame_step", c.c_uint32),
        ("frame_limit", c.c_uint32),
        ("cover_solid", c.c_uint32),
        ("reserved0", c.c_uint32),
        ("gap", c.c_double),
        ("name", c.c_char_p),
        ("coverage", c.POINTER(sph_coverage)),
    ]


class sph_io_export_report(c.Structure):
    _fields_ = [
        ("struct_size", c.c_uint32),
        ("frame_count", c.c_uint32),
        ("sphere_count", c.c_uint64),
        ("capsule_count", c.c_uint64),
        ("triangle_count", c.c_uint64),
        ("gap", c.c_double),
    ]


STRUCTS: List[Any] = [
    sph_allocator,
    sph_executor,
    sph_context_options,
    sph_frame_source,
    sph_animation_report,
    sph_hierarchy_options,
    sph_collapse,
    sph_level_arrays,
    sph_level_options,
    sph_coverage,
    sph_inflation_options,
    sph_inflation,
    sph_skin_clip,
    sph_skin_arrays,
    sph_skin_options,
    sph_skin_source,
    sph_skin_error,
    sph_deformer_options,
    sph_theta_curve,
    sph_implicit_joint,
    sph_implicit_options,
    sph_implicit_part,
    sph_tracker_options,
    sph_tracker_report,
    sph_measure_options,
    sph_distances,
    sph_quadric_minimum,
    sph_query_options,
    sph_contact,
    sph_sweep,
    sph_hit,
    sph_nearest,
    sph_gap,
    sph_simplify_options,
    sph_progressive_level,
    sph_skeleton_options,
    sph_skeleton_arrays,
    sph_surface_options,
    sph_io_open_rig_options,
    sph_io_rig_arrays,
    sph_io_frames,
    sph_io_spill_options,
    sph_io_spill_figures,
    sph_io_open_options,
    sph_io_description,
    sph_io_clip,
    sph_io_archive,
    sph_io_object,
    sph_io_rig_options,
    sph_io_export_options,
    sph_io_export_report,
]

PROTOTYPES: Dict[str, Tuple[Any, List[Any]]] = {
    "sph_status_text": (c.c_char_p, [c.c_int32]),
    "sph_context_options_init": (None, [c.POINTER(sph_context_options), c.c_size_t]),
    "sph_context_create": (c.c_int32, [c.POINTER(sph_context_options), c.POINTER(c.c_void_p)]),
    "sph_context_destroy": (None, [c.c_void_p]),
    "sph_context_memory_used": (c.c_uint64, [c.c_void_p]),
    "sph_context_memory_peak": (c.c_uint64, [c.c_void_p]),
    "sph_context_last_message": (c.c_char_p, [c.c_void_p]),
    "sph_context_fail": (c.c_int32, [c.c_void_p, c.c_int32, c.c_char_p]),
    "sph_context_allocate": (c.c_void_p, [c.c_void_p, c.c_size_t, c.c_size_t]),
    "sph_context_release": (None, [c.c_void_p, c.c_void_p]),
    "sph_context_report_progress": (c.c_int32, [c.c_void_p, c.c_char_p, c.c_double]),
    "sph_context_log": (None, [c.c_void_p, c.c_int32, c.c_char_p]),
    "sph_context_parallel_for": (None, [c.c_void_p, c.c_size_t, c.c_size_t, sph_range_fn, c.c_void_p]),
    "sph_animation_create": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_uint32, c.POINTER(c.c_void_p)]),
    "sph_animation_create_from_source": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_uint32, c.POINTER(sph_frame_source), c.POINTER(c.c_void_p)]),
    "sph_animation_create_from_positions": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_uint32, c.c_void_p, c.c_size_t, c.c_size_t, c.POINTER(c.c_void_p)]),
    "sph_animation_destroy": (None, [c.c_void_p]),
    "sph_animation_set_frame": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_size_t]),
    "sph_animation_set_triangles": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_size_t]),
    "sph_animation_set_edges": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_size_t]),
    "sph_animation_vertex_count": (c.c_uint32, [c.c_void_p]),
    "sph_animation_frame_count": (c.c_uint32, [c.c_void_p]),
    "sph_animation_triangle_count": (c.c_size_t, [c.c_void_p]),
    "sph_animation_edge_count": (c.c_size_t, [c.c_void_p]),
    "sph_animation_triangles": (c.c_void_p, [c.c_void_p]),
    "sph_animation_edges": (c.c_void_p, [c.c_void_p]),
    "sph_animation_read_frame": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p]),
    "sph_animation_bounding_diagonal": (c.c_int32, [c.c_void_p, c.c_void_p]),
    "sph_animation_report_init": (None, [c.POINTER(sph_animation_report), c.c_size_t]),
    "sph_animation_check": (c.c_int32, [c.c_void_p, c.POINTER(sph_animation_report)]),
    "sph_animation_weld": (c.c_int32, [c.c_void_p, c.c_float, c.c_void_p, c.POINTER(c.c_void_p)]),
    "sph_hierarchy_options_init": (None, [c.POINTER(sph_hierarchy_options), c.c_size_t]),
    "sph_hierarchy_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_hierarchy_options), c.POINTER(c.c_void_p)]),
    "sph_hierarchy_destroy": (None, [c.c_void_p]),
    "sph_hierarchy_vertex_count": (c.c_uint32, [c.c_void_p]),
    "sph_hierarchy_frame_count": (c.c_uint32, [c.c_void_p]),
    "sph_hierarchy_collapse_count": (c.c_uint32, [c.c_void_p]),
    "sph_hierarchy_bounding_diagonal": (c.c_double, [c.c_void_p]),
    "sph_hierarchy_evaluation_count": (c.c_uint64, [c.c_void_p]),
    "sph_hierarchy_first_forced": (c.c_uint32, [c.c_void_p]),
    "sph_hierarchy_collapse": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(sph_collapse)]),
    "sph_hierarchy_read_collapses": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_uint32, c.POINTER(sph_collapse)]),
    "sph_hierarchy_sphere": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_void_p]),
    "sph_hierarchy_count_for_error": (c.c_int32, [c.c_void_p, c.c_double, c.c_void_p]),
    "sph_hierarchy_write": (c.c_int32, [c.c_void_p, sph_write_fn, c.c_void_p]),
    "sph_hierarchy_read": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.POINTER(c.c_void_p)]),
    "sph_cursor_create": (c.c_int32, [c.c_void_p, c.POINTER(c.c_void_p)]),
    "sph_cursor_destroy": (None, [c.c_void_p]),
    "sph_cursor_move": (c.c_int32, [c.c_void_p, c.c_uint32]),
    "sph_cursor_sphere_count": (c.c_uint32, [c.c_void_p]),
    "sph_cursor_edge_count": (c.c_size_t, [c.c_void_p]),
    "sph_cursor_triangle_count": (c.c_size_t, [c.c_void_p]),
    "sph_cursor_read": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_level_create": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(c.c_void_p)]),
    "sph_level_options_init": (None, [c.POINTER(sph_level_options), c.c_size_t]),
    "sph_level_extract": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(sph_level_options), c.POINTER(c.c_void_p)]),
    "sph_level_create_from_arrays": (c.c_int32, [c.c_void_p, c.POINTER(sph_level_arrays), c.POINTER(c.c_void_p)]),
    "sph_level_destroy": (None, [c.c_void_p]),
    "sph_level_get_arrays": (c.c_int32, [c.c_void_p, c.POINTER(sph_level_arrays)]),
    "sph_level_sphere_count": (c.c_uint32, [c.c_void_p]),
    "sph_level_frame_count": (c.c_uint32, [c.c_void_p]),
    "sph_level_optimize_connectivity": (c.c_int32, [c.c_void_p, c.c_void_p]),
    "sph_level_write": (c.c_int32, [c.c_void_p, sph_write_fn, c.c_void_p]),
    "sph_level_read": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.POINTER(c.c_void_p)]),
    "sph_coverage_measure": (c.c_int32, [c.c_void_p, c.c_void_p, c.POINTER(sph_coverage)]),
    "sph_inflation_options_init": (None, [c.POINTER(sph_inflation_options), c.c_size_t]),
    "sph_coverage_inflate": (c.c_int32, [c.c_void_p, c.c_void_p, c.POINTER(sph_inflation_options), c.POINTER(sph_inflation), c.POINTER(c.c_void_p)]),
    "sph_skin_create_from_arrays": (c.c_int32, [c.c_void_p, c.POINTER(sph_skin_arrays), c.POINTER(c.c_void_p)]),
    "sph_skin_options_init": (None, [c.POINTER(sph_skin_options), c.c_size_t]),
    "sph_skin_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_skin_source), c.c_size_t, c.POINTER(sph_skin_options), c.POINTER(c.c_void_p)]),
    "sph_skin_destroy": (None, [c.c_void_p]),
    "sph_skin_vertex_count": (c.c_uint32, [c.c_void_p]),
    "sph_skin_bone_count": (c.c_uint32, [c.c_void_p]),
    "sph_skin_influence_count": (c.c_uint32, [c.c_void_p]),
    "sph_skin_frame_count": (c.c_uint32, [c.c_void_p]),
    "sph_skin_get_arrays": (c.c_int32, [c.c_void_p, c.POINTER(sph_skin_arrays)]),
    "sph_skin_get_errors": (c.c_int32, [c.c_void_p, c.POINTER(sph_skin_error), c.POINTER(sph_skin_error)]),
    "sph_skin_measure": (c.c_int32, [c.c_void_p, c.POINTER(sph_skin_source), c.c_size_t, c.POINTER(sph_skin_error), c.POINTER(sph_skin_error)]),
    "sph_deformer_options_init": (None, [c.POINTER(sph_deformer_options), c.c_size_t]),
    "sph_deformer_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_deformer_options), c.POINTER(c.c_void_p)]),
    "sph_deformer_destroy": (None, [c.c_void_p]),
    "sph_deformer_pose": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_int32, c.c_void_p, c.c_void_p]),
    "sph_pose_from_spheres": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_implicit_options_init": (None, [c.POINTER(sph_implicit_options), c.c_size_t]),
    "sph_implicit_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_implicit_options), c.POINTER(c.c_void_p)]),
    "sph_implicit_destroy": (None, [c.c_void_p]),
    "sph_implicit_bone_count": (c.c_uint32, [c.c_void_p]),
    "sph_implicit_joint_count": (c.c_uint32, [c.c_void_p]),
    "sph_implicit_get_part": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(sph_implicit_part)]),
    "sph_implicit_get_joint": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(sph_implicit_joint)]),
    "sph_implicit_set_joint": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(sph_implicit_joint)]),
    "sph_theta_curve_preset": (None, [c.POINTER(sph_theta_curve), c.c_int32]),
    "sph_theta_curve_at": (c.c_double, [c.POINTER(sph_theta_curve), c.c_double]),
    "sph_operation_compose": (c.c_int32, [c.c_int32, c.c_double, c.c_double, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_implicit_distances": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_size_t, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_implicit_evaluate": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_int32, c.c_size_t, c.c_void_p, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_implicit_write": (c.c_int32, [c.c_void_p, sph_write_fn, c.c_void_p]),
    "sph_implicit_read": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.POINTER(c.c_void_p)]),
    "sph_tracker_options_init": (None, [c.POINTER(sph_tracker_options), c.c_size_t]),
    "sph_tracker_create": (c.c_int32, [c.c_void_p, c.c_void_p, c.POINTER(sph_tracker_options), c.POINTER(c.c_void_p)]),
    "sph_tracker_destroy": (None, [c.c_void_p]),
    "sph_tracker_pose": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_void_p, c.c_void_p, c.POINTER(sph_tracker_report)]),
    "sph_mesh_intersections": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_size_t, c.c_void_p, c.c_void_p]),
    "sph_measure_options_init": (None, [c.POINTER(sph_measure_options), c.c_size_t]),
    "sph_measure_level": (c.c_int32, [c.c_void_p, c.c_void_p, c.POINTER(sph_measure_options), c.POINTER(sph_distances), c.POINTER(sph_distances)]),
    "sph_measure_meshes": (c.c_int32, [c.c_void_p, c.c_void_p, c.POINTER(sph_measure_options), c.POINTER(sph_distances), c.POINTER(sph_distances)]),
    "sph_quadric_create": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(c.c_void_p)]),
    "sph_quadric_destroy": (None, [c.c_void_p]),
    "sph_quadric_frame_count": (c.c_uint32, [c.c_void_p]),
    "sph_quadric_add_plane": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_void_p, c.c_double]),
    "sph_quadric_add_attachment": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_double]),
    "sph_quadric_add": (c.c_int32, [c.c_void_p, c.c_void_p]),
    "sph_quadric_evaluate": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_double, c.c_void_p]),
    "sph_quadric_minimize": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p, c.c_double, c.POINTER(sph_quadric_minimum), c.c_void_p]),
    "sph_query_options_init": (None, [c.POINTER(sph_query_options), c.c_size_t]),
    "sph_query_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_query_options), c.POINTER(c.c_void_p)]),
    "sph_query_destroy": (None, [c.c_void_p]),
    "sph_query_pose_frame": (c.c_int32, [c.c_void_p, c.c_uint32]),
    "sph_query_pose_time": (c.c_int32, [c.c_void_p, c.c_double]),
    "sph_query_pose_centers": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_void_p]),
    "sph_query_cast": (c.c_int32, [c.c_void_p, c.POINTER(sph_sweep), c.c_size_t, c.POINTER(sph_hit)]),
    "sph_query_cast_any": (c.c_int32, [c.c_void_p, c.POINTER(sph_sweep), c.c_size_t, c.c_void_p]),
    "sph_query_nearest": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_size_t, c.POINTER(sph_nearest)]),
    "sph_query_contains": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_size_t, c.c_int32, c.c_void_p]),
    "sph_query_between": (c.c_int32, [c.c_void_p, c.c_void_p, c.POINTER(sph_gap)]),
    "sph_query_cast_between": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p, c.POINTER(sph_gap)]),
    "sph_simplify_options_init": (None, [c.POINTER(sph_simplify_options), c.c_size_t]),
    "sph_progressive_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_simplify_options), c.POINTER(c.c_void_p)]),
    "sph_progressive_destroy": (None, [c.c_void_p]),
    "sph_progressive_collapse_count": (c.c_uint32, [c.c_void_p]),
    "sph_progressive_bounding_diagonal": (c.c_double, [c.c_void_p]),
    "sph_progressive_pose_count": (c.c_uint32, [c.c_void_p]),
    "sph_progressive_get_level": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(sph_progressive_level)]),
    "sph_progressive_find_vertices": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p]),
    "sph_progressive_find_triangles": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p]),
    "sph_progressive_find_error": (c.c_int32, [c.c_void_p, c.c_double, c.c_void_p]),
    "sph_progressive_get_skin": (c.c_int32, [c.c_void_p, c.c_uint32, c.POINTER(c.c_void_p)]),
    "sph_progressive_get_attributes": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_progressive_create_cursor": (c.c_int32, [c.c_void_p, c.POINTER(c.c_void_p)]),
    "sph_progressive_point_count": (c.c_uint32, [c.c_void_p]),
    "sph_progressive_influence_count": (c.c_uint32, [c.c_void_p]),
    "sph_progressive_attribute_count": (c.c_uint32, [c.c_void_p]),
    "sph_progressive_point": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_skeleton_options_init": (None, [c.POINTER(sph_skeleton_options), c.c_size_t]),
    "sph_skeleton_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_skeleton_options), c.POINTER(c.c_void_p)]),
    "sph_skeleton_destroy": (None, [c.c_void_p]),
    "sph_skeleton_get_arrays": (c.c_int32, [c.c_void_p, c.POINTER(sph_skeleton_arrays)]),
    "sph_skeleton_get_locals": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_skeleton_get_transforms": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p]),
    "sph_surface_options_init": (None, [c.POINTER(sph_surface_options), c.c_size_t]),
    "sph_surface_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_surface_options), c.POINTER(c.c_void_p)]),
    "sph_surface_destroy": (None, [c.c_void_p]),
    "sph_surface_frame_count": (c.c_uint32, [c.c_void_p]),
    "sph_surface_cell": (c.c_double, [c.c_void_p]),
    "sph_surface_vertex_count": (c.c_uint32, [c.c_void_p, c.c_uint32]),
    "sph_surface_triangle_count": (c.c_size_t, [c.c_void_p, c.c_uint32]),
    "sph_surface_positions": (c.c_void_p, [c.c_void_p, c.c_uint32]),
    "sph_surface_normals": (c.c_void_p, [c.c_void_p, c.c_uint32]),
    "sph_surface_triangles": (c.c_void_p, [c.c_void_p, c.c_uint32]),
    "sph_version": (c.c_uint32, []),
    "sph_io_open_rig_options_init": (None, [c.POINTER(sph_io_open_rig_options), c.c_size_t]),
    "sph_io_open_rig": (c.c_int32, [c.c_void_p, c.c_char_p, c.POINTER(sph_io_open_rig_options), c.POINTER(c.c_void_p)]),
    "sph_io_rig_destroy": (None, [c.c_void_p]),
    "sph_io_rig_skin": (c.c_void_p, [c.c_void_p]),
    "sph_io_rig_get_arrays": (c.c_int32, [c.c_void_p, c.POINTER(sph_io_rig_arrays)]),
    "sph_io_save_mesh": (c.c_int32, [c.c_void_p, c.c_uint32, c.c_void_p, c.c_void_p, c.c_size_t, c.c_void_p, c.c_char_p]),
    "sph_io_save_frames_glb": (c.c_int32, [c.c_void_p, c.POINTER(sph_io_frames), c.c_char_p]),
    "sph_io_save_implicit": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_char_p]),
    "sph_io_load_implicit": (c.c_int32, [c.c_void_p, c.c_char_p, c.POINTER(c.c_void_p)]),
    "sph_io_open_rig_levels": (c.c_int32, [c.c_void_p, c.c_char_p, c.POINTER(sph_io_open_rig_options), c.POINTER(sph_simplify_options), c.POINTER(c.c_void_p)]),
    "sph_io_rig_levels_destroy": (None, [c.c_void_p]),
    "sph_io_rig_levels_progressive": (c.c_void_p, [c.c_void_p]),
    "sph_io_rig_levels_rig": (c.c_void_p, [c.c_void_p]),
    "sph_io_rig_levels_save": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_size_t, c.c_char_p]),
    "sph_io_spill_options_init": (None, [c.POINTER(sph_io_spill_options), c.c_size_t]),
    "sph_io_spill_create": (c.c_int32, [c.c_void_p, c.POINTER(sph_io_spill_options), c.POINTER(c.c_void_p)]),
    "sph_io_spill_destroy": (None, [c.c_void_p]),
    "sph_io_spill_get_allocator": (None, [c.c_void_p, c.POINTER(sph_allocator)]),
    "sph_io_spill_get_executor": (None, [c.c_void_p, c.POINTER(sph_executor)]),
    "sph_io_spill_trim": (None, [c.c_void_p]),
    "sph_io_spill_get_figures": (c.c_int32, [c.c_void_p, c.POINTER(sph_io_spill_figures)]),
    "sph_io_open_options_init": (None, [c.POINTER(sph_io_open_options), c.c_size_t]),
    "sph_io_open_animation": (c.c_int32, [c.c_void_p, c.POINTER(c.c_char_p), c.c_size_t, c.POINTER(sph_io_open_options), c.POINTER(c.c_void_p)]),
    "sph_io_describe": (c.c_int32, [c.c_void_p, c.c_char_p, c.POINTER(sph_io_description)]),
    "sph_io_list_clips": (c.c_int32, [c.c_void_p, c.c_char_p, c.c_double, sph_io_clip_fn, c.c_void_p]),
    "sph_io_list_objects": (c.c_int32, [c.c_void_p, c.c_char_p, c.c_char_p, sph_io_archive_fn, sph_io_object_fn, c.c_void_p]),
    "sph_io_sort_natural": (None, [c.POINTER(c.c_char_p), c.c_size_t]),
    "sph_io_save_obj_pc2": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_double, c.c_double, c.c_char_p, c.c_char_p]),
    "sph_io_save_obj_mdd": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_double, c.c_double, c.c_char_p, c.c_char_p]),
    "sph_io_identify": (c.c_int32, [c.c_void_p, c.c_char_p, c.c_void_p]),
    "sph_io_save_hierarchy": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_char_p]),
    "sph_io_load_hierarchy": (c.c_int32, [c.c_void_p, c.c_char_p, c.POINTER(c.c_void_p)]),
    "sph_io_save_level": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_char_p]),
    "sph_io_save_surface": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_uint32, c.c_char_p]),
    "sph_io_rig_options_init": (None, [c.POINTER(sph_io_rig_options), c.c_size_t]),
    "sph_io_save_rig": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_void_p, c.POINTER(sph_io_rig_options), c.c_char_p]),
    "sph_io_load_level": (c.c_int32, [c.c_void_p, c.c_char_p, c.POINTER(c.c_void_p)]),
    "sph_io_export_options_init": (None, [c.POINTER(sph_io_export_options), c.c_size_t]),
    "sph_io_export_level": (c.c_int32, [c.c_void_p, c.c_void_p, c.c_char_p, c.POINTER(sph_io_export_options), c.POINTER(sph_io_export_report)]),
}
