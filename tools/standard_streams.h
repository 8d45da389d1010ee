/* Standard streams that the caller closed. */
#ifndef SONJECT_TOOLS_STANDARD_STREAMS_H
#define SONJECT_TOOLS_STANDARD_STREAMS_H

/* Opens the missing ones of descriptors 0, 1 and 2, so that no image file gets such a number and
 * messages end up in it. What is written to an output that was closed still fails. */
void standard_streams_secure(void);

#endif
