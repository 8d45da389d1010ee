/* Scenes, and runs of them. */
#ifndef SONJECT_SCENE_HPP
#define SONJECT_SCENE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <locale>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <sonject/context.hpp>
#include <sonject/elements.h>
#include <sonject/error.hpp>
#include <sonject/parameters.hpp>
#include <sonject/progress.hpp>
#include <sonject/run.h>
#include <sonject/scene.h>
#include <sonject/span.hpp>
#include <sonject/stages.h>
#include <sonject/text.hpp>

namespace sonject
{

/* Sonar, water, seabed, objects and where the image comes from, by the keys of scene files. */
class scene
{
  public:
    /* Makes an empty scene. */
    explicit scene(const context &context) : context_(context.get()), handle_(nullptr)
    {
        check(sonject_scene_create(context_, &handle_));
    }

    /* Reads a scene file. overrides: "key.path=value"; they replace those of params. */
    scene(const context &context, const std::string &path,
          const std::vector<std::string> &overrides = std::vector<std::string>(),
          sonject_scene_read_params params = defaults<sonject_scene_read_params>())
        : context_(context.get()), handle_(nullptr)
    {
        const std::vector<const char *> texts = detail::pointers_to(overrides);
        params.overrides = texts.data();
        params.override_count = static_cast<std::uint32_t>(texts.size());
        check(sonject_scene_read(context_, detail::c_text(path), &params, &handle_));
    }

    /* Takes over a handle that the C interface made with that context. */
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

    /* Sets a key of the scene, one of tools/scenes/KEYS.md: "sonar.altitude", "10 m". */
    void set(const std::string &key, const std::string &value)
    {
        check(sonject_scene_set(handle_, detail::c_text(key), detail::c_text(value)));
    }
    /* Sets a key to a number in its SI unit (angles: degrees), with all digits. */
    void set(const std::string &key, double value)
    {
        std::ostringstream text;
        text.imbue(std::locale::classic()); /* a host's locale may have a decimal comma */
        text.precision(17);
        text << value;
        set(key, text.str());
    }
    /* Sets a key to a whole number, such as a seed, or to true or false. */
    template <typename T, typename = typename std::enable_if<std::is_integral<T>::value>::type>
    void set(const std::string &key, T value)
    {
        set(key, std::is_same<T, bool>::value ? std::string(value ? "true" : "false")
                                              : std::to_string(value));
    }
    /* Sets a key to numbers instead of a table's file: rows of the columns that are named,
     * separated by commas. Heights have no names: columns is empty, column_count counts. See
     * sonject_scene_set_table. */
    void set_table(const std::string &key, const std::string &columns, span<const double> values,
                   std::size_t column_count = 0)
    {
        if (!columns.empty())
            column_count =
                1 + static_cast<std::size_t>(std::count(columns.begin(), columns.end(), ','));
        if (column_count == 0 || values.size() % column_count != 0)
            throw error(SONJECT_ERROR_ARGUMENT, "a table needs whole rows of its columns");
        check(sonject_scene_set_table(handle_, detail::c_text(key),
                                      columns.empty() ? nullptr : detail::c_text(columns),
                                      values.data(), values.size() / column_count, column_count));
    }
    /* Returns the value of a key as JSON, such as "10.0", or "null" if the scene does not set it.
     * The key "" is the whole scene. See sonject_scene_get. */
    std::string get(const std::string &key) const
    {
        detail::text json;
        check(sonject_scene_get(handle_, detail::c_text(key), json.out()));
        return json.copy();
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

    /* Returns the scene as a text, with all that was set. */
    std::string text() const
    {
        detail::text text;
        check(sonject_scene_text(handle_, text.out()));
        return text.copy();
    }

    /* Runs on files as the parameters say, wholly or a shard. Returns true if the folder held the
     * finished result already. */
    bool run(const sonject_run_params &params, const progress &callback = progress()) const
    {
        return detail::was_finished(
            context_, callback, [&](sonject_progress_function tell, void *user, int *answer) {
                return sonject_run(context_, handle_, &params, tell, user, answer);
            });
    }

    /* Makes the whole run into the folder. labels: sum of sonject_labels. */
    bool run(const std::string &folder, const progress &callback = progress(),
             std::uint32_t labels = 0) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        params.folder = detail::c_text(folder);
        params.labels = labels;
        return run(params, callback);
    }

    /* Traces shard 1...shards of a run into the folder. */
    void run_shard(const std::string &folder, std::uint32_t shard, std::uint32_t shards,
                   const progress &callback = progress()) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        params.folder = detail::c_text(folder);
        params.shard_index = shard;
        params.shard_count = shards;
        run(params, callback);
    }

    /* Makes the result of all shards in the folder. Returns true if it was finished already. */
    bool merge(const std::string &folder, const progress &callback = progress()) const
    {
        sonject_merge_params params = defaults<sonject_merge_params>();
        params.folder = detail::c_text(folder);
        return detail::was_finished(
            context_, callback, [&](sonject_progress_function tell, void *user, int *answer) {
                return sonject_merge(context_, handle_, &params, tell, user, answer);
            });
    }

    /* Traces and keeps the sums in the file, for sonject::form. */
    void trace(const std::string &file, const progress &callback = progress()) const
    {
        detail::tell_progress(context_, callback, [&](sonject_progress_function tell, void *user) {
            return sonject_trace(context_, handle_, detail::c_text(file), tell, user);
        });
    }

    /* Describes the series of a patch of rows x columns; both 0: of the patch that the scene makes.
     */
    sonject_element_layout describe_elements(std::uint64_t rows = 0,
                                             std::uint64_t columns = 0) const
    {
        sonject_element_layout layout = defaults<sonject_element_layout>();
        check(sonject_elements_describe(context_, handle_, rows, columns, &layout));
        return layout;
    }

    /* Writes the series of the array's hydrophones, for the scene's own input, into the folder. */
    void run_elements(const std::string &folder, const progress &callback = progress()) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        params.folder = detail::c_text(folder);
        detail::tell_progress(context_, callback, [&](sonject_progress_function tell, void *user) {
            return sonject_elements_run(context_, handle_, &params, tell, user);
        });
    }

    /* Writes the synthetic seabed that is the scene's input. */
    void write_seabed(const std::string &path) const
    {
        check(sonject_seabed_write(context_, handle_, detail::c_text(path)));
    }

  private:
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
    sonject_context *context_;
    sonject_scene *handle_;
};

/* Reads a scene from a text, YAML or JSON. name: for messages, and for resolving file names. */
inline scene scene_of_text(const context &context, const std::string &text,
                           const std::string &name = "scene")
{
    sonject_scene_read_params params = defaults<sonject_scene_read_params>();
    params.text = detail::c_text(text);
    return scene(context, name, std::vector<std::string>(), params);
}

/* Returns all keys of a kind of files as JSON; see sonject_keys. */
inline std::string keys(const context &context, sonject_keys_of of = SONJECT_KEYS_OF_SCENES)
{
    detail::text text;
    context.check(sonject_keys(context.get(), of, text.out()));
    return text.copy();
}

/* Returns the bands of a scene file from which an override such as "band=low" must choose. */
inline std::vector<std::string> bands(
    const context &context, const std::string &path,
    const std::vector<std::string> &overrides = std::vector<std::string>())
{
    const std::vector<const char *> texts = detail::pointers_to(overrides);
    sonject_scene_read_params params = defaults<sonject_scene_read_params>();
    detail::text lines;
    params.overrides = texts.data();
    params.override_count = static_cast<std::uint32_t>(texts.size());
    context.check(sonject_scene_bands(context.get(), detail::c_text(path), &params, lines.out()));
    const std::string all = lines.copy();
    std::vector<std::string> names;
    for (std::size_t start = 0; start < all.size();) {
        const std::size_t end = std::min(all.find('\n', start), all.size());
        names.push_back(all.substr(start, end - start));
        start = end + 1;
    }
    return names;
}

} // namespace sonject

#endif
