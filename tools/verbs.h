/* The verbs, one file each. */
#ifndef SONJECT_TOOLS_VERBS_H
#define SONJECT_TOOLS_VERBS_H

#include "arguments.h"

extern const struct verb run_verb;
extern const struct verb trace_verb;
extern const struct verb form_verb;
extern const struct verb campaign_verb;
extern const struct verb merge_verb;
extern const struct verb check_verb;
extern const struct verb quicklook_verb;
extern const struct verb measure_verb;
extern const struct verb convert_verb;
extern const struct verb seabed_verb;
extern const struct verb elements_verb;
extern const struct verb devices_verb;

#endif
