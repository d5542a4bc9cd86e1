/* SPDX-License-Identifier: MIT */
/* The program's command lines: arguments are the parts between zero bytes. */
#include <stdarg.h>

#include "fuzz.h"
#include "options.h"
#include "program.h"

enum { ARGUMENT_LIMIT = 32 };

/* In place of the program's, which prints: the text is made and measured. */
int usage_error(const char *command, const char *format, ...)
{
    char text[512];
    va_list list;
    va_start(list, format);
    FUZZ_CHECK(command != NULL && vsnprintf(text, sizeof text, format, list) > 0);
    va_end(list);
    return USAGE;
}

int failure(const char *format, ...)
{
    FUZZ_CHECK(format != NULL);
    return FAILED;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const choices[] = {"first", "second", NULL};
    bool flag = false;
    const char *text = NULL;
    uint32_t count = 7;
    double number = 0.5;
    int choice = 0;
    frame_range frames = {false, 0, 0, 0};
    common_options common = {0};
    const option table[] = {{"flag", 'f', OPTION_FLAG, &flag, 0, 0, NULL},
                            {"output", 'o', OPTION_TEXT, &text, 0, 0, NULL},
                            {"spheres", 'k', OPTION_COUNT, &count, 3, 1000, NULL},
                            {"scale", 0, OPTION_NUMBER, &number, -2, 2, NULL},
                            {"mode", 0, OPTION_CHOICE, &choice, 0, 0, choices},
                            {"frames", 0, OPTION_FRAMES, &frames, 0, 0, NULL},
                            COMMON_OPTIONS(common)};
    char *copy = malloc(size + 1);
    char *arguments_in[ARGUMENT_LIMIT + 1] = {(char *)"sphmesh"};
    int argc = 1, status;
    arguments rest = {0};
    FUZZ_CHECK(copy != NULL);
    if (size > 0) memcpy(copy, data, size);
    copy[size] = '\0';
    for (char *at = copy; at <= copy + size && argc < ARGUMENT_LIMIT; at += strlen(at) + 1) arguments_in[argc++] = at;
    status = options_parse("fuzz", table, argc, arguments_in, &rest);
    FUZZ_CHECK(status == DONE || status == USAGE);
    if (status == DONE) {
        FUZZ_CHECK(count == 7 || (count >= 3 && count <= 1000));
        FUZZ_CHECK(number >= -2 && number <= 2);
        FUZZ_CHECK(choice == 0 || choice == 1);
        FUZZ_CHECK(!frames.given || (frames.step > 0 && (frames.end == 0 || frames.end > frames.first)));
        FUZZ_CHECK(rest.count < ARGUMENT_LIMIT);
        for (size_t i = 0; i < rest.count; ++i) FUZZ_CHECK(rest.items[i] >= copy && rest.items[i] <= copy + size);
    }
    free(rest.items);
    free(copy);
    return 0;
}
