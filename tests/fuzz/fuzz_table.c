/* Tables of numbers. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>

#include "schema/tables.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static const struct table_format format = {.names = {"depth", "time", "speed", "other"},
                                               .required = 1,
                                               .samples_max = 100,
                                               .bytes_max = 4000};
    struct report report = {{0}, NULL, NULL};
    struct number_table table;
    fuzz_write("fuzz.csv", bytes, count);
    const sonject_status status = number_table_read(&report, "fuzz.csv", NULL, &format, &table);
    fuzz_expect(status, &report);
    if (status != SONJECT_OK)
        return 0;
    for (size_t column = 0; column < TABLE_COLUMNS_MAX; column++)
        for (size_t i = 0; table.values[column] && i < table.count; i++)
            if (isnan(table.values[column][i])) /* infinite ones are for who reads it */
                abort();
    number_table_clear(&table);
    return 0;
}
