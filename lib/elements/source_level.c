#include "elements/source_level.h"

#include <math.h>

#define MICROPASCAL 1e-6

static void scale_piece(struct impulse_piece *piece, const struct patch_view *view, double pressure,
                        double absorption_db_per_m)
{
    const double bin_width = view->column_spacing_m / piece->grid.bins_per_pixel;
    const double reference = view_apparent_range(view, 0.0);
    for (size_t i = 0; i < piece->count; i++) {
        const double apparent = reference + piece->bins[i] * bin_width;
        const double way = 2.0 * apparent / view->range_ratio;
        const double factor = pressure * pow(10.0, -absorption_db_per_m * way / 20.0);
        piece->real_part[i] = (float)(piece->real_part[i] * factor);
        piece->imaginary_part[i] = (float)(piece->imaginary_part[i] * factor);
    }
}

void impulse_list_set_source_level(struct impulse_list *list, const struct patch_view *view,
                                   double source_level_db, double absorption_db_per_m)
{
    const double pressure = sqrt(2.0) * MICROPASCAL * pow(10.0, source_level_db / 20.0);
    for (size_t i = 0; i < list->count; i++)
        scale_piece(&list->pieces[i], view, pressure, absorption_db_per_m);
}
