/* SPDX-License-Identifier: MIT */
#include "hierarchy_file_case.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

sph_status keep(void *user, const void *data, size_t size)
{
    bytes *b = user;
    if (b->size + size > b->capacity) {
        unsigned char *grown = test_malloc(2 * (b->size + size), 1);
        if (b->size != 0) memcpy(grown, b->data, b->size);
        free(b->data);
        b->data = grown;
        b->capacity = 2 * (b->size + size);
    }
    if (size != 0) memcpy(b->data + b->size, data, size);
    b->size += size;
    return SPH_OK;
}

bytes write_all(const sph_hierarchy *h)
{
    bytes b = {NULL, 0, 0};
    ck_assert_int_eq(sph_hierarchy_write(h, keep, &b), SPH_OK);
    return b;
}

static sph_animation *make_mesh(sph_context *of, int kind)
{
    static const uint32_t EDGES[] = {0, 1, 1, 2, 2, 3, 9, 4};
    static const float POINT[3] = {1, 2, 3};
    sph_animation *animation;
    switch (kind) {
    case 0:
        return test_cube(of, 1);
    case 1:
        return test_sphere(of, 2, 5);
    case 2:
        return test_torus(of, 9, 7, 8);
    case 3:
        return test_grid(of, 6, 4, 9);
    case 4:
        return test_soup(of, 40, 25, 3, 1);
    case 5:
        animation = test_soup(of, 12, 3, 2, 2);
        ck_assert_int_eq(sph_animation_set_edges(animation, EDGES, 4, 0), SPH_OK);
        return animation;
    case 6:
        return test_animation(of, POINT, 1, NULL, 0, 3);
    default:
        return test_soup(of, 30, 200, 1, 3); /* non-manifold */
    }
}

sph_hierarchy *make_hierarchy(sph_context *of, int kind, int32_t radius_mode)
{
    sph_animation *animation = make_mesh(of, kind);
    sph_hierarchy_options options;
    sph_hierarchy *h = NULL;
    sph_hierarchy_options_init(&options, sizeof options);
    options.radius_mode = radius_mode;
    ck_assert_msg(sph_hierarchy_create(animation, &options, &h) == SPH_OK, "%s", sph_context_last_message(of));
    sph_animation_destroy(animation);
    return h;
}
