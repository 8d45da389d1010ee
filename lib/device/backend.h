/* What a kind of devices does; device.c passes on to it what device.h declares. */
#ifndef SONJECT_DEVICE_BACKEND_H
#define SONJECT_DEVICE_BACKEND_H

#include "device/device.h"

/* Each as the function of device.h that has its name. Buffers and kernels to be released are not
 * NULL. */
struct device_calls {
    sonject_status (*claim)(struct report *report); /* before a call uses it, in a child perhaps */
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

/* The device native, which is always there. To open fills in a zeroed device, for calls->close also
 * on failure where calls are set. Errors: DEVICE, MEMORY. */
bool native_is_named(const char *name);
bool native_has_width(uint32_t width);
void native_describe(sonject_device_info *info);
sonject_status native_open(struct report *report, const sonject_context_params *params,
                           struct device *device);

/* Bytes that a buffer of it was asked for. */
size_t native_buffer_bytes(device_buffer buffer);

/* Devices of OpenCL, of which there may be none. gpu: the first GPU's place, *count if there is
 * none. Errors: DEVICE, MEMORY. */
sonject_status opencl_list(struct report *report, sonject_device_info *devices, size_t capacity,
                           size_t *count, size_t *gpu);

/* The first that `name` is part of; NULL: the first GPU, else the first of any kind. */
sonject_status opencl_open(struct report *report, const char *name, struct device *device);

/* Sets what a device is called, its lanes and its units. */
void device_take_info(struct device *device, const sonject_device_info *info);

#endif
