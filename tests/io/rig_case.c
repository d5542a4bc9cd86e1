/* SPDX-License-Identifier: MIT */
#include "rig_case.h"

#include <check.h>

sph_context *context;
rig_input input;
sph_skin_arrays skin;
const char *path;

void setup(void)
{
    context = test_context();
    files_setup();
    path = file_path("rig.glb");
}

void teardown(void)
{
    files_teardown();
    sph_context_destroy(context);
}

sph_skin *save(int32_t kind, uint32_t single_root, int32_t weights)
{
    sph_skeleton_options s;
    sph_io_rig_options o;
    sph_skeleton *skeleton = NULL;
    sph_skin *made = rig_skin(context, &input);
    sph_skeleton_options_init(&s, sizeof s);
    sph_io_rig_options_init(&o, sizeof o);
    s.layout = kind;
    s.single_root = single_root;
    o.weights = weights;
    skin.struct_size = sizeof skin;
    ck_assert_int_eq(sph_skin_get_arrays(made, &skin), SPH_OK);
    ck_assert_int_eq(sph_skeleton_create(made, &s, &skeleton), SPH_OK);
    ck_assert_msg(sph_io_save_rig(context, made, skeleton, &o, path) == SPH_OK, "%s",
                  sph_context_last_message(context));
    sph_skeleton_destroy(skeleton);
    return made;
}
