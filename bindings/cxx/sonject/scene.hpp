/* Scenes, and what becomes of their files. */
#ifndef SONJECT_SCENE_HPP
#define SONJECT_SCENE_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <sonject/context.hpp>
#include <sonject/elements.h>
#include <sonject/parameters.hpp>
#include <sonject/progress.hpp>
#include <sonject/run.h>
#include <sonject/scene.h>
#include <sonject/scene_content.hpp>
#include <sonject/stages.h>
#include <sonject/text.hpp>

namespace sonject
{

/* Sonar, water, seabed, objects and where the image comes from. */
class scene : public scene_content
{
  public:
    /* An empty one with all defaults. */
    explicit scene(const context &context) : scene_content(context.get(), nullptr)
    {
        check(sonject_scene_create(context_, &handle_));
    }

    /* Reads a scene file; overrides: "key.path=value". */
    scene(const context &context, const std::string &path,
          const std::vector<std::string> &overrides = std::vector<std::string>(),
          const sonject_scene_read_params &params = defaults<sonject_scene_read_params>())
        : scene_content(context.get(), nullptr)
    {
        const std::vector<const char *> texts = detail::pointers_to(overrides);
        check(sonject_scene_read_with(context_, path.c_str(), texts.data(), texts.size(), &params,
                                      &handle_));
    }

    /* Takes over what the C interface made with that context. */
    scene(sonject_context *context, sonject_scene *handle) noexcept : scene_content(context, handle)
    {
    }

    /* Checks the scene against its input and describes the geometry. */
    std::string check() const
    {
        detail::text description;
        check(sonject_check(context_, handle_, description.out()));
        return description.copy();
    }

    /* The scene as text, with all that was set. */
    std::string text() const
    {
        detail::text text;
        check(sonject_scene_text(handle_, text.out()));
        return text.copy();
    }

    /* Does the run on files that the parameters tell, or a shard of it; true if the folder held its
     * finished result already. */
    bool run(const sonject_run_params &params, const progress &callback = progress()) const
    {
        return detail::was_finished(
            context_, callback, [&](sonject_progress_function tell, void *user, int *answer) {
                return sonject_run(context_, handle_, &params, tell, user, answer);
            });
    }

    /* The whole run into the folder. labels: sum of sonject_labels. */
    bool run(const std::string &folder, const progress &callback = progress(),
             std::uint32_t labels = 0) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        params.folder = folder.c_str();
        params.labels = labels;
        return run(params, callback);
    }

    /* Traces shard 1...shards of a run into the folder. */
    void run_shard(const std::string &folder, std::uint32_t shard, std::uint32_t shards,
                   const progress &callback = progress()) const
    {
        sonject_run_params params = defaults<sonject_run_params>();
        params.folder = folder.c_str();
        params.shard_index = shard;
        params.shard_count = shards;
        run(params, callback);
    }

    /* Makes the result of all shards in the folder; true if it was finished already. */
    bool merge(const std::string &folder, const progress &callback = progress()) const
    {
        sonject_merge_params params = defaults<sonject_merge_params>();
        params.folder = folder.c_str();
        return detail::was_finished(
            context_, callback, [&](sonject_progress_function tell, void *user, int *answer) {
                return sonject_merge(context_, handle_, &params, tell, user, answer);
            });
    }

    /* Traces alone, and keeps the impulses in the file, for sonject::form; in export_file, if one
     * is named, as HDF5 arrays for other programs. */
    void trace(const std::string &file, const progress &callback = progress(),
               const std::string &export_file = std::string()) const
    {
        sonject_trace_params params = defaults<sonject_trace_params>();
        params.file = file.c_str();
        params.export_file = export_file.empty() ? nullptr : export_file.c_str();
        detail::tell_progress(context_, callback, [&](sonject_progress_function tell, void *user) {
            return sonject_trace(context_, handle_, &params, tell, user);
        });
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
        params.folder = folder.c_str();
        detail::tell_progress(context_, callback, [&](sonject_progress_function tell, void *user) {
            return sonject_elements_run(context_, handle_, &params, tell, user);
        });
    }

  private:
    using scene_content::check;
};

/* All keys that scenes have, as JSON; see sonject_keys. */
inline std::string keys(const context &context)
{
    detail::text text;
    context.check(sonject_keys(context.get(), text.out()));
    return text.copy();
}

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

} // namespace sonject

#endif
