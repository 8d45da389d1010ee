/* Finds the modules of image files: RASTERS_ARE_LINKED where they are part of the program (static
 * libraries, and tests that let their calls fail), else a shared object is loaded; HAS_RASTERS is
 * not defined in builds without OpenImageIO. */
#include "swath/image_library.h"

#define IS_TIFF_OR_PNG(kind) ((kind) == IMAGE_TIFF || (kind) == IMAGE_PNG)

#if !defined(HAS_RASTERS)
sonject_status raster_module_find(struct report *report, const char *path, enum image_kind kind,
                                  const struct raster_module **module)
{
    (void)kind;
    *module = NULL;
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no image files: build it with OpenImageIO",
                          path);
}
#elif defined(RASTERS_ARE_LINKED)
sonject_status raster_module_find(struct report *report, const char *path, enum image_kind kind,
                                  const struct raster_module **module)
{
    (void)report, (void)path;
    *module = IS_TIFF_OR_PNG(kind) ? &raster_module_tiff_png : &raster_module_openimageio;
    return SONJECT_OK;
}
#else
#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"

/* Its libraries stay out of sight of the host's others. It is never unloaded: what they keep until
 * the process ends needs their code then. Some of them end the process where memory is short. */
static sonject_status load(struct report *report, const char *path, const char *module_file,
                           const char *name, const struct raster_module **module)
{
    static const struct module_stamp own = MODULE_STAMP;
    char excerpt[REPORT_CAPACITY / 4];
    if (memory_is_short())
        return report_failure(report, SONJECT_ERROR_MEMORY,
                              "%s: too little memory to load what reads and writes images, %s: "
                              "allow the process more, a gigabyte at least (ulimit -v)",
                              path, module_file);
    void *handle = dlopen(module_file, RTLD_LAZY | RTLD_LOCAL);
    const struct raster_module *found = handle ? dlsym(handle, name) : NULL;
    const char *fault = found ? "it is of another version of sonject" : dlerror();
    if (found && memcmp(&found->stamp, &own, sizeof own) == 0) {
        *module = found;
        return SONJECT_OK;
    }
    return report_failure(
        report, SONJECT_ERROR_UNSUPPORTED,
        "%s: sonject reads and writes images by %s, which cannot be used: %s: "
        "install sonject, and what it needs, anew",
        path, module_file,
        text_excerpt(excerpt, sizeof excerpt, fault ? fault : "it cannot be loaded"));
}

sonject_status raster_module_find(struct report *report, const char *path, enum image_kind kind,
                                  const struct raster_module **module)
{
    static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
    static struct module {
        const char *file, *name;
        const struct raster_module *loaded;
    } modules[] = {{"tiff_png.so", "raster_module_tiff_png", NULL},
                   {"openimageio.so", "raster_module_openimageio", NULL}};
    struct module *wanted = &modules[IS_TIFF_OR_PNG(kind) ? 0 : 1];
    sonject_status status = SONJECT_OK;
    pthread_mutex_lock(&one_at_a_time);
    if (!wanted->loaded) {
        char *module_file = module_path(wanted->file);
        status = module_file ? load(report, path, module_file, wanted->name, &wanted->loaded)
                             : report_out_of_memory(report, "a path");
        free(module_file);
    }
    *module = wanted->loaded;
    pthread_mutex_unlock(&one_at_a_time);
    return status;
}
#endif
