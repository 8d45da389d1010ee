#include "swath/decoder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

void decoder_stop(struct decoder *decoder)
{
    (void)child_stop(&decoder->child);
    decoder_state_release(&decoder->state);
}

static sonject_status start(struct report *report, struct decoder *decoder, const char *path)
{
    char stamp[64], reason[128];
    char *program = decoder_path();
    CHECK_MEMORY(report, program, "a path");
    decoder_stamp(stamp);
    const int error =
        child_start(&decoder->child, program, stamp, DECODER_MEMORY_BYTES, DECODER_SILENCE_S);
    sonject_status status = SONJECT_OK;
    error_text(error, reason, sizeof reason);
    if (error == 0)
        decoder->starts++;
    else if (error == ENOENT || error == EACCES || error == ENOEXEC)
        status = report_failure(
            report, SONJECT_ERROR_UNSUPPORTED,
            "%s: sonject reads it with %s, which cannot be used: %s: install sonject again", path,
            program, reason);
    else
        status = file_failure(report, program, "start", error);
    free(program);
    return status;
}

/* Ends a child that does not answer, and reports why. */
static sonject_status tell_end(struct report *report, struct decoder *decoder, const char *path)
{
    const bool is_late = errno == EAGAIN;
    const bool is_cancelled = errno == ECANCELED;
    const struct child_end end = child_stop(&decoder->child);
    if (is_cancelled)
        return report_failure(report, SONJECT_CANCELLED, "cancelled");
    if (end.has_exited && end.status == DECODER_STRANGER)
        return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                              "%s: the program " DECODER_PROGRAM
                              " is of another version of sonject: install sonject again",
                              path);
    if (is_late || end.is_out_of_time)
        return input_failure(report, path,
                             "reading it takes longer than a sound file would: copy it again");
    return input_failure(
        report, path, "is damaged: the program that reads it ended%s; copy it again", end.reason);
}

bool decoder_receive(const struct report *report, const struct channel *channel, void *bytes,
                     size_t count)
{
    char *rest = bytes;
    int waits = 0;
    while (count > 0) {
        errno = 0;
        const long got = channel_receive(channel, rest, count);
        const bool has_waited = got < 0 && errno == EAGAIN;
        if (has_waited || (got < 0 && errno == EINTR)) {
            waits += has_waited;
            if (report_is_cancelled(report, NULL))
                errno = ECANCELED;
            else if (waits < DECODER_SILENCE_S * CHILD_WAITS_PER_SECOND)
                continue;
            return false;
        }
        if (got <= 0)
            return false;
        waits = 0;
        rest += got;
        count -= (size_t)got;
    }
    return true;
}

static sonject_status ask_child(struct report *report, struct decoder *decoder, const char *path,
                                const struct decoder_request *request, const void *in,
                                struct decoder_reply *reply, void *out, size_t capacity)
{
    const struct channel *channel = &decoder->child.channel;
    char message[REPORT_CAPACITY] = "";
    if (!channel_send(channel, request, sizeof *request) ||
        !channel_send(channel, in, (size_t)request->bytes) ||
        !decoder_receive(report, channel, reply, sizeof *reply))
        return tell_end(report, decoder, path);
    const bool is_good = reply->status == SONJECT_OK;
    errno = 0;
    if (reply->bytes > (is_good ? capacity : sizeof message - 1) ||
        !decoder_receive(report, channel, is_good ? out : message, (size_t)reply->bytes))
        return tell_end(report, decoder, path);
    const bool is_known = is_good || reply->status == SONJECT_ERROR_STORAGE ||
                          reply->status == SONJECT_ERROR_MEMORY ||
                          reply->status == SONJECT_ERROR_UNSUPPORTED;
    const sonject_status status = is_known ? (sonject_status)reply->status : SONJECT_ERROR_INPUT;
    return is_good ? status : report_failure(report, status, "%s", message);
}

static sonject_status ask_here(struct report *report, struct decoder *decoder, const char *path,
                               const struct decoder_request *request, const void *in,
                               struct decoder_reply *reply, void *out, size_t capacity)
{
    void *made = NULL;
    if (!decoder->state)
        decoder->state = decoder_state_make();
    CHECK_MEMORY(report, decoder->state, path);
    const sonject_status status = decoder_answer(report, decoder->state, request, in, reply, &made);
    if (reply->bytes > capacity)
        reply->bytes = 0;
    if (reply->bytes > 0)
        memcpy(out, made, (size_t)reply->bytes);
    free(made);
    return status;
}

sonject_status decoder_start(struct report *report, struct decoder *decoder, const char *path)
{
    if (decoder->is_in_process)
        return SONJECT_OK;
    if (decoder->child.owner != process_number())
        (void)child_stop(&decoder->child);
    return decoder->child.number == 0 ? start(report, decoder, path) : SONJECT_OK;
}

sonject_status decoder_ask(struct report *report, struct decoder *decoder, const char *path,
                           const struct decoder_request *request, const void *in,
                           struct decoder_reply *reply, void *out, size_t capacity, size_t *count)
{
    memset(reply, 0, sizeof *reply);
    const sonject_status status = (decoder->is_in_process ? ask_here : ask_child)(
        report, decoder, path, request, in, reply, out, capacity);
    *count = status == SONJECT_OK ? (size_t)reply->bytes : 0;
    return status;
}
