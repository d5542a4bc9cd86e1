/* SPDX-License-Identifier: MIT */
#include "base/base.h"

const char *sph_status_text(sph_status status)
{
    switch (status) {
    case SPH_OK:
        return "no error";
    case SPH_E_INVALID:
        return "invalid argument or input";
    case SPH_E_NOMEM:
        return "out of memory";
    case SPH_E_CANCELLED:
        return "cancelled";
    case SPH_E_VERSION:
        return "made by a newer version";
    case SPH_E_IO:
        return "input or output failed";
    case SPH_E_FORMAT:
        return "damaged or wrong format";
    case SPH_E_UNSUPPORTED:
        return "not supported";
    case SPH_E_LIMIT:
        return "beyond a limit";
    case SPH_E_STATE:
        return "not possible in this state";
    default:
        return "unknown status";
    }
}

/* Large memory comes from the system and goes back to it at once, where the C library might keep it. */
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#  define HAVE_LARGE 1
enum { LARGE = 1 << 18 };
#endif
