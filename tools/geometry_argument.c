#include "geometry_argument.h"

#include <string.h>

#include "message.h"

static bool parse_range_axis(const char *verb, const char *text, uint32_t *is_ground)
{
    *is_ground = strcmp(text, "ground") == 0;
    if (*is_ground || strcmp(text, "slant") == 0)
        return true;
    message(verb, ": --range-axis takes slant or ground, not \"", text, "\"");
    return false;
}

bool geometry_parse(const char *verb, const struct geometry_arguments *arguments,
                    uint32_t *is_ground, double *altitude_m, uint32_t *has_geometry,
                    sonject_geometry_params *geometry)
{
    const int given = arguments->row_spacing.is_given + arguments->column_spacing.is_given +
                      arguments->first_range.is_given;
    if (arguments->range_axis && !parse_range_axis(verb, arguments->range_axis, is_ground))
        return false;
    if (arguments->altitude.is_given && !(arguments->altitude.value > 0)) {
        message(verb, ": --altitude must be above 0");
        return false;
    }
    if (given != 0 && given < 3) {
        message(verb, ": --row-spacing, --column-spacing and --first-range belong together");
        return false;
    }
    if (arguments->altitude.is_given)
        *altitude_m = arguments->altitude.value;
    if (given == 0)
        return true;
    *has_geometry = 1;
    geometry->row_spacing_m = arguments->row_spacing.value;
    geometry->column_spacing_m = arguments->column_spacing.value;
    geometry->first_slant_range_m = arguments->first_range.value;
    return true;
}
