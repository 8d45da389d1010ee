/* The interface of a kind of devices, to which device.c passes on the functions of device.h. */
#ifndef SONJECT_DEVICE_BACKEND_H
#define SONJECT_DEVICE_BACKEND_H

#include "device/device.h"

/* The functions of a kind of devices, each as the function of device.h that has its name. Buffers
 * and kernels to be released are not NULL. */
struct device_calls {
    sonject_status (*claim)(struct report *report); /* before each use, perhaps in a forked child */
    void (*close)(struct device *device);
    sonject_status (*buffer_reserve)(struct report *report, struct device *device, size_t bytes,
                                     device_buffer *buffer);
    void (*buffer_release)(device_buffer buffer);
    sonject_status (*buffer_read)(struct report *report, struct device *device,
                                  device_buffer buffer, size_t offset, size_t bytes,
                                  void *contents);
    sonject_status (*buffer_write)(struct report *report, struct device *device,
                                   device_buffer buffer, size_t offset, size_t bytes,
                                   const void *contents);
    sonject_status (*buffer_map)(struct report *report, struct device *device, device_buffer buffer,
                                 size_t bytes, const void **contents);
    void (*buffer_unmap)(struct device *device, device_buffer buffer, const void *contents);
    sonject_status (*buffer_clear)(struct report *report, struct device *device,
                                   device_buffer buffer, size_t bytes);
    sonject_status (*kernel_create)(struct report *report, struct device *device,
                                    enum device_program program, enum program_variant variant,
                                    const char *name, device_kernel *kernel);
    void (*kernel_release)(device_kernel kernel);
    sonject_status (*kernel_run)(struct report *report, struct device *device, device_kernel kernel,
                                 const struct kernel_argument *arguments, size_t argument_count,
                                 uint32_t dimensions, const size_t *global);
};

/* The device native, which always exists. native_open fills in a zeroed device, which is for
 * calls->close, also on failure, if calls are set. Errors: DEVICE, MEMORY. */
bool native_is_named(const char *name);
bool native_has_width(uint32_t width);
void native_describe(sonject_device_info *info);
sonject_status native_open(struct report *report, const sonject_context_params *params,
                           struct device *device);

/* Returns the bytes that one of native's buffers was asked for. */
size_t native_buffer_bytes(device_buffer buffer);

/* Lists OpenCL's devices, of which there may be none. gpu: the first GPU's index, *count if there
 * is none. Errors: DEVICE, MEMORY. */
sonject_status opencl_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count, size_t *gpu);

/* Opens the first device with `name` in its name; NULL: the first GPU, else the first device. */
sonject_status opencl_open(struct report *report, const char *name, struct device *device);

/* Sets a device's names, lanes and units. */
void device_take_info(struct device *device, const sonject_device_info *info);

#endif
