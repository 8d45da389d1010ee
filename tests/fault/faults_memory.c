#include "faults.h"

#include <errno.h>
#include <stddef.h>

#include <jansson.h>

WRAPPED(void *, malloc, size_t bytes);
WRAPPED(void *, calloc, size_t count, size_t bytes);
WRAPPED(void *, realloc, void *block, size_t bytes);
WRAPPED(void, free, void *block);

static bool is_out_of_memory(void)
{
    int error;
    if (!fault_is_due(FAULT_MEMORY, &error))
        return false;
    errno = ENOMEM;
    return true;
}

static void *counted(void *block)
{
    if (block)
        fault_count_block(1);
    return block;
}

void *__wrap_malloc(size_t bytes)
{
    fault_look_away();
    void *block = is_out_of_memory() ? NULL : counted(__real_malloc(bytes));
    fault_look_again();
    return block;
}

void *__wrap_calloc(size_t count, size_t bytes)
{
    fault_look_away();
    void *block = is_out_of_memory() ? NULL : counted(__real_calloc(count, bytes));
    fault_look_again();
    return block;
}

void *__wrap_realloc(void *block, size_t bytes)
{
    if (is_out_of_memory())
        return NULL;
    fault_look_away();
    void *larger = __real_realloc(block, bytes);
    fault_look_again();
    return block ? larger : counted(larger);
}

void __wrap_free(void *block)
{
    if (block)
        fault_count_block(-1);
    __real_free(block);
}

void fault_take_jansson(void)
{
    json_set_alloc_funcs(__wrap_malloc, __wrap_free);
}
