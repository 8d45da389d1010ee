#include "schema/profile_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/ranges.h"
#include "medium/water.h"

enum {
    HEIGHT,
    DEPTH,
    SPEED
};

static const struct table_format format = {
    {"height_m", "depth_m", "sound_speed_mps", NULL}, 1, PROFILE_SAMPLES_MAX, PROFILE_BYTES_MAX};

/* Takes the columns over and checks them. */
static sonject_status take_columns(struct report *report, struct number_table *numbers,
                                   struct profile_table *table)
{
    struct profile_fault fault;
    const int position = numbers->values[DEPTH] ? DEPTH : HEIGHT;
    sonject_status status = SONJECT_OK;
    table->is_depth = position == DEPTH;
    table->positions_m = numbers->values[position];
    table->speeds_mps = numbers->values[SPEED];
    table->count = numbers->count;
    numbers->values[position] = NULL;
    numbers->values[SPEED] = NULL;
    if (!profile_table_is_good(table, &fault))
        status = number_table_refuse(numbers, report, fault.sample,
                                     (size_t)(fault.is_speed ? SPEED : position), fault.what);
    number_table_clear(numbers);
    if (status != SONJECT_OK)
        profile_table_clear(table);
    return status;
}

sonject_status profile_table_read(struct report *report, const char *path,
                                  struct profile_table *table)
{
    struct number_table numbers;
    CHECK(number_table_read(report, path, &format, &numbers));
    return take_columns(report, &numbers, table);
}

sonject_status profile_table_take(struct report *report, const struct number_array *array,
                                  struct profile_table *table)
{
    struct number_table numbers;
    CHECK(number_table_take(report, array, &format, &numbers));
    return take_columns(report, &numbers, table);
}

/* What a range check says, without the value's name. */
static bool is_within(struct profile_fault *fault, double value, double least, double most,
                      const char *unit)
{
    struct report report = {{0}, NULL, NULL};
    struct check check = {&report, NULL, SONJECT_OK};
    check_within(&check, "it", value, least, most, unit);
    if (check.status != SONJECT_OK)
        snprintf(fault->what, sizeof fault->what, "%.190s", report.message + 3);
    return check.status == SONJECT_OK;
}

/* Whether sample i >= 1 goes on in the direction of the first two. */
static bool goes_on(const struct profile_table *table, size_t i, struct profile_fault *fault)
{
    const double *position = table->positions_m;
    const double step = position[i] - position[i - 1];
    const bool rises = position[1] > position[0];
    if (fabs(step) >= WATER_HEIGHT_STEP_MIN_M && (step > 0.0) == rises)
        return true;
    snprintf(fault->what, sizeof fault->what,
             "must %s from one to the next by at least %g m; %.9g follows %.9g",
             i == 1  ? "rise or fall"
             : rises ? "go on rising"
                     : "go on falling",
             WATER_HEIGHT_STEP_MIN_M, position[i], position[i - 1]);
    return false;
}

bool profile_table_is_good(const struct profile_table *table, struct profile_fault *fault)
{
    fault->is_speed = false;
    for (size_t i = 0; i < table->count; i++) {
        fault->sample = i;
        if (!is_within(fault, table->positions_m[i], table->is_depth ? 0.0 : -1e6, 1e6, " m"))
            return false;
        if (i > 0 && !goes_on(table, i, fault))
            return false;
        if (!is_within(fault, table->speeds_mps[i], WATER_SPEED_MIN_MPS, WATER_SPEED_MAX_MPS,
                       " m/s")) {
            fault->is_speed = true;
            return false;
        }
    }
    fault->sample = table->count;
    snprintf(fault->what, sizeof fault->what, "a profile needs at least two samples, not %zu",
             table->count);
    return table->count >= 2;
}

static void reverse(double *values, size_t count)
{
    for (size_t i = 0; i < count / 2; i++) {
        const double value = values[i];
        values[i] = values[count - 1 - i];
        values[count - 1 - i] = value;
    }
}

void profile_table_to_heights(struct profile_table *table, double depth_m)
{
    for (size_t i = 0; table->is_depth && i < table->count; i++)
        table->positions_m[i] = depth_m - table->positions_m[i];
    table->is_depth = false;
    if (table->positions_m[0] < table->positions_m[1])
        return;
    reverse(table->positions_m, table->count);
    reverse(table->speeds_mps, table->count);
}

void profile_table_clear(struct profile_table *table)
{
    free(table->positions_m);
    free(table->speeds_mps);
    memset(table, 0, sizeof *table);
}
