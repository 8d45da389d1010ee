#include "stage.h"

#include <string.h>

#include "exit_code.h"
#include "message.h"
#include "stop.h"

static void log_notes(void *progress, const char *line)
{
    if (strncmp(line, "note: ", 6) == 0)
        progress_log(progress, line);
}

int stage_work(const struct stage_options *stage, stage_function function, const void *verb_options,
               const char *done)
{
    stop_watch();
    struct progress progress;
    progress_begin(&progress, stage->is_quiet);
    sonject_context_params params = {.struct_size = sizeof(params)};
    params.device_name = stage->device;
    params.log = stage->is_quiet ? NULL : stage->is_verbose ? progress_log : log_notes;
    params.log_user = &progress;
    sonject_context *context = NULL;
    int was_finished = 0;
    sonject_status status = sonject_context_create(&params, &context);
    if (status == SONJECT_OK)
        status = function(context, verb_options, &progress, &was_finished);
    progress_end(&progress);
    int code = EXIT_CODE_DONE;
    /* A driver's compiler that a signal finds at work removes its files, and fails. */
    if (status == SONJECT_CANCELLED || (status == SONJECT_ERROR_DEVICE && stop_is_asked()))
        code = stop_report();
    else if (status != SONJECT_OK)
        code = fail_with(context, status);
    else if (!stage->is_quiet && was_finished)
        message(stage->output, " already holds the finished result");
    else if (!stage->is_quiet)
        message(done, stage->output);
    sonject_context_release(&context);
    return code;
}
