/* The status that every call of the library returns. */
#ifndef SONJECT_STATUS_H
#define SONJECT_STATUS_H

#include <sonject/export.h>

SONJECT_BEGIN_DECLARATIONS

/* The outcome of a call. Values are stable: new ones are added at the end. After a failure the
 * context holds the message (sonject_context_message). */
typedef enum sonject_status {
    SONJECT_OK = 0,
    SONJECT_ERROR_ARGUMENT = 1, /* the call breaks its contract (null, wrong size, out of range) */
    SONJECT_ERROR_INPUT = 2,    /* a scene or an image cannot be used as it is */
    SONJECT_ERROR_DEVICE = 3,   /* no such device, or the device failed */
    SONJECT_ERROR_STORAGE = 4,  /* reading or writing a file failed */
    SONJECT_ERROR_MEMORY = 5,   /* out of host memory */
    SONJECT_ERROR_UNSUPPORTED = 6, /* this build of the library lacks the feature */
    SONJECT_CANCELLED = 7          /* the progress callback asked to stop; nothing was published */
} sonject_status;

/* Returns a short English name of the status, such as "bad input". Never NULL; static storage. */
SONJECT_API const char *sonject_status_name(sonject_status status);

SONJECT_END_DECLARATIONS

#endif
