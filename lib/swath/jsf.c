/* Sidescan channels of EdgeTech's JSF files. A file is a sequence of messages. Each message of type
 * 80 holds a ping of one channel of one subsystem. Numbers are little-endian, at the offsets of
 * EdgeTech's published description (0004824, rev. 1.20). Channels are numbered from 0 in the order
 * of subsystem and channel; subsystem 0 is a sub-bottom profiler. Samples have 16 bits: envelopes,
 * or pairs for analytic signals. A power of two scales each ping (recording_set_scales). Ranges use
 * the first ping's sound speed. Writing clips numbers beyond 16 bits, and refuses what is not a
 * number.
 *
 * Refused: a file that is cut short or damaged, no sidescan channel, no channel as chosen or
 * several (the message lists them), other kinds of samples, compressed ones, pings in several
 * packets, pings with different cells. */
#include <stdio.h>

#include "base/file.h"
#include "swath/swath_format.h"

#define MARK            0x1601
#define MESSAGE_BYTES   16  /* a message's header */
#define PING_BYTES      240 /* a ping's header, before its samples */
#define TYPE_PING       80
#define KIND_ENVELOPE   0
#define KIND_ANALYTIC   1
#define KIND_COMPRESSED 256 /* this and all above */
#define HAS_POSITION    (1u << 0)
#define HAS_HEADING     (1u << 3)
#define HAS_ALTITUDE    (1u << 6)
#define UNITS_MM        1
#define UNITS_ARC       2 /* 1e-4 minutes of arc */
#define UNITS_DM        3
#define USUAL_SPEED     1500.0 /* m/s, if the file has none between 1300 and 1700 */

/* A channel of a subsystem. Order: by subsystem, then by channel. */
struct source {
    uint32_t subsystem, channel;
};

struct message {
    uint64_t place, bytes; /* the body, after the header */
    struct source source;
    bool is_ping; /* a ping of a sidescan */
};

struct opening {
    struct report *report;
    struct swath_file *file;
    struct source sources[CHANNEL_NUMBER_MAX + 1]; /* sorted */
    uint32_t source_count;
    double speed_mps; /* 0 before the first ping */
    uint32_t kind;    /* the first ping's kind of samples */
    bool has_units;   /* a ping has had a position, which sets all units */
};

static bool is_jsf(struct swath_file *file, const unsigned char *head, size_t count)
{
    (void)file;
    return count == MESSAGE_BYTES && word_at(head, 0, 2) == MARK;
}

static int32_t signed_at(const unsigned char *bytes, size_t place, size_t size)
{
    const uint32_t word = word_at(bytes, place, size);
    return size == 2 ? (int16_t)word : (int32_t)word;
}

static sonject_status damaged(const struct opening *opening, uint64_t place, const char *what)
{
    return recording_damaged(opening->report, opening->file, place, what);
}

static sonject_status read_message(const struct opening *opening, uint64_t place,
                                   struct message *message)
{
    const struct swath_file *file = opening->file;
    const uint64_t left = file->bytes - place;
    unsigned char head[MESSAGE_BYTES];
    if (left < sizeof head || !byte_file_read(file->stream, place, head, sizeof head))
        return damaged(opening, place, "the last message is cut short");
    if (word_at(head, 0, 2) != MARK)
        return damaged(opening, place, "no message where one should be");
    message->place = place + sizeof head;
    message->bytes = word_at(head, 12, 4);
    if (message->bytes > left - sizeof head)
        return damaged(opening, place, "the last message is cut short");
    message->source = (struct source){head[7], head[8]};
    message->is_ping = word_at(head, 4, 2) == TYPE_PING && head[7] > 0 && head[8] < 2;
    return SONJECT_OK;
}

/* Returns whether a comes after b. */
static bool is_after(const struct source *a, const struct source *b)
{
    return a->subsystem > b->subsystem || (a->subsystem == b->subsystem && a->channel > b->channel);
}

static void add_source(struct opening *opening, const struct source *source)
{
    uint32_t place = 0;
    while (place < opening->source_count && is_after(source, &opening->sources[place]))
        place++;
    if (opening->source_count > CHANNEL_NUMBER_MAX ||
        (place < opening->source_count && !is_after(&opening->sources[place], source)))
        return;
    for (uint32_t i = opening->source_count++; i > place; i--)
        opening->sources[i] = opening->sources[i - 1];
    opening->sources[place] = *source;
}

static sonject_status choose_source(struct opening *opening, int32_t wanted, struct source *chosen)
{
    struct swath_file *file = opening->file;
    struct channel_list list = {.wanted = wanted};
    struct message message;
    for (uint64_t place = 0; place < file->bytes; place = message.place + message.bytes) {
        CHECK(read_message(opening, place, &message));
        if (message.is_ping)
            add_source(opening, &message.source);
    }
    for (uint32_t i = 0; i < opening->source_count; i++) {
        char of[32];
        snprintf(of, sizeof of, "subsystem %u", opening->sources[i].subsystem);
        channel_list_add(&list, i,
                         opening->sources[i].channel == 0 ? RECORDED_PORT : RECORDED_STARBOARD, of);
    }
    CHECK(channel_list_check(opening->report, file->path, &list));
    *chosen = opening->sources[list.found];
    file->recording.channel = list.found;
    file->recording.side = chosen->channel == 0 ? RECORDED_PORT : RECORDED_STARBOARD;
    return SONJECT_OK;
}

static sonject_status check_kind(struct opening *opening, const unsigned char *head)
{
    const struct swath_file *file = opening->file;
    const uint64_t rows = file->layout.rows;
    const uint64_t number = rows + file->recording.empty.count;
    const uint32_t kind = word_at(head, 34, 2);
    if (kind >= KIND_COMPRESSED)
        return input_failure(opening->report, file->path,
                             "holds compressed samples: decompress it with EdgeTech's software");
    if (kind != KIND_ENVELOPE && kind != KIND_ANALYTIC)
        return input_failure(opening->report, file->path,
                             "channel %u has samples of kind %u; sonject reads envelopes (0) and "
                             "analytic signals (1)",
                             file->recording.channel, kind);
    if (word_at(head, 220, 2) > 1)
        return input_failure(opening->report, file->path,
                             "ping %llu is in several packets, which sonject does not join",
                             (unsigned long long)number);
    if (rows > 0 && kind != opening->kind)
        return input_failure(opening->report, file->path,
                             "ping %llu has samples of kind %u, the pings before it of kind %u: "
                             "cut the file there",
                             (unsigned long long)number, kind, opening->kind);
    opening->kind = kind;
    return SONJECT_OK;
}

/* Reads a position. Skips angles if the first position was a length, and the reverse. */
static void read_position(struct opening *opening, const unsigned char *head,
                          struct recorded_ping *ping)
{
    struct recording *recording = &opening->file->recording;
    const uint32_t units = word_at(head, 88, 2);
    const double unit = units == UNITS_MM    ? 1e-3
                        : units == UNITS_ARC ? 1e-4 / 60.0
                        : units == UNITS_DM  ? 0.1
                                             : 0.0;
    const bool is_geographic = units == UNITS_ARC;
    if (!(word_at(head, 30, 2) & HAS_POSITION) || !(unit > 0.0) ||
        (opening->has_units && is_geographic != recording->is_geographic))
        return;
    opening->has_units = true;
    recording->is_geographic = is_geographic;
    ping->easting = unit * signed_at(head, 80, 4);
    ping->northing = unit * signed_at(head, 84, 4);
}

static sonject_status add_ping(struct opening *opening, const struct message *message)
{
    struct swath_file *file = opening->file;
    unsigned char head[PING_BYTES];
    if (message->bytes < sizeof head ||
        !byte_file_read(file->stream, message->place, head, sizeof head))
        return damaged(opening, message->place, "a ping is cut short");
    CHECK(check_kind(opening, head));
    const uint32_t valid = word_at(head, 30, 2);
    const uint64_t samples = word_at(head, 114, 2) | (word_at(head, 16, 2) >> 8 & 15) << 16;
    const double speed = finite_at(head, 148, 4);
    const double interval_s = 1e-9 * word_at(head, 116, 4);
    const double delay_s = interval_s * word_at(head, 4, 4);
    if (samples * (opening->kind == KIND_ANALYTIC ? 4 : 2) > message->bytes - sizeof head)
        return damaged(opening, message->place, "more samples than the ping holds");
    if (!(opening->speed_mps > 0.0))
        opening->speed_mps = speed > 1300.0 && speed < 1700.0 ? speed : USUAL_SPEED;
    struct recorded_ping ping = {
        .altitude_m = valid & HAS_ALTITUDE ? (float)(1e-3 * signed_at(head, 144, 4)) : 0.0f,
        .heading_deg = valid & HAS_HEADING ? (float)(0.01 * word_at(head, 172, 2)) : 0.0f,
        .delay_s = (float)delay_s,
        .duration_s = (float)(interval_s * (double)samples),
        .slant_range_m =
            (float)(0.5 * opening->speed_mps * (delay_s + interval_s * (double)samples)),
        .weight = signed_at(head, 168, 2)};
    read_position(opening, head, &ping);
    return recording_add(opening->report, file, &ping, message->place + sizeof head, samples);
}

/* Decides how samples are shown, once all pings are known. */
static sonject_status set_samples(const struct opening *opening)
{
    struct swath_file *file = opening->file;
    const bool is_analytic = opening->kind == KIND_ANALYTIC;
    file->layout.channels = is_analytic ? 2 : 1;
    file->layout.type = is_analytic ? PIXEL_FLOAT32 : PIXEL_UINT16;
    file->lines.type = is_analytic ? STORED_INT16 : STORED_UINT16;
    file->lines.clips = true;
    return recording_set_scales(opening->report, file);
}

static sonject_status open_jsf(struct report *report, struct swath_file *file, int32_t channel,
                               const char *array)
{
    struct opening opening = {.report = report, .file = file};
    struct source chosen;
    struct message message;
    (void)array;
    CHECK(choose_source(&opening, channel, &chosen));
    for (uint64_t place = 0; place < file->bytes; place = message.place + message.bytes) {
        CHECK(read_message(&opening, place, &message));
        if (message.is_ping && message.source.subsystem == chosen.subsystem &&
            message.source.channel == chosen.channel)
            CHECK(add_ping(&opening, &message));
    }
    return file->layout.rows > 0 ? set_samples(&opening)
                                 : input_failure(report, file->path, "has no pings");
}

const struct swath_format jsf_format = {
    true, false, is_jsf, open_jsf, sample_lines_read, sample_lines_copy};
