/* SPDX-License-Identifier: MIT */
/* Built against an installed library by what pkg-config says, as a user of it would. */
#include <stdio.h>

#include <sphmesh/io.h>
#include <sphmesh/sphmesh.h>

int main(void)
{
    sph_context *context = NULL;
    sph_io_open_options options;
    const char *names[] = {"s10.obj", "s2.obj"};
    if (sph_version() != SPH_VERSION || sph_context_create(NULL, &context) != SPH_OK) return 1;
    sph_io_open_options_init(&options, sizeof options);
    sph_io_sort_natural(names, 2);
    printf("%s %u\n", names[0], (unsigned)sph_version());
    sph_context_destroy(context);
    return options.scale == 1 && names[0][1] == '2' ? 0 : 1;
}
