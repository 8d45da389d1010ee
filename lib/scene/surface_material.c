#include "scene/surface_material.h"

#include <math.h>

#define PI 3.14159265358979323846

sonject_material_params surface_material(const sonject_surface_params *surface)
{
    sonject_material_params material = surface->material;
    const double most = material.reflection_kind == SONJECT_REFLECTION_FLUID
                            ? 1.0
                            : material.reflection * material.reflection;
    if (isnan(material.glossy_albedo))
        material.glossy_albedo = fmax(0.0, most - PI * material.lambert);
    return material;
}
