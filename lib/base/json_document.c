#include "base/json_document.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

json_t *json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_count(uint64_t value)
{
    return json_integer((json_int_t)value);
}

void json_add(json_t *object, const char *key, json_t *value)
{
    json_object_set_new(object, key, value);
}

sonject_status json_document_write(struct report *report, json_t *document, const char *path)
{
    char *text = json_dumps(document, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
    json_decref(document);
    if (!text)
        return report_out_of_memory(report, path);
    const sonject_status status = file_write_whole(report, path, text, strlen(text));
    free(text);
    return status;
}
