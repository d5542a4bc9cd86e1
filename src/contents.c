/* SPDX-License-Identifier: MIT */
#include "contents.h"

#include <stdio.h>

#include "report.h"

/* Where it goes, and how many rows there have been. */
typedef struct listing {
    json *j; /* NULL: a table */
    unsigned count;
} listing;

static void print_clip(void *user, const sph_io_clip *clip)
{
    listing *l = user;
    if (l->j == NULL) {
        if (l->count == 0) puts("clips:         number   seconds  frames  name");
        printf("%21u  %8.3f  %6s  %s\n", l->count, clip->duration, count_text(clip->frame_count), clip->name);
    } else {
        json_open(l->j, NULL, '{');
        json_text(l->j, "name", clip->name);
        json_number(l->j, "seconds", clip->duration);
        json_integer(l->j, "frames", clip->frame_count);
        json_close(l->j, '}');
    }
    ++l->count;
}

static void print_archive(void *user, const sph_io_archive *a)
{
    const listing *l = user;
    if (l->j != NULL) {
        json_open(l->j, "archive", '{');
        json_integer(l->j, "version", a->version);
        json_text(l->j, "application", a->application);
        json_text(l->j, "library", a->library);
        json_text(l->j, "date", a->date);
        json_text(l->j, "description", a->description);
        json_close(l->j, '}');
        return;
    }
    printf("archive:    Alembic (Ogawa), library %u.%u.%u", a->version / 10000, a->version / 100 % 100,
           a->version % 100);
    if (a->application[0] != '\0') printf(", written by %s", a->application);
    if (a->date[0] != '\0') printf(" on %s", a->date);
    puts("");
    if (a->description[0] != '\0') printf("            %s\n", a->description);
}

static void object_json(json *j, const sph_io_object *o)
{
    json_open(j, NULL, '{');
    json_text(j, "path", o->path);
    json_text(j, "kind", o->kind);
    json_boolean(j, "chosen", o->chosen != 0);
    json_boolean(j, "hidden", o->hidden != 0);
    json_integer(j, "vertices", o->vertex_count);
    json_integer(j, "faces", o->face_count);
    json_integer(j, "samples", o->sample_count);
    json_number(j, "first_second", o->first_time);
    json_number(j, "last_second", o->last_time);
    json_close(j, '}');
}

static void print_object(void *user, const sph_io_object *o)
{
    listing *l = user;
    if (l->j != NULL) {
        object_json(l->j, o);
    } else {
        if (l->count == 0) puts("objects:      samples  from s    to s  vertices     faces  (* read)");
        printf("%21s", count_text(o->sample_count));
        if (o->sample_count > 1)
            printf("  %6.2f  %6.2f", o->first_time, o->last_time);
        else
            printf("  %6s  %6s", "", "");
        printf("  %8s  %8s  %s %s, %s%s\n", o->vertex_count == 0 ? "" : count_text(o->vertex_count),
               o->vertex_count == 0 ? "" : count_text(o->face_count), o->chosen ? "*" : " ", o->path, o->kind,
               o->hidden ? ", hidden" : "");
    }
    ++l->count;
}

void contents_print_format(session *s, const input_options *input, const arguments *paths, json *j)
{
    sph_io_description d = {.struct_size = sizeof d, .format = ""}, cache = {.struct_size = sizeof cache};
    uint64_t files = 0;
    bool known = true; /* all have been opened before */
    for (size_t i = paths->count; i-- > 0;) {
        known = known && sph_io_describe(s->context, paths->items[i], &d) == SPH_OK;
        files += d.file_count;
    }
    if (input->cache != NULL) known = known && sph_io_describe(s->context, input->cache, &cache) == SPH_OK;
    if (!known) return;
    if (j != NULL) {
        json_text(j, "format", d.format);
        json_integer(j, "files", files);
        json_text(j, "cache_format", cache.format);
        return;
    }
    printf("input:      %s", d.format);
    if (files > 1) printf(", a sequence of %s files", count_text(files));
    if (input->cache != NULL)
        printf(", with a point cache (%s) of %s frames", cache.format == NULL ? "" : cache.format,
               count_text(cache.frame_count));
    puts("");
}

void contents_print(session *s, const input_options *input, const arguments *paths, json *j)
{
    const bool alone = paths->count == 1 && input->cache == NULL; /* it has been opened before */
    listing clips = {j, 0}, objects = {j, 0};
    if (j != NULL) json_open(j, "clips", '[');
    if (alone) (void)sph_io_list_clips(s->context, paths->items[0], input->fps, print_clip, &clips);
    if (j != NULL) json_close(j, ']');
    if (alone) (void)sph_io_list_objects(s->context, paths->items[0], input->object, print_archive, NULL, &objects);
    if (j != NULL) json_open(j, "objects", '[');
    if (alone) (void)sph_io_list_objects(s->context, paths->items[0], input->object, NULL, print_object, &objects);
    if (j != NULL) json_close(j, ']');
}
