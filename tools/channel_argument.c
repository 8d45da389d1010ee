#include "channel_argument.h"

#include <string.h>

#include <sonject/sonject.h>

#include "message.h"
#include "number.h"

bool channel_parse(const char *verb, const char *text, int32_t *channel)
{
    double number = 0.0;
    if (strcmp(text, "port") == 0) {
        *channel = SONJECT_CHANNEL_PORT;
    } else if (strcmp(text, "starboard") == 0) {
        *channel = SONJECT_CHANNEL_STARBOARD;
    } else if (number_parse(text, &number) && number >= 0.0 && number < 64.0 &&
               number == (double)(int32_t)number) {
        *channel = (int32_t)number;
    } else {
        message(verb, ": --channel takes port, starboard or a channel's number, not \"", text,
                "\"");
        return false;
    }
    return true;
}
