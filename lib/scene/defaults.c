/* What the public structures hold before a caller changes them. */
#include <math.h>
#include <string.h>

#include <sonject/image.h>
#include <sonject/injection.h>
#include <sonject/medium.h>
#include <sonject/object.h>
#include <sonject/seabed.h>
#include <sonject/sonar.h>
#include <sonject/surface.h>

void sonject_sonar_params_init(sonject_sonar_params *sonar)
{
    memset(sonar, 0, sizeof *sonar);
    sonar->struct_size = sizeof *sonar;
    sonar->response_window = SONJECT_WINDOW_RECTANGULAR;
    sonar->centre_frequency_hz = 100e3;
    sonar->bandwidth_hz = 30e3;
    sonar->altitude_m = 10.0;
    sonar->taylor_sidelobe_db = 35.0;
    sonar->taylor_terms = 5;
    sonar->aperture_rad = -1.0;
}

void sonject_medium_params_init(sonject_medium_params *medium)
{
    memset(medium, 0, sizeof *medium);
    medium->struct_size = sizeof *medium;
    medium->sound_speed_mps = 1500.0;
}

void sonject_seabed_params_init(sonject_seabed_params *seabed)
{
    memset(seabed, 0, sizeof *seabed);
    seabed->struct_size = sizeof *seabed;
    seabed->map = SONJECT_MAP_INTENSITY;
    seabed->lambert = pow(10.0, -2.7);
    seabed->level_radius_m = 3.0;
    seabed->despeckle_radius_m = 0.1;
    sonject_material_params_init(&seabed->forward);
    seabed->forward.reflection = 0.0;
    seabed->forward.roughness_m = 0.0;
    seabed->forward.lambert = NAN;
}

void sonject_surface_params_init(sonject_surface_params *surface)
{
    memset(surface, 0, sizeof *surface);
    surface->struct_size = sizeof *surface;
    sonject_material_params_init(&surface->material);
    surface->material.reflection = -1.0;
    surface->material.roughness_m = 0.0;
    surface->material.lambert = 0.0;
    surface->material.glossy_albedo = NAN;
    surface->material.glossy_slope = 0.2;
}

/* No first slant range is right for most images, so there is none until the caller gives it. */
void sonject_geometry_params_init(sonject_geometry_params *geometry)
{
    memset(geometry, 0, sizeof *geometry);
    geometry->struct_size = sizeof *geometry;
    geometry->side = SONJECT_SIDE_PORT;
    geometry->row_spacing_m = 0.025;
    geometry->column_spacing_m = 0.025;
    geometry->first_slant_range_m = NAN;
}

void sonject_transfer_params_init(sonject_transfer_params *transfer)
{
    memset(transfer, 0, sizeof *transfer);
    transfer->struct_size = sizeof *transfer;
    transfer->kind = SONJECT_TRANSFER_AMPLITUDE;
    transfer->parameter = 1.0;
}

/* The mean level leaves 14 dB to full scale for the targets' highlights. */
void sonject_synthetic_params_init(sonject_synthetic_params *synthetic)
{
    memset(synthetic, 0, sizeof *synthetic);
    synthetic->struct_size = sizeof *synthetic;
    synthetic->rows = 400;
    synthetic->columns = 400;
    synthetic->seed = 1;
    synthetic->speckle_shape = 10.0;
    synthetic->texture_length_m = 0.1;
    synthetic->ripple_wavelength_m = 0.6;
    synthetic->ripple_contrast = 0.6;
    synthetic->ripple_heading_rad = 1.25;
    synthetic->patch_contrast_db = 4.0;
    synthetic->patch_length_m = 5.0;
    synthetic->mean_amplitude = 0.1;
}

void sonject_injection_params_init(sonject_injection_params *injection)
{
    memset(injection, 0, sizeof *injection);
    injection->struct_size = sizeof *injection;
    injection->mode = SONJECT_MODE_COMPOSITE;
    injection->column_rule = SONJECT_COLUMNS_FOCUSED;
    injection->estimate_noise = 1;
    injection->noise_floor_db = -25.0;
    injection->influence_db = -40.0;
    injection->ray_scale = 1.0;
    injection->seed = 1;
    injection->interactions = 1;
}

void sonject_material_params_init(sonject_material_params *material)
{
    memset(material, 0, sizeof *material);
    material->struct_size = sizeof *material;
    material->reflection = 0.9;
    material->roughness_m = 1.0e-3;
    material->lambert = 0.1;
    material->lambert_exponent = 1.0;
    material->glossy_slope = 0.1;
    material->density_ratio = 1.0;
    material->speed_ratio = 1.0;
}

void sonject_mesh_params_init(sonject_mesh_params *mesh)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->struct_size = sizeof *mesh;
    mesh->unit_m = 1.0;
    for (int axis = 0; axis < 3; axis++)
        mesh->axes[axis] = axis + 1;
}

void sonject_part_params_init(sonject_part_params *part)
{
    memset(part, 0, sizeof *part);
    part->struct_size = sizeof *part;
}

void sonject_object_params_init(sonject_object_params *object)
{
    memset(object, 0, sizeof *object);
    object->struct_size = sizeof *object;
    object->shape = SONJECT_SHAPE_SPHERE;
    object->diameter_m = 0.5;
    object->position_kind = SONJECT_POSITION_PATCH_CENTRE;
    sonject_material_params_init(&object->material);
}
