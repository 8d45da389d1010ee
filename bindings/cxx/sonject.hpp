/* sonject for C++11 and later: the C interface with owners instead of releases, exceptions instead
 * of statuses, and views of memory that know their size. Header only; link with libsonject.
 *
 *     sonject::context context;
 *     sonject::scene scene(context);
 *     auto geometry = sonject::defaults<sonject_geometry_params>();
 *     geometry.first_slant_range_m = 44.0;
 *     scene.set(geometry);
 *     auto ball = sonject::defaults<sonject_object_params>();
 *     ball.shape = SONJECT_SHAPE_SPHERE;
 *     ball.diameter_m = 0.5;
 *     scene.add(ball);
 *     sonject::result result = sonject::inject(scene, {pixels.data(), rows, columns});
 *     result.layer(SONJECT_LAYER_IMAGE, sonject::span<float>(pixels));
 *
 * Structures, units, ranges and meanings are those of <sonject/...>. What fails throws
 * sonject::error (sonject::cancelled where a progress callback asked to stop) with the library's
 * message; nothing is then changed unless the C function says so. An object of these classes
 * belongs to one thread at a time, and must not outlive the context that it was made with; moving a
 * context is fine. */
#ifndef SONJECT_HPP
#define SONJECT_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <sonject/sonject.h>

namespace sonject
{

/* A failed call: status() and the one-line message. */
class error : public std::runtime_error
{
  public:
    error(sonject_status status, const std::string &message)
        : std::runtime_error(message), status_(status)
    {
    }
    sonject_status status() const noexcept
    {
        return status_;
    }

  private:
    sonject_status status_;
};

/* A progress callback asked to stop; nothing was published. */
class cancelled : public error
{
  public:
    explicit cancelled(const std::string &message) : error(SONJECT_CANCELLED, message)
    {
    }
};

/* Elements in somebody's memory. Takes anything with data() and size(): vectors, arrays, and the
 * spans of later C++. */
template <typename Element> class span
{
  public:
    span() noexcept : data_(nullptr), size_(0)
    {
    }
    span(Element *data, std::size_t size) noexcept : data_(data), size_(size)
    {
    }
    template <typename Container,
              typename = decltype(static_cast<Element *>(std::declval<Container &>().data()))>
    span(Container &container) : data_(container.data()), size_(container.size())
    {
    }
    template <typename Container,
              typename = decltype(static_cast<Element *>(std::declval<const Container &>().data()))>
    span(const Container &container) : data_(container.data()), size_(container.size())
    {
    }
    Element *data() const noexcept
    {
        return data_;
    }
    std::size_t size() const noexcept
    {
        return size_;
    }

  private:
    Element *data_;
    std::size_t size_;
};

/* Called with the finished fraction 0...1 and the stage's name; false cancels. What it throws ends
 * the call and comes out of it. */
using progress = std::function<bool(double fraction, const char *stage)>;

/* Called with a line of news. Must not throw. */
using log = std::function<void(const char *line)>;

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

/* Throws what a status of a call on this context means. */
inline void check(sonject_context *context, sonject_status status)
{
    if (status == SONJECT_CANCELLED)
        throw cancelled(sonject_context_message(context));
    if (status != SONJECT_OK)
        throw error(status, sonject_context_message(context));
}

/* A text that the library made, which it gets back. */
class text
{
  public:
    text() : text_(nullptr)
    {
    }
    text(const text &) = delete;
    text &operator=(const text &) = delete;
    ~text()
    {
        sonject_text_release(&text_);
    }
    char **out() noexcept
    {
        return &text_;
    }
    std::string copy() const
    {
        return text_;
    }

  private:
    char *text_;
};

/* Texts as C takes an array of them; the originals must stay. */
inline std::vector<const char *> pointers_to(const std::vector<std::string> &texts)
{
    std::vector<const char *> pointers;
    for (const std::string &each : texts)
        pointers.push_back(each.c_str());
    return pointers;
}

/* Carries a progress callback through C, and what it throws around it. */
class progress_bridge
{
  public:
    explicit progress_bridge(const progress &callback) : callback_(callback)
    {
    }
    sonject_progress_function function() const
    {
        return callback_ ? &progress_bridge::tell : nullptr;
    }
    void rethrow() const
    {
        if (thrown_)
            std::rethrow_exception(thrown_);
    }

  private:
    static int tell(void *user, double fraction, const char *stage)
    {
        progress_bridge *bridge = static_cast<progress_bridge *>(user);
        try {
            return bridge->callback_(fraction, stage) ? 0 : 1;
        } catch (...) {
            bridge->thrown_ = std::current_exception();
            return 1;
        }
    }
    const progress &callback_;
    std::exception_ptr thrown_;
};

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

/* What a context is made from; empty texts and null handles: the defaults. */
struct context_options {
    std::string device_name;
    std::string cache_folder; /* for compiled programs; uses_cache false: none is kept */
    bool uses_cache = true;
    void *opencl_context = nullptr; /* a host's cl_context and cl_device_id */
    void *opencl_device = nullptr;
    sonject::log log;
};

/* One OpenCL device and what is compiled for it. */
class context
{
  public:
    explicit context(context_options options = context_options())
        : log_(new sonject::log(std::move(options.log))), handle_(nullptr)
    {
        sonject_context_params params;
        sonject_context_params_init(&params);
        params.device_name = options.device_name.empty() ? nullptr : options.device_name.c_str();
        if (!options.uses_cache)
            params.cache_folder = "";
        else if (!options.cache_folder.empty())
            params.cache_folder = options.cache_folder.c_str();
        params.opencl_context = options.opencl_context;
        params.opencl_device = options.opencl_device;
        params.log = *log_ ? &context::tell : nullptr;
        params.log_user = log_;
        const sonject_status status = sonject_context_create(&params, &handle_);
        if (status != SONJECT_OK) {
            delete log_;
            throw error(status, sonject_status_name(status));
        }
    }
    context(context &&other) noexcept : log_(other.log_), handle_(other.handle_)
    {
        other.log_ = nullptr;
        other.handle_ = nullptr;
    }
    context &operator=(context &&other) noexcept
    {
        std::swap(log_, other.log_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    context(const context &) = delete;
    context &operator=(const context &) = delete;
    ~context()
    {
        sonject_context_release(&handle_);
        delete log_;
    }

    /* For calls of the C interface. */
    sonject_context *get() const noexcept
    {
        return handle_;
    }

    std::vector<sonject_device_info> devices() const
    {
        std::size_t count = 0;
        check(sonject_devices(handle_, nullptr, 0, &count));
        std::vector<sonject_device_info> list(count);
        check(sonject_devices(handle_, list.data(), list.size(), &count));
        list.resize(count < list.size() ? count : list.size());
        return list;
    }

    /* Draws an image file as a PNG. */
    void quicklook(const sonject_quicklook_params &params) const
    {
        check(sonject_quicklook(handle_, &params));
    }

    /* Makes a file of one format from a file of another. */
    void convert(const sonject_convert_params &params) const
    {
        check(sonject_convert(handle_, &params));
    }

    /* Writes a synthetic seabed. */
    void write_seabed(const sonject_seabed_file_params &params) const
    {
        check(sonject_seabed_write(handle_, &params));
    }

    /* Throws what a status of a call on this context means. */
    void check(sonject_status status) const
    {
        detail::check(handle_, status);
    }

  private:
    static void tell(void *user, const char *line)
    {
        (*static_cast<sonject::log *>(user))(line);
    }
    sonject::log *log_; /* owned, apart, so that moving keeps its place */
    sonject_context *handle_;
};

/* Sonar, water, seabed, objects and where the image comes from. */
class scene
{
  public:
    /* An empty one with all defaults. */
    explicit scene(const context &context) : context_(context.get()), handle_(nullptr)
    {
        check(sonject_scene_create(context_, &handle_));
    }

    /* Reads a scene file; overrides: "key.path=value". */
    scene(const context &context, const std::string &path,
          const std::vector<std::string> &overrides = std::vector<std::string>(),
          const sonject_scene_read_params &params = defaults<sonject_scene_read_params>())
        : context_(context.get()), handle_(nullptr)
    {
        const std::vector<const char *> texts = detail::pointers_to(overrides);
        check(sonject_scene_read_with(context_, path.c_str(), texts.data(), texts.size(), &params,
                                      &handle_));
    }
    /* Takes over what the C interface made with that context. */
    scene(sonject_context *context, sonject_scene *handle) noexcept
        : context_(context), handle_(handle)
    {
    }
    scene(scene &&other) noexcept : context_(other.context_), handle_(other.handle_)
    {
        other.handle_ = nullptr;
    }
    scene &operator=(scene &&other) noexcept
    {
        std::swap(context_, other.context_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    scene(const scene &) = delete;
    scene &operator=(const scene &) = delete;
    ~scene()
    {
        sonject_scene_release(&handle_);
    }

    sonject_scene *get() const noexcept
    {
        return handle_;
    }
    sonject_context *context_handle() const noexcept
    {
        return context_;
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

    /* Checks the scene against its input and describes the geometry. */
    std::string check() const
    {
        detail::text description;
        check(sonject_check(context_, handle_, description.out()));
        return description.copy();
    }

    /* Does the whole run on files into the folder; true if it was finished already. labels: sum of
     * sonject_labels. */
    bool run(const std::string &folder, const progress &callback = progress(),
             std::uint32_t labels = 0) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        detail::progress_bridge bridge(callback);
        int was_finished = 0;
        params.folder = folder.c_str();
        params.labels = labels;
        const sonject_status status =
            sonject_run(context_, handle_, &params, bridge.function(), &bridge, &was_finished);
        bridge.rethrow();
        check(status);
        return was_finished != 0;
    }

    /* Traces shard 1...shards of a run into the folder. */
    void run_shard(const std::string &folder, std::uint32_t shard, std::uint32_t shards,
                   const progress &callback = progress()) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        detail::progress_bridge bridge(callback);
        params.folder = folder.c_str();
        params.shard_index = shard;
        params.shard_count = shards;
        const sonject_status status =
            sonject_run(context_, handle_, &params, bridge.function(), &bridge, nullptr);
        bridge.rethrow();
        check(status);
    }

    /* Traces alone, and keeps the impulses in the file, for sonject::form. */
    void trace(const std::string &file, const progress &callback = progress()) const
    {
        sonject_trace_params params = defaults<sonject_trace_params>();
        detail::progress_bridge bridge(callback);
        params.file = file.c_str();
        const sonject_status status =
            sonject_trace(context_, handle_, &params, bridge.function(), &bridge);
        bridge.rethrow();
        check(status);
    }

    /* What the series of a patch of rows x columns are; both 0: of the patch that the scene makes.
     */
    sonject_element_layout describe_elements(std::uint64_t rows = 0,
                                             std::uint64_t columns = 0) const
    {
        sonject_element_layout layout = {};
        layout.struct_size = sizeof layout;
        check(sonject_elements_describe(context_, handle_, rows, columns, &layout));
        return layout;
    }
    /* Writes what the array's hydrophones hear of the scene's own input into the folder. */
    void run_elements(const std::string &folder, const progress &callback = progress()) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        detail::progress_bridge bridge(callback);
        params.folder = folder.c_str();
        const sonject_status status =
            sonject_elements_run(context_, handle_, &params, bridge.function(), &bridge);
        bridge.rethrow();
        check(status);
    }

    /* Makes the result of all shards in the folder; true if it was finished already. */
    bool merge(const std::string &folder, const progress &callback = progress()) const
    {
        sonject_merge_params params = defaults<sonject_merge_params>();
        detail::progress_bridge bridge(callback);
        int was_finished = 0;
        params.folder = folder.c_str();
        const sonject_status status =
            sonject_merge(context_, handle_, &params, bridge.function(), &bridge, &was_finished);
        bridge.rethrow();
        check(status);
        return was_finished != 0;
    }

  private:
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
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
    sonject_context *context_;
    sonject_scene *handle_;
};

/* The bands of a scene file that are to be chosen by an override such as "band=low". */
inline std::vector<std::string> bands(
    const context &context, const std::string &path,
    const std::vector<std::string> &overrides = std::vector<std::string>())
{
    const std::vector<const char *> texts = detail::pointers_to(overrides);
    detail::text lines;
    context.check(
        sonject_scene_bands(context.get(), path.c_str(), texts.data(), texts.size(), lines.out()));
    const std::string all = lines.copy();
    std::vector<std::string> names;
    for (std::size_t start = 0; start < all.size();) {
        const std::size_t end = std::min(all.find('\n', start), all.size());
        names.push_back(all.substr(start, end - start));
        start = end + 1;
    }
    return names;
}

/* Forms the image of what scene::trace kept; params.folder gets it. other: a scene that differs in
 * what another image may differ, nullptr: the one that the file keeps. True if the result was
 * finished already. */
inline bool form(const context &context, const sonject_form_params &params,
                 const scene *other = nullptr, const progress &callback = progress())
{
    detail::progress_bridge bridge(callback);
    int was_finished = 0;
    const sonject_status status = sonject_form(context.get(), other ? other->get() : nullptr,
                                               &params, bridge.function(), &bridge, &was_finished);
    bridge.rethrow();
    context.check(status);
    return was_finished != 0;
}

/* A patch in the caller's memory: linear amplitudes, or pairs of real and imaginary part. */
struct pixels {
    pixels(const float *data, std::uint64_t rows, std::uint64_t columns,
           sonject_pixel_kind kind = SONJECT_PIXELS_AMPLITUDE, std::uint64_t row_stride = 0)
        : value()
    {
        value.struct_size = sizeof value;
        value.kind = kind;
        value.rows = rows;
        value.columns = columns;
        value.row_stride = row_stride;
        value.data = data;
    }
    sonject_pixels value;
};

/* What an injection gave. */
class result
{
  public:
    result(sonject_result *handle, sonject_context *context, std::uint32_t objects) noexcept
        : handle_(handle), context_(context), objects_(objects)
    {
    }
    result(result &&other) noexcept
        : handle_(other.handle_), context_(other.context_), objects_(other.objects_)
    {
        other.handle_ = nullptr;
    }
    result &operator=(result &&other) noexcept
    {
        std::swap(handle_, other.handle_);
        std::swap(context_, other.context_);
        std::swap(objects_, other.objects_);
        return *this;
    }
    result(const result &) = delete;
    result &operator=(const result &) = delete;
    ~result()
    {
        sonject_result_release(&handle_);
    }

    sonject_result *get() const noexcept
    {
        return handle_;
    }
    std::uint64_t rows() const
    {
        return size().rows;
    }
    std::uint64_t columns() const
    {
        return size().columns;
    }
    bool is_complex() const
    {
        return size().kind == SONJECT_PIXELS_COMPLEX;
    }

    /* Copies a layer into memory of exactly its size: float for IMAGE (pairs where is_complex),
     * FIELD (pairs), ENERGY and VISIBILITY, std::uint8_t for the masks. */
    template <typename Element> void layer(sonject_layer layer, span<Element> buffer) const
    {
        check(sonject_result_layer(handle_, layer, buffer.data(), buffer.size() * sizeof(Element)));
    }
    std::vector<float> energy() const
    {
        return copy<float>(SONJECT_LAYER_ENERGY, 1);
    }
    std::vector<float> image() const
    {
        return copy<float>(SONJECT_LAYER_IMAGE, is_complex() ? 2 : 1);
    }
    /* A mask: HIGHLIGHT, SHADOW, LABELS or INFLUENCE. */
    std::vector<std::uint8_t> mask(sonject_layer layer) const
    {
        return copy<std::uint8_t>(layer, 1);
    }
    /* Expected energy of the paths that meet `order` surfaces, where the scene asked for it. */
    std::vector<float> order_energy(std::uint32_t order) const
    {
        const measure extent = size();
        std::vector<float> buffer(static_cast<std::size_t>(extent.rows * extent.columns));
        check(sonject_result_order_energy(handle_, order, buffer.data(),
                                          buffer.size() * sizeof(float)));
        return buffer;
    }

    std::uint32_t object_count() const noexcept
    {
        return objects_;
    }
    sonject_object_truth object(std::uint32_t index) const
    {
        sonject_object_truth truth = {};
        truth.struct_size = sizeof truth;
        check(sonject_result_object(handle_, index, &truth));
        return truth;
    }
    sonject_statistics statistics() const
    {
        sonject_statistics numbers = {};
        numbers.struct_size = sizeof numbers;
        check(sonject_result_statistics(handle_, &numbers));
        return numbers;
    }

  private:
    struct measure {
        std::uint64_t rows, columns;
        std::uint32_t kind;
    };
    measure size() const
    {
        measure extent = {0, 0, 0};
        check(sonject_result_size(handle_, &extent.rows, &extent.columns, &extent.kind));
        return extent;
    }
    template <typename Element>
    std::vector<Element> copy(sonject_layer layer, std::size_t parts) const
    {
        const measure extent = size();
        std::vector<Element> buffer(static_cast<std::size_t>(extent.rows * extent.columns) * parts);
        this->layer(layer, span<Element>(buffer));
        return buffer;
    }
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
    sonject_result *handle_;
    sonject_context *context_;
    std::uint32_t objects_;
};

namespace detail
{

inline result inject(const scene &scene, const sonject_pixels *pixels, const progress &callback)
{
    progress_bridge bridge(callback);
    sonject_result *handle = nullptr;
    sonject_context *context = scene.context_handle();
    const std::uint32_t objects = scene.object_count();
    const sonject_status status =
        sonject_inject(context, scene.get(), pixels, bridge.function(), &bridge, &handle);
    bridge.rethrow();
    check(context, status);
    return result(handle, context, objects);
}

} // namespace detail

/* Puts the scene's objects into a patch; see sonject_inject. */
inline result inject(const scene &scene, const pixels &patch, const progress &callback = progress())
{
    return detail::inject(scene, &patch.value, callback);
}

/* The same into the swath that the scene itself makes (uniform or synthetic). */
inline result inject(const scene &scene, const progress &callback = progress())
{
    return detail::inject(scene, nullptr, callback);
}

/* Many injections, drawn from distributions that a campaign file names. */
class campaign
{
  public:
    /* overrides: "key.path=value" of the campaign's keys. */
    campaign(const context &context, const std::string &path,
             const std::vector<std::string> &overrides = std::vector<std::string>(),
             const sonject_campaign_read_params &params = defaults<sonject_campaign_read_params>())
        : context_(context.get()), handle_(nullptr)
    {
        const std::vector<const char *> texts = detail::pointers_to(overrides);
        check(sonject_campaign_read(context_, path.c_str(), texts.data(), texts.size(), &params,
                                    &handle_));
    }
    campaign(campaign &&other) noexcept : context_(other.context_), handle_(other.handle_)
    {
        other.handle_ = nullptr;
    }
    campaign &operator=(campaign &&other) noexcept
    {
        std::swap(context_, other.context_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    campaign(const campaign &) = delete;
    campaign &operator=(const campaign &) = delete;
    ~campaign()
    {
        sonject_campaign_release(&handle_);
    }

    sonject_campaign *get() const noexcept
    {
        return handle_;
    }
    std::uint64_t image_count() const
    {
        std::uint64_t count = 0;
        check(sonject_campaign_image_count(handle_, &count));
        return count;
    }
    sonject_campaign_image describe(std::uint64_t id) const
    {
        sonject_campaign_image image = {};
        image.struct_size = sizeof image;
        check(sonject_campaign_describe(handle_, id, &image));
        return image;
    }
    /* The scene of an image: its input is the swath's file, its patch the image. */
    sonject::scene scene(std::uint64_t id) const
    {
        sonject_scene *made = nullptr;
        check(sonject_campaign_scene(context_, handle_, id, &made));
        return sonject::scene(context_, made);
    }
    /* Makes an image in memory. */
    result inject(std::uint64_t id, const progress &callback = progress()) const
    {
        detail::progress_bridge bridge(callback);
        const std::uint32_t objects = describe(id).object_count;
        sonject_result *made = nullptr;
        const sonject_status status =
            sonject_campaign_inject(context_, handle_, id, bridge.function(), &bridge, &made);
        bridge.rethrow();
        check(status);
        return result(made, context_, objects);
    }
    /* Makes the images that the folder lacks; true if there was nothing left to do. */
    bool run(const sonject_campaign_run_params &params, const progress &callback = progress()) const
    {
        detail::progress_bridge bridge(callback);
        int was_finished = 0;
        const sonject_status status = sonject_campaign_run(
            context_, handle_, &params, bridge.function(), &bridge, &was_finished);
        bridge.rethrow();
        check(status);
        return was_finished != 0;
    }

  private:
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
    sonject_context *context_;
    sonject_campaign *handle_;
};

/* Joins what the shards of a campaign left in a folder; see sonject_campaign_merge. */
inline void merge_campaign(const context &context, const std::string &folder,
                           const progress &callback = progress())
{
    detail::progress_bridge bridge(callback);
    const sonject_status status =
        sonject_campaign_merge(context.get(), folder.c_str(), bridge.function(), &bridge);
    bridge.rethrow();
    context.check(status);
}

/* What the hydrophones of the scene's array hear: pings x hydrophones x samples of
 * scene::describe_elements, in base band pairs of real and imaginary part. */
inline std::vector<float> element_series(const scene &scene, const pixels &patch,
                                         const progress &callback = progress())
{
    const sonject_element_layout layout =
        scene.describe_elements(patch.value.rows, patch.value.columns);
    const sonject_elements_params &elements = layout.elements;
    const std::size_t parts = elements.form == SONJECT_SERIES_BASEBAND ? 2 : 1;
    std::vector<float> series(static_cast<std::size_t>(layout.samples) * elements.hydrophones *
                              elements.pings * parts);
    detail::progress_bridge bridge(callback);
    sonject_context *context = scene.context_handle();
    const sonject_status status =
        sonject_element_series(context, scene.get(), &patch.value, bridge.function(), &bridge,
                               series.data(), series.size() * sizeof(float));
    bridge.rethrow();
    detail::check(context, status);
    return series;
}

/* What an image file says of its seabed and of the seam; see sonject_measure. */
inline sonject_measurement measure(const context &context, const sonject_measure_params &params)
{
    sonject_measurement measurement = {};
    measurement.struct_size = sizeof measurement;
    context.check(sonject_measure(context.get(), &params, &measurement));
    return measurement;
}

/* The same of pixels in memory; masks: rows x columns bytes, or none. */
inline sonject_measurement measure(const context &context, const pixels &image,
                                   span<const std::uint8_t> influence = span<const std::uint8_t>(),
                                   span<const std::uint8_t> labels = span<const std::uint8_t>())
{
    const std::uint64_t size = image.value.rows * image.value.columns;
    sonject_measurement measurement = {};
    measurement.struct_size = sizeof measurement;
    if ((influence.size() && influence.size() != size) || (labels.size() && labels.size() != size))
        throw error(SONJECT_ERROR_ARGUMENT, "a mask needs rows x columns bytes");
    context.check(sonject_measure_pixels(context.get(), &image.value,
                                         influence.size() ? influence.data() : nullptr,
                                         labels.size() ? labels.data() : nullptr, &measurement));
    return measurement;
}

/* Contacts of an image file as JSON; see sonject_measure_contacts. */
inline std::string measure_contacts(const context &context,
                                    const sonject_contact_file_params &params)
{
    detail::text text;
    context.check(sonject_measure_contacts(context.get(), &params, text.out()));
    return text.copy();
}

/* Two such sets compared, as JSON; picture "": none. */
inline std::string compare_contacts(const context &context, const std::string &first,
                                    const std::string &second, const std::string &picture = "")
{
    detail::text text;
    context.check(sonject_compare_contacts(context.get(), first.c_str(), second.c_str(),
                                           picture.empty() ? nullptr : picture.c_str(),
                                           text.out()));
    return text.copy();
}

/* Lengths and levels of a contact; see sonject_measure_contact. */
inline sonject_contact_measures measure_contact(const context &context, const pixels &image,
                                                const sonject_contact_params &params)
{
    sonject_contact_measures measures = {};
    measures.struct_size = sizeof measures;
    detail::check(context.get(),
                  sonject_measure_contact(context.get(), &image.value, &params, &measures));
    return measures;
}

/* The library's version, such as "0.1.0". */
inline std::string version()
{
    return sonject_version();
}

} // namespace sonject

#endif
