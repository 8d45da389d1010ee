/* Campaigns: data sets of many injections. */
#ifndef SONJECT_CAMPAIGN_HPP
#define SONJECT_CAMPAIGN_HPP

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <sonject/campaign.h>
#include <sonject/context.hpp>
#include <sonject/injection.hpp>
#include <sonject/parameters.hpp>
#include <sonject/progress.hpp>
#include <sonject/scene.hpp>
#include <sonject/text.hpp>

namespace sonject
{

/* Many injections, drawn from distributions that a campaign file names. */
class campaign
{
  public:
    /* overrides: "key.path=value" of the campaign's keys. */
    campaign(const context &context, const std::string &path,
             const std::vector<std::string> &overrides = std::vector<std::string>())
        : context_(context.get()), handle_(nullptr)
    {
        const std::vector<const char *> texts = detail::pointers_to(overrides);
        sonject_scene_read_params params = defaults<sonject_scene_read_params>();
        params.overrides = texts.data();
        params.override_count = static_cast<std::uint32_t>(texts.size());
        check(sonject_campaign_read(context_, detail::c_text(path), &params, &handle_));
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
        sonject_campaign_image image = defaults<sonject_campaign_image>();
        check(sonject_campaign_describe(handle_, id, &image));
        return image;
    }
    /* Makes the scene of an image; its input is the swath's file, its patch the image. */
    sonject::scene scene(std::uint64_t id) const
    {
        sonject_scene *made = nullptr;
        check(sonject_campaign_scene(context_, handle_, id, &made));
        return sonject::scene(context_, made);
    }
    /* Makes an image in memory. */
    result inject(std::uint64_t id, const progress &callback = progress()) const
    {
        return detail::make_result(
            context_, describe(id).object_count, callback,
            [&](sonject_progress_function tell, void *user, sonject_result **made) {
                return sonject_campaign_inject(context_, handle_, id, tell, user, made);
            });
    }
    /* Makes the images that the folder lacks. Returns true if nothing was left to do. */
    bool run(const sonject_campaign_run_params &params, const progress &callback = progress()) const
    {
        return detail::was_finished(
            context_, callback, [&](sonject_progress_function tell, void *user, int *answer) {
                return sonject_campaign_run(context_, handle_, &params, tell, user, answer);
            });
    }

  private:
    void check(sonject_status status) const
    {
        detail::check(context_, status);
    }
    sonject_context *context_;
    sonject_campaign *handle_;
};

/* Joins the shards of a campaign in a folder; see sonject_campaign_merge. */
inline void merge_campaign(const context &context, const std::string &folder,
                           const progress &callback = progress())
{
    detail::tell_progress(context.get(), callback, [&](sonject_progress_function tell, void *user) {
        return sonject_campaign_merge(context.get(), detail::c_text(folder), tell, user);
    });
}

/* Writes a campaign file whose targets measure as real contacts do; see sonject_campaign_fit.
 * reading: overrides, and whether code is allowed; nullptr: neither. */
inline void fit_campaign(const context &context, const std::string &path,
                         const sonject_campaign_fit_params &params,
                         const sonject_scene_read_params *reading = nullptr,
                         const progress &callback = progress())
{
    detail::tell_progress(context.get(), callback, [&](sonject_progress_function tell, void *user) {
        return sonject_campaign_fit(context.get(), detail::c_text(path), reading, &params, tell,
                                    user);
    });
}

} // namespace sonject

#endif
