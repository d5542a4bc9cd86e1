/* SPDX-License-Identifier: MIT */
#include "clips.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

/* Frames of the whole, as an animation of their own. */
typedef struct clip_view {
    const sph_animation *whole;
    const uint32_t *frames;
} clip_view;

/* A clip as it is asked for. */
typedef struct wanted {
    const char *name; /* not ended */
    size_t name_length;
    uint32_t first, end, step;
} wanted;

static sph_status read_frame(void *user, uint32_t frame, float *xyz)
{
    const clip_view *view = user;
    return sph_animation_read_frame(view->whole, view->frames[frame], xyz);
}

static sph_status make_view(session *s, clip_view *view, uint32_t frame_count, sph_animation **out)
{
    const sph_animation *whole = view->whole;
    const sph_frame_source source = {.user = view, .read_frame = read_frame};
    sph_status status =
        sph_animation_create_from_source(s->context, sph_animation_vertex_count(whole), frame_count, &source, out);
    if (status == SPH_OK)
        status =
            sph_animation_set_triangles(*out, sph_animation_triangles(whole), sph_animation_triangle_count(whole), 0);
    if (status == SPH_OK)
        status = sph_animation_set_edges(*out, sph_animation_edges(whole), sph_animation_edge_count(whole), 0);
    return status;
}

static uint32_t frames_of(const wanted *w)
{
    return (w->end - w->first - 1) / w->step + 1;
}

/* NAME=A:B:STEP,... */
static int read_text(const char *text, uint32_t frame_count, wanted *list, uint32_t *count)
{
    for (*count = 0; *text != '\0'; ++*count) {
        wanted *w = &list[*count];
        char range_text[64];
        const size_t length = strcspn(text, ","), name_length = strcspn(text, "=");
        frame_range range;
        if (*count == CLIPS_MOST) return usage_error("skin", "--clips: more than %d", CLIPS_MOST);
        if (name_length >= length || length - name_length > sizeof range_text)
            return usage_error("skin", "--clips: '%.*s' is not NAME=A:B", (int)length, text);
        snprintf(range_text, sizeof range_text, "%.*s", (int)(length - name_length - 1), text + name_length + 1);
        if (!read_frames(range_text, &range))
            return usage_error("skin", "--clips: '%s' is not A:B or A:B:STEP with A below B and STEP above 0",
                               range_text);
        if (range.end == 0) range.end = frame_count;
        if (range.first >= range.end || range.end > frame_count)
            return usage_error("skin", "--clips: '%.*s': the input has frames 0 to %u", (int)length, text,
                               frame_count - 1);
        *w = (wanted){text, name_length, range.first, range.end, range.step};
        text += length + (text[length] == ',');
    }
    return *count == 0 ? usage_error("skin", "--clips: there are none") : DONE;
}

/* The clips of a glTF, one after another, as the input has them. */
typedef struct found {
    wanted *list;
    char (*names)[64];
    uint32_t count, frame_count;
    bool too_many;
} found;

static void see_clip(void *user, const sph_io_clip *clip)
{
    found *f = user;
    if (f->count == CLIPS_MOST) {
        f->too_many = true;
        return;
    }
    snprintf(f->names[f->count], sizeof f->names[0], "%s", clip->name);
    f->list[f->count] =
        (wanted){f->names[f->count], strlen(f->names[f->count]), f->frame_count, f->frame_count + clip->frame_count, 1};
    f->frame_count += clip->frame_count;
    ++f->count;
}

static sph_status find_clips(session *s, const input_options *input, const arguments *paths, uint32_t frame_count,
                             found *f)
{
    sph_status status = SPH_OK;
    if (paths->count == 1 && input->cache == NULL && input->clip == NULL && !input->frames.given)
        status = sph_io_list_clips(s->context, paths->items[0], input->fps, see_clip, f);
    if (status != SPH_OK || f->too_many || f->count == 0 || f->frame_count != frame_count) {
        f->list[0] = (wanted){"", 0, 0, frame_count, 1};
        f->count = 1;
        if (input->clip != NULL) {
            f->list[0].name = input->clip;
            f->list[0].name_length = strlen(input->clip);
        }
    }
    return SPH_OK; /* patterns of names are no files of clips */
}

/* Frames and names of all clips in one place each. */
static int gather(clips *c, const wanted *list)
{
    size_t bytes = 0;
    uint64_t frames = 0;
    uint32_t at = 0;
    char *name;
    for (uint32_t i = 0; i < c->count; ++i) {
        bytes += list[i].name_length + 1;
        frames += frames_of(&list[i]);
    }
    if (frames > INT32_MAX) return usage_error("skin", "--clips: more than 2^31 - 1 frames together");
    c->frame_count = (uint32_t)frames;
    c->frames = malloc(c->frame_count * sizeof *c->frames);
    c->names = name = malloc(bytes);
    c->views = malloc(((size_t)c->count + 1) * sizeof *c->views);
    if (c->frames == NULL || c->names == NULL || c->views == NULL) return failure("out of memory");
    c->every = c->frame_count == sph_animation_frame_count(c->whole);
    for (uint32_t i = 0; i < c->count; ++i) {
        const wanted *w = &list[i];
        memcpy(name, w->name, w->name_length);
        name[w->name_length] = '\0';
        c->sources[i].name = name;
        name += w->name_length + 1;
        c->views[i] = (clip_view){c->whole, c->frames + at};
        for (uint32_t f = 0; f < frames_of(w); ++f, ++at) {
            c->frames[at] = w->first + f * w->step;
            c->every = c->every && c->frames[at] == at;
        }
    }
    c->views[c->count] = (clip_view){c->whole, c->frames};
    return DONE;
}

static sph_status make_views(session *s, clips *c, const wanted *list, double fps)
{
    sph_status status = SPH_OK;
    c->all = c->whole;
    if (!c->every) status = make_view(s, &c->views[c->count], c->frame_count, &c->all);
    for (uint32_t i = 0; i < c->count && status == SPH_OK; ++i) {
        sph_animation *clip = c->whole;
        if (!c->every || c->count > 1) status = make_view(s, &c->views[i], frames_of(&list[i]), &clip);
        c->sources[i].animation = clip;
        c->sources[i].frames_per_second = fps;
    }
    return status;
}

int clips_open(session *s, const input_options *input, const arguments *paths, const char *text, sph_animation *whole,
               clips *out)
{
    static wanted list[CLIPS_MOST];
    static char names[CLIPS_MOST][64];
    const uint32_t frames = sph_animation_frame_count(whole);
    found f = {.list = list, .names = names};
    sph_status status = SPH_OK;
    int result = DONE;
    *out = (clips){.whole = whole};
    if (text != NULL)
        result = read_text(text, frames, list, &f.count);
    else
        status = find_clips(s, input, paths, frames, &f);
    out->count = f.count;
    if (result == DONE && status == SPH_OK) result = gather(out, list);
    if (result == DONE && status == SPH_OK) status = make_views(s, out, list, input->fps);
    return status == SPH_OK ? result : session_fail(s, status, NULL);
}

void clips_close(clips *c)
{
    for (uint32_t i = 0; i < c->count; ++i)
        if (c->sources[i].animation != c->whole)
            sph_animation_destroy((sph_animation *)(uintptr_t)c->sources[i].animation);
    if (c->all != c->whole) sph_animation_destroy(c->all);
    free(c->names);
    free(c->frames);
    free(c->views);
    *c = (clips){0};
}
