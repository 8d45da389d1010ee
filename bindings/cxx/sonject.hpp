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
SONJECT_CXX_DEFAULTS(sonject_convert_params)
SONJECT_CXX_DEFAULTS(sonject_geometry_params)
SONJECT_CXX_DEFAULTS(sonject_injection_params)
SONJECT_CXX_DEFAULTS(sonject_material_params)
SONJECT_CXX_DEFAULTS(sonject_medium_params)
SONJECT_CXX_DEFAULTS(sonject_merge_params)
SONJECT_CXX_DEFAULTS(sonject_mesh_params)
SONJECT_CXX_DEFAULTS(sonject_object_params)
SONJECT_CXX_DEFAULTS(sonject_part_params)
SONJECT_CXX_DEFAULTS(sonject_quicklook_params)
SONJECT_CXX_DEFAULTS(sonject_relief_params)
SONJECT_CXX_DEFAULTS(sonject_run_params)
SONJECT_CXX_DEFAULTS(sonject_scene_read_params)
SONJECT_CXX_DEFAULTS(sonject_seabed_file_params)
SONJECT_CXX_DEFAULTS(sonject_seabed_params)
SONJECT_CXX_DEFAULTS(sonject_sonar_params)
SONJECT_CXX_DEFAULTS(sonject_surface_params)
SONJECT_CXX_DEFAULTS(sonject_synthetic_params)
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
        std::vector<const char *> texts;
        for (const std::string &override_text : overrides)
            texts.push_back(override_text.c_str());
        check(sonject_scene_read_with(context_, path.c_str(), texts.data(), texts.size(), &params,
                                      &handle_));
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
        char *text = nullptr;
        check(sonject_check(context_, handle_, &text));
        std::string description;
        try {
            description = text;
        } catch (...) {
            sonject_text_release(&text);
            throw;
        }
        sonject_text_release(&text);
        return description;
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
    sonject_context *context_;
    sonject_scene *handle_;
};

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
        std::vector<const char *> texts;
        for (const std::string &override_text : overrides)
            texts.push_back(override_text.c_str());
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
    /* Makes the images that the folder lacks; false if there was nothing left to do. */
    bool run(const sonject_campaign_run_params &params, const progress &callback = progress()) const
    {
        detail::progress_bridge bridge(callback);
        int was_finished = 0;
        const sonject_status status = sonject_campaign_run(
            context_, handle_, &params, bridge.function(), &bridge, &was_finished);
        bridge.rethrow();
        check(status);
        return !was_finished;
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
