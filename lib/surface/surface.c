/* SPDX-License-Identifier: MIT */
/* Surfaces of levels: options, frames, and what the handle tells. */
#include "surface/surface.h"

#include <float.h>
#include <math.h>

enum { MOST_CELLS = 4096 };

/* Where the lattice lies, in cells: no plane of a model that is built of round numbers has its points upon it. */
static const double SHIFT[3] = {0.3819660113, 0.4142135624, 0.2679491924};
enum { PADDING = 2 }; /* cells that stay free around the solid */

typedef struct job {
    const sph_context *context;
    const sph_level *level;
    sph_surface_options options;
    uint32_t frame_count;
    double cell;
    float *radii; /* none below the least */
    sph__solid solid;
    sph__memory memory;
    sph__progress progress;
} job;

/* --- options --- */

static const sph_surface_options DEFAULTS = {
    .struct_size = sizeof(sph_surface_options), .resolution = 128, .frame_step = 1, .memory_limit = UINT64_C(1) << 30};
enum { OPTIONS_V1 = offsetof(sph_surface_options, memory_limit) + sizeof(uint64_t) };
_Static_assert(OPTIONS_V1 == 32, "a field of 0.1 moved");

void sph_surface_options_init(sph_surface_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status read_options(job *j, const sph_surface_options *in)
{
    sph_surface_options *o = &j->options;
    const uint32_t frames = j->level->frame_count;
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(j->context, "sph_surface_options", in, o, sizeof *o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0) return sph__fail(j->context, SPH_E_INVALID, "sph_surface_options: flags must be 0");
    if (o->resolution == 0 || o->resolution > MOST_CELLS)
        return sph__fail(j->context, SPH_E_INVALID, "a resolution of %u cells; from 1 to %d are possible",
                         (unsigned)o->resolution, MOST_CELLS);
    if (o->frame_step == 0) return sph__fail(j->context, SPH_E_INVALID, "frame_step is 0");
    if (o->first_frame >= frames)
        return sph__fail(j->context, SPH_E_INVALID, "first_frame is %u, but there are %u frames",
                         (unsigned)o->first_frame, (unsigned)frames);
    j->frame_count = (frames - o->first_frame - 1) / o->frame_step + 1;
    if (o->frame_limit != 0 && o->frame_limit < j->frame_count) j->frame_count = o->frame_limit;
    j->memory = (sph__memory){.context = j->context, .limit = o->memory_limit, .resolution = o->resolution};
    return SPH_OK;
}

/* --- sizes --- */

/* The box of a frame's spheres, whose radii are at least `least`. A hull of spheres is within it. */
static void find_box(const sph_level *level, uint32_t frame, double least, double low[3], double high[3])
{
    const float *centers = sph__level_centers(level, frame), *radii = sph__level_radii(level, frame);
    for (int k = 0; k < 3; ++k) {
        low[k] = DBL_MAX;
        high[k] = -DBL_MAX;
        for (size_t i = 0; i < level->sphere_count; ++i) {
            const double c = centers[3 * i + (size_t)k], r = fmax(radii[i], least);
            low[k] = fmin(low[k], c - r);
            high[k] = fmax(high[k], c + r);
        }
    }
}

/* The side of a cell, the same for all frames. Far from the origin floats cannot tell smaller cells apart. */
static sph_status choose_cell(job *j)
{
    double longest = 0, farthest = 0;
    for (uint32_t f = 0; f < j->level->frame_count; ++f) {
        double low[3], high[3];
        find_box(j->level, f, 0, low, high);
        for (int k = 0; k < 3; ++k) {
            longest = fmax(longest, high[k] - low[k]);
            farthest = fmax(farthest, fmax(fabs(low[k]), fabs(high[k])));
        }
    }
    if (farthest > FLT_MAX / 8)
        return sph__fail(j->context, SPH_E_LIMIT, "the level reaches out to %g: too far for floats", farthest);
    j->cell = fmax(longest / j->options.resolution, 1e-6 * farthest);
    if (!(j->cell > 16 * FLT_MIN)) j->cell = 16 * FLT_MIN;
    return SPH_OK;
}

static sph_status place_grid(const job *j, uint32_t frame, sph__grid *grid)
{
    double low[3], high[3];
    find_box(j->level, frame, SPH_SURFACE_LEAST_RADIUS * j->cell, low, high);
    for (int k = 0; k < 3; ++k) {
        grid->origin[k] = low[k] - (PADDING + SHIFT[k]) * j->cell;
        grid->size[k] = (uint32_t)((high[k] - grid->origin[k]) / j->cell + PADDING) / SPH__BRICK_SIDE + 1;
    }
    grid->cell = j->cell;
    return SPH_OK;
}

/* --- frames --- */

static void pose(job *j, uint32_t frame)
{
    const float *radii = sph__level_radii(j->level, frame);
    const float least = (float)(SPH_SURFACE_LEAST_RADIUS * j->cell);
    for (uint32_t i = 0; i < j->level->sphere_count; ++i)
        j->radii[i] = radii[i] > least ? radii[i] : least;
    sph__solid_pose(&j->solid, sph__level_centers(j->level, frame), j->radii, 0);
}

static sph_status extract(job *j, uint32_t frame, sph__surface_mesh *mesh)
{
    sph__grid grid = {.context = j->context, .solid = &j->solid, .memory = &j->memory, .progress = &j->progress};
    sph_status status;
    pose(j, frame);
    status = place_grid(j, frame, &grid);
    if (status == SPH_OK) status = sph__grid_sample(&grid);
    if (status == SPH_OK) status = sph__grid_flood(&grid);
    if (status == SPH_OK) status = sph__grid_march(&grid, mesh);
    sph__grid_free(&grid);
    return status;
}

static sph_status extract_all(job *j, sph_surface *surface)
{
    sph_status status = SPH_OK;
    sph__progress_begin(&j->progress, j->context);
    for (uint32_t i = 0; i < j->frame_count && status == SPH_OK; ++i) {
        sph__progress_part(&j->progress, 1.0 / j->frame_count);
        status = extract(j, j->options.first_frame + i * j->options.frame_step, &surface->meshes[i]);
    }
    return status;
}

static sph_status make_surface(job *j, sph_surface **out)
{
    sph_status status = SPH_OK;
    sph_surface *surface = sph__new(j->context, sizeof *surface, SPH__SURFACE);
    if (surface == NULL) return sph__fail_memory(j->context);
    surface->context = sph__context_retain(j->level->context);
    surface->cell = j->cell;
    surface->meshes = sph__zalloc(j->context, j->frame_count, sizeof *surface->meshes);
    j->radii = sph__alloc(j->context, j->level->sphere_count, sizeof *j->radii);
    if (surface->meshes == NULL || j->radii == NULL)
        status = sph__fail_memory(j->context);
    else
        surface->frame_count = j->frame_count;
    if (status == SPH_OK) status = sph__solid_init(&j->solid, j->level);
    if (status == SPH_OK) status = extract_all(j, surface);
    sph__solid_free(&j->solid);
    sph__free(j->context, j->radii);
    if (status == SPH_OK)
        *out = surface;
    else
        sph_surface_destroy(surface);
    return status;
}

sph_status sph_surface_create(const sph_level *level, const sph_surface_options *options, sph_surface **out)
{
    SPH__OWN(level, SPH__LEVEL);
    job j = {.level = level};
    sph_status status;
    if (out != NULL) *out = NULL;
    if (level != NULL) j.context = level->context;
    if (level == NULL || out == NULL)
        return sph__fail(j.context, SPH_E_INVALID, "sph_surface_create: an argument is NULL");
    status = read_options(&j, options);
    if (status == SPH_OK) status = choose_cell(&j);
    return status == SPH_OK ? make_surface(&j, out) : status;
}

/* --- the handle --- */

void sph_surface_destroy(sph_surface *surface)
{
    SPH__OWN(surface, SPH__SURFACE);
    sph_context *context;
    if (surface == NULL) return;
    context = surface->context;
    for (uint32_t i = 0; i < surface->frame_count; ++i) {
        sph__free(context, surface->meshes[i].positions);
        sph__free(context, surface->meshes[i].normals);
        sph__free(context, surface->meshes[i].triangles);
    }
    sph__free(context, surface->meshes);
    sph__free(context, surface);
    sph__context_release(context);
}

static const sph__surface_mesh *mesh_at(const sph_surface *surface, uint32_t index)
{
    return surface == NULL || index >= surface->frame_count ? NULL : &surface->meshes[index];
}

uint32_t sph_surface_frame_count(const sph_surface *surface)
{
    SPH__OWN(surface, SPH__SURFACE);
    return surface == NULL ? 0 : surface->frame_count;
}

double sph_surface_cell(const sph_surface *surface)
{
    SPH__OWN(surface, SPH__SURFACE);
    return surface == NULL ? 0 : surface->cell;
}

uint32_t sph_surface_vertex_count(const sph_surface *surface, uint32_t index)
{
    SPH__OWN(surface, SPH__SURFACE);
    const sph__surface_mesh *mesh = mesh_at(surface, index);
    return mesh == NULL ? 0 : mesh->vertex_count;
}

size_t sph_surface_triangle_count(const sph_surface *surface, uint32_t index)
{
    SPH__OWN(surface, SPH__SURFACE);
    const sph__surface_mesh *mesh = mesh_at(surface, index);
    return mesh == NULL ? 0 : mesh->triangle_count;
}

const float *sph_surface_positions(const sph_surface *surface, uint32_t index)
{
    SPH__OWN(surface, SPH__SURFACE);
    const sph__surface_mesh *mesh = mesh_at(surface, index);
    return mesh == NULL ? NULL : mesh->positions;
}

const float *sph_surface_normals(const sph_surface *surface, uint32_t index)
{
    SPH__OWN(surface, SPH__SURFACE);
    const sph__surface_mesh *mesh = mesh_at(surface, index);
    return mesh == NULL ? NULL : mesh->normals;
}

const uint32_t *sph_surface_triangles(const sph_surface *surface, uint32_t index)
{
    SPH__OWN(surface, SPH__SURFACE);
    const sph__surface_mesh *mesh = mesh_at(surface, index);
    return mesh == NULL ? NULL : mesh->triangles;
}
