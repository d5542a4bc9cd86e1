/* SPDX-License-Identifier: MIT */
/*
 * A small GLB with all that is read in it, cut at every length, with bytes changed at random, with numbers of its JSON
 * replaced by absurd ones, and with allocations that fail. The reader gets copies that end where their memory ends.
 */
#include <check.h>
#include <string.h>

#include "faults.h"
#include "glb.h"
#include "io/io.h"
#include "runner.h"
#include "support.h"

static sph_context *context;
static test_faulty memory;
static layout sample;

static const char REST[] =
    "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
    "\"nodes\":[{\"children\":[1,2]},{\"mesh\":0,\"skin\":0},{\"translation\":[0,1,0],\"children\":[3]},{}],"
    "\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2},"
    "\"indices\":3,\"targets\":[{\"POSITION\":4}]}]}],\"skins\":[{\"joints\":[2,3],\"inverseBindMatrices\":5}],"
    "\"animations\":[{\"name\":\"a\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":2,\"path\":\"rotation\"}},"
    "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"weights\"}}],\"samplers\":[{\"input\":6,\"output\":7},"
    "{\"input\":6,\"output\":8,\"interpolation\":\"CUBICSPLINE\"}]}]";

static void make_sample(void)
{
    static const double POSITIONS[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, INDICES[6] = {0, 1, 2, 0, 2, 3};
    static const double JOINTS[16] = {0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0};
    static const double WEIGHTS[16] = {128, 127, 0, 0, 255, 0, 0, 0, 10, 245, 0, 0, 255, 0, 0, 0};
    static const double BINDS[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1,
                                     1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
    static const double TIMES[2] = {0, 0.1}, TURNS[8] = {0, 0, 0, 1, 0, 0, 1, 0}, CUBIC[6] = {0, 0, 1, 1, 1, 0};
    glb g = {.view_count = 0};
    glb_floats(&g, "VEC3", 4, POSITIONS);
    glb_numbers(&g, GLB_U8, "VEC4", 4, JOINTS, "");
    glb_numbers(&g, GLB_U8, "VEC4", 4, WEIGHTS, ",\"normalized\":true");
    glb_numbers(&g, GLB_U16, "SCALAR", 6, INDICES, "");
    glb_numbers(&g, GLB_F32, "VEC3", 4, POSITIONS,
                ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":3,\"componentType\":5123},"
                "\"values\":{\"bufferView\":0}}");
    glb_floats(&g, "MAT4", 2, BINDS);
    glb_floats(&g, "SCALAR", 2, TIMES);
    glb_floats(&g, "VEC4", 2, TURNS);
    glb_floats(&g, "SCALAR", 6, CUBIC);
    glb_layout(&g, REST, &sample);
    glb_free(&g);
}

static void setup(void)
{
    sph_allocator allocator;
    memory = (test_faulty){.fail_at = 0};
    allocator = test_faulty_allocator(&memory);
    context = test_context_with_allocator(&allocator);
    files_setup();
    make_sample();
}

static void teardown(void)
{
    layout_free(&sample);
    files_teardown();
    sph_context_destroy(context);
    ck_assert_uint_eq(memory.live_blocks, 0);
    ck_assert(!memory.misused);
}

/* Reads from exact memory, and a frame or two; nothing is left over and no index is out of range. */
static sph_status read_exact(const unsigned char *bytes, size_t size)
{
    unsigned char *copy = exact_copy(bytes, size);
    const sph__io_map map = {copy, size};
    const size_t before = memory.live_blocks;
    sph__io_mesh mesh = {.context = context};
    sph__io_gltf *g = NULL;
    sph_status status = sph__io_gltf_open("a.glb", &map, 30, NULL, &mesh, &g);
    ck_assert_int_eq(g == NULL, status != SPH_OK);
    if (status == SPH_OK) {
        const uint32_t count = sph__io_gltf_frame_count(g);
        float *xyz = test_malloc(3 * mesh.vertex_count, sizeof *xyz);
        for (size_t i = 0; i < 3 * mesh.triangle_count; ++i)
            ck_assert_uint_lt(mesh.triangles[i], mesh.vertex_count);
        for (size_t i = 0; i < 2 * mesh.edge_count; ++i)
            ck_assert_uint_lt(mesh.edges[i], mesh.vertex_count);
        for (uint32_t f = 0; f < count && f < 4; ++f)
            sph__io_gltf_read(g, f, xyz);
        sph__io_gltf_read(g, count - 1, xyz);
        free(xyz);
    } else {
        ck_assert_str_ne(sph_context_last_message(context), "");
    }
    sph__io_gltf_close(g);
    sph__io_mesh_release(&mesh);
    ck_assert_uint_eq(memory.live_blocks, before);
    free(copy);
    return status;
}

static void check_refusal(sph_status status)
{
    ck_assert_msg(status == SPH_OK || status == SPH_E_FORMAT || status == SPH_E_UNSUPPORTED || status == SPH_E_LIMIT ||
                      status == SPH_E_IO,
                  "%d: %s", (int)status, sph_context_last_message(context));
}

START_TEST(a_glb_cut_at_any_length_is_refused)
{
    ck_assert_msg(read_exact(sample.bytes, sample.size) == SPH_OK, "%s", sph_context_last_message(context));
    for (size_t size = 0; size < sample.size; ++size)
        ck_assert_int_eq(read_exact(sample.bytes, size), SPH_E_FORMAT);
    /* the same with a header that says so */
    for (size_t size = 12; size < sample.size; ++size) {
        unsigned char *cut = exact_copy(sample.bytes, size);
        for (int i = 0; i < 4; ++i)
            cut[8 + i] = (unsigned char)(size >> 8 * i);
        ck_assert_int_eq(read_exact(cut, size), SPH_E_FORMAT);
        free(cut);
    }
}
END_TEST

START_TEST(a_glb_with_random_damage_is_refused_or_read_within_its_bytes)
{
    uint64_t state = (uint64_t)_i + 1;
    const size_t json = 20 + (sample.bytes[12] | (size_t)sample.bytes[13] << 8);
    size_t read = 0;
    for (int round = 0; round < 4000; ++round) {
        unsigned char *damaged = exact_copy(sample.bytes, sample.size);
        const unsigned changes = 1 + (unsigned)(test_random(&state) % 3);
        memory.peak_bytes = memory.live_bytes;
        for (unsigned i = 0; i < changes; ++i) {
            const uint64_t value = test_random(&state);
            const size_t place =
                _i == 0 ? json + 8 + test_random(&state) % (sample.size - json - 8) : test_random(&state) % json;
            /* Digits for digits come furthest. */
            if (place >= json || place < 20)
                damaged[place] = (unsigned char)value;
            else if (damaged[place] >= '0' && damaged[place] <= '9')
                damaged[place] = (unsigned char)('0' + value % 10);
            else if (_i == 2)
                damaged[place] = (unsigned char)"0123456789-+.e[]{},:\"\\/ abXY"[value % 28];
        }
        {
            const sph_status status = read_exact(damaged, sample.size);
            check_refusal(status);
            read += status == SPH_OK;
        }
        ck_assert_uint_le(memory.peak_bytes - memory.live_bytes, ((size_t)1 << 27));
        free(damaged);
    }
    ck_assert_uint_gt(read, 10); /* else the damage went no further than the first check */
}
END_TEST

/* Each number of the JSON in turn by others, as far as they fit over it and the blanks and zeros around it. */
START_TEST(absurd_numbers_in_the_json_are_refused_or_read_within_the_bytes)
{
    static const char *const NUMBERS[] = {
        "-1",  "0",    "2147483647", "4294967295", "4294967296", "9007199254740991", "1e9", "99999999999999999999",
        "0.5", "null", "[]",         "{}",         "\"x\""};
    const size_t json = 20 + (sample.bytes[12] | (size_t)sample.bytes[13] << 8);
    for (size_t place = 20; place < json; ++place) {
        size_t end = place;
        if (sample.bytes[place - 1] >= '0' && sample.bytes[place - 1] <= '9') continue;
        while (end < json && sample.bytes[end] >= '0' && sample.bytes[end] <= '9')
            ++end;
        for (size_t i = 0; end > place && i < sizeof NUMBERS / sizeof *NUMBERS; ++i) {
            layout l = {NULL, 0, 0};
            const size_t length = strlen(NUMBERS[i]), grown = json - 20 - (end - place) + length;
            put_bytes(&l, "glTF\2\0\0", 8);
            put_little(&l, sample.size - (json - 20) + grown, 4);
            put_little(&l, grown, 4);
            put_bytes(&l, "JSON", 4);
            put_bytes(&l, sample.bytes + 20, place - 20);
            put_bytes(&l, NUMBERS[i], length);
            put_bytes(&l, sample.bytes + end, sample.size - end);
            check_refusal(read_exact(l.bytes, l.size));
            layout_free(&l);
        }
    }
}
END_TEST

/* `user` is the file's path. */
static sph_status open_and_destroy(sph_context *own, const void *user)
{
    const char *path = user;
    sph_animation *animation = NULL;
    const sph_status status = sph_io_open_animation(own, &path, 1, NULL, &animation);
    ck_assert_int_eq(animation == NULL, status != SPH_OK);
    sph_animation_destroy(animation);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    const char *path = file_write("a.glb", sample.bytes, sample.size);
    check_every_allocation((test_faults){.work = open_and_destroy, .user = path, .least = 31, .sticky = _i});
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, a_glb_cut_at_any_length_is_refused);
    tcase_add_loop_test(tc, a_glb_with_random_damage_is_refused_or_read_within_its_bytes, 0, 3);
    tcase_add_test(tc, absurd_numbers_in_the_json_are_refused_or_read_within_the_bytes);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    return run_suite(suite_create("io glTF damage"), tc);
}
