/* SPDX-License-Identifier: MIT */
/* CRC-32C, eight bytes at a step. The tables are made where they are needed: 2048 numbers, in a few microseconds. */
#include "base/container.h"

enum { POLYNOMIAL = (int)0x82F63B78 }; /* reflected */

void sph__crc32c_init(sph__crc32c *crc)
{
    for (uint32_t i = 0; i < 256; ++i) {
        uint32_t value = i;
        for (unsigned bit = 0; bit < 8; ++bit)
            value = value >> 1 ^ ((value & 1) != 0 ? (uint32_t)POLYNOMIAL : 0);
        crc->tables[0][i] = value;
    }
    for (unsigned t = 1; t < 8; ++t)
        for (unsigned i = 0; i < 256; ++i)
            crc->tables[t][i] = crc->tables[t - 1][i] >> 8 ^ crc->tables[0][crc->tables[t - 1][i] & 0xFF];
}

uint32_t sph__crc32c_add(const sph__crc32c *crc, uint32_t before, const void *bytes, size_t size)
{
    const unsigned char *p = bytes;
    uint32_t value = ~before;
    for (; size >= 8; size -= 8, p += 8) {
        const uint32_t low = value ^ (p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24);
        value = crc->tables[7][low & 0xFF] ^ crc->tables[6][low >> 8 & 0xFF] ^ crc->tables[5][low >> 16 & 0xFF] ^
                crc->tables[4][low >> 24] ^ crc->tables[3][p[4]] ^ crc->tables[2][p[5]] ^ crc->tables[1][p[6]] ^
                crc->tables[0][p[7]];
    }
    for (; size > 0; --size, ++p)
        value = value >> 8 ^ crc->tables[0][(value ^ *p) & 0xFF];
    return ~value;
}
