/* Functions for all formats of recordings: the choice of a channel, and pings that become rows. */
#include "swath/recording.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/byte_order.h"
#include "base/file.h"
#include "swath/swath_format.h"

#define SAMPLES_MAX   (UINT32_C(1) << 24)
#define WEIGHTS_MAX   64 /* largest difference between pings' weights */
#define WHOLE_WEIGHTS 16 /* largest difference at which 16 bit numbers fit 32 bits */

void channel_list_add(struct channel_list *list, uint32_t number, uint32_t side, const char *of)
{
    const size_t length = strlen(list->text);
    snprintf(list->text + length, sizeof list->text - length, "%s%u (%s%s%s)",
             length > 0 ? ", " : "", number, side == RECORDED_PORT ? "port" : "starboard",
             of ? ", " : "", of ? of : "");
    if ((list->wanted == SONJECT_CHANNEL_PORT && side != RECORDED_PORT) ||
        (list->wanted == SONJECT_CHANNEL_STARBOARD && side != RECORDED_STARBOARD) ||
        (list->wanted >= 0 && (uint32_t)list->wanted != number))
        return;
    list->matches++;
    list->found = number;
}

sonject_status channel_list_check(struct report *report, const char *path,
                                  const struct channel_list *list)
{
    if (*list->text == '\0')
        return input_failure(report, path, "has no sidescan channel");
    if (list->matches != 1)
        return input_failure(
            report, path,
            "has %s such sidescan channel: choose one by input.channel or --channel, "
            "%s",
            list->matches == 0 ? "no" : "more than one", list->text);
    return SONJECT_OK;
}

uint32_t word_at(const unsigned char *bytes, size_t place, size_t size)
{
    return (uint32_t)number_from_bytes(bytes + place, size, false);
}

double finite_at(const unsigned char *bytes, size_t place, size_t size)
{
    const double number = float_from_bytes(bytes + place, size, false);
    return isfinite(number) ? number : 0.0;
}

sonject_status recording_damaged(struct report *report, const struct swath_file *file,
                                 uint64_t place, const char *what)
{
    return input_failure(report, file->path, "damaged at byte %llu: %s: copy or export it again",
                         (unsigned long long)place, what);
}

double recorded_near_edge_m(const struct recorded_ping *ping)
{
    const double duration = (double)ping->duration_s;
    const double delay = (double)ping->delay_s;
    /* the far edge's range includes the delay */
    const double share = duration > 0.0 && delay > 0.0 ? delay / (delay + duration) : 0.0;
    return (double)ping->slant_range_m * share;
}

/* Checks that a ping has the range cells of the first row, within one of them. */
static sonject_status check_same(struct report *report, const struct swath_file *file,
                                 const struct recorded_ping *ping, uint64_t samples)
{
    const struct raster_layout *layout = &file->layout;
    const struct recorded_ping *first = layout->rows > 0 ? file->recording.pings : ping;
    const double near_edge = recorded_near_edge_m(first);
    const double far_edge = (double)first->slant_range_m;
    const double cell = (far_edge - near_edge) / (double)samples;
    if (layout->rows == 0 ||
        (samples == layout->columns && fabs(recorded_near_edge_m(ping) - near_edge) <= cell &&
         fabs((double)ping->slant_range_m - far_edge) <= cell))
        return SONJECT_OK;
    return input_failure(report, file->path,
                         "ping %llu has %llu samples from %.6g to %.6g m, the first ping %llu from "
                         "%.6g to %.6g m: cut the file there",
                         (unsigned long long)(layout->rows + file->recording.empty.count),
                         (unsigned long long)samples, recorded_near_edge_m(ping),
                         (double)ping->slant_range_m, (unsigned long long)layout->columns,
                         near_edge, far_edge);
}

sonject_status recording_add(struct report *report, struct swath_file *file,
                             const struct recorded_ping *ping, uint64_t place, uint64_t samples)
{
    struct recording *recording = &file->recording;
    struct raster_layout *layout = &file->layout;
    if (samples == 0) {
        struct ping_list *empty = &recording->empty;
        CHECK(grow_list(report, &empty->numbers, (size_t)empty->count, sizeof *empty->numbers,
                        "the pings"));
        empty->numbers[empty->count] = layout->rows + empty->count;
        empty->count++;
        return SONJECT_OK;
    }
    if (samples > SAMPLES_MAX || !(ping->slant_range_m > 0.0f))
        return recording_damaged(report, file, place, "a ping without slant range");
    CHECK(check_same(report, file, ping, samples));
    const size_t rows = (size_t)layout->rows;
    CHECK(grow_list(report, &recording->pings, rows, sizeof *recording->pings, "the pings"));
    CHECK(grow_list(report, &file->lines.places, rows, sizeof *file->lines.places, "the pings"));
    recording->pings[layout->rows] = *ping;
    file->lines.places[layout->rows++] = place;
    recording->rows = layout->rows;
    recording->columns = layout->columns = samples;
    return SONJECT_OK;
}

sonject_status recording_set_scales(struct report *report, struct swath_file *file)
{
    const struct recorded_ping *pings = file->recording.pings;
    const double full_scale = swath_file_full_scale(file);
    int32_t least = pings[0].weight;
    int32_t most = least;
    for (uint64_t i = 1; i < file->layout.rows; i++) {
        least = pings[i].weight < least ? pings[i].weight : least;
        most = pings[i].weight > most ? pings[i].weight : most;
    }
    if (most == least)
        return SONJECT_OK;
    if (most - least > WEIGHTS_MAX)
        return input_failure(report, file->path,
                             "weighs its pings from 2^%d to 2^%d, which no recorder does: cut the "
                             "file",
                             -most, -least);
    file->layout.type = PIXEL_FLOAT32;
    file->lines.clips = true;
    file->largest = file->layout.channels == 1 && most - least <= WHOLE_WEIGHTS
                        ? (uint32_t)full_scale << (most - least)
                        : 0;
    file->lines.scales = allocate_array((size_t)file->layout.rows, sizeof *file->lines.scales);
    CHECK_MEMORY(report, file->lines.scales, "the pings");
    for (uint64_t i = 0; i < file->layout.rows; i++)
        file->lines.scales[i] = ldexp(1.0, most - pings[i].weight);
    return SONJECT_OK;
}
