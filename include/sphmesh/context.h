/* SPDX-License-Identifier: MIT */
/**
 * @file context.h
 * @brief Statuses, and the context through which the library reaches its host: memory, threads, log and progress.
 */
#ifndef SPHMESH_CONTEXT_H
#define SPHMESH_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "export.h"

SPH_BEGIN_DECLS

/** Outcome of a call. Values never change their meaning and are never reused; treat unknown ones as errors. */
typedef int32_t sph_status;

/** The statuses. Everything but #SPH_OK is an error; sph_context_last_message() then says what was wrong and where. */
enum {
    SPH_OK = 0,            /**< done */
    SPH_E_INVALID = 1,     /**< an argument or the input is wrong */
    SPH_E_NOMEM = 2,       /**< the allocator returned NULL, the context's memory limit is reached, or a size exceeds what
                                can be addressed */
    SPH_E_CANCELLED = 3,   /**< the progress callback asked to stop */
    SPH_E_VERSION = 4,     /**< made by a newer version than this library */
    SPH_E_IO = 5,          /**< the operating system or a frame source failed to read or write */
    SPH_E_FORMAT = 6,      /**< a file's content is damaged or is not of the format that it claims */
    SPH_E_UNSUPPORTED = 7, /**< valid, but not something this library does */
    SPH_E_LIMIT = 8,       /**< beyond a limit that the caller or the library sets */
    SPH_E_STATE = 9        /**< the handle is not in a state in which this call makes sense */
};

/**
 * @brief Short constant English text for a status, e.g. "out of memory"; never NULL, also for unknown values.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API const char *sph_status_text(sph_status status);

/** Handle: the library's link to its host. Handles made with a context keep it alive after sph_context_destroy(). */
typedef struct sph_context sph_context;

/**
 * Memory for everything that the library keeps. Copied into the context; `user` is borrowed until the context and all
 * handles made with it are gone. Both functions may be called from any thread at once.
 */
typedef struct sph_allocator {
    void *user; /**< passed back to both functions */
    /** Returns `size` bytes (> 0) aligned to `alignment` (a power of two, at most 64), or NULL. */
    void *(*allocate)(void *user, size_t size, size_t alignment);
    /** Takes back memory with the size it was asked with; never called with NULL. */
    void (*release)(void *user, void *memory, size_t size);
} sph_allocator;

/** Body of a parallel loop: process items [begin, end). Never fails, never blocks, calls no public function. */
typedef void sph_range_fn(void *argument, size_t begin, size_t end);

/**
 * The host's job system. Results never depend on the number of workers or on the order of blocks.
 */
typedef struct sph_executor {
    void *user; /**< passed back; borrowed as in sph_allocator */
    /**
     * Split [0, count) at multiples of `grain`, call `body` exactly once per block in any order on any threads, and
     * return when all blocks are done.
     */
    void (*parallel_for)(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument);
} sph_executor;

/** Importance of a log message. */
enum { SPH_LOG_WARNING = 1, SPH_LOG_INFO = 2, SPH_LOG_DEBUG = 3 };

/** Receives log messages (UTF-8, one line, without a newline). Called on the thread that made the library call. */
typedef void sph_log_fn(void *user, int32_t severity, const char *message);

/**
 * Progress of a long call, and the way to stop it: return false and the call ends soon with #SPH_E_CANCELLED.
 * Called only on the thread that made the library call. `stage` names what is being done ("decimation"); `fraction`
 * is that of the whole call, in [0, 1], and never falls within one call.
 */
typedef bool sph_progress_fn(void *user, const char *stage, double fraction);

/** Options of sph_context_create(). Fill with sph_context_options_init() first. */
typedef struct sph_context_options {
    uint32_t struct_size;      /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;            /**< must be 0 */
    sph_allocator allocator;   /**< all NULL: the C library's */
    sph_executor executor;     /**< all NULL: the built-in threads */
    sph_log_fn *log;           /**< may be NULL: silent */
    void *log_user;            /**< passed to `log` */
    sph_progress_fn *progress; /**< may be NULL */
    void *progress_user;       /**< passed to `progress` */
    uint32_t thread_count;     /**< threads of the built-in executor, the caller's included; 0 = one per processor; default 0 */
    uint32_t reserved0;        /**< must be 0 */
    uint64_t memory_limit;     /**< bytes that all handles of the context and the calls with them may hold together: one more
                                    and the call fails as if memory had run out; 0 (default): no limit. Against input that
                                    asks for too much */
} sph_context_options;

/**
 * @brief Fills `options` with the defaults. Call as `sph_context_options_init(&o, sizeof o)`.
 * @since 0.1
 */
SPH_API void sph_context_options_init(sph_context_options *options, size_t size);

/**
 * @brief Makes a context.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      the context, owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  `out` is NULL, a half-filled allocator or executor, or options that were not initialised.
 * @retval SPH_E_VERSION  options that only a newer library knows are set.
 * @retval SPH_E_NOMEM    out of memory. Threads that cannot be started are done without.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_context_create(const sph_context_options *options, sph_context **out);

/**
 * @brief Gives up the caller's hold on the context; memory goes with the last handle made with it. NULL is fine.
 * @since 0.1
 */
SPH_API void sph_context_destroy(sph_context *context);

/**
 * @brief Bytes of the allocator that the context, its handles and calls under way hold; 0 for NULL.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API uint64_t sph_context_memory_used(const sph_context *context);

/** @brief The most that sph_context_memory_used() has been so far; 0 for NULL. @since 0.1 */
SPH_API uint64_t sph_context_memory_peak(const sph_context *context);

/**
 * @brief What was wrong in the calling thread's last failed call with this context or with a handle made with it.
 * @return UTF-8 text naming the frame, vertex, byte or file concerned; "" where nothing failed. Owned by the context,
 *         valid until the same thread's next failure with it.
 * @par Thread safety  Any number of threads: each sees its own messages.
 * @since 0.1
 */
SPH_API const char *sph_context_last_message(const sph_context *context);

/**
 * @name For importers and frame sources
 * What the library itself uses, so that code beside it can live by the same rules.
 */
/**@{*/

/**
 * @brief Sets the calling thread's message and returns `status`, so that a frame source can write
 *        `return sph_context_fail(context, SPH_E_IO, "...")`. `context` may be NULL; long messages are cut at 511 bytes, between characters.
 * @since 0.1
 */
SPH_API sph_status sph_context_fail(sph_context *context, sph_status status, const char *message);

/**
 * @brief Memory from the context's allocator, 64-byte aligned; NULL when there is none or count * size overflows.
 * @since 0.1
 */
SPH_API void *sph_context_allocate(sph_context *context, size_t count, size_t size);

/** @brief Gives back memory from sph_context_allocate(). NULL is fine. @since 0.1 */
SPH_API void sph_context_release(sph_context *context, void *memory);

/**
 * @brief Reports progress of a long piece of work to the host, as the library does.
 * @retval SPH_E_CANCELLED  the host asked to stop; the message is set.
 * @since 0.1
 */
SPH_API sph_status sph_context_report_progress(sph_context *context, const char *stage, double fraction);

/** @brief Writes to the host's log. @since 0.1 */
SPH_API void sph_context_log(sph_context *context, int32_t severity, const char *message);

/** @brief Runs a parallel loop on the context's executor; see sph_executor. @since 0.1 */
SPH_API void sph_context_parallel_for(sph_context *context, size_t count, size_t grain, sph_range_fn *body,
                                      void *argument);
/**@}*/

SPH_END_DECLS

#endif
