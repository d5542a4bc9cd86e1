/* SPDX-License-Identifier: MIT */
/*
 * Point caches: PC2 (little-endian, with a magic) and MDD (big-endian, without one). They stay in the file: a frame is
 * copied out of the mapping when it is asked for.
 */
#include <string.h>

#include "io/bytes.h"
#include "io/io.h"

enum { PC2_HEADER = 32, MDD_HEADER = 8, VERTEX_SIZE = 12, PC2_VERSION = 1 };

static const char PC2_MAGIC[12] = "POINTCACHE2";

static bool is_pc2(const sph__io_map *map)
{
    return map->size >= sizeof PC2_MAGIC && memcmp(map->bytes, PC2_MAGIC, sizeof PC2_MAGIC) == 0;
}

/* Bytes of an MDD of so many frames and points, from int32s; the largest is below 2^66, so 0 where it is too large. */
static uint64_t mdd_size(uint32_t frames, uint32_t points)
{
    const uint64_t frame = 4 + (uint64_t)points * VERTEX_SIZE;
    return frames > (UINT64_MAX - MDD_HEADER) / frame ? 0 : MDD_HEADER + frames * frame;
}

static bool is_mdd(const sph__io_map *map)
{
    uint32_t frames, points;
    if (map->size < MDD_HEADER) return false;
    frames = sph__io_load_32(map->bytes, true);
    points = sph__io_load_32(map->bytes + 4, true);
    return frames >= 1 && frames <= INT32_MAX && points >= 1 && points <= INT32_MAX &&
           mdd_size(frames, points) == map->size;
}

const char *sph__io_cache_name(const char *path, const sph__io_map *map)
{
    if (is_pc2(map) || sph__io_has_ending(path, "pc2")) return "PC2";
    return is_mdd(map) || sph__io_has_ending(path, "mdd") ? "MDD" : NULL;
}

static sph_status check_counts(sph_context *context, const char *path, int32_t points, int32_t frames)
{
    if (points >= 1 && frames >= 1) return SPH_OK;
    return sph__io_fail(context, SPH_E_FORMAT, "%s: its header says %d frames of %d points", sph__io_shown(path),
                        (int)frames, (int)points);
}

static sph_status open_pc2(sph_context *context, const char *path, sph__io_cache *cache)
{
    const sph__io_map *map = &cache->map;
    uint64_t room;
    sph_status status;
    if (!is_pc2(map))
        return sph__io_fail(context, SPH_E_FORMAT, "%s: byte 0: not a PC2 file, which begins with POINTCACHE2",
                            sph__io_shown(path));
    if (map->size < PC2_HEADER)
        return sph__io_fail(context, SPH_E_FORMAT, "%s: ends at byte %zu, within the header of %d bytes",
                            sph__io_shown(path), map->size, PC2_HEADER);
    if (sph__io_load_32(map->bytes + 12, false) != PC2_VERSION)
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: byte 12: PC2 version %d, only %d is known",
                            sph__io_shown(path), (int)(int32_t)sph__io_load_32(map->bytes + 12, false), PC2_VERSION);
    cache->vertex_count = sph__io_load_32(map->bytes + 16, false);
    cache->frame_count = sph__io_load_32(map->bytes + 28, false);
    cache->offset = PC2_HEADER;
    status = check_counts(context, path, (int32_t)cache->vertex_count, (int32_t)cache->frame_count);
    if (status != SPH_OK) return status;
    room = (map->size - PC2_HEADER) / ((uint64_t)cache->vertex_count * VERTEX_SIZE);
    if (room < cache->frame_count)
        return sph__io_fail(context, SPH_E_FORMAT,
                            "%s: ends at byte %zu, within frame %llu: its header says %u frames of %u points",
                            sph__io_shown(path), map->size, (unsigned long long)room, (unsigned)cache->frame_count,
                            (unsigned)cache->vertex_count);
    if (map->size - PC2_HEADER > (uint64_t)cache->vertex_count * VERTEX_SIZE * cache->frame_count)
        sph_context_log(context, SPH_LOG_WARNING, "a PC2 file is longer than its header says; the rest is left out");
    return SPH_OK;
}

static sph_status open_mdd(sph_context *context, const char *path, sph__io_cache *cache)
{
    const sph__io_map *map = &cache->map;
    sph_status status;
    if (map->size < MDD_HEADER)
        return sph__io_fail(context, SPH_E_FORMAT, "%s: ends at byte %zu, within the header of %d bytes",
                            sph__io_shown(path), map->size, MDD_HEADER);
    cache->frame_count = sph__io_load_32(map->bytes, true);
    cache->vertex_count = sph__io_load_32(map->bytes + 4, true);
    cache->offset = MDD_HEADER + 4 * (size_t)cache->frame_count;
    cache->big_endian = true;
    status = check_counts(context, path, (int32_t)cache->vertex_count, (int32_t)cache->frame_count);
    if (status != SPH_OK) return status;
    if (!is_mdd(map))
        return sph__io_fail(context, SPH_E_FORMAT,
                            "%s: not an MDD file, or damaged: %u frames of %u points would take %llu bytes, it has %zu",
                            sph__io_shown(path), (unsigned)cache->frame_count, (unsigned)cache->vertex_count,
                            (unsigned long long)mdd_size(cache->frame_count, cache->vertex_count), map->size);
    return SPH_OK;
}

sph_status sph__io_cache_interpret(sph_context *context, const char *path, sph__io_cache *cache)
{
    if (is_pc2(&cache->map) || sph__io_has_ending(path, "pc2")) return open_pc2(context, path, cache);
    if (is_mdd(&cache->map) || sph__io_has_ending(path, "mdd")) return open_mdd(context, path, cache);
    return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: neither a PC2 nor an MDD point cache", sph__io_shown(path));
}

sph_status sph__io_cache_open(sph_context *context, const char *path, sph__io_cache *cache)
{
    sph_status status;
    *cache = (sph__io_cache){.offset = 0};
    status = sph__io_map_open(context, path, &cache->map);
    if (status == SPH_OK) status = sph__io_cache_interpret(context, path, cache);
    if (status != SPH_OK) sph__io_cache_close(cache);
    return status;
}

void sph__io_cache_close(sph__io_cache *cache)
{
    sph__io_map_close(&cache->map);
    *cache = (sph__io_cache){.offset = 0};
}

void sph__io_cache_read(const sph__io_cache *cache, uint32_t frame, float *xyz)
{
    const size_t size = (size_t)cache->vertex_count * VERTEX_SIZE, begin = cache->offset + frame * size;
    const unsigned char *p = cache->map.bytes + begin;
    for (size_t i = 0; i < 3 * (size_t)cache->vertex_count; ++i)
        xyz[i] = sph__io_load_float(p + 4 * i, cache->big_endian);
    sph__io_map_drop(&cache->map, begin, begin + size);
}
