/* Stands in for impulse_export.c in builds without HDF5. */
#include "inject/impulse_export.h"

sonject_status impulse_export_begin(struct report *report, const char *path,
                                    struct impulse_export **export)
{
    *export = NULL;
    return report_failure(report, SONJECT_ERROR_UNSUPPORTED,
                          "%s: this build of sonject exports no impulses: build it with HDF5",
                          path);
}

sonject_status impulse_export_lines(struct impulse_export *export,
                                    const struct impulse_lines *lines)
{
    (void)export;
    (void)lines;
    return SONJECT_ERROR_UNSUPPORTED;
}

sonject_status impulse_export_publish(struct impulse_export *export, const struct scene *scene,
                                      const struct injection_input *input,
                                      const struct impulse_facts *facts, const char *scene_hash,
                                      const char *image_path)
{
    (void)export;
    (void)scene;
    (void)input;
    (void)facts;
    (void)scene_hash;
    (void)image_path;
    return SONJECT_ERROR_UNSUPPORTED;
}

void impulse_export_release(struct impulse_export **export)
{
    *export = NULL;
}
