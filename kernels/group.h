/* Work-items that follow the rays of one segment of a strip. On a CPU that is one work-item, which
 * takes WIDTH rays at a time. On a GPU it is the work-items of a group, which walk in step.
 * Neighbouring rays go to neighbouring items, so that the items take the same branches. */
#ifndef SONJECT_KERNELS_GROUP_H
#define SONJECT_KERNELS_GROUP_H

#include "layout.h"
#include "width.h"

#ifndef GROUP_ITEMS
#define GROUP_ITEMS 1
#endif

/* The number of rays, or blocks of rays, that a group takes at once. */
#define GROUP_WIDTH (GROUP_ITEMS * WIDTH)

#if GROUP_ITEMS > 1
#define GROUP_KERNEL __kernel __attribute__((reqd_work_group_size(GROUP_ITEMS, 1, 1)))
#define GROUP_NUMBER ((int)get_group_id(0))
#define GROUP_ITEM   ((RECORD_WORD)get_local_id(0))
#define GROUP_MEMORY __local                      /* shared by the group's items */
#define GROUP_WAIT() barrier(CLK_LOCAL_MEM_FENCE) /* all items of the group must come here */
#else
#define GROUP_KERNEL __kernel
#define GROUP_NUMBER ((int)get_global_id(0))
#define GROUP_ITEM   0u
#define GROUP_MEMORY
#define GROUP_WAIT()
#endif

/* Adds the counts of an item to its group's record, which began with zeros. */
FUNCTION void count_outcome(GLOBAL struct outcome_record *sum, const struct outcome_record *own)
{
#if GROUP_ITEMS > 1
    atomic_add(&sum->queries, own->queries);
    atomic_add(&sum->impulses, own->impulses);
    atomic_or(&sum->faults, own->faults);
    atomic_add(&sum->rays, own->rays);
#else
    *sum = *own;
#endif
}

#endif
