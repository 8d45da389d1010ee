#include "scene/sonar_array.h"

#include "scene/placement.h"

void sonar_array_axes(double axes[3][3], const sonject_sonar_params *sonar, bool is_mirrored)
{
    turn_axes(axes, sonar->array_heading_rad, sonar->array_pitch_rad, -sonar->array_depression_rad);
    if (!is_mirrored)
        return;
    /* the view's track runs the other way, and so does the long side that points ahead in it */
    for (int i = 0; i < 3; i++)
        axes[i][0] = -axes[i][0];
    for (int k = 0; k < 3; k++)
        axes[0][k] = -axes[0][k];
}

bool sonar_array_is_turned(const sonject_sonar_params *sonar)
{
    return sonar->array_heading_rad != 0.0 || sonar->array_pitch_rad != 0.0;
}
