/* SPDX-License-Identifier: MIT */
/* Alembic archives that fixtures/make_alembic.py wrote, against closed forms of what it puts in. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files.h"
#include "runner.h"
#include "support.h"

static const double TOLERANCE = 1e-6;
static const float TRIANGLE[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};

static sph_context *context;
static sph_animation *animation;
static sph_io_open_options options;
static float xyz[300];

static void setup(void)
{
    context = test_context();
    animation = NULL;
    files_setup();
    sph_io_open_options_init(&options, sizeof options);
}

static void teardown(void)
{
    sph_animation_destroy(animation);
    files_teardown();
    sph_context_destroy(context);
}

static const char *fixture(const char *name)
{
    static char path[1024];
    ck_assert_msg(getenv("SPH_FIXTURES") != NULL, "SPH_FIXTURES is not set");
    snprintf(path, sizeof path, "%s/alembic_%s.abc", getenv("SPH_FIXTURES"), name);
    return path;
}

static void open_fixture(const char *name, const char *object, uint32_t vertices, uint32_t frames)
{
    sph_status status;
    sph_animation_destroy(animation);
    options.object = object;
    animation = open_one(context, fixture(name), &options, &status);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), vertices);
    ck_assert_uint_eq(sph_animation_frame_count(animation), frames);
}

static void read(uint32_t frame)
{
    ck_assert_int_eq(sph_animation_read_frame(animation, frame, xyz), SPH_OK);
}

static void check_vertex(uint32_t v, double x, double y, double z)
{
    const double wanted[3] = {x, y, z};
    for (int k = 0; k < 3; ++k)
        ck_assert_msg(fabs((double)xyz[3 * v + (uint32_t)k] - wanted[k]) <= TOLERANCE * (1 + fabs(wanted[k])),
                      "vertex %u axis %d: %.9g, not %.9g", v, k, (double)xyz[3 * v + (uint32_t)k], wanted[k]);
}

static void check_refusal(const char *name, const char *object, sph_status expected, const char *message)
{
    sph_status status;
    options.object = object;
    ck_assert_ptr_null(open_one(context, fixture(name), &options, &status));
    ck_assert_msg(strstr(sph_context_last_message(context), message) != NULL, "«%s», not «%s»",
                  sph_context_last_message(context), message);
    ck_assert_int_eq(status, expected);
}

/* What each stack of operations of the first fixture makes of (x, y, z), in the order of the file. */
static void operate(int which, const float p[3], double out[3])
{
    const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
    const double results[10][3] = {
        {x + 10, y + 20, z + 30}, {2 * x, 3 * y, 4 * z}, {x, -z, y}, {z, y, -x}, {-y, x, z}, {z, x, y},
        {5 - y, 6 + x, 7 + z},    {1 - y, 2 * x, z},     {-x, y, z}, {x, y, z}};
    memcpy(out, results[which], sizeof results[which]);
}

/* _i 0: the translation that is above all of them is left out; 1: it is not. */
START_TEST(every_operation_moves_points_as_its_formula_says)
{
    options.space = _i == 0 ? SPH_IO_SPACE_LOCAL : SPH_IO_SPACE_WORLD;
    open_fixture("operations", NULL, 30, 1);
    read(0);
    for (int m = 0; m < 10; ++m)
        for (uint32_t v = 0; v < 3; ++v) {
            double wanted[3];
            operate(m, TRIANGLE[v], wanted);
            check_vertex(3 * (uint32_t)m + v, wanted[0] + 100 * _i, wanted[1], wanted[2]);
        }
}
END_TEST

START_TEST(an_object_alone_is_in_its_own_space_bit_for_bit)
{
    open_fixture("operations", "/all/stack/stackShape", 3, 1);
    read(0);
    ck_assert_mem_eq(xyz, TRIANGLE, sizeof TRIANGLE);
    open_fixture("operations", "axis", 3, 1); /* by name, and what is below it */
    read(0);
    ck_assert_mem_eq(xyz, TRIANGLE, sizeof TRIANGLE);
}
END_TEST

START_TEST(what_a_transform_mirrors_faces_outward_again)
{
    const uint32_t *t;
    open_fixture("operations", NULL, 30, 1);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), 10);
    t = sph_animation_triangles(animation);
    for (uint32_t m = 0; m < 10; ++m) {
        /* The corners as a cycle from the least: (0 1 2), turned where it is mirrored (number 8). */
        uint32_t first = t[3 * m] < t[3 * m + 1] && t[3 * m] < t[3 * m + 2] ? 0 : t[3 * m + 1] < t[3 * m + 2] ? 1 : 2;
        ck_assert_uint_eq(t[3 * m + first], 3 * m);
        ck_assert_uint_eq(t[3 * m + (first + 1) % 3], 3 * m + (m == 8 ? 2 : 1));
    }
}
END_TEST

/* Of the fixture of times: at t seconds, the sample (linear between samples), and the lift. */
static double lift(double t)
{
    return t < 0.1 ? 100 * t : t < 0.5 ? 10 + 10 * (t - 0.1) / 0.4 : 20;
}

static void check_moving(uint32_t frame, double t)
{
    const double s = fmin(24 * t, 4);
    read(frame);
    for (uint32_t k = 0; k < 3; ++k)
        check_vertex(k, s, k + lift(t), s * k);
}

START_TEST(frames_are_where_positions_or_transforms_have_samples)
{
    static const double TIMES[7] = {0, 1 / 24., 2 / 24., 0.1, 3 / 24., 4 / 24., 0.5};
    open_fixture("times", "/lift", 3, 7);
    for (uint32_t f = 7; f-- > 0;)
        check_moving(f, TIMES[f]);
}
END_TEST

START_TEST(a_rate_of_the_callers_is_linear_between_samples)
{
    options.fps = 10;
    open_fixture("times", "moving", 3, 6);
    for (uint32_t f = 0; f < 6; ++f)
        check_moving(f, 0.1 * f);
    options.fps = 1000;
    open_fixture("times", "moving", 3, 501);
    for (uint32_t f = 0; f < 501; ++f)
        check_moving(f, 0.001 * f);
}
END_TEST

START_TEST(cyclic_samples_are_at_their_times)
{
    open_fixture("times", "cyclic", 3, 6);
    for (uint32_t f = 0; f < 6; ++f) {
        read(f);
        check_vertex(1, f, 1, f);
    }
    options.fps = 8; /* from -0.25 s on; a sample every half second */
    open_fixture("times", "cyclic", 3, 21);
    for (uint32_t f = 0; f < 21; ++f) {
        read(f);
        check_vertex(2, 0.25 * f, 2, 0.5 * f);
    }
}
END_TEST

START_TEST(samples_that_repeat_are_stored_once_and_read_as_often_as_they_are_there)
{
    static const double SAMPLES[5] = {0, 0, 1, 2, 2};
    open_fixture("times", "repeats", 3, 5);
    for (uint32_t f = 0; f < 5; ++f) {
        read(f);
        check_vertex(2, SAMPLES[f], 2, 2 * SAMPLES[f]);
    }
    options.first_frame = 1;
    options.frame_step = 2;
    open_fixture("times", "repeats", 3, 2);
    for (uint32_t f = 0; f < 2; ++f) {
        read(f);
        check_vertex(1, SAMPLES[1 + 2 * f], 1, SAMPLES[1 + 2 * f]);
    }
}
END_TEST

START_TEST(what_never_changes_is_one_frame)
{
    open_fixture("times", "still", 3, 1);
    options.fps = 24;
    open_fixture("times", "still", 3, 1);
}
END_TEST

static double signed_volume(uint32_t first, uint32_t triangles)
{
    const uint32_t *t = sph_animation_triangles(animation) + 3 * first;
    double sum = 0;
    for (uint32_t i = 0; i < triangles; ++i, t += 3) {
        const float *a = xyz + 3 * t[0], *b = xyz + 3 * t[1], *c = xyz + 3 * t[2];
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            sum += (double)a[k] * ((double)b[l] * (double)c[m] - (double)b[m] * (double)c[l]) / 6;
        }
    }
    return sum;
}

START_TEST(faces_that_are_clockwise_in_the_file_face_outward)
{
    static const double SCALES[5] = {1, 1, 1.5, 2, 2};
    open_fixture("scene", "/root/body", 8, 5);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), 12);
    for (uint32_t f = 0; f < 5; ++f) {
        read(f);
        ck_assert_double_eq_tol(signed_volume(0, 12), 8 * pow(SCALES[f], 3), 1e-5);
    }
}
END_TEST

/* All of the scene: a cube that grows, a cage, the cube again beside itself, a triangle, and one that is above nothing.
 */
START_TEST(a_scene_is_united_with_instances_and_without_what_is_hidden)
{
    static const double SCALES[5] = {1, 1, 1.5, 2, 2};
    open_fixture("scene", NULL, 8 + 4 + 8 + 3 + 3, 5);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), 12 + 2 + 12 + 1 + 1);
    for (uint32_t f = 0; f < 5; ++f) {
        read(f);
        for (uint32_t v = 0; v < 8; ++v) { /* turned by 90 degrees around x: (x, y, z) is at (x, -z, y) */
            const double s = SCALES[f], x = s * (v & 1 ? 1 : -1), y = s * (v & 2 ? 1 : -1), z = s * (v & 4 ? 1 : -1);
            check_vertex(v, x, -z, y);
            check_vertex(12 + v, x + f, -z, y);
        }
        check_vertex(8 + 2, 1, 0, 1);
        for (uint32_t v = 0; v < 3; ++v) {
            const float *p = TRIANGLE[v];
            check_vertex(20 + v, (double)p[0], -(double)p[2], (double)p[1]);
            check_vertex(23 + v, (double)p[0], (double)p[1], (double)p[2] + 1000); /* without the turn */
        }
    }
}
END_TEST

START_TEST(an_instance_and_a_hidden_mesh_are_read_when_they_are_asked_for)
{
    open_fixture("scene", "copy", 8, 5);
    read(4);
    check_vertex(0, -2 + 4, -2, -2);
    open_fixture("scene", "ghost", 3, 1);
    read(0);
    ck_assert_mem_eq(xyz, TRIANGLE, sizeof TRIANGLE);
}
END_TEST

START_TEST(up_scale_and_space_are_options)
{
    options.up_axis = SPH_UP_Z;
    options.scale = 0.5;
    open_fixture("scene", "cage", 4, 1);
    read(0);
    check_vertex(2, 0.5, 0, -0.5); /* (1, 1, 0) with z up */
    options.up_axis = SPH_UP_Y;
    options.space = SPH_IO_SPACE_WORLD;
    open_fixture("scene", "cage", 4, 1);
    read(0);
    check_vertex(2, 0.5, 0, 0.5); /* (1, 0, 1) in the scene */
}
END_TEST

START_TEST(welding_unites_what_coincides_in_all_frames)
{
    options.weld = SPH_IO_WELD_ALL;
    open_fixture("scene", NULL, 26, 5); /* the instance coincides with the cube in the first frame alone */
    options.object = NULL;
    open_fixture("operations", NULL, 29, 1); /* (1, 2, 3) comes again */
}
END_TEST

START_TEST(equal_faces_that_are_stored_again_are_no_change)
{
    open_fixture("topology", "same", 3, 3);
    read(2);
    check_vertex(0, 3, 2, 3);
}
END_TEST

START_TEST(changing_topology_is_refused_with_its_frame)
{
    check_refusal("topology", "turns", SPH_E_UNSUPPORTED,
                  "/turns: its topology changes: sample 2 (frame 2, at 0.0833333 s) has other faces");
    check_refusal("topology", "grows", SPH_E_UNSUPPORTED,
                  "/grows: its topology changes: sample 1 (frame 1, at 0.0416667 s) has other vertices");
}
END_TEST

START_TEST(a_choice_that_is_not_there_is_refused_with_what_is)
{
    sph_status status;
    check_refusal("topology", "nobody", SPH_E_INVALID, "no mesh 'nobody': it has same, turns, grows");
    check_refusal("scene", "/body", SPH_E_INVALID, "no mesh '/body': it has body, cage, copy");
    check_refusal("scene", "hair", SPH_E_INVALID, "no mesh 'hair'");
    ck_assert_ptr_null(open_one(context, write_obj("a.obj", 4, 0), &options, &status));
    ck_assert_int_eq(status, SPH_E_INVALID);
    options.space = 2;
    check_refusal("scene", NULL, SPH_E_INVALID, "space is 2");
}
END_TEST

START_TEST(hdf5_is_refused_by_name)
{
    static const char HDF5[] = "\x89HDF\r\n\x1A\n and so on";
    check_refused(context, file_write("a.abc", HDF5, sizeof HDF5), SPH_E_UNSUPPORTED, "Alembic (HDF5)");
    check_refused(context, file_text("b.abc", "hello"), SPH_E_FORMAT, "not an Alembic (Ogawa) file");
}
END_TEST

/* As the mesh of a cache, and as one of a sequence, an archive is its first frame. */
START_TEST(with_a_cache_an_archive_is_its_mesh)
{
    options.cache_path = write_cache("a.pc2", 30, 2);
    open_fixture("operations", NULL, 30, 2);
    read(1);
    check_vertex(29, (double)coordinate(1, 29, 0), (double)coordinate(1, 29, 1), (double)coordinate(1, 29, 2));
    ck_assert_uint_eq(sph_animation_triangle_count(animation), 10);
}
END_TEST

static char told[2000];

static void tell_archive(void *user, const sph_io_archive *a)
{
    snprintf(user, sizeof told, "%u %s %s;", (unsigned)a->version, a->application, a->date);
}

static void tell_object(void *user, const sph_io_object *o)
{
    const size_t length = strlen(user);
    snprintf((char *)user + length, sizeof told - length, "%s %s %u %u %u%s%s;", o->path, o->kind,
             (unsigned)o->sample_count, (unsigned)o->vertex_count, (unsigned)o->face_count, o->chosen ? " *" : "",
             o->hidden ? " hidden" : "");
}

START_TEST(an_archive_tells_its_objects)
{
    ck_assert_int_eq(sph_io_list_objects(context, fixture("scene"), "place", tell_archive, tell_object, told), SPH_OK);
    ck_assert_str_eq(told, "10800 make_alembic.py today;/root Xform 1 0 0;/root/body PolyMesh 5 8 6;"
                           "/root/cage SubD 1 4 1;/root/place Xform 5 0 0;/root/place/copy PolyMesh 5 8 6 *;"
                           "/root/ghost Xform 1 0 0 hidden;/root/ghost/ghostShape PolyMesh 1 3 1 hidden;"
                           "/root/seen Xform 1 0 0;/root/seen/seenShape PolyMesh 1 3 1;/root/hair Curve 1 0 0;"
                           "/root/free Xform 1 0 0;/root/free/freeShape PolyMesh 1 3 1;");
    told[0] = '\0';
    ck_assert_int_eq(sph_io_list_objects(context, write_obj("a.obj", 4, 0), NULL, NULL, tell_object, told), SPH_OK);
    ck_assert_str_eq(told, "");
    ck_assert_int_eq(sph_io_list_objects(context, NULL, NULL, NULL, tell_object, told), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_list_objects(NULL, "a.abc", NULL, NULL, tell_object, told), SPH_E_INVALID);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, every_operation_moves_points_as_its_formula_says, 0, 2);
    tcase_add_test(tc, an_object_alone_is_in_its_own_space_bit_for_bit);
    tcase_add_test(tc, what_a_transform_mirrors_faces_outward_again);
    tcase_add_test(tc, frames_are_where_positions_or_transforms_have_samples);
    tcase_add_test(tc, a_rate_of_the_callers_is_linear_between_samples);
    tcase_add_test(tc, cyclic_samples_are_at_their_times);
    tcase_add_test(tc, samples_that_repeat_are_stored_once_and_read_as_often_as_they_are_there);
    tcase_add_test(tc, what_never_changes_is_one_frame);
    tcase_add_test(tc, faces_that_are_clockwise_in_the_file_face_outward);
    tcase_add_test(tc, a_scene_is_united_with_instances_and_without_what_is_hidden);
    tcase_add_test(tc, an_instance_and_a_hidden_mesh_are_read_when_they_are_asked_for);
    tcase_add_test(tc, up_scale_and_space_are_options);
    tcase_add_test(tc, welding_unites_what_coincides_in_all_frames);
    tcase_add_test(tc, equal_faces_that_are_stored_again_are_no_change);
    tcase_add_test(tc, changing_topology_is_refused_with_its_frame);
    tcase_add_test(tc, a_choice_that_is_not_there_is_refused_with_what_is);
    tcase_add_test(tc, hdf5_is_refused_by_name);
    tcase_add_test(tc, with_a_cache_an_archive_is_its_mesh);
    tcase_add_test(tc, an_archive_tells_its_objects);
    return run_suite(suite_create("io Alembic"), tc);
}
