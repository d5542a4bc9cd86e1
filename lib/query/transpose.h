/* SPDX-License-Identifier: MIT */
/* Eight rows of eight floats become columns; as a macro, for clones (hierarchy/lanes.h). */
#ifndef SPH_QUERY_TRANSPOSE_H
#define SPH_QUERY_TRANSPOSE_H

typedef float sph__query_v8f __attribute__((vector_size(32), may_alias, aligned(4)));

typedef float sph__query_v16f __attribute__((vector_size(64), may_alias, aligned(4)));

#define SPH__QUERY_LOW(a, b) __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13)
#define SPH__QUERY_HIGH(a, b) __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15)
#define SPH__QUERY_EVEN(a, b) __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
#define SPH__QUERY_ODD(a, b) __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15)
#define SPH__QUERY_FRONT(a, b) __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11)
#define SPH__QUERY_BACK(a, b) __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15)
#define SPH__QUERY_ROW(row) (*(const sph__query_v8f *)(const void *)(row))
#define SPH__QUERY_COLUMN(column) (*(sph__query_v8f *)(void *)(column))

/* `row(i)` is where row i is; the columns go to c0 to c7. */
#define SPH__QUERY_TRANSPOSE(row, c0, c1, c2, c3, c4, c5, c6, c7)                                                      \
    do {                                                                                                               \
        const sph__query_v8f r0 = SPH__QUERY_ROW(row(0)), r1 = SPH__QUERY_ROW(row(1)), r2 = SPH__QUERY_ROW(row(2));    \
        const sph__query_v8f r3 = SPH__QUERY_ROW(row(3)), r4 = SPH__QUERY_ROW(row(4)), r5 = SPH__QUERY_ROW(row(5));    \
        const sph__query_v8f r6 = SPH__QUERY_ROW(row(6)), r7 = SPH__QUERY_ROW(row(7));                                 \
        const sph__query_v8f a0 = SPH__QUERY_LOW(r0, r1), a1 = SPH__QUERY_HIGH(r0, r1);                                \
        const sph__query_v8f a2 = SPH__QUERY_LOW(r2, r3), a3 = SPH__QUERY_HIGH(r2, r3);                                \
        const sph__query_v8f a4 = SPH__QUERY_LOW(r4, r5), a5 = SPH__QUERY_HIGH(r4, r5);                                \
        const sph__query_v8f a6 = SPH__QUERY_LOW(r6, r7), a7 = SPH__QUERY_HIGH(r6, r7);                                \
        const sph__query_v8f b0 = SPH__QUERY_EVEN(a0, a2), b1 = SPH__QUERY_ODD(a0, a2);                                \
        const sph__query_v8f b2 = SPH__QUERY_EVEN(a1, a3), b3 = SPH__QUERY_ODD(a1, a3);                                \
        const sph__query_v8f b4 = SPH__QUERY_EVEN(a4, a6), b5 = SPH__QUERY_ODD(a4, a6);                                \
        const sph__query_v8f b6 = SPH__QUERY_EVEN(a5, a7), b7 = SPH__QUERY_ODD(a5, a7);                                \
        SPH__QUERY_COLUMN(c0) = SPH__QUERY_FRONT(b0, b4);                                                              \
        SPH__QUERY_COLUMN(c1) = SPH__QUERY_FRONT(b1, b5);                                                              \
        SPH__QUERY_COLUMN(c2) = SPH__QUERY_FRONT(b2, b6);                                                              \
        SPH__QUERY_COLUMN(c3) = SPH__QUERY_FRONT(b3, b7);                                                              \
        SPH__QUERY_COLUMN(c4) = SPH__QUERY_BACK(b0, b4);                                                               \
        SPH__QUERY_COLUMN(c5) = SPH__QUERY_BACK(b1, b5);                                                               \
        SPH__QUERY_COLUMN(c6) = SPH__QUERY_BACK(b2, b6);                                                               \
        SPH__QUERY_COLUMN(c7) = SPH__QUERY_BACK(b3, b7);                                                               \
    } while (0)

/* Sixteen rows of eight: columns that are written as a whole. */
#define SPH__QUERY_TRANSPOSE_16(row, next_row, columns)                                                                \
    do {                                                                                                               \
        sph__query_v8f low[8], high[8];                                                                                \
        SPH__QUERY_TRANSPOSE(row, low, low + 1, low + 2, low + 3, low + 4, low + 5, low + 6, low + 7);                 \
        SPH__QUERY_TRANSPOSE(next_row, high, high + 1, high + 2, high + 3, high + 4, high + 5, high + 6, high + 7);    \
        for (int column = 0; column < 8; ++column)                                                                     \
            *(sph__query_v16f *)(void *)(columns)[column] = __builtin_shufflevector(                                   \
                low[column], high[column], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);                      \
    } while (0)

#endif
