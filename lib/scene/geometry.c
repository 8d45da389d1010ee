#include "scene/geometry.h"

#include <stdlib.h>
#include <string.h>

#include "scene/response_table.h"

double ping_table_at(const struct ping_table *table, const double *column, double row)
{
    const size_t i = piece_at(table->rows, table->count, row);
    const double share = (row - table->rows[i]) / (table->rows[i + 1] - table->rows[i]);
    return column[i] + share * (column[i + 1] - column[i]);
}

void ping_table_clear(struct ping_table *table)
{
    free(table->rows);
    memset(table, 0, sizeof *table);
}
