/* The program sonject-decoder. It answers the library's requests over a channel, its standard
 * input, until the channel ends. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "swath/decoder.h"

#ifdef IS_SANITIZED /* sanitizers reserve terabytes of addresses */
#define MEMORY_BYTES 0
#else
#define MEMORY_BYTES DECODER_MEMORY_BYTES
#endif

static bool serve(const struct channel *channel, struct decoder_state *state)
{
    struct report report = {.host = NULL};
    struct decoder_request request;
    struct decoder_reply reply;
    void *out = NULL;
    if (!decoder_receive(&report, channel, &request, sizeof request))
        return false;
    child_limit_time(DECODER_CPU_S); /* each request has its own limit */
    memset(&reply, 0, sizeof reply);
    char *in = malloc((size_t)request.bytes + 1);
    bool goes_on = in && decoder_receive(&report, channel, in, (size_t)request.bytes);
    if (goes_on) {
        reply.status = (int32_t)decoder_answer(&report, state, &request, in, &reply, &out);
        if (reply.status != SONJECT_OK)
            reply.bytes = strlen(report.message);
        goes_on = channel_send(channel, &reply, sizeof reply) &&
                  channel_send(channel, out ? out : report.message, (size_t)reply.bytes);
    }
    free(out);
    free(in);
    return goes_on;
}

int main(int count, char **arguments)
{
    char stamp[64];
    struct channel channel = {0};
    decoder_stamp(stamp);
    if (count != 2 || strcmp(arguments[1], stamp) != 0) {
        fputs("sonject-decoder: is started by the library sonject, of its own version\n", stderr);
        return DECODER_STRANGER;
    }
    struct decoder_state *state = child_begin(&channel, MEMORY_BYTES) ? decoder_state_make() : NULL;
    if (!state)
        return 1;
    while (serve(&channel, state))
        continue;
    child_exit();
}
