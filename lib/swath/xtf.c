/* Sidescan channels of XTF files (eXtended Triton Format, X41). Numbers are little-endian, at the
 * offsets of Triton's published format description. A power of two scales each ping's samples
 * (recording_set_scales). Refused: a file that is cut short or damaged,
 * no sidescan channel, no channel as chosen or several (the message lists them), samples of other
 * sizes than 1 or 2 bytes, pings of the channel with different numbers of samples or range cells
 * (the message says where). */
#include "base/file.h"
#include "swath/swath_format.h"

#define FILE_MARK           0x7B
#define PACKET_MARK         0xFACE
#define HEADER_BLOCK        1024
#define CHANNELS_PLACE      256
#define CHANNEL_BYTES       128
#define PACKET_BYTES        256 /* a ping's header */
#define CHANNEL_HEAD_BYTES  64
#define PACKET_KIND_SONAR   0
#define CORRECTED_TO_GROUND 2 /* a channel's correction flags; 1: slant range */
#define UNITS_GEOGRAPHIC    3

struct xtf_channel {
    uint32_t kind; /* enum recorded_side or another kind */
    uint32_t sample_bytes;
    bool is_signed;
    bool is_ground_range;
};

/* A file that is being opened. */
struct opening {
    struct report *report;
    struct swath_file *file;
    struct xtf_channel channels[CHANNEL_NUMBER_MAX + 1];
    uint32_t channel_count;
};

static bool is_xtf(struct swath_file *file, const unsigned char *head, size_t count)
{
    (void)file;
    return count >= 2 && head[0] == FILE_MARK && head[1] > 0;
}

static float float_at(const unsigned char *bytes, size_t place)
{
    return (float)finite_at(bytes, place, 4);
}

static double double_at(const unsigned char *bytes, size_t place)
{
    return finite_at(bytes, place, 8);
}

static sonject_status damaged(const struct opening *opening, uint64_t place, const char *what)
{
    return recording_damaged(opening->report, opening->file, place, what);
}

static bool is_sidescan(const struct xtf_channel *channel)
{
    return channel->kind == RECORDED_PORT || channel->kind == RECORDED_STARBOARD;
}

/* Reads the header and the channels' descriptions. *first_packet gets the first packet's offset. */
static sonject_status read_header(struct opening *opening, uint64_t *first_packet)
{
    FILE *stream = opening->file->stream;
    unsigned char head[CHANNELS_PLACE];
    unsigned char info[CHANNEL_BYTES];
    if (!byte_file_read(stream, 0, head, sizeof head))
        return damaged(opening, 0, "its header is cut short");
    opening->file->recording.is_geographic = word_at(head, 164, 2) == UNITS_GEOGRAPHIC;
    opening->channel_count = word_at(head, 166, 2);
    const uint32_t described = opening->channel_count + word_at(head, 168, 2);
    if (opening->channel_count > CHANNEL_NUMBER_MAX + 1 || described > 4 * (CHANNEL_NUMBER_MAX + 1))
        return damaged(opening, 166, "more channels than such files have");
    for (uint32_t i = 0; i < opening->channel_count; i++) {
        if (!byte_file_read(stream, CHANNELS_PLACE + (uint64_t)i * CHANNEL_BYTES, info,
                            sizeof info))
            return damaged(opening, CHANNELS_PLACE, "its channels are cut short");
        opening->channels[i].kind = info[0];
        opening->channels[i].is_ground_range = word_at(info, 2, 2) == CORRECTED_TO_GROUND;
        opening->channels[i].is_signed = word_at(info, 4, 2) == 0;
        opening->channels[i].sample_bytes = word_at(info, 6, 2);
    }
    *first_packet =
        ((uint64_t)CHANNELS_PLACE + (uint64_t)described * CHANNEL_BYTES + HEADER_BLOCK - 1) /
        HEADER_BLOCK * HEADER_BLOCK;
    return SONJECT_OK;
}

static sonject_status choose_channel(struct opening *opening, int32_t wanted)
{
    struct channel_list list = {.wanted = wanted};
    for (uint32_t i = 0; i < opening->channel_count; i++)
        if (is_sidescan(&opening->channels[i]))
            channel_list_add(&list, i, opening->channels[i].kind, NULL);
    CHECK(channel_list_check(opening->report, opening->file->path, &list));
    opening->file->recording.channel = list.found;
    opening->file->recording.side = opening->channels[list.found].kind;
    opening->file->recording.is_ground_range = opening->channels[list.found].is_ground_range;
    return SONJECT_OK;
}

static sonject_status set_samples(struct opening *opening)
{
    struct swath_file *file = opening->file;
    const struct xtf_channel *channel = &opening->channels[file->recording.channel];
    if (channel->sample_bytes != 1 && channel->sample_bytes != 2)
        return input_failure(opening->report, file->path,
                             "channel %u has samples of %u bytes; sonject reads 1 and 2",
                             file->recording.channel, channel->sample_bytes);
    file->layout.type = channel->sample_bytes == 1 ? PIXEL_UINT8 : PIXEL_UINT16;
    file->layout.channels = 1;
    file->lines.type = channel->sample_bytes == 1 ? STORED_UINT8
                       : channel->is_signed       ? STORED_INT16
                                                  : STORED_UINT16;
    file->largest = file->lines.type == STORED_INT16 ? INT16_MAX : 0;
    /* port's samples are stored as displayed, from far to near */
    file->lines.is_reversed = file->recording.side == RECORDED_PORT;
    return SONJECT_OK;
}

static sonject_status add_ping(struct opening *opening, const unsigned char *packet,
                               const unsigned char *channel, uint64_t place, uint64_t samples)
{
    struct swath_file *file = opening->file;
    const double sensor_x = double_at(packet, 168);
    const double sensor_y = double_at(packet, 160);
    const bool has_sensor = sensor_x != 0.0 || sensor_y != 0.0;
    struct recorded_ping ping = {0};
    ping.easting = has_sensor ? sensor_x : double_at(packet, 136);
    ping.northing = has_sensor ? sensor_y : double_at(packet, 128);
    ping.altitude_m = float_at(packet, 196);
    ping.heading_deg = float_at(packet, 212);
    if (ping.heading_deg == 0.0f)
        ping.heading_deg = float_at(packet, 124);
    ping.slant_range_m = float_at(channel, 4);
    ping.delay_s = float_at(channel, 12);
    ping.duration_s = float_at(channel, 16);
    ping.weight = (int16_t)word_at(channel, 58, 2);
    return recording_add(opening->report, file, &ping, place, samples);
}

/* Adds the chosen channel's ping of a packet, which may lack that channel. */
static sonject_status read_packet(struct opening *opening, const unsigned char *packet,
                                  uint64_t start, uint64_t end)
{
    struct swath_file *file = opening->file;
    const uint32_t channels = word_at(packet, 4, 2);
    unsigned char head[CHANNEL_HEAD_BYTES];
    uint64_t place = start + PACKET_BYTES;
    for (uint32_t i = 0; i < channels; i++) {
        if (end - place < sizeof head || !byte_file_read(file->stream, place, head, sizeof head))
            return damaged(opening, place, "a channel is cut short");
        const uint32_t number = word_at(head, 0, 2);
        const uint64_t samples = word_at(head, 42, 4);
        place += sizeof head;
        if (number >= opening->channel_count)
            return damaged(opening, place - sizeof head, "a channel that the header lacks");
        const uint64_t bytes = samples * opening->channels[number].sample_bytes;
        if (bytes > end - place)
            return damaged(opening, place, "more samples than the ping holds");
        if (number == file->recording.channel)
            return add_ping(opening, packet, head, place, samples);
        place += bytes;
    }
    return SONJECT_OK;
}

static sonject_status read_packets(struct opening *opening, uint64_t place)
{
    struct swath_file *file = opening->file;
    unsigned char packet[PACKET_BYTES];
    while (place < file->bytes) {
        const uint64_t left = file->bytes - place;
        if (left < 14 || !byte_file_read(file->stream, place, packet, 14))
            return damaged(opening, place, "the last packet is cut short");
        const uint64_t bytes = word_at(packet, 10, 4);
        if (word_at(packet, 0, 2) != PACKET_MARK || bytes < 14)
            return damaged(opening, place, "no packet where one should be");
        if (bytes > left)
            return damaged(opening, place, "the last packet is cut short");
        if (packet[2] == PACKET_KIND_SONAR) {
            if (bytes < PACKET_BYTES || !byte_file_read(file->stream, place, packet, PACKET_BYTES))
                return damaged(opening, place, "a ping is cut short");
            CHECK(read_packet(opening, packet, place, place + bytes));
        }
        place += bytes;
    }
    return file->layout.rows > 0 ? SONJECT_OK
                                 : input_failure(opening->report, file->path, "has no pings");
}

static sonject_status open_xtf(struct report *report, struct swath_file *file, int32_t channel,
                               const char *array)
{
    struct opening opening = {.report = report, .file = file};
    uint64_t first_packet = 0;
    (void)array;
    CHECK(read_header(&opening, &first_packet));
    CHECK(choose_channel(&opening, channel));
    CHECK(set_samples(&opening));
    CHECK(read_packets(&opening, first_packet));
    return recording_set_scales(report, file);
}

const struct swath_format xtf_format = {
    true, false, is_xtf, open_xtf, sample_lines_read, sample_lines_copy};
