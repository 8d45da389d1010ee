/* The pulse's defaults and ranges. */
#include <string.h>

#include "base/ranges.h"
#include "scene/scene.h"

void sonject_pulse_params_init(sonject_pulse_params *pulse)
{
    memset(pulse, 0, sizeof *pulse);
    pulse->struct_size = sizeof *pulse;
    pulse->taylor_sidelobe_db = 35.0;
    pulse->taylor_terms = 5;
}

sonject_status check_pulse(const sonject_pulse_params *pulse, struct report *report,
                           struct check_listener *listener)
{
    struct check check = {report, listener, SONJECT_OK};
    check_choice(&check, "kind", pulse->kind, SONJECT_PULSE_TABLE + 1);
    check_choice(&check, "window", pulse->window, SONJECT_PULSE_TAYLOR + 1);
    check_finite(&check, "window.taylor.sidelobes", pulse->taylor_sidelobe_db);
    if (pulse->window == SONJECT_PULSE_TAYLOR) {
        check_within(&check, "window.taylor.sidelobes", pulse->taylor_sidelobe_db, 1.0, 120.0,
                     " dB");
        check_within(&check, "window.taylor.terms", pulse->taylor_terms, 2.0, 16.0, "");
    }
    return check.status;
}
