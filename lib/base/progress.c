#include "base/progress.h"

int progress_share_tell(void *user, double fraction, const char *stage)
{
    const struct progress_share *part = user;
    return part->progress ? part->progress(part->user, part->first + part->share * fraction, stage)
                          : 0;
}
