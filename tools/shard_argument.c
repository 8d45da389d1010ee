#include "shard_argument.h"

#include <string.h>

#include "message.h"
#include "number.h"

static bool parse(const char *text, uint64_t *part, uint64_t *whole)
{
    char first[16];
    const char *slash = strchr(text, '/');
    if (!slash || (size_t)(slash - text) >= sizeof first)
        return false;
    memcpy(first, text, (size_t)(slash - text));
    first[slash - text] = '\0';
    return whole_number_parse(first, part) && whole_number_parse(slash + 1, whole) && *part >= 1 &&
           *part <= *whole && *whole <= UINT32_MAX;
}

bool shard_parse(const char *verb, const char *text, uint32_t *index, uint32_t *count)
{
    uint64_t part, whole;
    if (!text)
        return true;
    if (!parse(text, &part, &whole)) {
        message(verb, ": --shard takes I/K, whole numbers with I from 1 to K, not \"", text, "\"");
        return false;
    }
    *index = (uint32_t)part;
    *count = (uint32_t)whole;
    return true;
}
