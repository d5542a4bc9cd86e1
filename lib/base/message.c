/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <unistd.h>
#if defined(__linux__)
#include <sys/syscall.h>
#endif

#include "base/message.h"

bool sph__messages_init(sph__messages *messages)
{
    return pthread_mutex_init(&messages->mutex, NULL) == 0;
}

void sph__messages_destroy(sph__messages *messages, const sph_allocator *allocator)
{
    while (messages->more != NULL) {
        sph__message_slot *slot = messages->more;
        messages->more = slot->next;
        allocator->release(allocator->user, slot, sizeof *slot);
    }
    pthread_mutex_destroy(&messages->mutex);
}

/* A number that a new thread does not inherit from a dead one along with its pthread_t; 0 where the system has none. */
static uint64_t thread_number(void)
{
#if defined(__linux__)
    return (uint64_t)syscall(SYS_gettid);
#else
    return 0;
#endif
}

/* The slot of this pthread_t: two threads that live never share one. Call with the mutex held. */
static sph__message_slot *find_slot(sph__messages *messages)
{
    const pthread_t self = pthread_self();
    for (uint32_t i = 0; i < messages->own_used; ++i)
        if (pthread_equal(messages->own[i].thread, self)) return &messages->own[i];
    for (sph__message_slot *slot = messages->more; slot != NULL; slot = slot->next)
        if (pthread_equal(slot->thread, self)) return slot;
    return NULL;
}

static sph__message_slot *take_own_slot(sph__messages *messages)
{
    return messages->own_used < SPH__MESSAGE_SLOTS ? &messages->own[messages->own_used++] : NULL;
}

static void fill_slot(sph__messages *messages, sph__message_slot *slot, const char *text)
{
    slot->thread = pthread_self();
    slot->thread_number = thread_number();
    slot->stamp = ++messages->clock;
    memcpy(slot->text, text, SPH__MESSAGE_SIZE);
}

void sph__messages_store(sph__messages *messages, const sph_allocator *allocator, const char *text)
{
    sph__message_slot *slot;
    pthread_mutex_lock(&messages->mutex);
    slot = find_slot(messages);
    if (slot == NULL) slot = take_own_slot(messages);
    if (slot != NULL) fill_slot(messages, slot, text);
    pthread_mutex_unlock(&messages->mutex);
    if (slot != NULL) return;
    slot = allocator->allocate(allocator->user, sizeof *slot, SPH__ALIGN); /* the host's code: not under the mutex */
    if (slot == NULL) return;
    pthread_mutex_lock(&messages->mutex);
    fill_slot(messages, slot, text);
    slot->next = messages->more;
    messages->more = slot;
    pthread_mutex_unlock(&messages->mutex);
}

const char *sph__messages_read(sph__messages *messages, uint64_t *stamp)
{
    const uint64_t number = thread_number();
    const sph__message_slot *slot;
    const char *text = "";
    *stamp = 0;
    pthread_mutex_lock(&messages->mutex);
    slot = find_slot(messages);
    if (slot != NULL && slot->thread_number == number) {
        text = slot->text;
        *stamp = slot->stamp;
    }
    pthread_mutex_unlock(&messages->mutex);
    return text;
}

void sph__format_message(char text[SPH__MESSAGE_SIZE], const char *format, va_list arguments)
{
    const int length = vsnprintf(text, SPH__MESSAGE_SIZE, format, arguments);
    size_t end = SPH__MESSAGE_SIZE - 1, lead = end;
    if (length < 0) text[0] = 0;
    if (length < SPH__MESSAGE_SIZE) return;
    while (lead > 0 && end - lead < 4 && ((unsigned char)text[lead - 1] & 0xc0) == 0x80)
        --lead;
    if (lead > 0 && (unsigned char)text[lead - 1] >= 0xc0) { /* the last sequence: whole or cut? */
        const unsigned char first = (unsigned char)text[lead - 1];
        const size_t whole = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
        if (end - (lead - 1) < whole) end = lead - 1;
    }
    text[end] = 0;
}
