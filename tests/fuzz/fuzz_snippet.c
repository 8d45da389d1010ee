/* Shapes that users write: what is refused before a compiler sees it. */
#include "fuzz.h"

#include <stdlib.h>

#include "user/snippet.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct report report = {{0}, NULL, NULL};
    struct user_snippet snippet;
    char *code = fuzz_text(bytes, count);
    const sonject_status status = snippet_make(&report, "fuzz.cl", 1, code, &snippet);
    fuzz_expect(status, &report);
    if (status == SONJECT_OK)
        snippet_clear(&snippet);
    free(code);
    return 0;
}
