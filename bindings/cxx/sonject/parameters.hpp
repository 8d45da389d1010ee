/* Parameters with the library's defaults, and materials by name. */
#ifndef SONJECT_PARAMETERS_HPP
#define SONJECT_PARAMETERS_HPP

#include <string>

#include <sonject/error.hpp>
#include <sonject/sonject.h>

namespace sonject
{

namespace detail
{

template <typename Structure> void fill_defaults(Structure &structure);
#define SONJECT_CXX_DEFAULTS(name)                                                                 \
    template <> inline void fill_defaults(name &structure)                                         \
    {                                                                                              \
        name##_init(&structure);                                                                   \
    }
SONJECT_CXX_DEFAULTS(sonject_campaign_read_params)
SONJECT_CXX_DEFAULTS(sonject_campaign_run_params)
SONJECT_CXX_DEFAULTS(sonject_contact_file_params)
SONJECT_CXX_DEFAULTS(sonject_contact_params)
SONJECT_CXX_DEFAULTS(sonject_convert_params)
SONJECT_CXX_DEFAULTS(sonject_elements_params)
SONJECT_CXX_DEFAULTS(sonject_form_params)
SONJECT_CXX_DEFAULTS(sonject_geometry_params)
SONJECT_CXX_DEFAULTS(sonject_injection_params)
SONJECT_CXX_DEFAULTS(sonject_material_params)
SONJECT_CXX_DEFAULTS(sonject_measure_params)
SONJECT_CXX_DEFAULTS(sonject_medium_params)
SONJECT_CXX_DEFAULTS(sonject_merge_params)
SONJECT_CXX_DEFAULTS(sonject_mesh_params)
SONJECT_CXX_DEFAULTS(sonject_motion_params)
SONJECT_CXX_DEFAULTS(sonject_object_params)
SONJECT_CXX_DEFAULTS(sonject_part_params)
SONJECT_CXX_DEFAULTS(sonject_pulse_params)
SONJECT_CXX_DEFAULTS(sonject_quicklook_params)
SONJECT_CXX_DEFAULTS(sonject_relief_params)
SONJECT_CXX_DEFAULTS(sonject_run_params)
SONJECT_CXX_DEFAULTS(sonject_scene_read_params)
SONJECT_CXX_DEFAULTS(sonject_seabed_file_params)
SONJECT_CXX_DEFAULTS(sonject_seabed_params)
SONJECT_CXX_DEFAULTS(sonject_sonar_params)
SONJECT_CXX_DEFAULTS(sonject_surface_params)
SONJECT_CXX_DEFAULTS(sonject_synthetic_params)
SONJECT_CXX_DEFAULTS(sonject_trace_params)
SONJECT_CXX_DEFAULTS(sonject_transfer_params)
SONJECT_CXX_DEFAULTS(sonject_user_shape_params)
#undef SONJECT_CXX_DEFAULTS
template <> inline void fill_defaults(sonject_patch_params &structure)
{
    structure = sonject_patch_params();
    structure.struct_size = sizeof structure;
}

} // namespace detail

/* A structure with the library's defaults and its size. */
template <typename Structure> Structure defaults()
{
    Structure structure;
    detail::fill_defaults(structure);
    return structure;
}

/* A material by name ("steel", "medium sand", ...): throws error if there is none. */
inline sonject_material_params material(const std::string &name)
{
    sonject_material_params params = defaults<sonject_material_params>();
    const sonject_status status = sonject_material_named(name.c_str(), &params);
    if (status != SONJECT_OK)
        throw error(status, "there is no material named " + name);
    return params;
}

} // namespace sonject

#endif
