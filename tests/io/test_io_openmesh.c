/* SPDX-License-Identifier: MIT */
/* OpenMesh reads what we write, and reads the same file as we do. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files.h"
#include "openmesh_shim.h"
#include "runner.h"
#include "support.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
    files_setup();
}

static void teardown(void)
{
    files_teardown();
    sph_context_destroy(context);
}

static float largest(const float *values, size_t count)
{
    float result = 0;
    for (size_t i = 0; i < count; ++i)
        result = fmaxf(result, fabsf(values[i]));
    return result;
}

/*
 * Face by face: OpenMesh starts a face at any of its corners. Positions may differ in the last place, as its parser is
 * not an exact one.
 */
static void check_same(const openmesh_mesh *theirs, const sph_animation *ours, float relative)
{
    const uint32_t *triangle = sph_animation_triangles(ours), *corner = theirs->corners;
    float *xyz = test_malloc(3 * theirs->vertex_count, sizeof *xyz), tolerance;
    size_t triangles = 0;
    ck_assert_uint_eq(theirs->vertex_count, sph_animation_vertex_count(ours));
    ck_assert_int_eq(sph_animation_read_frame(ours, 0, xyz), SPH_OK);
    tolerance = largest(xyz, 3 * theirs->vertex_count) * relative;
    for (size_t i = 0; i < 3 * theirs->vertex_count; ++i)
        ck_assert_float_eq_tol(theirs->positions[i], xyz[i], tolerance);
    for (size_t f = 0; f < theirs->face_count; ++f) {
        const uint32_t size = theirs->sizes[f];
        uint32_t start = 0;
        while (start < size && corner[start] != triangle[0])
            ++start;
        ck_assert_uint_lt(start, size);
        for (uint32_t i = 1; i + 1 < size; ++i, triangle += 3, ++triangles) {
            ck_assert_uint_lt(triangles, sph_animation_triangle_count(ours));
            ck_assert_uint_eq(triangle[0], corner[start]);
            ck_assert_uint_eq(triangle[1], corner[(start + i) % size]);
            ck_assert_uint_eq(triangle[2], corner[(start + i + 1) % size]);
        }
        corner += size;
    }
    ck_assert_uint_eq(triangles, sph_animation_triangle_count(ours));
    free(xyz);
}

static void compare_readers(const char *path)
{
    openmesh_mesh theirs;
    sph_status status;
    sph_animation *ours = open_one(context, path, NULL, &status);
    ck_assert_msg(ours != NULL, "%s", sph_context_last_message(context));
    ck_assert_int_eq(openmesh_read(path, &theirs), 1);
    check_same(&theirs, ours, 0x1p-22f);
    openmesh_free(&theirs);
    sph_animation_destroy(ours);
}

START_TEST(openmesh_reads_the_meshes_that_we_write)
{
    sph_animation *animation = _i == 0   ? test_cube(context, 2)
                               : _i == 1 ? test_sphere(context, 3, 2)
                               : _i == 2 ? test_torus(context, 16, 9, 2)
                                         : test_grid(context, 7, 5, 2);
    const char *obj = file_path("a.obj");
    openmesh_mesh theirs;
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, obj, file_path("a.pc2")), SPH_OK);
    ck_assert_int_eq(openmesh_read(obj, &theirs), 1);
    check_same(&theirs, animation, 0x1p-22f);
    openmesh_free(&theirs);
    compare_readers(obj);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(openmesh_reads_the_levels_that_we_write)
{
    static const float CENTERS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3f, 0.3f, -1.7e-5f}, RADII[] = {1, 2, 3, 4};
    static const uint32_t TRIANGLES[] = {0, 1, 2, 1, 0, 3}, EDGE[] = {2, 3};
    const sph_level_arrays a = {sizeof a, 4, 1, 0, CENTERS, RADII, 1, EDGE, 2, TRIANGLES, 0, NULL};
    const char *path = file_path(_i == 0 ? "l.obj" : "l.ply");
    sph_level *level;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    compare_readers(path);
    sph_level_destroy(level);
}
END_TEST

START_TEST(openmesh_and_we_read_the_same_file_alike)
{
    static const char *const TEXTS[] = {"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 1 2 3 4\nf 2/1 1/2 5/3\nf "
                                        "3//1 2//2 5//3\nf 4/1/1 3/1/1 5/1/1\n"
                                        "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 1 0 0\nvn 0 1 0\n",
                                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2\nf -4 -2 -1\n",
                                        "# comment\r\nv 1e-3 -2.5e2 0.125\r\nv 1 0 0\r\nv 0 1 0\r\ng a\r\nf 1 2 3\r\n",
                                        "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nv -1 1 0\nf 1 2 3 4 5 6\n"};
    compare_readers(file_text("a.obj", TEXTS[_i]));
}
END_TEST

START_TEST(openmesh_and_we_read_blenders_file_alike)
{
    char path[1024];
    const char *folder = getenv("SPH_FIXTURES");
    ck_assert_ptr_nonnull(folder);
    snprintf(path, sizeof path, "%s/blender.obj", folder);
    compare_readers(path);
}
END_TEST

/* --- PLY, OFF and STL --- */

enum { BINARY_OFF = 3 };
static const struct {
    const char *name;
    unsigned flags;
} FLAVOURS[] = {{"a.ply", 0},
                {"b.ply", OPENMESH_BINARY},
                {"c.ply", OPENMESH_BINARY | OPENMESH_BIG},
                {"d.off", OPENMESH_BINARY}, /* refused */
                {"e.off", 0},
                {"f.stl", 0},
                {"g.stl", OPENMESH_BINARY},
                {"h.ply", OPENMESH_NORMALS | OPENMESH_COLORS | OPENMESH_TEXTURE | OPENMESH_FACE_COLORS},
                {"i.ply", OPENMESH_BINARY | OPENMESH_NORMALS | OPENMESH_COLORS | OPENMESH_TEXTURE},
                {"j.ply", OPENMESH_BINARY | OPENMESH_BIG | OPENMESH_COLORS | OPENMESH_FACE_COLORS},
                {"k.off", OPENMESH_NORMALS},
                {"l.off", OPENMESH_COLORS},
                {"m.off", OPENMESH_NORMALS | OPENMESH_COLORS | OPENMESH_FACE_COLORS},
                {"n.off", OPENMESH_TEXTURE},
                {"o.off", OPENMESH_FACE_COLORS},
                {"p.obj", 0}};
enum { FLAVOUR_COUNT = sizeof FLAVOURS / sizeof *FLAVOURS };

/* The triangles of an animation's first frame, or, with `polygons`, quadrilaterals and a pentagon of a strip. */
static openmesh_mesh mesh_to_write(sph_animation *animation, bool polygons)
{
    static uint32_t sizes[4000], strip[] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 5, 7, 6};
    static float xyz[9000];
    openmesh_mesh mesh = {.vertex_count = sph_animation_vertex_count(animation), .positions = xyz, .sizes = sizes};
    ck_assert_uint_le(3 * mesh.vertex_count, sizeof xyz / sizeof *xyz);
    ck_assert_uint_le(sph_animation_triangle_count(animation), sizeof sizes / sizeof *sizes);
    ck_assert_int_eq(sph_animation_read_frame(animation, 0, xyz), SPH_OK);
    mesh.face_count = polygons ? 3 : sph_animation_triangle_count(animation);
    mesh.corners = polygons ? strip : (uint32_t *)(uintptr_t)sph_animation_triangles(animation);
    for (size_t f = 0; f < mesh.face_count; ++f)
        sizes[f] = !polygons ? 3 : f < 2 ? 4 : 5;
    return mesh;
}

START_TEST(openmesh_and_we_read_alike_what_openmesh_writes)
{
    const char *path = file_path(FLAVOURS[_i].name);
    for (int shape = 0; shape < 5; ++shape) {
        sph_animation *animation = shape == 0   ? test_cube(context, 2)
                                   : shape == 1 ? test_sphere(context, 3, 2)
                                   : shape == 2 ? test_torus(context, 16, 9, 2)
                                   : shape == 3 ? test_grid(context, 7, 5, 2)
                                                : test_cube(context, 1);
        const openmesh_mesh mesh = mesh_to_write(animation, shape == 4);
        const bool stl = strstr(path, ".stl") != NULL;
        if (shape == 4 && stl) {
            sph_animation_destroy(animation); /* triangles only */
            continue;
        }
        ck_assert_int_eq(openmesh_write(path, &mesh, FLAVOURS[_i].flags), 1);
        if (_i == BINARY_OFF) {
            check_refused(context, path, SPH_E_UNSUPPORTED, "binary OFF is not read");
        } else {
            compare_readers(path);
            if (shape != 4 && !stl) {
                openmesh_mesh theirs; /* its text has six digits */
                ck_assert_int_eq(openmesh_read(path, &theirs), 1);
                check_same(&theirs, animation, 1e-5f);
                openmesh_free(&theirs);
            }
        }
        sph_animation_destroy(animation);
    }
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, openmesh_reads_the_meshes_that_we_write, 0, 4);
    tcase_add_loop_test(tc, openmesh_reads_the_levels_that_we_write, 0, 2);
    tcase_add_loop_test(tc, openmesh_and_we_read_the_same_file_alike, 0, 4);
    tcase_add_test(tc, openmesh_and_we_read_blenders_file_alike);
    tcase_add_loop_test(tc, openmesh_and_we_read_alike_what_openmesh_writes, 0, FLAVOUR_COUNT);
    return run_suite(suite_create("io OpenMesh"), tc);
}
