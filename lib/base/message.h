/* SPDX-License-Identifier: MIT */
/* The last message of each thread that failed with a context. */
#ifndef SPH_MESSAGE_H
#define SPH_MESSAGE_H

#include <pthread.h>

#include "base/base.h"

enum { SPH__MESSAGE_SIZE = 512, SPH__MESSAGE_SLOTS = 8 };

typedef struct sph__message_slot {
    pthread_t thread;
    uint64_t thread_number; /* tells a thread from a dead one whose pthread_t it got */
    uint64_t stamp;
    struct sph__message_slot *next;
    char text[SPH__MESSAGE_SIZE];
} sph__message_slot;

typedef struct sph__messages {
    pthread_mutex_t mutex; /* guards everything but the texts, which belong to their threads */
    uint64_t clock;
    uint32_t own_used;
    sph__message_slot *more; /* for threads beyond the first ones: never moved while the context lives */
    sph__message_slot own[SPH__MESSAGE_SLOTS]; /* so that being out of memory can be said when it is */
} sph__messages;

bool sph__messages_init(sph__messages *messages);
void sph__messages_destroy(sph__messages *messages, const sph_allocator *allocator);
/* Stores `text` for the calling thread. Is lost when there is no slot left and no memory for one. */
void sph__messages_store(sph__messages *messages, const sph_allocator *allocator, const char *text);
/* The calling thread's text and its stamp; "" and 0 where there is none. */
const char *sph__messages_read(sph__messages *messages, uint64_t *stamp);
/* Formats at most SPH__MESSAGE_SIZE - 1 bytes, not cutting a UTF-8 sequence in two. */
void sph__format_message(char text[SPH__MESSAGE_SIZE], const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));

#endif
