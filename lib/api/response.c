/* What shapes the point response beside the sonar: pulse, measured responses, residual motion. */
#include "api/handles.h"

static sonject_status check_samples(struct report *report, const char *what,
                                    const double *positions, const double *real_part,
                                    const double *imaginary_part, size_t count)
{
    struct response_fault fault;
    if (!positions || !real_part)
        return null_argument(report, what);
    if (response_samples_are_good(positions, real_part, imaginary_part, count, &fault))
        return SONJECT_OK;
    if (fault.sample < count)
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: sample %zu: %s", what, fault.sample,
                              fault.what);
    return report_failure(report, SONJECT_ERROR_INPUT, "%s %s", what, fault.what);
}

sonject_status sonject_scene_set_pulse(sonject_scene *scene, const sonject_pulse_params *pulse)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_pulse_params taken = scene->scene.pulse;
    CHECK(params_take(scene->report, &taken, sizeof taken, pulse, sizeof taken, "pulse"));
    CHECK(check_pulse(&taken, scene->report, NULL));
    if (taken.kind == SONJECT_PULSE_TABLE && scene->scene.pulse_table.count == 0)
        return report_failure(scene->report, SONJECT_ERROR_INPUT,
                              "kind of the pulse is a table, but the scene has none: set it "
                              "first");
    scene->scene.pulse = taken;
    if (taken.kind != SONJECT_PULSE_TABLE)
        response_table_clear(&scene->scene.pulse_table);
    return SONJECT_OK;
}

sonject_status sonject_scene_set_pulse_table(sonject_scene *scene, uint32_t axis,
                                             const double *positions, const double *real_part,
                                             const double *imaginary_part, size_t count)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (axis > SONJECT_PULSE_AXIS_TIME)
        return report_failure(scene->report, SONJECT_ERROR_INPUT,
                              "axis of the pulse table must be 0 or 1, not %lu",
                              (unsigned long)axis);
    if (count == 0) {
        response_table_clear(&scene->scene.pulse_table);
        scene->scene.pulse.kind = SONJECT_PULSE_GAUSSIAN;
        return SONJECT_OK;
    }
    sonject_status status =
        check_samples(scene->report, "pulse table", positions, real_part, imaginary_part, count);
    THEN(status, response_table_set(&scene->scene.pulse_table, scene->report, positions, real_part,
                                    imaginary_part, count, axis == SONJECT_PULSE_AXIS_TIME));
    if (status == SONJECT_OK)
        scene->scene.pulse.kind = SONJECT_PULSE_TABLE;
    return status;
}

sonject_status sonject_scene_set_cross_range_table(sonject_scene *scene, const double *distances_m,
                                                   const double *real_part,
                                                   const double *imaginary_part, size_t count)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    if (count == 0) {
        response_table_clear(&scene->scene.cross_range_table);
        return SONJECT_OK;
    }
    CHECK(check_samples(scene->report, "cross-range table", distances_m, real_part, imaginary_part,
                        count));
    return response_table_set(&scene->scene.cross_range_table, scene->report, distances_m,
                              real_part, imaginary_part, count, false);
}

sonject_status sonject_scene_set_motion(sonject_scene *scene, const sonject_motion_params *motion)
{
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    sonject_motion_params taken = scene->scene.motion.params;
    sonject_status status = params_take(scene->report, &taken, sizeof taken, motion,
                                        offsetof(sonject_motion_params, yaw_advance_m), "motion");
    THEN(status, check_motion(&taken, scene->report, NULL));
    if (status == SONJECT_OK)
        scene->scene.motion.params = taken;
    return status;
}

static sonject_status set_motion_samples(sonject_scene *scene, enum motion_kind kind,
                                         const double *along_track_m, const double *values,
                                         size_t count)
{
    const bool is_sway = kind == MOTION_SWAY;
    size_t sample;
    const char *what;
    if (!scene)
        return SONJECT_ERROR_ARGUMENT;
    struct aperture_motion *motion = &scene->scene.motion;
    struct motion_table *table = is_sway ? &motion->sway_table : &motion->yaw_table;
    if (count == 0) {
        motion_table_clear(table);
        return SONJECT_OK;
    }
    if (!along_track_m || !values)
        return null_argument(scene->report, is_sway ? "along_track_m and sway_m of the motion table"
                                                    : "along_track_m and yaw_rad of the yaw table");
    if (!motion_samples_are_good(kind, along_track_m, values, count, &sample, &what))
        return report_failure(scene->report, SONJECT_ERROR_INPUT, "%s table: sample %zu: %s",
                              is_sway ? "motion" : "yaw", sample, what);
    return motion_table_set(table, scene->report, along_track_m, values, count);
}

sonject_status sonject_scene_set_motion_table(sonject_scene *scene, const double *along_track_m,
                                              const double *sway_m, size_t count)
{
    return set_motion_samples(scene, MOTION_SWAY, along_track_m, sway_m, count);
}

sonject_status sonject_scene_set_yaw_table(sonject_scene *scene, const double *along_track_m,
                                           const double *yaw_rad, size_t count)
{
    return set_motion_samples(scene, MOTION_YAW, along_track_m, yaw_rad, count);
}
