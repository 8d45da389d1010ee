/* Finds the module of image files: RASTERS_ARE_LINKED where it is part of the program (static
 * libraries, and tests that let its calls fail), else a shared object is loaded; HAS_RASTERS is not
 * defined in builds without OpenImageIO. */
#include "swath/raster_module.h"

#if !defined(HAS_RASTERS)
sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module)
{
    *module = NULL;
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject has no image files: build it with OpenImageIO",
                          path);
}
#elif defined(RASTERS_ARE_LINKED)
sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module)
{
    (void)report, (void)path;
    *module = &raster_module_openimageio;
    return SONJECT_OK;
}
#else
#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <sonject/version.h>

#include "base/memory.h"
#include "base/module_path.h"
#include "base/text.h"

static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;
static const struct raster_module *loaded;

static sonject_status refuse(struct report *report, const char *path, const char *module_file,
                             const char *why)
{
    char excerpt[REPORT_CAPACITY / 4];
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: sonject reads and writes images by %s, which cannot be used: %s: "
                          "install sonject and OpenImageIO anew",
                          path, module_file, text_excerpt(excerpt, sizeof excerpt, why));
}

/* NULL if the module was built with this library. */
static const char *what_is_wrong_with(const struct raster_module *module)
{
    if (module->mark != RASTER_MODULE_MARK)
        return "it is of something else";
    if (strncmp(module->version, sonject_version(), sizeof module->version) != 0 ||
        module->module_bytes != sizeof *module || module->report_bytes != sizeof(struct report) ||
        module->encoding_bytes != sizeof(struct raster_encoding))
        return "it is of another version of sonject";
    return NULL;
}

/* Its libraries stay out of sight of the host's others. It is never unloaded: what they keep until
 * the process ends needs their code then. Some of them end the process where memory is short. */
static sonject_status load(struct report *report, const char *path, const char *module_file)
{
    if (memory_is_short())
        return report_failure(report, SONJECT_ERROR_MEMORY,
                              "%s: too little memory to load what reads and writes images, %s: "
                              "allow the process more, a gigabyte at least (ulimit -v)",
                              path, module_file);
    void *handle = dlopen(module_file, RTLD_LAZY | RTLD_LOCAL);
    const struct raster_module *module = handle ? dlsym(handle, "raster_module_openimageio") : NULL;
    if (!module) {
        const char *reason = dlerror();
        return refuse(report, path, module_file, reason ? reason : "it cannot be loaded");
    }
    const char *fault = what_is_wrong_with(module);
    if (fault)
        return refuse(report, path, module_file, fault);
    loaded = module;
    return SONJECT_OK;
}

sonject_status raster_module_find(struct report *report, const char *path,
                                  const struct raster_module **module)
{
    sonject_status status = SONJECT_OK;
    pthread_mutex_lock(&one_at_a_time);
    if (!loaded) {
        char *module_file = module_path("openimageio.so");
        status =
            module_file ? load(report, path, module_file) : report_out_of_memory(report, "a path");
        free(module_file);
    }
    *module = loaded;
    pthread_mutex_unlock(&one_at_a_time);
    return status;
}
#endif
