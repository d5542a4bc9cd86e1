/* SPDX-License-Identifier: MIT */
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

#include <sphmesh/version.h>

#include "base/handle.h"
#include "base/message.h"

struct sph_context {
    sph_allocator allocator;
    sph_executor executor;
    sph_log_fn *log;
    void *log_user;
    sph_progress_fn *progress;
    void *progress_user;
    sph__pool *pool; /* NULL with a caller's executor and for one thread */
    uint32_t worker_count;
    atomic_uint_fast64_t references;
    uint64_t memory_limit; /* UINT64_MAX: none */
    atomic_uint_fast64_t memory_used, memory_peak;
    atomic_bool limit_reached; /* since the last message about memory */
    sph__messages messages;
    sph__graves graves;
};

enum { CONTEXT_SIZE = SPH__IN_FRONT + sizeof(sph_context) };

uint32_t sph_version(void)
{
    return SPH_VERSION;
}

static void inline_parallel_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    (void)user;
    for (size_t begin = 0, end; begin < count; begin = end) {
        end = count - begin < grain ? count : begin + grain;
        body(argument, begin, end);
    }
}

enum { CONTEXT_OPTIONS_V1 = offsetof(sph_context_options, reserved0) + sizeof(uint32_t) };
_Static_assert(sizeof(void *) != 8 || CONTEXT_OPTIONS_V1 == 88, "a field of 0.1 moved");

static const sph_context_options CONTEXT_DEFAULTS = {.struct_size = sizeof(sph_context_options)};

void sph_context_options_init(sph_context_options *options, size_t size)
{
    sph__options_init(options, size, &CONTEXT_DEFAULTS, sizeof CONTEXT_DEFAULTS, CONTEXT_OPTIONS_V1);
}

static uint32_t processor_count(void)
{
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : count > 256 ? 256 : (uint32_t)count;
}

static sph_status read_options(const sph_context_options *in, sph_context_options *o)
{
    sph_status status;
    *o = CONTEXT_DEFAULTS;
    status = sph__options_read(NULL, "sph_context_options", in, o, sizeof *o, CONTEXT_OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0 || o->reserved0 != 0 || (o->allocator.allocate == NULL) != (o->allocator.release == NULL) ||
        (o->allocator.user != NULL && o->allocator.allocate == NULL) ||
        (o->executor.user != NULL && o->executor.parallel_for == NULL) || o->thread_count > 256)
        return SPH_E_INVALID;
    if (o->allocator.allocate == NULL) o->allocator = (sph_allocator){NULL, sph__default_allocate, sph__default_release};
    if (o->thread_count == 0) o->thread_count = processor_count();
    return SPH_OK;
}

static sph_status start_executor(sph_context *context, const sph_context_options *o)
{
    context->worker_count = o->thread_count;
    if (o->executor.parallel_for != NULL) {
        context->worker_count = processor_count();
        context->executor = o->executor;
    } else if (o->thread_count == 1) {
        context->executor.parallel_for = inline_parallel_for;
    } else {
        context->pool = sph__pool_create(&context->allocator, o->thread_count - 1);
        if (context->pool == NULL) return SPH_E_NOMEM;
        context->executor = (sph_executor){context->pool, sph__pool_parallel_for};
    }
    return SPH_OK;
}

/* Where handles are checked, something is in front of a context as of any other block. */
static sph_context *context_in(void *block)
{
    return (sph_context *)(void *)((char *)block + SPH__IN_FRONT);
}

static void *block_of(sph_context *context)
{
    return (char *)context - SPH__IN_FRONT;
}

sph_status sph_context_create(const sph_context_options *options, sph_context **out)
{
    sph_context_options o;
    sph_context *context;
    sph_status status;
    if (out == NULL) return SPH_E_INVALID;
    *out = NULL;
    status = read_options(options, &o);
    if (status != SPH_OK) return status;
    context = o.allocator.allocate(o.allocator.user, CONTEXT_SIZE, SPH__ALIGN);
    if (context == NULL) return SPH_E_NOMEM;
    memset(context, 0, CONTEXT_SIZE);
    context = context_in(context);
    context->allocator = o.allocator;
    context->log = o.log;
    context->log_user = o.log_user;
    context->progress = o.progress;
    context->progress_user = o.progress_user;
    context->memory_limit = o.memory_limit == 0 ? UINT64_MAX : o.memory_limit;
    atomic_init(&context->references, 1);
    atomic_init(&context->memory_used, CONTEXT_SIZE);
    atomic_init(&context->memory_peak, CONTEXT_SIZE);
    if (!sph__messages_init(&context->messages)) {
        o.allocator.release(o.allocator.user, block_of(context), CONTEXT_SIZE);
        return SPH_E_NOMEM;
    }
    sph__handle_mark(context, context, SPH__CONTEXT);
    status = start_executor(context, &o);
    if (status != SPH_OK) {
        sph_context_destroy(context);
        return status;
    }
    *out = context;
    return SPH_OK;
}

sph_context *sph__context_retain(sph_context *context)
{
    atomic_fetch_add_explicit(&context->references, 1, memory_order_relaxed);
    return context;
}

void sph__context_release(sph_context *context)
{
    if (context == NULL || atomic_fetch_sub_explicit(&context->references, 1, memory_order_acq_rel) != 1) return;
    sph__pool_destroy(context->pool);
    sph__messages_destroy(&context->messages, &context->allocator);
    sph__graves_clear(&context->graves, &context->allocator);
    context->allocator.release(context->allocator.user, block_of(context), CONTEXT_SIZE);
}

void sph_context_destroy(sph_context *context)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph__context_release(context);
}

const char *sph_context_last_message(const sph_context *context)
{
    SPH__OWN(context, SPH__CONTEXT);
    uint64_t stamp;
    /* The messages are not part of the visible state that const speaks of. */
    return context == NULL ? "" : sph__messages_read(&((sph_context *)context)->messages, &stamp);
}

sph_status sph__fail(const sph_context *context, sph_status status, const char *format, ...)
{
    char text[SPH__MESSAGE_SIZE]; /* formatted first: an argument may be the last message itself */
    va_list arguments;
    if (context == NULL) return status;
    va_start(arguments, format);
    sph__format_message(text, format, arguments);
    va_end(arguments);
    sph__messages_store(&((sph_context *)context)->messages, &context->allocator, text);
    return status;
}

sph_status sph__fail_memory(const sph_context *context)
{
    if (atomic_exchange_explicit(&((sph_context *)context)->limit_reached, false, memory_order_relaxed))
        return sph__fail(context, SPH_E_NOMEM, "out of memory: the limit of %llu bytes is reached",
                         (unsigned long long)context->memory_limit);
    return sph__fail(context, SPH_E_NOMEM, "out of memory");
}

uint64_t sph__message_stamp(const sph_context *context)
{
    uint64_t stamp;
    sph__messages_read(&((sph_context *)context)->messages, &stamp);
    return stamp;
}

void sph__log(const sph_context *context, int32_t severity, const char *format, ...)
{
    char text[SPH__MESSAGE_SIZE];
    va_list arguments;
    if (context == NULL || context->log == NULL) return;
    va_start(arguments, format);
    sph__format_message(text, format, arguments);
    va_end(arguments);
    context->log(context->log_user, severity, text);
}

sph_status sph_context_fail(sph_context *context, sph_status status, const char *message)
{
    SPH__OWN(context, SPH__CONTEXT);
    return sph__fail(context, status, "%s", message == NULL ? "" : message);
}

void sph_context_log(sph_context *context, int32_t severity, const char *message)
{
    SPH__OWN(context, SPH__CONTEXT);
    if (message != NULL) sph__log(context, severity, "%s", message);
}

void *sph_context_allocate(sph_context *context, size_t count, size_t size)
{
    SPH__OWN(context, SPH__CONTEXT);
    return context == NULL ? NULL : sph__alloc(context, count, size);
}

void sph_context_release(sph_context *context, void *memory)
{
    SPH__OWN(context, SPH__CONTEXT);
    if (context != NULL) sph__free(context, memory);
}

sph_status sph_context_report_progress(sph_context *context, const char *stage, double fraction)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph__progress progress;
    if (context == NULL || stage == NULL || !(fraction >= 0 && fraction <= 1)) return SPH_E_INVALID;
    sph__progress_begin(&progress, context);
    sph__progress_part(&progress, 1);
    return sph__progress_report(&progress, stage, fraction);
}

void sph_context_parallel_for(sph_context *context, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    SPH__OWN(context, SPH__CONTEXT);
    if (context != NULL && grain != 0 && body != NULL) sph__parallel_for(context, count, grain, body, argument);
}

uint64_t sph_context_memory_used(const sph_context *context)
{
    SPH__OWN(context, SPH__CONTEXT);
    return context == NULL ? 0 : atomic_load_explicit(&context->memory_used, memory_order_relaxed);
}

uint64_t sph_context_memory_peak(const sph_context *context)
{
    SPH__OWN(context, SPH__CONTEXT);
    return context == NULL ? 0 : atomic_load_explicit(&context->memory_peak, memory_order_relaxed);
}

/* Counts memory before it is asked for, so that two threads cannot pass the limit together. */
static bool charge(sph_context *context, uint64_t bytes)
{
    const uint64_t used = atomic_fetch_add_explicit(&context->memory_used, bytes, memory_order_relaxed) + bytes;
    uint_fast64_t peak = atomic_load_explicit(&context->memory_peak, memory_order_relaxed);
    if (used > context->memory_limit) {
        atomic_fetch_sub_explicit(&context->memory_used, bytes, memory_order_relaxed);
        atomic_store_explicit(&context->limit_reached, true, memory_order_relaxed);
        return false;
    }
    while (used > peak && !atomic_compare_exchange_weak_explicit(&context->memory_peak, &peak, used,
                                                                 memory_order_relaxed, memory_order_relaxed)) {
    }
    return true;
}

/* Each block carries its size in front, one alignment unit long. The counts are not part of the visible state that const
 * speaks of. */
void *sph__alloc(const sph_context *context, size_t count, size_t size)
{
    sph_context *counted = (sph_context *)context;
    size_t bytes;
    char *memory;
    if (!sph__multiply_size(count, size, &bytes) || bytes > SIZE_MAX - SPH__ALIGN || bytes > PTRDIFF_MAX - SPH__ALIGN)
        return NULL;
    bytes += SPH__ALIGN;
    if (!charge(counted, bytes)) return NULL;
    memory = context->allocator.allocate(context->allocator.user, bytes, SPH__ALIGN);
    if (memory == NULL) {
        atomic_fetch_sub_explicit(&counted->memory_used, bytes, memory_order_relaxed);
        return NULL;
    }
    memcpy(memory, &bytes, sizeof bytes);
    sph__handle_mark(memory + SPH__ALIGN, context, SPH__NO_HANDLE);
    return memory + SPH__ALIGN;
}

void *sph__new(const sph_context *context, size_t size, int kind)
{
    void *handle = sph__zalloc(context, 1, size);
    if (handle != NULL) sph__handle_mark(handle, context, kind);
    return handle;
}

void *sph__zalloc(const sph_context *context, size_t count, size_t size)
{
    void *memory = sph__alloc(context, count, size);
    if (memory != NULL) memset(memory, 0, count * size);
    return memory;
}

void sph__free(const sph_context *context, void *memory)
{
    size_t bytes;
    char *start;
    if (memory == NULL) return;
    start = (char *)memory - SPH__ALIGN;
    memcpy(&bytes, start, sizeof bytes);
    if (!sph__bury(&((sph_context *)context)->graves, &context->allocator, memory))
        context->allocator.release(context->allocator.user, start, bytes);
    atomic_fetch_sub_explicit(&((sph_context *)context)->memory_used, bytes, memory_order_relaxed);
}

void *sph__realloc(const sph_context *context, void *memory, size_t count, size_t size)
{
    void *grown = sph__alloc(context, count, size);
    if (grown != NULL && memory != NULL) {
        size_t bytes;
        memcpy(&bytes, (char *)memory - SPH__ALIGN, sizeof bytes);
        bytes -= SPH__ALIGN;
        memcpy(grown, memory, bytes < count * size ? bytes : count * size);
        sph__free(context, memory);
    }
    return grown;
}

bool sph__multiply_size(size_t a, size_t b, size_t *out)
{
    return !__builtin_mul_overflow(a, b, out);
}

bool sph__reserve(const sph_context *context, void **memory, size_t *capacity, size_t need, size_t size)
{
    size_t wanted;
    void *grown;
    if (need <= *capacity) return true;
    wanted = *capacity > SIZE_MAX / 2 ? need : *capacity * 2;
    if (wanted < need) wanted = need;
    if (wanted < 16) wanted = 16;
    grown = sph__realloc(context, *memory, wanted, size);
    if (grown == NULL) return false;
    *memory = grown;
    *capacity = wanted;
    return true;
}

void sph__parallel_for(const sph_context *context, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    if (count == 0) return;
    if (count <= grain)
        body(argument, 0, count);
    else
        context->executor.parallel_for(context->executor.user, count, grain, body, argument);
}

uint32_t sph__worker_count(const sph_context *context)
{
    return context->worker_count;
}

void sph__progress_begin(sph__progress *progress, const sph_context *context)
{
    *progress = (sph__progress){.context = context};
}

void sph__progress_part(sph__progress *progress, double span)
{
    progress->base += progress->span;
    progress->span = span;
}

sph_status sph__progress_report(sph__progress *progress, const char *stage, double fraction)
{
    const sph_context *context = progress->context;
    double value = progress->base + progress->span * fraction;
    if (context->progress == NULL) return SPH_OK;
    if (value > 1) value = 1;
    if (value > progress->last) progress->last = value;
    if (context->progress(context->progress_user, stage, progress->last)) return SPH_OK;
    return sph__fail(context, SPH_E_CANCELLED, "cancelled during %s", stage);
}
