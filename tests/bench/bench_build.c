/* SPDX-License-Identifier: MIT */
/*
 * What building hierarchies costs, each figure beside its target and its baseline: docs/performance.md.
 *
 *   bench_build [--json|--markdown] [--tiny] [--repeats N] [--only SECTION] [--data FOLDER] [--folder FOLDER]
 *
 * Sections: samba, static, growth, threads, memory, levels. Real data is looked for in FOLDER, else in $SPHMESH_DATA.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

bench_options bench = {.repeats = 5};

static int usage(const char *what)
{
    fprintf(stderr,
            "bench_build: what is %s?\n"
            "usage: bench_build [--json|--markdown] [--tiny] [--repeats N] [--only SECTION] [--data FOLDER] [--folder "
            "FOLDER]\n",
            what);
    return 2;
}

static void run_all(void)
{
    bench_begin();
    bench_rows_samba();
    bench_rows_static();
    bench_rows_growth();
    bench_rows_threads();
    bench_rows_memory();
    bench_rows_levels();
    bench_end();
}

int main(int argc, char **argv)
{
    bench.self = argv[0];
    bench.data = getenv("SPHMESH_DATA");
    for (int i = 1; i < argc; ++i) {
        const bool more = i + 1 < argc;
        if (strcmp(argv[i], "--json") == 0)
            bench.json = true;
        else if (strcmp(argv[i], "--markdown") == 0)
            bench.markdown = true;
        else if (strcmp(argv[i], "--tiny") == 0)
            bench.tiny = true, bench.repeats = 1;
        else if (strcmp(argv[i], "--repeats") == 0 && more && atoi(argv[i + 1]) > 0)
            bench.repeats = (uint32_t)atoi(argv[++i]);
        else if (strcmp(argv[i], "--only") == 0 && more)
            bench.only = argv[++i];
        else if (strcmp(argv[i], "--data") == 0 && more)
            bench.data = argv[++i];
        else if (strcmp(argv[i], "--folder") == 0 && more)
            bench.folder = argv[++i];
        else if (strcmp(argv[i], "--child") == 0 && i + 2 < argc)
            return bench_child(argv[i + 1], argv[i + 2]);
        else
            return usage(argv[i]);
    }
    run_all();
    return 0;
}
