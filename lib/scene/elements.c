/* The array of the element level: its defaults, and the ranges of its values. */
#include <math.h>
#include <string.h>

#include "base/ranges.h"
#include "scene/scene.h"

#define HALF_PI             1.57079632679489661923
#define HYDROPHONES_MAX     65536
#define PINGS_MAX           (UINT32_C(1) << 24)
#define TIME_MAX_S          3600.0
#define RATE_MIN_HZ         1.0
#define RATE_MAX_HZ         1e10
#define SOURCE_LEVEL_MAX_DB 300.0

void sonject_elements_params_init(sonject_elements_params *elements)
{
    memset(elements, 0, sizeof *elements);
    elements->struct_size = sizeof *elements;
    elements->form = SONJECT_SERIES_BASEBAND;
    elements->pulse = SONJECT_SERIES_COMPRESSED;
    elements->hydrophones = 1;
    elements->first_ping_m = NAN;
    elements->transmitter_length_m = NAN;
    elements->first_hydrophone_m = NAN;
    elements->hydrophone_length_m = NAN;
    elements->first_time_s = NAN;
    elements->last_time_s = NAN;
    elements->chirp_duration_s = 0.01;
    elements->source_level_db = NAN;
}

static void check_given_length(struct check *check, const char *key, double value_m)
{
    if (!isnan(value_m))
        check_length(check, key, value_m);
}

static void check_given_coordinate(struct check *check, const char *key, double value_m)
{
    if (!isnan(value_m))
        check_coordinate(check, key, value_m);
}

static void check_spacing(struct check *check, const char *key, double value_m)
{
    if (value_m != 0.0)
        check_positive_length(check, key, value_m);
}

static void check_times(struct check *check, const sonject_elements_params *elements)
{
    if (!isnan(elements->first_time_s))
        check_within(check, "first_time", elements->first_time_s, 0.0, TIME_MAX_S, " s");
    if (!isnan(elements->last_time_s))
        check_within(check, "last_time", elements->last_time_s, 0.0, TIME_MAX_S, " s");
    if (elements->last_time_s < elements->first_time_s)
        check_relation(check, "last_time", "first_time",
                       "must not be before first_time, %g s, but is %g s", elements->first_time_s,
                       elements->last_time_s);
    if (elements->sampling_rate_hz != 0.0)
        check_within(check, "sampling_rate", elements->sampling_rate_hz, RATE_MIN_HZ, RATE_MAX_HZ,
                     " Hz");
    check_within(check, "chirp", elements->chirp_duration_s, 1e-9, 100.0, " s");
}

sonject_status check_elements(const sonject_elements_params *elements, struct report *report,
                              struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_choice(&check, "form", elements->form, SONJECT_SERIES_PASSBAND + 1);
    check_choice(&check, "pulse", elements->pulse, SONJECT_SERIES_CHIRP + 1);
    check_within(&check, "hydrophones.count", elements->hydrophones, 1.0, HYDROPHONES_MAX, "");
    if (elements->pings > PINGS_MAX)
        check_failure(&check, "pings.count", "must be at most 2^24");
    check_given_coordinate(&check, "pings.first", elements->first_ping_m);
    check_spacing(&check, "pings.spacing", elements->ping_spacing_m);
    check_coordinate(&check, "transmitter.offset", elements->transmitter_offset_m);
    check_given_length(&check, "transmitter.length", elements->transmitter_length_m);
    check_given_coordinate(&check, "hydrophones.first", elements->first_hydrophone_m);
    check_spacing(&check, "hydrophones.spacing", elements->hydrophone_spacing_m);
    check_given_length(&check, "hydrophones.length", elements->hydrophone_length_m);
    check_times(&check, elements);
    if (!isnan(elements->source_level_db))
        check_within(&check, "source_level", elements->source_level_db, 0.0, SOURCE_LEVEL_MAX_DB,
                     " dB");
    check_within(&check, "aspect_limit", elements->aspect_limit_rad, 0.0, HALF_PI, " rad");
    return check.status;
}
