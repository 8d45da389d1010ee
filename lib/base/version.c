#include <sonject/version.h>

#define TEXT_OF_(token) #token
#define TEXT_OF(token)  TEXT_OF_(token)

const char *sonject_version(void)
{
    return TEXT_OF(SONJECT_VERSION_MAJOR) "." TEXT_OF(SONJECT_VERSION_MINOR) "." TEXT_OF(
        SONJECT_VERSION_PATCH);
}
