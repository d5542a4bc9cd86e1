/* SPDX-License-Identifier: MIT */
/**
 * @file spill.h
 * @brief An allocator for data that does not fit: large blocks live in a temporary file, and only so much of them stays
 *        resident. Part of libsphmesh-io.
 *
 * Make a spill with a plain context, then a second context with the spill's allocator, and work with that one: animations,
 * hierarchies and all else made with it may be several times larger than the limit. Results are the same bits as without.
 *
 * @code
 * sph_io_spill_options_init(&o, sizeof o);
 * o.memory_limit = 512u << 20;
 * o.folder = "/var/tmp";
 * sph_io_spill_create(plain, &o, &spill);
 * sph_io_spill_get_allocator(spill, &context_options.allocator);
 * sph_io_spill_get_executor(spill, &context_options.executor);
 * sph_context_create(&context_options, &context);
 * @endcode
 *
 * The file has no name and goes with the spill, or with the process. Blocks in it are mapped; a thread of the spill's own
 * watches the resident set of the process, and takes pages away in turn when it comes near to the limit. Where they are
 * needed again they come back: from the page cache as long as the system has memory to spare, else from the disk. So the
 * folder should be on a disk and have room, about ten times the input positions to be safe; in a file system that is itself
 * in memory (tmpfs) nothing is gained, and a warning is logged.
 *
 * What the limit cannot hold back is memory that does not come from the spill: the host's own, and blocks below
 * `least_size`. And the thread looks every millisecond or so: what is touched in between comes on top.
 */
#ifndef SPHMESH_SPILL_H
#define SPHMESH_SPILL_H

#include "context.h"

SPH_BEGIN_DECLS

/** Handle: a temporary file, and the allocator that uses it. */
typedef struct sph_io_spill sph_io_spill;

/** Options of sph_io_spill_create(). Fill with sph_io_spill_options_init() first. */
typedef struct sph_io_spill_options {
    uint32_t struct_size;  /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;        /**< must be 0 */
    uint64_t memory_limit; /**< bytes that the process should have resident; at least #SPH_IO_SPILL_LEAST; no default */
    uint64_t least_size;   /**< blocks of at least so many bytes live in the file; default 65536; > 0 */
    const char *folder;    /**< where the file goes; NULL (default): /var/tmp */
} sph_io_spill_options;

/** The smallest limit: 16 MiB. The program alone takes about half of it. */
#define SPH_IO_SPILL_LEAST (UINT64_C(16) << 20)

/** What a spill has done. */
typedef struct sph_io_spill_figures {
    uint32_t struct_size;     /**< set by the caller to sizeof(sph_io_spill_figures) */
    uint32_t reserved0;       /**< set to 0 */
    uint64_t live_bytes;      /**< of blocks in the file, now */
    uint64_t peak_live_bytes; /**< the most there were */
    uint64_t file_bytes;      /**< size of the file; it does not shrink */
    uint64_t resident_bytes;  /**< of the whole process, now; 0 where it cannot be told */
    uint64_t trims;           /**< times that pages were taken away */
} sph_io_spill_figures;

/** @brief Fills `options` with the defaults. Call as `sph_io_spill_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_io_spill_options_init(sph_io_spill_options *options, size_t size);

/**
 * @brief Makes the temporary file and starts to watch the process.
 * @param[in]  context  gives the memory for small blocks, runs loops, and takes messages, also those of blocks that could not be made;
 *                      must outlive the spill, and must not itself use it.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID      NULL, a limit below #SPH_IO_SPILL_LEAST, or bad options.
 * @retval SPH_E_VERSION      options that only a newer library knows are set.
 * @retval SPH_E_IO           no file can be made in the folder; the message has its name and the system's reason.
 * @retval SPH_E_NOMEM        out of memory or of addresses.
 * @retval SPH_E_UNSUPPORTED  the system does not tell how much is resident (no /proc/self/statm).
 * @par Thread safety  Any number of threads, with distinct contexts.
 * @since 0.1
 */
SPH_API sph_status sph_io_spill_create(sph_context *context, const sph_io_spill_options *options, sph_io_spill **out);

/**
 * @brief Ends the thread and removes the file. Everything made with the allocator must be gone, contexts too. NULL is fine.
 * @since 0.1
 */
SPH_API void sph_io_spill_destroy(sph_io_spill *spill);

/**
 * @brief The allocator for sph_context_options, borrowing `spill`. When the file cannot grow, allocations fail, calls end with
 *        #SPH_E_NOMEM, and the message of the spill's own context (on the thread concerned) has the system's reason.
 * @since 0.1
 */
SPH_API void sph_io_spill_get_allocator(sph_io_spill *spill, sph_allocator *allocator);

/**
 * @brief An executor that runs loops on that of the spill's own context and looks at memory after each block; for the same
 *        options. Without it a loop that fills much memory at once can go further beyond the limit.
 * @since 0.1
 */
SPH_API void sph_io_spill_get_executor(sph_io_spill *spill, sph_executor *executor);

/**
 * @brief Looks at the resident set now and takes pages away where it is near the limit; for callers with a good moment, such
 *        as a progress callback. The spill does so by itself.
 * @par Thread safety  Any number of threads, also while blocks are used.
 * @since 0.1
 */
SPH_API void sph_io_spill_trim(sph_io_spill *spill);

/**
 * @brief What the spill has done so far.
 * @retval SPH_E_INVALID  NULL, or struct_size is not set.
 * @since 0.1
 */
SPH_API sph_status sph_io_spill_get_figures(sph_io_spill *spill, sph_io_spill_figures *figures);

SPH_END_DECLS

#endif
