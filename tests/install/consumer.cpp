/* SPDX-License-Identifier: MIT */
/* The core from C++, through the installed headers alone. */
#include <sphmesh/sphmesh.h>

#include <cstdio>
#include <memory>

int main()
{
    sph_context *handle = nullptr;
    if (sph_context_create(nullptr, &handle) != SPH_OK) return 1;
    const std::unique_ptr<sph_context, decltype(&sph_context_destroy)> context(handle, sph_context_destroy);
    sph_animation *animation = nullptr;
    if (sph_animation_create(context.get(), 0, 1, &animation) != SPH_E_INVALID || animation != nullptr) return 1;
    std::printf("%s\n", sph_context_last_message(context.get()));
    return 0;
}
