#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "elements/elements.h"
#include "kernels/element_series_records.h"

#define PI                    3.14159265358979323846
#define SAMPLES_PER_DEVIATION 16.0      /* echoes shared by two fine samples then err by 5e-4 */
#define FINE_SAMPLES_MAX      4194304.0 /* 2^22: delays are single precision */
#define STRIPS_AWAY_MAX       1e9
#define ANY_SLOPE_SQUARE      1e16
#define WIDTH_MAX             16
#define LINES_BYTES           67108864.0 /* memory of the pairs worked on at a time */
#define PAIRS_MAX             65536.0
#define WORK_ITEMS            65536 /* enough for a GPU */
#define SHARE_SAMPLES         64    /* least samples of a line for a work-item */

/* The pulse of a series, on samples so fine that two of them may share an echo. */
struct fine_pulse {
    uint32_t fine; /* fine samples for each of the series */
    uint32_t taps;
    double first_time_s;               /* time of fine sample 0 */
    float *real_part, *imaginary_part; /* owned, taps each: sample n of the series is the sum over
                                          taps of fine sample n * fine + tap times tap */
};

static void fine_pulse_clear(struct fine_pulse *pulse)
{
    free(pulse->real_part);
    free(pulse->imaginary_part);
    memset(pulse, 0, sizeof *pulse);
}

/* Fills in the image's pulse. */
static void fill_compressed(struct fine_pulse *pulse, uint32_t lead, double metres_per_sample,
                            const struct point_response *response)
{
    for (uint32_t tap = 0; tap < pulse->taps; tap++) {
        const double distance = ((double)lead - (double)tap) * metres_per_sample;
        const struct complex_number value = range_response_complex(response, distance);
        pulse->real_part[tap] = (float)value.real_part;
        pulse->imaginary_part[tap] = (float)value.imaginary_part;
    }
}

/* Fills in a chirp. It rises through the band in true frequency, which falls in an envelope of
 * exp(-i 2 pi f0 t). Both ends count half, as in an integral. */
static void fill_chirp(struct fine_pulse *pulse, const sonject_element_layout *layout,
                       double fine_rate)
{
    const double duration = layout->elements.chirp_duration_s;
    const double rate = layout->bandwidth_hz / duration;
    for (uint32_t tap = 0; tap < pulse->taps; tap++) {
        const double time = (pulse->taps - 1 - tap) / fine_rate;
        const double from_middle = time - 0.5 * duration;
        const double phase = -PI * rate * from_middle * from_middle;
        /* share of the sample's interval within the chirp */
        const double early = fmin(time * fine_rate + 0.5, 1.0);
        const double late = fmin(fmax((duration - time) * fine_rate + 0.5, 0.0), 1.0);
        const double share = fmin(early, late);
        pulse->real_part[tap] = (float)(share * cos(phase));
        pulse->imaginary_part[tap] = (float)(share * sin(phase));
    }
}

/* Makes a pulse for fine_pulse_clear. Errors: MEMORY, INPUT (too many fine samples). */
static sonject_status fine_pulse_init(struct fine_pulse *pulse, struct report *report,
                                      const sonject_element_layout *layout,
                                      const struct point_response *response)
{
    const sonject_elements_params *elements = &layout->elements;
    const bool is_chirp = elements->pulse == SONJECT_SERIES_CHIRP;
    const double deviation_s = 2.0 * response->range_deviation_m / layout->sound_speed_mps;
    memset(pulse, 0, sizeof *pulse);
    pulse->fine = (uint32_t)fmax(
        1.0, ceil(SAMPLES_PER_DEVIATION / (deviation_s * elements->sampling_rate_hz) - 1e-9));
    const double fine_rate = elements->sampling_rate_hz * pulse->fine;
    const double metres = 0.5 * layout->sound_speed_mps / fine_rate;
    const double lead =
        ceil(is_chirp ? elements->chirp_duration_s * fine_rate : response->pulse_tail_m / metres);
    const double taps = is_chirp ? lead + 1.0 : 2.0 * lead + 1.0;
    const double samples = ((double)layout->samples - 1.0) * pulse->fine + taps;
    if (samples > FINE_SAMPLES_MAX)
        return report_failure(report, SONJECT_ERROR_INPUT,
                              "elements: a ping's window of %.3g s at %.4g Hz needs %.3g fine "
                              "samples, more than 2^22: narrow first_time and last_time, or lower "
                              "the sampling rate",
                              (double)layout->samples / elements->sampling_rate_hz,
                              elements->sampling_rate_hz, samples);
    pulse->taps = (uint32_t)taps;
    pulse->first_time_s = elements->first_time_s - lead / fine_rate;
    pulse->real_part = allocate_array(pulse->taps, sizeof(float));
    pulse->imaginary_part = allocate_array(pulse->taps, sizeof(float));
    if (!pulse->real_part || !pulse->imaginary_part) {
        fine_pulse_clear(pulse);
        return report_out_of_memory(report, "the pulse");
    }
    if (is_chirp)
        fill_chirp(pulse, layout, fine_rate);
    else
        fill_compressed(pulse, (uint32_t)lead, metres, response);
    return SONJECT_OK;
}

/* Returns the number of fine samples that make the series. */
static uint32_t fine_pulse_samples(const struct fine_pulse *pulse,
                                   const sonject_element_layout *layout)
{
    return (uint32_t)(layout->samples - 1) * pulse->fine + pulse->taps;
}

typedef char impulse_grid_record_is_packed[sizeof(struct impulse_grid_record) == 14 * 4 ? 1 : -1];
typedef char element_pair_record_is_packed[sizeof(struct element_pair_record) == 4 * 4 ? 1 : -1];

/* Returns the square of the tangent of the aspect limit; without a limit, a larger one than any. */
static double largest_slope_squared(const sonject_elements_params *elements)
{
    const double slope = tan(elements->aspect_limit_rad);
    return elements->aspect_limit_rad > 0.0 ? fmin(slope * slope, ANY_SLOPE_SQUARE)
                                            : ANY_SLOPE_SQUARE;
}

/* Returns the record of a piece's strips and bins, and of the rules that turn its echoes into fine
 * samples. segments: work-items that share a line. */
static struct impulse_grid_record impulse_grid_record_of(const sonject_element_layout *layout,
                                                         const struct patch_view *view,
                                                         const struct impulse_piece *piece,
                                                         const struct fine_pulse *pulse,
                                                         int32_t segments)
{
    const sonject_elements_params *elements = &layout->elements;
    const double c = layout->sound_speed_mps;
    const double wavelength = c / layout->centre_frequency_hz;
    const double bin_width = view->column_spacing_m / piece->grid.bins_per_pixel;
    const double reference = view_processor_range(view, 0.0);
    const double fine_rate = elements->sampling_rate_hz * pulse->fine;
    struct impulse_grid_record record;
    memset(&record, 0, sizeof record);
    record.strip_width = (float)(view->row_spacing_m / piece->grid.strips_per_row);
    record.bin_width = (float)bin_width;
    record.reference_range = (float)reference;
    record.first_strip = piece->grid.strips.first;
    record.strips = piece->grid.strips.count;
    record.largest_range = (float)(reference + piece->last_bin * bin_width);
    record.cycles_per_metre = (float)(1.0 / wavelength);
    record.samples_per_metre = (float)(fine_rate / c);
    record.first_sample = (float)((2.0 * reference / c - pulse->first_time_s) * fine_rate);
    record.transmitter_cycles = (float)(0.5 * elements->transmitter_length_m / wavelength);
    record.hydrophone_cycles = (float)(0.5 * elements->hydrophone_length_m / wavelength);
    record.largest_slope_squared = (float)largest_slope_squared(elements);
    record.samples = (int32_t)fine_pulse_samples(pulse, layout);
    record.segments = segments;
    return record;
}

/* Finds a position on the numbering of a piece's strips: whole strips, and a fraction 0...1. */
static void find_strip(const struct patch_view *view, const struct impulse_piece *piece,
                       double along_track_m, int32_t *strip, float *fraction)
{
    const double per_row = piece->grid.strips_per_row;
    const double x = view->is_mirrored ? -along_track_m : along_track_m;
    const double position = (view_row_of_x(view, x) + 0.5) * per_row - 0.5;
    const double limited = fmax(-STRIPS_AWAY_MAX, fmin(position, STRIPS_AWAY_MAX));
    *strip = (int32_t)floor(limited);
    *fraction = (float)(limited - floor(limited));
}

/* Fills in pairs first...first + count - 1 of transmitter and hydrophone on the numbering of a
 * piece's strips. Hydrophones of a ping come one after the other. */
static void element_pair_records_fill(struct element_pair_record *records,
                                      const sonject_elements_params *elements,
                                      const struct patch_view *view,
                                      const struct impulse_piece *piece, size_t first, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const uint32_t ping = (uint32_t)((first + i) / elements->hydrophones);
        const uint32_t hydrophone = (uint32_t)((first + i) % elements->hydrophones);
        struct element_pair_record *record = &records[i];
        find_strip(view, piece, element_transmitter_m(elements, ping), &record->transmitter_strip,
                   &record->transmitter_fraction);
        find_strip(view, piece, element_hydrophone_m(elements, ping, hydrophone),
                   &record->hydrophone_strip, &record->hydrophone_fraction);
    }
}

/* The device memory of the pairs of transmitter and hydrophone that are worked on at a time. */
struct series_work {
    const struct series_request *request;
    struct report *report;
    struct device *device;
    struct fine_pulse pulse;
    size_t pairs;          /* pings x hydrophones */
    size_t chunk;          /* pairs at a time */
    uint32_t fine_samples; /* fine samples of a line */
    int32_t line_stride, series_stride;
    struct element_pair_record *records; /* chunk of them; owned */
    float *parts[2];                     /* chunk x series_stride; owned */
    device_buffer lines[2], series[2], pulses[2];
    device_kernel hear, pulse_kernel;
};

static void work_clear(struct series_work *work)
{
    kernel_release(work->device, &work->hear);
    kernel_release(work->device, &work->pulse_kernel);
    for (int part = 0; part < 2; part++) {
        buffer_release(work->device, &work->lines[part]);
        buffer_release(work->device, &work->series[part]);
        buffer_release(work->device, &work->pulses[part]);
        free(work->parts[part]);
    }
    free(work->records);
    fine_pulse_clear(&work->pulse);
}

static void choose_chunk(struct series_work *work)
{
    const sonject_element_layout *layout = work->request->layout;
    const size_t padded = ((size_t)layout->samples + WIDTH_MAX - 1) / WIDTH_MAX * WIDTH_MAX;
    work->pairs = (size_t)layout->elements.pings * layout->elements.hydrophones;
    work->fine_samples = fine_pulse_samples(&work->pulse, layout);
    work->line_stride = (int32_t)(padded * work->pulse.fine + work->pulse.taps);
    work->series_stride = (int32_t)padded;
    const double line_bytes = (double)work->line_stride * sizeof(float);
    const double most = fmin(LINES_BYTES, (double)work->device->allocation_limit) / line_bytes;
    work->chunk = (size_t)fmax(1.0, fmin(fmin(most, PAIRS_MAX), (double)work->pairs));
}

static sonject_status work_init(struct series_work *work, const struct series_request *request,
                                struct report *report, struct device *device)
{
    memset(work, 0, sizeof *work);
    work->request = request;
    work->report = report;
    work->device = device;
    CHECK(fine_pulse_init(&work->pulse, report, request->layout, request->response));
    choose_chunk(work);
    const size_t line_bytes = work->chunk * (size_t)work->line_stride * sizeof(float);
    const size_t series_bytes = work->chunk * (size_t)work->series_stride * sizeof(float);
    const size_t pulse_bytes = work->pulse.taps * sizeof(float);
    const float *const pulses[2] = {work->pulse.real_part, work->pulse.imaginary_part};
    work->records = allocate_array(work->chunk, sizeof *work->records);
    CHECK_MEMORY(report, work->records, "time series");
    for (int part = 0; part < 2; part++) {
        work->parts[part] = allocate_array(series_bytes, 1);
        CHECK_MEMORY(report, work->parts[part], "time series");
        CHECK(buffer_create(report, device, line_bytes, NULL, &work->lines[part]));
        CHECK(buffer_create(report, device, series_bytes, NULL, &work->series[part]));
        CHECK(buffer_create(report, device, pulse_bytes, pulses[part], &work->pulses[part]));
    }
    CHECK(kernel_create(report, device, PROGRAM_ELEMENT_SERIES, PROGRAM_PLAIN, "hear_elements",
                        &work->hear));
    return kernel_create(report, device, PROGRAM_ELEMENT_SERIES, PROGRAM_PLAIN, "pulse_elements",
                         &work->pulse_kernel);
}

/* Makes a buffer of a piece's numbers with room for a group of lanes behind them. */
static sonject_status padded_buffer(struct series_work *work, const void *numbers, size_t count,
                                    device_buffer *buffer)
{
    CHECK(buffer_create(work->report, work->device, (count + WIDTH_MAX) * sizeof(float), NULL,
                        buffer));
    return buffer_write(work->report, work->device, *buffer, 0, count * sizeof(float), numbers);
}

/* Returns the work-items that share a line. A CPU's work-item does a whole line. */
static int32_t series_segments(const struct series_work *work)
{
    if (work->device->is_cpu)
        return 1;
    const int32_t most = (int32_t)(work->fine_samples / SHARE_SAMPLES) + 1;
    const int32_t wanted = (int32_t)(WORK_ITEMS / work->chunk) + 1;
    return most < wanted ? most : wanted;
}

static sonject_status hear_piece(struct series_work *work, const struct impulse_piece *piece,
                                 size_t first, size_t count)
{
    enum {
        GRID,
        PAIRS,
        STARTS,
        BINS,
        REAL_PART,
        IMAGINARY_PART,
        BUFFERS
    };
    const struct series_request *request = work->request;
    const struct impulse_grid_record grid = impulse_grid_record_of(
        request->layout, request->view, piece, &work->pulse, series_segments(work));
    const size_t strips = (size_t)piece->grid.strips.count;
    device_buffer buffers[BUFFERS] = {NULL};
    element_pair_records_fill(work->records, &request->layout->elements, request->view, piece,
                              first, count);
    sonject_status status =
        buffer_create(work->report, work->device, sizeof grid, &grid, &buffers[GRID]);
    THEN(status, buffer_create(work->report, work->device, count * sizeof *work->records,
                               work->records, &buffers[PAIRS]));
    THEN(status, padded_buffer(work, piece->starts, strips + 1, &buffers[STARTS]));
    THEN(status, padded_buffer(work, piece->bins, piece->count, &buffers[BINS]));
    THEN(status, padded_buffer(work, piece->real_part, piece->count, &buffers[REAL_PART]));
    THEN(status,
         padded_buffer(work, piece->imaginary_part, piece->count, &buffers[IMAGINARY_PART]));
    if (status == SONJECT_OK) {
        const struct kernel_argument arguments[] = {
            ARGUMENT(buffers[GRID]),      ARGUMENT(buffers[PAIRS]),
            ARGUMENT(buffers[STARTS]),    ARGUMENT(buffers[BINS]),
            ARGUMENT(buffers[REAL_PART]), ARGUMENT(buffers[IMAGINARY_PART]),
            ARGUMENT(work->line_stride),  ARGUMENT(work->lines[0]),
            ARGUMENT(work->lines[1])};
        const size_t global[2] = {(size_t)grid.segments, count};
        status = kernel_run(work->report, work->device, work->hear, arguments,
                            sizeof arguments / sizeof *arguments, 2, global);
    }
    for (int i = 0; i < BUFFERS; i++)
        buffer_release(work->device, &buffers[i]);
    return status;
}

static sonject_status pulse_chunk(struct series_work *work, size_t count)
{
    const int32_t fine = (int32_t)work->pulse.fine;
    const int32_t taps = (int32_t)work->pulse.taps;
    const size_t bytes = count * (size_t)work->series_stride * sizeof(float);
    const struct kernel_argument arguments[] = {
        ARGUMENT(work->lines[0]), ARGUMENT(work->lines[1]),      ARGUMENT(work->line_stride),
        ARGUMENT(fine),           ARGUMENT(work->pulses[0]),     ARGUMENT(work->pulses[1]),
        ARGUMENT(taps),           ARGUMENT(work->series_stride), ARGUMENT(work->series[0]),
        ARGUMENT(work->series[1])};
    const size_t global[2] = {(size_t)work->series_stride / work->device->width, count};
    CHECK(kernel_run(work->report, work->device, work->pulse_kernel, arguments,
                     sizeof arguments / sizeof *arguments, 2, global));
    CHECK(buffer_read(work->report, work->device, work->series[0], 0, bytes, work->parts[0]));
    return buffer_read(work->report, work->device, work->series[1], 0, bytes, work->parts[1]);
}

/* Writes a chunk's series to the caller's, on the carrier in pass band. */
static void hand_over(const struct series_work *work, size_t first, size_t count, float *series)
{
    const sonject_element_layout *layout = work->request->layout;
    const size_t samples = (size_t)layout->samples;
    const bool is_passband = layout->elements.form == SONJECT_SERIES_PASSBAND;
    for (size_t n = 0; n < samples; n++) {
        const double time =
            layout->elements.first_time_s + (double)n / layout->elements.sampling_rate_hz;
        const double cycles = fmod(layout->centre_frequency_hz * time, 1.0);
        const float cosine = (float)cos(2.0 * PI * cycles);
        const float sine = (float)sin(2.0 * PI * cycles);
        for (size_t i = 0; i < count; i++) {
            const float a = work->parts[0][i * (size_t)work->series_stride + n];
            const float b = work->parts[1][i * (size_t)work->series_stride + n];
            const size_t at = (first + i) * samples + n;
            if (is_passband) {
                series[at] = a * cosine + b * sine;
            } else {
                series[2 * at] = a;
                series[2 * at + 1] = b;
            }
        }
    }
}

static sonject_status compute_chunk(struct series_work *work, size_t first, size_t count,
                                    float *series)
{
    const struct impulse_list *impulses = work->request->impulses;
    const size_t bytes = count * (size_t)work->line_stride * sizeof(float);
    sonject_status status = buffer_clear(work->report, work->device, work->lines[0], bytes);
    THEN(status, buffer_clear(work->report, work->device, work->lines[1], bytes));
    for (size_t i = 0; status == SONJECT_OK && i < impulses->count; i++)
        status = hear_piece(work, &impulses->pieces[i], first, count);
    THEN(status, pulse_chunk(work, count));
    if (status == SONJECT_OK)
        hand_over(work, first, count, series);
    return status;
}

static sonject_status tell(const struct series_request *request, struct report *report, double done)
{
    const double fraction = request->first_fraction + (1.0 - request->first_fraction) * done;
    if (request->progress && request->progress(request->user, fraction, "hearing the impulses"))
        return report_failure(report, SONJECT_CANCELLED, "cancelled while hearing the impulses");
    return SONJECT_OK;
}

sonject_status series_compute(const struct series_request *request, struct report *report,
                              struct device *device, float *series)
{
    struct series_work work;
    sonject_status status = work_init(&work, request, report, device);
    for (size_t first = 0; status == SONJECT_OK && first < work.pairs; first += work.chunk) {
        const size_t left = work.pairs - first;
        const size_t count = left < work.chunk ? left : work.chunk;
        status = compute_chunk(&work, first, count, series);
        THEN(status, tell(request, report, (double)(first + count) / (double)work.pairs));
    }
    work_clear(&work);
    return status;
}
