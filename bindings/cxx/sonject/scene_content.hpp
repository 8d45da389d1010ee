/* What a scene holds, and how that is set. */
#ifndef SONJECT_SCENE_CONTENT_HPP
#define SONJECT_SCENE_CONTENT_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <sonject/elements.h>
#include <sonject/error.hpp>
#include <sonject/parameters.hpp>
#include <sonject/scene.h>
#include <sonject/span.hpp>

namespace sonject
{

/* The part of sonject::scene that describes: sonar, water, seabed, objects and where the image
 * comes from. */
class scene_content
{
  public:
    scene_content(scene_content &&other) noexcept : context_(other.context_), handle_(other.handle_)
    {
        other.handle_ = nullptr;
    }
    scene_content &operator=(scene_content &&other) noexcept
    {
        std::swap(context_, other.context_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    scene_content(const scene_content &) = delete;
    scene_content &operator=(const scene_content &) = delete;

    sonject_scene *get() const noexcept
    {
        return handle_;
    }
    sonject_context *context_handle() const noexcept
    {
        return context_;
    }

    /* Sets a key of the scene: "sonar.altitude", "10 m"; see sonject_scene_set. */
    void set(const std::string &key, const std::string &value)
    {
        check(sonject_scene_set(handle_, key.c_str(), value.c_str()));
    }
    /* Numbers in place of a table's file: rows of as many columns as are named, separated by
     * commas; of heights, without names, column_count. See sonject_scene_set_table. */
    void set_table(const std::string &key, const std::string &columns, span<const double> values,
                   std::size_t column_count = 0)
    {
        if (!columns.empty())
            column_count =
                1 + static_cast<std::size_t>(std::count(columns.begin(), columns.end(), ','));
        require(column_count > 0 && values.size() % column_count == 0,
                "a table needs whole rows of its columns");
        check(sonject_scene_set_table(handle_, key.c_str(),
                                      columns.empty() ? nullptr : columns.c_str(), values.data(),
                                      values.size() / column_count, column_count));
    }

    void set(const sonject_sonar_params &sonar)
    {
        check(sonject_scene_set_sonar(handle_, &sonar));
    }
    void set(const sonject_pulse_params &pulse)
    {
        check(sonject_scene_set_pulse(handle_, &pulse));
    }
    void set(const sonject_motion_params &motion)
    {
        check(sonject_scene_set_motion(handle_, &motion));
    }
    void set(const sonject_elements_params &elements)
    {
        check(sonject_scene_set_elements(handle_, &elements));
    }
    void set(const sonject_medium_params &medium)
    {
        check(sonject_scene_set_medium(handle_, &medium));
    }
    void set(const sonject_seabed_params &seabed)
    {
        check(sonject_scene_set_seabed(handle_, &seabed));
    }
    void set(const sonject_surface_params &surface)
    {
        check(sonject_scene_set_surface(handle_, &surface));
    }
    void set(const sonject_geometry_params &geometry)
    {
        check(sonject_scene_set_geometry(handle_, &geometry));
    }
    void set(const sonject_transfer_params &transfer)
    {
        check(sonject_scene_set_transfer(handle_, &transfer));
    }
    void set(const sonject_injection_params &injection)
    {
        check(sonject_scene_set_injection(handle_, &injection));
    }
    void set(const sonject_patch_params &patch)
    {
        check(sonject_scene_set_patch(handle_, &patch));
    }

    /* Measured pulse: samples at positions that the axis tells; imaginary_part: of that number, or
     * none where all are 0. */
    void set_pulse_table(sonject_pulse_axis axis, span<const double> positions,
                         span<const double> real_part,
                         span<const double> imaginary_part = span<const double>())
    {
        require_samples(positions, real_part, imaginary_part);
        check(sonject_scene_set_pulse_table(handle_, axis, positions.data(), real_part.data(),
                                            imaginary_part.size() ? imaginary_part.data() : nullptr,
                                            positions.size()));
    }
    /* Measured cross-range response of a synthetic aperture, likewise. */
    void set_cross_range_table(span<const double> distances_m, span<const double> real_part,
                               span<const double> imaginary_part = span<const double>())
    {
        require_samples(distances_m, real_part, imaginary_part);
        check(sonject_scene_set_cross_range_table(
            handle_, distances_m.data(), real_part.data(),
            imaginary_part.size() ? imaginary_part.data() : nullptr, distances_m.size()));
    }
    /* Measured residual sway at positions along the track. */
    void set_motion_table(span<const double> along_track_m, span<const double> sway_m)
    {
        require(sway_m.size() == along_track_m.size(), "motion needs as many sways as positions");
        check(sonject_scene_set_motion_table(handle_, along_track_m.data(), sway_m.data(),
                                             along_track_m.size()));
    }

    /* Measured residual yaw, likewise. */
    void set_yaw_table(span<const double> along_track_m, span<const double> yaw_rad)
    {
        require(yaw_rad.size() == along_track_m.size(), "motion needs as many yaws as positions");
        check(sonject_scene_set_yaw_table(handle_, along_track_m.data(), yaw_rad.data(),
                                          along_track_m.size()));
    }

    /* Level layers of water: bottoms_m, rising from 0, and sound speeds of equal number; densities
     * of that number, or none. */
    void set_water_layers(span<const double> bottoms_m, span<const double> sound_speeds_mps,
                          span<const double> densities = span<const double>())
    {
        require(sound_speeds_mps.size() == bottoms_m.size() &&
                    (densities.size() == 0 || densities.size() == bottoms_m.size()),
                "layers need as many sound speeds (and densities) as bottoms");
        check(sonject_scene_set_water_layers(handle_, bottoms_m.data(), sound_speeds_mps.data(),
                                             densities.size() ? densities.data() : nullptr,
                                             bottoms_m.size()));
    }
    void set_sound_speed_profile(span<const double> heights_m, span<const double> sound_speeds_mps)
    {
        require(sound_speeds_mps.size() == heights_m.size(),
                "a profile needs as many sound speeds as heights");
        check(sonject_scene_set_sound_speed_profile(handle_, heights_m.data(),
                                                    sound_speeds_mps.data(), heights_m.size()));
    }

    /* Heights of the seabed, relief.rows x relief.columns of them. */
    void set_relief(const sonject_relief_params &relief, span<const float> heights_m)
    {
        require(heights_m.size() == static_cast<std::size_t>(relief.rows) *
                                        static_cast<std::size_t>(relief.columns),
                "a relief needs rows x columns heights");
        check(sonject_scene_set_relief(handle_, &relief, heights_m.data()));
    }

    void set_input(const std::string &path)
    {
        check(sonject_scene_set_input_file(handle_, path.c_str()));
    }
    /* A channel of an XTF file: SONJECT_CHANNEL_PORT and the like, or its number. */
    void set_input(const std::string &path, std::int32_t channel)
    {
        set_input(path);
        check(sonject_scene_set_input_channel(handle_, channel));
    }
    /* An array of an HDF5 or MATLAB file. */
    void set_input(const std::string &path, const std::string &array)
    {
        set_input(path);
        check(sonject_scene_set_input_array(handle_, array.c_str()));
    }
    void set_input_uniform(std::uint32_t rows, std::uint32_t columns)
    {
        check(sonject_scene_set_input_uniform(handle_, rows, columns));
    }
    void set_input(const sonject_synthetic_params &synthetic)
    {
        check(sonject_scene_set_input_synthetic(handle_, &synthetic));
    }
    /* Geometry and altitude from the input, an XTF file. */
    void take_geometry()
    {
        check(sonject_scene_take_geometry(handle_));
    }

    /* Each gives the number of what was added, counted from 0. */
    std::uint32_t add(const sonject_object_params &object)
    {
        std::uint32_t index = 0;
        check(sonject_scene_add_object(handle_, &object, &index));
        return index;
    }
    std::uint32_t add_mesh(const std::string &path,
                           const sonject_mesh_params &params = defaults<sonject_mesh_params>())
    {
        std::uint32_t number = 0;
        check(sonject_scene_add_mesh(handle_, path.c_str(), &params, &number));
        return number;
    }
    std::uint32_t add_user_shape(const sonject_user_shape_params &shape)
    {
        std::uint32_t number = 0;
        check(sonject_scene_add_user_shape(handle_, &shape, &number));
        return number;
    }
    /* The target that a file describes; placing: its position, pose, burial and level, and its name
     * and class where not "". */
    std::uint32_t add_target(
        const std::string &path,
        const sonject_object_params &placing = defaults<sonject_object_params>(),
        bool allows_user_shapes = false)
    {
        std::uint32_t index = 0;
        sonject_scene_read_params params = defaults<sonject_scene_read_params>();
        params.allows_user_shapes = allows_user_shapes;
        check(sonject_scene_add_target(handle_, path.c_str(), &params, &placing, &index));
        return index;
    }
    /* A part of the object of that number, whose shape is SONJECT_SHAPE_PARTS. */
    void add_part(std::uint32_t object, const sonject_object_params &shape,
                  const sonject_part_params &part = defaults<sonject_part_params>())
    {
        check(sonject_scene_add_part(handle_, object, &shape, &part));
    }
    std::uint32_t object_count() const
    {
        std::uint32_t count = 0;
        check(sonject_scene_object_count(handle_, &count));
        return count;
    }

  protected:
    scene_content(sonject_context *context, sonject_scene *handle) noexcept
        : context_(context), handle_(handle)
    {
    }
    ~scene_content()
    {
        sonject_scene_release(&handle_);
    }
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
    sonject_context *context_;
    sonject_scene *handle_;

  private:
    static void require(bool is_good, const char *message)
    {
        if (!is_good)
            throw error(SONJECT_ERROR_ARGUMENT, message);
    }
    static void require_samples(span<const double> positions, span<const double> real_part,
                                span<const double> imaginary_part)
    {
        require(real_part.size() == positions.size() &&
                    (imaginary_part.size() == 0 || imaginary_part.size() == positions.size()),
                "a table needs as many samples as positions");
    }
};

} // namespace sonject

#endif
