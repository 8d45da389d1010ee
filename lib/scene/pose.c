#include "scene/pose.h"

#include <math.h>

void turn_axes(double axes[3][3], double heading, double pitch, double roll)
{
    const double cp = cos(pitch);
    const double sp = sin(pitch);
    const double nose[3] = {cos(heading) * cp, sin(heading) * cp, sp};
    const double side[3] = {-sin(heading), cos(heading), 0.0};
    const double up[3] = {-cos(heading) * sp, -sin(heading) * sp, cp};
    for (int i = 0; i < 3; i++) {
        axes[0][i] = nose[i];
        axes[1][i] = side[i] * cos(roll) + up[i] * sin(roll);
        axes[2][i] = up[i] * cos(roll) - side[i] * sin(roll);
    }
}

void compose_axes(double product[3][3], double inner[3][3], double outer[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            product[i][k] = 0.0;
            for (int m = 0; m < 3; m++)
                product[i][k] += inner[i][m] * outer[m][k];
        }
}
