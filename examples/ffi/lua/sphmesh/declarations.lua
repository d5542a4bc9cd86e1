-- SPDX-License-Identifier: MIT
-- Written by examples/ffi/declarations.py from the public headers: do not edit, run `ninja ffi-declarations`.
local declarations = {}
declarations.cdef = [[
typedef int32_t sph_status;
enum 
{
  SPH_OK = 0,
  SPH_E_INVALID = 1,
  SPH_E_NOMEM = 2,
  SPH_E_CANCELLED = 3,
  SPH_E_VERSION = 4,
  SPH_E_IO = 5,
  SPH_E_FORMAT = 6,
  SPH_E_UNSUPPORTED = 7,
  SPH_E_LIMIT = 8,
  SPH_E_STATE = 9
};
const char *sph_status_text(sph_status status);
typedef struct sph_context sph_context;
typedef struct sph_allocator
{
  void *user;
  void *(*allocate)(void *user, size_t size, size_t alignment);
  void (*release)(void *user, void *memory, size_t size);
} sph_allocator;
typedef void sph_range_fn(void *argument, size_t begin, size_t end);
typedef struct sph_executor
{
  void *user;
  void (*parallel_for)(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument);
} sph_executor;
enum 
{
  SPH_LOG_WARNING = 1,
  SPH_LOG_INFO = 2,
  SPH_LOG_DEBUG = 3
};
typedef void sph_log_fn(void *user, int32_t severity, const char *message);
typedef bool sph_progress_fn(void *user, const char *stage, double fraction);
typedef struct sph_context_options
{
  uint32_t struct_size;
  uint32_t flags;
  sph_allocator allocator;
  sph_executor executor;
  sph_log_fn *log;
  void *log_user;
  sph_progress_fn *progress;
  void *progress_user;
  uint32_t thread_count;
  uint32_t reserved0;
  uint64_t memory_limit;
} sph_context_options;
void sph_context_options_init(sph_context_options *options, size_t size);
sph_status sph_context_create(const sph_context_options *options, sph_context **out);
void sph_context_destroy(sph_context *context);
uint64_t sph_context_memory_used(const sph_context *context);
uint64_t sph_context_memory_peak(const sph_context *context);
const char *sph_context_last_message(const sph_context *context);
sph_status sph_context_fail(sph_context *context, sph_status status, const char *message);
void *sph_context_allocate(sph_context *context, size_t count, size_t size);
void sph_context_release(sph_context *context, void *memory);
sph_status sph_context_report_progress(sph_context *context, const char *stage, double fraction);
void sph_context_log(sph_context *context, int32_t severity, const char *message);
void sph_context_parallel_for(sph_context *context, size_t count, size_t grain, sph_range_fn *body, void *argument);
typedef struct sph_animation sph_animation;
typedef struct sph_frame_source
{
  void *user;
  sph_status (*read_frame)(void *user, uint32_t frame, float *xyz);
  void (*destroy)(void *user);
} sph_frame_source;
sph_status sph_animation_create(sph_context *context, uint32_t vertex_count, uint32_t frame_count, sph_animation **out);
sph_status sph_animation_create_from_source(sph_context *context, uint32_t vertex_count, uint32_t frame_count, const sph_frame_source *source, sph_animation **out);
sph_status sph_animation_create_from_positions(sph_context *context, uint32_t vertex_count, uint32_t frame_count, const float *positions, size_t stride, size_t frame_stride, sph_animation **out);
void sph_animation_destroy(sph_animation *animation);
sph_status sph_animation_set_frame(sph_animation *animation, uint32_t frame, const float *xyz, size_t stride);
sph_status sph_animation_set_triangles(sph_animation *animation, const uint32_t *indices, size_t triangle_count, size_t stride);
sph_status sph_animation_set_edges(sph_animation *animation, const uint32_t *indices, size_t edge_count, size_t stride);
uint32_t sph_animation_vertex_count(const sph_animation *animation);
uint32_t sph_animation_frame_count(const sph_animation *animation);
size_t sph_animation_triangle_count(const sph_animation *animation);
size_t sph_animation_edge_count(const sph_animation *animation);
const uint32_t *sph_animation_triangles(const sph_animation *animation);
const uint32_t *sph_animation_edges(const sph_animation *animation);
sph_status sph_animation_read_frame(const sph_animation *animation, uint32_t frame, float *xyz);
sph_status sph_animation_bounding_diagonal(const sph_animation *animation, double *diagonal);
typedef struct sph_animation_report
{
  uint32_t struct_size;
  uint32_t reserved0;
  uint64_t non_finite_count;
  uint32_t first_non_finite_frame;
  uint32_t first_non_finite_vertex;
  uint64_t repeated_index_count;
  uint64_t first_repeated_index;
  uint64_t duplicate_triangle_count;
  uint64_t zero_area_count;
  uint32_t first_zero_area_frame;
  uint32_t first_zero_area_triangle;
  uint64_t boundary_edge_count;
  uint64_t non_manifold_edge_count;
  uint64_t inconsistent_edge_count;
  uint64_t wire_edge_count;
  uint64_t component_count;
  uint64_t isolated_vertex_count;
  uint64_t coincident_vertex_count;
  uint64_t inward_component_count;
} sph_animation_report;
void sph_animation_report_init(sph_animation_report *report, size_t size);
sph_status sph_animation_check(const sph_animation *animation, sph_animation_report *report);
sph_status sph_animation_weld(const sph_animation *animation, float tolerance, uint32_t *map, sph_animation **out);
typedef struct sph_hierarchy sph_hierarchy;
enum 
{
  SPH_IMPORTANCE_NONE = 0,
  SPH_IMPORTANCE_CURVATURE = 1,
  SPH_IMPORTANCE_CALLER = 2
};
enum 
{
  SPH_RADIUS_CONSTANT = 0,
  SPH_RADIUS_PER_FRAME = 1,
  SPH_RADIUS_ZERO = 2
};
enum 
{
  SPH_ORIENTATION_OUTWARD = 0,
  SPH_ORIENTATION_AS_GIVEN = 1
};
typedef struct sph_hierarchy_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t importance;
  int32_t radius_mode;
  double radius_factor;
  double temporal_coherence;
  uint32_t width_directions;
  int32_t orientation;
  const float *importance_weights;
  size_t importance_frame_stride;
} sph_hierarchy_options;
void sph_hierarchy_options_init(sph_hierarchy_options *options, size_t size);
typedef struct sph_collapse
{
  uint32_t u;
  uint32_t v;
  uint32_t node;
  uint32_t forced;
  double cost;
  double error;
} sph_collapse;
sph_status sph_hierarchy_create(const sph_animation *animation, const sph_hierarchy_options *options, sph_hierarchy **out);
void sph_hierarchy_destroy(sph_hierarchy *hierarchy);
uint32_t sph_hierarchy_vertex_count(const sph_hierarchy *hierarchy);
uint32_t sph_hierarchy_frame_count(const sph_hierarchy *hierarchy);
uint32_t sph_hierarchy_collapse_count(const sph_hierarchy *hierarchy);
double sph_hierarchy_bounding_diagonal(const sph_hierarchy *hierarchy);
uint64_t sph_hierarchy_evaluation_count(const sph_hierarchy *hierarchy);
uint32_t sph_hierarchy_first_forced(const sph_hierarchy *hierarchy);
sph_status sph_hierarchy_collapse(const sph_hierarchy *hierarchy, uint32_t index, sph_collapse *collapse);
sph_status sph_hierarchy_read_collapses(const sph_hierarchy *hierarchy, uint32_t first, uint32_t count, sph_collapse *collapses);
sph_status sph_hierarchy_sphere(const sph_hierarchy *hierarchy, uint32_t node, float *centers, float *radii);
sph_status sph_hierarchy_count_for_error(const sph_hierarchy *hierarchy, double max_error, uint32_t *sphere_count);
typedef sph_status sph_write_fn(void *user, const void *bytes, size_t size);
sph_status sph_hierarchy_write(const sph_hierarchy *hierarchy, sph_write_fn *write, void *user);
sph_status sph_hierarchy_read(sph_context *context, const void *bytes, size_t size, sph_hierarchy **out);
typedef struct sph_cursor sph_cursor;
sph_status sph_cursor_create(const sph_hierarchy *hierarchy, sph_cursor **out);
void sph_cursor_destroy(sph_cursor *cursor);
sph_status sph_cursor_move(sph_cursor *cursor, uint32_t sphere_count);
uint32_t sph_cursor_sphere_count(const sph_cursor *cursor);
size_t sph_cursor_edge_count(const sph_cursor *cursor);
size_t sph_cursor_triangle_count(const sph_cursor *cursor);
sph_status sph_cursor_read(const sph_cursor *cursor, uint32_t *nodes, uint32_t *edges, uint32_t *triangles);
typedef struct sph_level sph_level;
typedef struct sph_level_arrays
{
  uint32_t struct_size;
  uint32_t sphere_count;
  uint32_t frame_count;
  uint32_t radii_per_frame;
  const float *centers;
  const float *radii;
  size_t edge_count;
  const uint32_t *edges;
  size_t triangle_count;
  const uint32_t *triangles;
  size_t label_count;
  const uint32_t *labels;
} sph_level_arrays;
sph_status sph_level_create(const sph_hierarchy *hierarchy, uint32_t sphere_count, sph_level **out);
enum 
{
  SPH_LABELS_VERTICES = 0,
  SPH_LABELS_NONE = 1
};
typedef struct sph_level_options
{
  uint32_t struct_size;
  uint32_t flags;
  uint32_t first_frame;
  uint32_t frame_count;
  int32_t labels;
} sph_level_options;
void sph_level_options_init(sph_level_options *options, size_t size);
sph_status sph_level_extract(const sph_hierarchy *hierarchy, uint32_t sphere_count, const sph_level_options *options, sph_level **out);
sph_status sph_level_create_from_arrays(sph_context *context, const sph_level_arrays *arrays, sph_level **out);
void sph_level_destroy(sph_level *level);
sph_status sph_level_get_arrays(const sph_level *level, sph_level_arrays *arrays);
uint32_t sph_level_sphere_count(const sph_level *level);
uint32_t sph_level_frame_count(const sph_level *level);
sph_status sph_level_optimize_connectivity(sph_level *level, const sph_animation *animation);
sph_status sph_level_write(const sph_level *level, sph_write_fn *write, void *user);
sph_status sph_level_read(sph_context *context, const void *bytes, size_t size, sph_level **out);
typedef struct sph_coverage
{
  uint32_t struct_size;
  uint32_t frame;
  uint32_t vertex;
  uint32_t reserved0;
  double distance;
  uint64_t uncovered_count;
} sph_coverage;
sph_status sph_coverage_measure(const sph_animation *animation, const sph_level *level, sph_coverage *coverage);
typedef struct sph_inflation_options
{
  uint32_t struct_size;
  uint32_t flags;
  uint32_t rounds;
  uint32_t reserved0;
  double margin;
} sph_inflation_options;
void sph_inflation_options_init(sph_inflation_options *options, size_t size);
typedef struct sph_inflation
{
  uint32_t struct_size;
  uint32_t rounds;
  uint64_t grown_count;
  double max_growth;
  double mean_growth;
  double volume_before;
  double volume_after;
} sph_inflation;
sph_status sph_coverage_inflate(const sph_animation *animation, const sph_level *level, const sph_inflation_options *options, sph_inflation *inflation, sph_level **out);
typedef struct sph_skin sph_skin;
typedef struct sph_skin_clip
{
  const char *name;
  uint32_t first_frame;
  uint32_t frame_count;
  double frames_per_second;
} sph_skin_clip;
typedef struct sph_skin_arrays
{
  uint32_t struct_size;
  uint32_t vertex_count;
  uint32_t bone_count;
  uint32_t influence_count;
  uint32_t frame_count;
  uint32_t clip_count;
  const float *rest;
  const uint32_t *bones;
  const float *weights;
  const double *transforms;
  const sph_skin_clip *clips;
  const double *pivots;
  const double *radii;
  size_t triangle_count;
  const uint32_t *triangles;
  size_t link_count;
  const uint32_t *links;
  uint32_t rigid;
  uint32_t reserved0;
} sph_skin_arrays;
sph_status sph_skin_create_from_arrays(sph_context *context, const sph_skin_arrays *arrays, sph_skin **out);
enum 
{
  SPH_SKIN_MIXED = 0,
  SPH_SKIN_ANIMATION = 1,
  SPH_SKIN_GEOMETRIC = 2
};
enum 
{
  SPH_SKIN_UNIFORM = 1
};
enum 
{
  SPH_SKIN_STEP_START = 0,
  SPH_SKIN_STEP_TRANSFORMS = 1,
  SPH_SKIN_STEP_WEIGHTS = 2,
  SPH_SKIN_STEP_REST = 3,
  SPH_SKIN_STEP_AHEAD = 4
};
typedef void sph_skin_step_fn(void *user, uint32_t round, int32_t step, double energy);
typedef struct sph_skin_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t mode;
  uint32_t influence_limit;
  uint32_t rings;
  uint32_t round_limit;
  uint32_t rest_interval;
  uint32_t initial_influence_count;
  double tolerance;
  double error_limit;
  double smoothness;
  double filter_radius;
  double minor_bone;
  const uint32_t *initial_bones;
  const float *initial_weights;
  const double *initial_transforms;
  const uint8_t *locked_bones;
  const uint8_t *locked_vertices;
  sph_skin_step_fn *step;
  void *step_user;
} sph_skin_options;
void sph_skin_options_init(sph_skin_options *options, size_t size);
typedef struct sph_skin_source
{
  const sph_animation *animation;
  const char *name;
  double frames_per_second;
} sph_skin_source;
sph_status sph_skin_create(const sph_level *level, const sph_skin_source *sources, size_t source_count, const sph_skin_options *options, sph_skin **out);
void sph_skin_destroy(sph_skin *skin);
uint32_t sph_skin_vertex_count(const sph_skin *skin);
uint32_t sph_skin_bone_count(const sph_skin *skin);
uint32_t sph_skin_influence_count(const sph_skin *skin);
uint32_t sph_skin_frame_count(const sph_skin *skin);
sph_status sph_skin_get_arrays(const sph_skin *skin, sph_skin_arrays *arrays);
typedef struct sph_skin_error
{
  double mse;
  double rmse;
  double max;
  double rmse_percent;
  double max_percent;
  double diagonal;
  uint32_t max_vertex;
  uint32_t max_frame;
} sph_skin_error;
sph_status sph_skin_get_errors(const sph_skin *skin, sph_skin_error *overall, sph_skin_error *per_frame);
sph_status sph_skin_measure(const sph_skin *skin, const sph_skin_source *sources, size_t source_count, sph_skin_error *overall, sph_skin_error *per_frame);
typedef struct sph_deformer sph_deformer;
enum 
{
  SPH_POSE_LINEAR = 0,
  SPH_POSE_DUAL_QUATERNION = 1
};
typedef struct sph_deformer_options
{
  uint32_t struct_size;
  uint32_t flags;
  const float *normals;
} sph_deformer_options;
void sph_deformer_options_init(sph_deformer_options *options, size_t size);
sph_status sph_deformer_create(const sph_skin *skin, const sph_deformer_options *options, sph_deformer **out);
void sph_deformer_destroy(sph_deformer *deformer);
sph_status sph_deformer_pose(sph_deformer *deformer, const double *transforms, size_t pose_count, int32_t method, float *positions, float *normals);
sph_status sph_pose_from_spheres(const sph_skin *skin, const double *reference, const double *centers, double *transforms);
typedef struct sph_implicit sph_implicit;
typedef struct sph_tracker sph_tracker;
enum 
{
  SPH_OPERATION_UNION = 0,
  SPH_OPERATION_BLEND = 1,
  SPH_OPERATION_BULGE = 2
};
enum 
{
  SPH_EVALUATION_TABLE = 0,
  SPH_EVALUATION_EXACT = 1
};
typedef struct sph_theta_curve
{
  double angles[3];
  double thetas[3];
  double exponents[2];
} sph_theta_curve;
typedef struct sph_implicit_joint
{
  uint32_t struct_size;
  int32_t operation;
  uint32_t bones[2];
  double position[3];
  double strength;
  sph_theta_curve curve;
} sph_implicit_joint;
typedef struct sph_implicit_options
{
  uint32_t struct_size;
  uint32_t flags;
  uint32_t sample_count;
  int32_t operation;
  uint32_t table_size;
  uint32_t operator_table_size;
  double joint_gap;
  const uint32_t *parents;
  const uint32_t *parts;
  const sph_implicit_joint *joints;
  size_t joint_count;
} sph_implicit_options;
void sph_implicit_options_init(sph_implicit_options *options, size_t size);
sph_status sph_implicit_create(const sph_skin *skin, const sph_implicit_options *options, sph_implicit **out);
void sph_implicit_destroy(sph_implicit *implicit);
uint32_t sph_implicit_bone_count(const sph_implicit *implicit);
uint32_t sph_implicit_joint_count(const sph_implicit *implicit);
typedef struct sph_implicit_part
{
  uint32_t struct_size;
  uint32_t vertex_count;
  uint32_t sample_count;
  uint32_t closing_count;
  double radius;
  double low[3];
  double high[3];
  const double *samples;
  const double *normals;
} sph_implicit_part;
sph_status sph_implicit_get_part(const sph_implicit *implicit, uint32_t bone, sph_implicit_part *part);
sph_status sph_implicit_get_joint(const sph_implicit *implicit, uint32_t index, sph_implicit_joint *joint);
sph_status sph_implicit_set_joint(sph_implicit *implicit, uint32_t index, const sph_implicit_joint *joint);
void sph_theta_curve_preset(sph_theta_curve *curve, int32_t operation);
double sph_theta_curve_at(const sph_theta_curve *curve, double alpha);
sph_status sph_operation_compose(int32_t operation, double strength, double theta, const double values[2], double *result, double slopes[2]);
sph_status sph_implicit_distances(const sph_implicit *implicit, uint32_t bone, size_t count, const double *points, double *distances, double *gradients);
sph_status sph_implicit_evaluate(const sph_implicit *implicit, const double *transforms, int32_t evaluation, size_t count, const double *points, double *values, double *gradients, uint32_t *bones);
sph_status sph_implicit_write(const sph_implicit *implicit, sph_write_fn *write, void *user);
sph_status sph_implicit_read(sph_context *context, const void *bytes, size_t size, sph_implicit **out);
enum 
{
  SPH_TRACKER_UNGUARDED = 1,
  SPH_TRACKER_UNSMOOTHED = 2,
  SPH_TRACKER_COUNTED = 4
};
typedef struct sph_tracker_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t method;
  int32_t evaluation;
  uint32_t iteration_limit;
  uint32_t smoothing_rounds;
  double step;
  double contact_angle;
  double tolerance;
  double reach;
} sph_tracker_options;
void sph_tracker_options_init(sph_tracker_options *options, size_t size);
sph_status sph_tracker_create(const sph_implicit *implicit, const sph_skin *skin, const sph_tracker_options *options, sph_tracker **out);
void sph_tracker_destroy(sph_tracker *tracker);
typedef struct sph_tracker_report
{
  uint32_t moved;
  uint32_t contacts;
  uint32_t held_back;
  uint32_t reserved0;
  double farthest;
  uint64_t pairs_before;
  uint64_t pairs_after;
} sph_tracker_report;
sph_status sph_tracker_pose(sph_tracker *tracker, const double *transforms, size_t pose_count, float *positions, float *normals, sph_tracker_report *reports);
sph_status sph_mesh_intersections(sph_context *context, uint32_t vertex_count, const float *positions, size_t triangle_count, const uint32_t *triangles, uint64_t *pairs);
typedef struct sph_measure_options
{
  uint32_t struct_size;
  uint32_t flags;
  uint32_t samples;
  uint32_t seed;
  uint32_t first_frame;
  uint32_t frame_step;
  uint32_t frame_limit;
  uint32_t reserved0;
} sph_measure_options;
void sph_measure_options_init(sph_measure_options *options, size_t size);
typedef struct sph_distances
{
  double hausdorff;
  double mean12;
  double mean21;
  double max12;
  double max21;
  double area1;
  double area2;
} sph_distances;
sph_status sph_measure_level(const sph_animation *animation, const sph_level *level, const sph_measure_options *options, sph_distances *mean, sph_distances *per_frame);
sph_status sph_measure_meshes(const sph_animation *animation1, const sph_animation *animation2, const sph_measure_options *options, sph_distances *mean, sph_distances *per_frame);
typedef struct sph_quadric sph_quadric;
typedef struct sph_quadric_minimum
{
  double radius;
  double lambda;
  double cost;
  uint32_t degenerate_frames;
  uint32_t reserved0;
} sph_quadric_minimum;
sph_status sph_quadric_create(sph_context *context, uint32_t frame_count, sph_quadric **out);
void sph_quadric_destroy(sph_quadric *quadric);
uint32_t sph_quadric_frame_count(const sph_quadric *quadric);
sph_status sph_quadric_add_plane(sph_quadric *quadric, uint32_t frame, const double point[3], const double normal[3], double weight);
sph_status sph_quadric_add_attachment(sph_quadric *quadric, uint32_t frame, const double center[3], double weight);
sph_status sph_quadric_add(sph_quadric *quadric, const sph_quadric *other);
sph_status sph_quadric_evaluate(const sph_quadric *quadric, const double *centers, double radius, double *cost);
sph_status sph_quadric_minimize(const sph_quadric *quadric, const double *u, const double *v, double radius_max, sph_quadric_minimum *minimum, double *centers);
typedef struct sph_query sph_query;
enum 
{
  SPH_SEARCH_AUTO = 0,
  SPH_SEARCH_EXHAUSTIVE = 1,
  SPH_SEARCH_TREE = 2
};
typedef struct sph_query_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t search;
  uint32_t reserved0;
} sph_query_options;
void sph_query_options_init(sph_query_options *options, size_t size);
sph_status sph_query_create(const sph_level *level, const sph_query_options *options, sph_query **out);
void sph_query_destroy(sph_query *query);
sph_status sph_query_pose_frame(sph_query *query, uint32_t frame);
sph_status sph_query_pose_time(sph_query *query, double frame);
sph_status sph_query_pose_centers(sph_query *query, const float *centers, size_t stride, const float *radii);
enum 
{
  SPH_SIMPLEX_NONE = 0,
  SPH_SIMPLEX_SPHERE = 1,
  SPH_SIMPLEX_EDGE = 2,
  SPH_SIMPLEX_TRIANGLE = 3
};
typedef struct sph_contact
{
  double point[3];
  double normal[3];
  double weights[3];
  uint32_t spheres[3];
  uint32_t simplex;
  uint32_t kind;
  uint32_t reserved0;
} sph_contact;
typedef struct sph_sweep
{
  float from[3];
  float to[3];
  float radius;
  uint32_t reserved0;
} sph_sweep;
typedef struct sph_hit
{
  double s;
  double depth;
  uint32_t hit;
  uint32_t reserved0;
  sph_contact contact;
} sph_hit;
sph_status sph_query_cast(const sph_query *query, const sph_sweep *sweeps, size_t count, sph_hit *hits);
sph_status sph_query_cast_any(const sph_query *query, const sph_sweep *sweeps, size_t count, uint8_t *hits);
typedef struct sph_nearest
{
  double distance;
  sph_contact contact;
} sph_nearest;
sph_status sph_query_nearest(const sph_query *query, const float *points, size_t stride, size_t count, sph_nearest *nearest);
enum 
{
  SPH_CAVITY_SOLID = 0,
  SPH_CAVITY_SPACE = 1
};
sph_status sph_query_contains(const sph_query *query, const float *points, size_t stride, size_t count, int32_t cavities, uint8_t *inside);
typedef struct sph_gap
{
  double s;
  double distance;
  uint32_t hit;
  uint32_t reserved0;
  sph_contact first;
  sph_contact second;
} sph_gap;
sph_status sph_query_between(const sph_query *first, const sph_query *second, sph_gap *gap);
sph_status sph_query_cast_between(const sph_query *first, const float motion[3], const sph_query *second, sph_gap *gap);
typedef struct sph_progressive sph_progressive;
enum 
{
  SPH_SIMPLIFY_SKINNED = 0,
  SPH_SIMPLIFY_POSITION = 1,
  SPH_SIMPLIFY_PULLED_BACK = 2,
  SPH_SIMPLIFY_REST = 3
};
typedef struct sph_simplify_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t method;
  uint32_t influence_limit;
  uint32_t pose_limit;
  uint32_t pose_count;
  const double *poses;
  double border_weight;
  double tolerance;
  uint32_t round_limit;
  uint32_t attribute_count;
  const float *attributes;
  const float *normals;
  const uint32_t *groups;
  const uint8_t *locked;
} sph_simplify_options;
void sph_simplify_options_init(sph_simplify_options *options, size_t size);
sph_status sph_progressive_create(const sph_skin *skin, const sph_simplify_options *options, sph_progressive **out);
void sph_progressive_destroy(sph_progressive *progressive);
uint32_t sph_progressive_collapse_count(const sph_progressive *progressive);
double sph_progressive_bounding_diagonal(const sph_progressive *progressive);
uint32_t sph_progressive_pose_count(const sph_progressive *progressive);
typedef struct sph_progressive_level
{
  uint32_t struct_size;
  uint32_t collapse_count;
  uint32_t vertex_count;
  uint32_t point_count;
  uint32_t triangle_count;
  uint32_t forced;
  double error;
  double max_error;
} sph_progressive_level;
sph_status sph_progressive_get_level(const sph_progressive *progressive, uint32_t level, sph_progressive_level *out);
sph_status sph_progressive_find_vertices(const sph_progressive *progressive, uint32_t vertex_count, uint32_t *level);
sph_status sph_progressive_find_triangles(const sph_progressive *progressive, uint32_t triangle_count, uint32_t *level);
sph_status sph_progressive_find_error(const sph_progressive *progressive, double max_error, uint32_t *level);
sph_status sph_progressive_get_skin(const sph_progressive *progressive, uint32_t level, sph_skin **out);
sph_status sph_progressive_get_attributes(const sph_progressive *progressive, uint32_t level, float *normals, float *attributes, uint32_t *vertex_sources, uint32_t *triangle_sources);
sph_status sph_progressive_create_cursor(const sph_progressive *progressive, sph_cursor **out);
uint32_t sph_progressive_point_count(const sph_progressive *progressive);
uint32_t sph_progressive_influence_count(const sph_progressive *progressive);
uint32_t sph_progressive_attribute_count(const sph_progressive *progressive);
sph_status sph_progressive_point(const sph_progressive *progressive, uint32_t point, float rest[3], uint32_t *bones, float *weights);
typedef struct sph_skeleton sph_skeleton;
enum 
{
  SPH_SKELETON_TREE = 0,
  SPH_SKELETON_FLAT = 1
};
enum 
{
  SPH_ROOT_CENTER = 0,
  SPH_ROOT_HEAVIEST = 1,
  SPH_ROOT_GIVEN = 2
};
typedef struct sph_skeleton_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t layout;
  int32_t root;
  uint32_t root_bone;
  uint32_t single_root;
} sph_skeleton_options;
void sph_skeleton_options_init(sph_skeleton_options *options, size_t size);
sph_status sph_skeleton_create(const sph_skin *skin, const sph_skeleton_options *options, sph_skeleton **out);
void sph_skeleton_destroy(sph_skeleton *skeleton);
typedef struct sph_skeleton_arrays
{
  uint32_t struct_size;
  uint32_t bone_count;
  uint32_t joint_count;
  uint32_t reserved0;
  const uint32_t *parents;
  const uint32_t *order;
  const double *positions;
  const double *rest;
  const double *inverse_bind;
  const double *gaps;
} sph_skeleton_arrays;
sph_status sph_skeleton_get_arrays(const sph_skeleton *skeleton, sph_skeleton_arrays *arrays);
sph_status sph_skeleton_get_locals(const sph_skeleton *skeleton, const double *transforms, double *locals);
sph_status sph_skeleton_get_transforms(const sph_skeleton *skeleton, const double *locals, double *transforms);
typedef struct sph_surface sph_surface;
typedef struct sph_surface_options
{
  uint32_t struct_size;
  uint32_t flags;
  uint32_t resolution;
  uint32_t first_frame;
  uint32_t frame_step;
  uint32_t frame_limit;
  uint64_t memory_limit;
} sph_surface_options;
void sph_surface_options_init(sph_surface_options *options, size_t size);
sph_status sph_surface_create(const sph_level *level, const sph_surface_options *options, sph_surface **out);
void sph_surface_destroy(sph_surface *surface);
uint32_t sph_surface_frame_count(const sph_surface *surface);
double sph_surface_cell(const sph_surface *surface);
uint32_t sph_surface_vertex_count(const sph_surface *surface, uint32_t index);
size_t sph_surface_triangle_count(const sph_surface *surface, uint32_t index);
const float *sph_surface_positions(const sph_surface *surface, uint32_t index);
const float *sph_surface_normals(const sph_surface *surface, uint32_t index);
const uint32_t *sph_surface_triangles(const sph_surface *surface, uint32_t index);
uint32_t sph_version(void);
typedef struct sph_io_rig sph_io_rig;
typedef struct sph_io_open_rig_options
{
  uint32_t struct_size;
  uint32_t flags;
  const char *clip;
  double fps;
  uint32_t first_frame;
  uint32_t end_frame;
  uint32_t frame_step;
  uint32_t reserved0;
} sph_io_open_rig_options;
void sph_io_open_rig_options_init(sph_io_open_rig_options *options, size_t size);
sph_status sph_io_open_rig(sph_context *context, const char *path, const sph_io_open_rig_options *options, sph_io_rig **out);
void sph_io_rig_destroy(sph_io_rig *rig);
const sph_skin *sph_io_rig_skin(const sph_io_rig *rig);
typedef struct sph_io_rig_arrays
{
  uint32_t struct_size;
  uint32_t bone_count;
  uint32_t frame_count;
  uint32_t morphs;
  const char * const *names;
  const uint32_t *nodes;
  const uint32_t *parents;
  const double *inverse_bind;
  const double *joints_rest;
  const double *joints;
  size_t edge_count;
  const uint32_t *edges;
} sph_io_rig_arrays;
sph_status sph_io_rig_get_arrays(const sph_io_rig *rig, sph_io_rig_arrays *arrays);
sph_status sph_io_save_mesh(sph_context *context, uint32_t vertex_count, const float *positions, const float *normals, size_t triangle_count, const uint32_t *triangles, const char *path);
typedef struct sph_io_frames
{
  uint32_t struct_size;
  uint32_t vertex_count;
  uint32_t frame_count;
  uint32_t reserved0;
  const float *positions;
  size_t triangle_count;
  const uint32_t *triangles;
  double frames_per_second;
  const char *name;
} sph_io_frames;
sph_status sph_io_save_frames_glb(sph_context *context, const sph_io_frames *frames, const char *path);
sph_status sph_io_save_implicit(sph_context *context, const sph_implicit *implicit, const char *path);
sph_status sph_io_load_implicit(sph_context *context, const char *path, sph_implicit **out);
typedef struct sph_io_rig_levels sph_io_rig_levels;
sph_status sph_io_open_rig_levels(sph_context *context, const char *path, const sph_io_open_rig_options *rig, const sph_simplify_options *options, sph_io_rig_levels **out);
void sph_io_rig_levels_destroy(sph_io_rig_levels *levels);
const sph_progressive *sph_io_rig_levels_progressive(const sph_io_rig_levels *levels);
const sph_io_rig *sph_io_rig_levels_rig(const sph_io_rig_levels *levels);
sph_status sph_io_rig_levels_save(const sph_io_rig_levels *levels, const uint32_t *level_numbers, size_t level_count, const char *path);
typedef struct sph_io_spill sph_io_spill;
typedef struct sph_io_spill_options
{
  uint32_t struct_size;
  uint32_t flags;
  uint64_t memory_limit;
  uint64_t least_size;
  const char *folder;
} sph_io_spill_options;
typedef struct sph_io_spill_figures
{
  uint32_t struct_size;
  uint32_t reserved0;
  uint64_t live_bytes;
  uint64_t peak_live_bytes;
  uint64_t file_bytes;
  uint64_t resident_bytes;
  uint64_t trims;
} sph_io_spill_figures;
void sph_io_spill_options_init(sph_io_spill_options *options, size_t size);
sph_status sph_io_spill_create(sph_context *context, const sph_io_spill_options *options, sph_io_spill **out);
void sph_io_spill_destroy(sph_io_spill *spill);
void sph_io_spill_get_allocator(sph_io_spill *spill, sph_allocator *allocator);
void sph_io_spill_get_executor(sph_io_spill *spill, sph_executor *executor);
void sph_io_spill_trim(sph_io_spill *spill);
sph_status sph_io_spill_get_figures(sph_io_spill *spill, sph_io_spill_figures *figures);
enum 
{
  SPH_UP_Y = 0,
  SPH_UP_Z = 1
};
enum 
{
  SPH_IO_WELD_AUTO = 0,
  SPH_IO_WELD_NONE = 1,
  SPH_IO_WELD_ALL = 2
};
enum 
{
  SPH_IO_SPACE_LOCAL = 0,
  SPH_IO_SPACE_WORLD = 1
};
typedef struct sph_io_open_options
{
  uint32_t struct_size;
  uint32_t flags;
  const char *cache_path;
  uint32_t first_frame;
  uint32_t end_frame;
  uint32_t frame_step;
  int32_t up_axis;
  double scale;
  double fps;
  const char *clip;
  int32_t weld;
  int32_t space;
  const char *object;
} sph_io_open_options;
void sph_io_open_options_init(sph_io_open_options *options, size_t size);
sph_status sph_io_open_animation(sph_context *context, const char * const *paths, size_t path_count, const sph_io_open_options *options, sph_animation **out);
typedef struct sph_io_description
{
  uint32_t struct_size;
  uint32_t file_count;
  const char *format;
  uint32_t point_count;
  uint32_t frame_count;
} sph_io_description;
sph_status sph_io_describe(sph_context *context, const char *path, sph_io_description *out);
typedef struct sph_io_clip
{
  uint32_t struct_size;
  uint32_t frame_count;
  const char *name;
  double duration;
} sph_io_clip;
typedef void sph_io_clip_fn(void *user, const sph_io_clip *clip);
sph_status sph_io_list_clips(sph_context *context, const char *path, double fps, sph_io_clip_fn *visit, void *user);
typedef struct sph_io_archive
{
  uint32_t struct_size;
  uint32_t version;
  const char *application;
  const char *library;
  const char *date;
  const char *description;
} sph_io_archive;
typedef struct sph_io_object
{
  uint32_t struct_size;
  uint32_t sample_count;
  const char *path;
  const char *kind;
  uint64_t vertex_count;
  uint64_t face_count;
  double first_time;
  double last_time;
  uint32_t chosen;
  uint32_t hidden;
} sph_io_object;
typedef void sph_io_archive_fn(void *user, const sph_io_archive *archive);
typedef void sph_io_object_fn(void *user, const sph_io_object *object);
sph_status sph_io_list_objects(sph_context *context, const char *path, const char *object, sph_io_archive_fn *archive, sph_io_object_fn *visit, void *user);
void sph_io_sort_natural(const char **names, size_t count);
sph_status sph_io_save_obj_pc2(sph_context *context, const sph_animation *animation, double first_frame, double frames_per_sample, const char *obj_path, const char *pc2_path);
sph_status sph_io_save_obj_mdd(sph_context *context, const sph_animation *animation, double first_second, double frames_per_second, const char *obj_path, const char *mdd_path);
enum 
{
  SPH_IO_HIERARCHY = 1,
  SPH_IO_LEVEL = 2,
  SPH_IO_IMPLICIT = 3
};
sph_status sph_io_identify(sph_context *context, const char *path, int32_t *kind);
sph_status sph_io_save_hierarchy(sph_context *context, const sph_hierarchy *hierarchy, const char *path);
sph_status sph_io_load_hierarchy(sph_context *context, const char *path, sph_hierarchy **out);
sph_status sph_io_save_level(sph_context *context, const sph_level *level, const char *path);
sph_status sph_io_save_surface(sph_context *context, const sph_surface *surface, uint32_t index, const char *path);
enum 
{
  SPH_IO_WEIGHTS_FLOAT = 0,
  SPH_IO_WEIGHTS_U8 = 1,
  SPH_IO_WEIGHTS_U16 = 2
};
typedef struct sph_io_rig_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t weights;
  uint32_t reserved0;
  double frames_per_second;
} sph_io_rig_options;
void sph_io_rig_options_init(sph_io_rig_options *options, size_t size);
sph_status sph_io_save_rig(sph_context *context, const sph_skin *skin, const sph_skeleton *skeleton, const sph_io_rig_options *options, const char *path);
sph_status sph_io_load_level(sph_context *context, const char *path, sph_level **out);
enum 
{
  SPH_IO_EXPORT_BY_NAME = 0,
  SPH_IO_EXPORT_PRIMITIVES = 1,
  SPH_IO_EXPORT_MA = 2,
  SPH_IO_EXPORT_SRDF = 3,
  SPH_IO_EXPORT_YAML = 4,
  SPH_IO_EXPORT_URDF = 5,
  SPH_IO_EXPORT_GLB = 6
};
typedef struct sph_io_export_options
{
  uint32_t struct_size;
  uint32_t flags;
  int32_t format;
  uint32_t first_frame;
  uint32_t frame_step;
  uint32_t frame_limit;
  uint32_t cover_solid;
  uint32_t reserved0;
  double gap;
  const char *name;
  const sph_coverage *coverage;
} sph_io_export_options;
void sph_io_export_options_init(sph_io_export_options *options, size_t size);
typedef struct sph_io_export_report
{
  uint32_t struct_size;
  uint32_t frame_count;
  uint64_t sphere_count;
  uint64_t capsule_count;
  uint64_t triangle_count;
  double gap;
} sph_io_export_report;
sph_status sph_io_export_level(sph_context *context, const sph_level *level, const char *path, const sph_io_export_options *options, sph_io_export_report *report);]]
declarations.constants = {
  SPH_BULGE_LIMIT = 0.5,
  SPH_IO_SPILL_LEAST = 16777216,
  SPH_NO_JOINT = 4294967295,
  SPH_NO_SPHERE = 4294967295,
  SPH_SKIN_AUTO = 4294967295,
  SPH_SURFACE_LEAST_RADIUS = 0.56,
  SPH_VERSION = 1000,
  SPH_VERSION_MAJOR = 0,
  SPH_VERSION_MINOR = 1,
  SPH_VERSION_PATCH = 0,
}
declarations.structs = {
  "sph_allocator",
  "sph_executor",
  "sph_context_options",
  "sph_frame_source",
  "sph_animation_report",
  "sph_hierarchy_options",
  "sph_collapse",
  "sph_level_arrays",
  "sph_level_options",
  "sph_coverage",
  "sph_inflation_options",
  "sph_inflation",
  "sph_skin_clip",
  "sph_skin_arrays",
  "sph_skin_options",
  "sph_skin_source",
  "sph_skin_error",
  "sph_deformer_options",
  "sph_theta_curve",
  "sph_implicit_joint",
  "sph_implicit_options",
  "sph_implicit_part",
  "sph_tracker_options",
  "sph_tracker_report",
  "sph_measure_options",
  "sph_distances",
  "sph_quadric_minimum",
  "sph_query_options",
  "sph_contact",
  "sph_sweep",
  "sph_hit",
  "sph_nearest",
  "sph_gap",
  "sph_simplify_options",
  "sph_progressive_level",
  "sph_skeleton_options",
  "sph_skeleton_arrays",
  "sph_surface_options",
  "sph_io_open_rig_options",
  "sph_io_rig_arrays",
  "sph_io_frames",
  "sph_io_spill_options",
  "sph_io_spill_figures",
  "sph_io_open_options",
  "sph_io_description",
  "sph_io_clip",
  "sph_io_archive",
  "sph_io_object",
  "sph_io_rig_options",
  "sph_io_export_options",
  "sph_io_export_report",
}
return declarations
