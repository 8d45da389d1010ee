/* The device native: kernels that the C compiler built for several instruction sets. */
#if defined(HAS_AVX2) || defined(HAS_AVX512)
#include <cpuid.h>
#endif
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/system/process.h"
#include "base/text.h"
#include "device/backend.h"
#include "device/native/native.h"

#define NAME "native"

#define KEPT_LEAST ((size_t)128 << 10) /* bytes of the smallest buffer that is kept */
#ifdef IS_SANITIZED                    /* sanitizers must see a buffer's end and release */
#define KEPT_MOST ((size_t)0)
#else
#define KEPT_MOST ((size_t)8 << 20)
#endif

/* Released buffers of all contexts, for later calls; atomic. */
static void *kept[12];

/* The programs of a set, in the order of enum device_program. */
#define PROGRAMS(set)                                                                              \
    {                                                                                              \
        set##_trace_rough, set##_trace_rough_images, set##_trace_smooth,                           \
            set##_trace_smooth_images, set##_trace_chains, set##_trace_multibounce,                \
            set##_image_formation, set##_element_series                                            \
    }
#define DECLARE(set)                                                                               \
    extern const struct native_kernel set##_trace_rough[], set##_trace_rough_images[],             \
        set##_trace_smooth[], set##_trace_smooth_images[], set##_trace_chains[],                   \
        set##_trace_multibounce[], set##_image_formation[], set##_element_series[];

struct instruction_set {
    const char *name;
    uint32_t width;
    uint32_t features, registers; /* bits that the processor and the system must have */
    native_program programs[2][PROGRAM_COUNT]; /* first index: variant */
};

DECLARE(baseline_full)
#ifdef HAS_AVX2
DECLARE(avx2_plain)
DECLARE(avx2_full)
#endif
#ifdef HAS_AVX512
DECLARE(avx512_plain)
DECLARE(avx512_full)
#endif
#define AVX2_FEATURES    (bit_AVX2 | bit_BMI | bit_BMI2)
#define AVX512_FEATURES  (bit_AVX512F | bit_AVX512CD | bit_AVX512BW | bit_AVX512DQ | bit_AVX512VL)
#define AVX2_REGISTERS   0x06
#define AVX512_REGISTERS 0xE6

/* The instruction sets, the best last. */
static const struct instruction_set instruction_sets[] = {
    {"baseline", 4, 0, 0, {PROGRAMS(baseline_full), PROGRAMS(baseline_full)}},
#ifdef HAS_AVX2
    {"AVX2", 8, AVX2_FEATURES, AVX2_REGISTERS, {PROGRAMS(avx2_plain), PROGRAMS(avx2_full)}},
#endif
#ifdef HAS_AVX512
    {"AVX-512",
     16,
     AVX2_FEATURES | AVX512_FEATURES,
     AVX512_REGISTERS,
     {PROGRAMS(avx512_plain), PROGRAMS(avx512_full)}},
#endif
};

/* Returns the features in ebx of CPUID's leaf 7 and, above them, the registers in XCR0 that the
 * system keeps. Asks the processor itself, since not every compiler's library can, and only once,
 * since a virtual machine takes long to answer. */
static uint64_t processor_abilities(void)
{
#if defined(HAS_AVX2) || defined(HAS_AVX512)
    static const uint64_t asked = UINT64_C(1) << 63;
    static uint64_t known; /* atomic */
    unsigned eax, ebx, ecx, edx, registers;
    uint64_t abilities = __atomic_load_n(&known, __ATOMIC_RELAXED);
    if (abilities != 0)
        return abilities;
    abilities = asked;
    if (__get_cpuid(1, &eax, &ebx, &ecx, &edx) && (ecx & bit_OSXSAVE) && (ecx & bit_POPCNT) &&
        __get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx)) {
        __asm__("xgetbv" : "=a"(registers), "=d"(edx) : "c"(0));
        abilities |= (uint64_t)registers << 32 | ebx;
    }
    __atomic_store_n(&known, abilities, __ATOMIC_RELAXED);
    return abilities;
#else
    return 0;
#endif
}

/* Returns the best set that the processor has, of `width` lanes unless that is 0; NULL: none. */
static const struct instruction_set *find_instruction_set(uint32_t width)
{
    const struct instruction_set *best = NULL;
    const uint64_t abilities = processor_abilities();
    for (size_t i = 0; i < COUNT(instruction_sets); i++) {
        const struct instruction_set *set = &instruction_sets[i];
        const uint64_t wanted = (uint64_t)set->registers << 32 | set->features;
        if ((abilities & wanted) == wanted && (width == 0 || set->width == width))
            best = set;
    }
    return best;
}

bool native_has_width(uint32_t width)
{
    return find_instruction_set(width) != NULL;
}

bool native_is_named(const char *name)
{
    return contains_ignoring_case(NAME, name);
}

void native_describe(sonject_device_info *info)
{
    const struct instruction_set *set = find_instruction_set(0);
    memset(info, 0, sizeof *info);
    strcpy(info->name, NAME);
    strcpy(info->platform, "built in");
    strcpy(info->driver, set->name);
    info->compute_units = processor_count();
    info->vector_width = set->width;
}

static sonject_status native_claim(struct report *report)
{
    (void)report;
    return SONJECT_OK;
}

/* The head before each buffer. The system clears new memory page by page, which took a quarter of a
 * short call's time. Some large buffers are therefore kept for the next call. */
struct buffer_head {
    size_t capacity, bytes; /* allocated, asked for; the two keep the buffer aligned */
};

size_t native_buffer_bytes(device_buffer buffer)
{
    return ((const struct buffer_head *)buffer - 1)->bytes;
}

static void native_close(struct device *device)
{
    (void)device;
    for (size_t i = 0; i < COUNT(kept); i++)
        free(__atomic_exchange_n(&kept[i], NULL, __ATOMIC_ACQ_REL));
    threads_release();
}

static bool put_back(size_t place, struct buffer_head *head)
{
    void *nothing = NULL;
    return __atomic_compare_exchange_n(&kept[place], &nothing, head, false, __ATOMIC_ACQ_REL,
                                       __ATOMIC_RELAXED);
}

/* Takes a kept buffer of so many bytes, or up to twice as many; NULL if there is none. A buffer
 * belongs to the thread that takes it out of its place. */
static struct buffer_head *take_kept(size_t bytes)
{
    for (size_t i = 0; i < COUNT(kept); i++) {
        struct buffer_head *head = __atomic_exchange_n(&kept[i], NULL, __ATOMIC_ACQ_REL);
        if (head && head->capacity >= bytes && head->capacity / 2 <= bytes)
            return head;
        if (head && !put_back(i, head))
            free(head);
    }
    return NULL;
}

static sonject_status native_reserve(struct report *report, struct device *device, size_t bytes,
                                     device_buffer *buffer)
{
    (void)device;
    struct buffer_head *head = bytes < KEPT_LEAST ? NULL : take_kept(bytes);
    if (!head) {
        head = bytes > SIZE_MAX - sizeof *head ? NULL : malloc(sizeof *head + bytes);
        CHECK_MEMORY(report, head, "a buffer of the device");
        head->capacity = bytes;
    }
    head->bytes = bytes;
    *buffer = head + 1;
    return SONJECT_OK;
}

static void native_release(device_buffer buffer)
{
    struct buffer_head *head = (struct buffer_head *)buffer - 1;
    const bool is_kept = head->capacity >= KEPT_LEAST && head->capacity <= KEPT_MOST;
    for (size_t i = 0; is_kept && i < COUNT(kept); i++)
        if (put_back(i, head))
            return;
    /* replaces any other, so that buffers of sizes no longer asked for go */
    void **any = &kept[((uintptr_t)head >> 12) % COUNT(kept)];
    free(is_kept ? __atomic_exchange_n(any, head, __ATOMIC_ACQ_REL) : head);
}

static sonject_status native_read(struct report *report, struct device *device,
                                  device_buffer buffer, size_t offset, size_t bytes, void *contents)
{
    (void)report, (void)device;
    memcpy(contents, (const char *)buffer + offset, bytes);
    return SONJECT_OK;
}

static sonject_status native_write(struct report *report, struct device *device,
                                   device_buffer buffer, size_t offset, size_t bytes,
                                   const void *contents)
{
    (void)report, (void)device;
    memcpy((char *)buffer + offset, contents, bytes);
    return SONJECT_OK;
}

static sonject_status native_map(struct report *report, struct device *device, device_buffer buffer,
                                 size_t bytes, const void **contents)
{
    (void)report, (void)device, (void)bytes;
    *contents = buffer;
    return SONJECT_OK;
}

static void native_unmap(struct device *device, device_buffer buffer, const void *contents)
{
    (void)device, (void)buffer, (void)contents;
}

static sonject_status native_clear(struct report *report, struct device *device,
                                   device_buffer buffer, size_t bytes)
{
    (void)report, (void)device;
    memset(buffer, 0, bytes);
    return SONJECT_OK;
}

static sonject_status native_kernel_create(struct report *report, struct device *device,
                                           enum device_program program,
                                           enum program_variant variant, const char *name,
                                           device_kernel *kernel)
{
    const struct instruction_set *set = find_instruction_set(device->width);
    if (!set)
        return report_failure(report, SONJECT_ERROR_DEVICE,
                              "device '%s' has no kernels of %u lanes", device->name,
                              (unsigned)device->width);
    const struct native_kernel *found = set->programs[variant][program];
    while (strcmp(found->name, name) != 0)
        found++;
    *kernel = (void *)(uintptr_t)found;
    return SONJECT_OK;
}

static void native_kernel_release(device_kernel kernel)
{
    (void)kernel;
}

static sonject_status native_kernel_run(struct report *report, struct device *device,
                                        device_kernel kernel,
                                        const struct kernel_argument *arguments,
                                        size_t argument_count, uint32_t dimensions,
                                        const size_t *global)
{
    const struct native_kernel *native = kernel;
    size_t items[3] = {1, 1, 1};
    (void)report, (void)argument_count;
    memcpy(items, global, dimensions * sizeof *global);
    if (device->run_tasks)
        threads_run_by_host(device->run_tasks, device->run_tasks_user, device->compute_units,
                            native->run, arguments, items);
    else
        threads_run(device->compute_units, native->run, arguments, items);
    return SONJECT_OK;
}

sonject_status native_open(struct report *report, const sonject_context_params *params,
                           struct device *device)
{
    static const struct device_calls calls = {
        .claim = native_claim,
        .close = native_close,
        .buffer_reserve = native_reserve,
        .buffer_release = native_release,
        .buffer_read = native_read,
        .buffer_write = native_write,
        .buffer_map = native_map,
        .buffer_unmap = native_unmap,
        .buffer_clear = native_clear,
        .kernel_create = native_kernel_create,
        .kernel_release = native_kernel_release,
        .kernel_run = native_kernel_run,
    };
    sonject_device_info info;
    (void)report;
    native_describe(&info);
    if (params->threads > 0 && params->threads < info.compute_units)
        info.compute_units = params->threads;
    device_take_info(device, &info);
    device->calls = &calls;
    device->is_cpu = true;
    device->run_tasks = params->run_tasks;
    device->run_tasks_user = params->run_tasks_user;
    device->allocation_limit = PTRDIFF_MAX;
    threads_retain();
    return SONJECT_OK;
}
