/* SPDX-License-Identifier: MIT */
/*
 * The mesh formats that are known by name. A new reader takes its line in the table: where `read` is NULL the format is
 * refused by its name.
 */
#include <string.h>

#include "io/io.h"

typedef struct format {
    const char *name, *ending;
    const char *magic; /* what such a file begins with; NULL: nothing that would tell it from others */
    size_t magic_size;
    sph__io_read_fn *read;
    const char *hint; /* what to do with one that is not read */
} format;

#define MAGIC(text) text, sizeof(text) - 1
static const format FORMATS[] = {
    {"OBJ", "obj", NULL, 0, sph__io_read_obj, NULL},
    {"PLY", "ply", MAGIC("ply\n"), sph__io_read_ply, NULL},
    {"PLY", "ply", MAGIC("ply\r"), sph__io_read_ply, NULL},
    {"OFF", "off", MAGIC("OFF"), sph__io_read_off, NULL},
    {"OFF", "coff", MAGIC("COFF"), sph__io_read_off, NULL},
    {"OFF", "noff", MAGIC("NOFF"), sph__io_read_off, NULL},
    {"OFF", "cnoff", MAGIC("CNOFF"), sph__io_read_off, NULL},
    {"OFF", "stoff", MAGIC("STOFF"), sph__io_read_off, NULL},
    {"OFF", "off", MAGIC("STNOFF"), sph__io_read_off, NULL},
    {"OFF", "off", MAGIC("STCOFF"), sph__io_read_off, NULL},
    {"OFF", "off", MAGIC("STCNOFF"), sph__io_read_off, NULL},
    {"OFF", "off", MAGIC("4OFF"), sph__io_read_off, NULL},
    {"OFF", "off", MAGIC("nOFF"), sph__io_read_off, NULL},
    {"STL", "stl", NULL, 0, sph__io_read_stl, NULL},
    {"binary glTF", "glb", MAGIC("glTF"), sph__io_read_gltf, NULL},
    {"glTF", "gltf", NULL, 0, sph__io_read_gltf, NULL},
    {"Alembic", "abc", MAGIC("Ogawa"), sph__io_read_abc, NULL},
    {"Alembic (HDF5)", "abc", MAGIC("\x89HDF\r\n\x1A\n"), NULL,
     ", only from Alembic (Ogawa): abcconvert -toOgawa converts them"},
    {"FBX", "fbx", MAGIC("Kaydara FBX Binary"), NULL, NULL},
    {"Collada", "dae", NULL, 0, NULL, NULL},
    {"USD", "usd", MAGIC("PXR-USDC"), NULL, NULL},
    {"USD", "usda", MAGIC("#usda"), NULL, NULL},
    {"USD", "usdc", NULL, 0, NULL, NULL},
    {"USD", "usdz", NULL, 0, NULL, NULL},
    {"sphmesh", "sphm", MAGIC("\x89SPH\r\n\x1A\n"), NULL, NULL},
};
enum { FORMAT_COUNT = sizeof FORMATS / sizeof *FORMATS };

static const format *find_by_content(const sph__io_map *map)
{
    for (size_t i = 0; i < FORMAT_COUNT; ++i)
        if (FORMATS[i].magic != NULL && map->size >= FORMATS[i].magic_size &&
            memcmp(map->bytes, FORMATS[i].magic, FORMATS[i].magic_size) == 0)
            return &FORMATS[i];
    return NULL;
}

static const format *find_by_name(const char *path)
{
    for (size_t i = 0; i < FORMAT_COUNT; ++i)
        if (sph__io_has_ending(path, FORMATS[i].ending)) return &FORMATS[i];
    return NULL;
}

/* A file of another name is taken for OBJ when its first record is one of OBJ's. */
static bool looks_like_obj(const sph__io_map *map)
{
    static const char *const WORDS[] = {"v", "vn", "vt", "o", "g", "s", "f", "mtllib", "usemtl"};
    const char *p = (const char *)map->bytes, *end = p + map->size, *word;
    while (p < end && (*p == '#' || *p == '\n' || *p == '\r' || *p == ' ' || *p == '\t'))
        if (*p++ == '#')
            while (p < end && *p != '\n' && *p != '\r')
                ++p;
    for (word = p; p < end && *p >= 'a' && *p <= 'z';)
        ++p;
    if (p == end || (*p != ' ' && *p != '\t')) return false;
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; ++i)
        if ((size_t)(p - word) == strlen(WORDS[i]) && memcmp(word, WORDS[i], (size_t)(p - word)) == 0) return true;
    return false;
}

static const format *find(const char *path, const sph__io_map *map)
{
    const format *found = find_by_content(map);
    if (found == NULL) found = find_by_name(path);
    return found;
}

const char *sph__io_format_name(const char *path, const sph__io_map *map)
{
    const format *found = find(path, map);
    const char *cache = sph__io_cache_name(path, map);
    if (found != NULL) return found->name;
    return cache != NULL ? cache : looks_like_obj(map) ? FORMATS[0].name : NULL;
}

sph_status sph__io_find_reader(sph_context *context, const char *path, const sph__io_map *map, sph__io_read_fn **read)
{
    const format *found = find(path, map);
    const char *cache = sph__io_cache_name(path, map);
    *read = NULL;
    if (found == NULL && cache != NULL)
        return sph__io_fail(context, SPH_E_UNSUPPORTED,
                            "%s: a point cache (%s) has no triangles: name the mesh, and this as its cache",
                            sph__io_shown(path), cache);
    if (found == NULL && looks_like_obj(map)) found = &FORMATS[0];
    if (found == NULL)
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: not a format that is known", sph__io_shown(path));
    if (found->read == NULL)
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: meshes are not read from %s files%s", sph__io_shown(path),
                            found->name, found->hint == NULL ? "" : found->hint);
    *read = found->read;
    return SPH_OK;
}

sph_status sph__io_read_mesh(const char *path, sph__io_mesh *mesh, size_t *watched)
{
    sph__io_map map;
    sph__io_read_fn *read;
    sph_status status = sph__io_map_open(mesh->context, path, &map);
    if (status != SPH_OK) return status;
    status = sph__io_find_reader(mesh->context, path, &map, &read);
    if (status == SPH_OK) status = read(path, &map, mesh, watched);
    sph__io_map_close(&map);
    return status;
}
