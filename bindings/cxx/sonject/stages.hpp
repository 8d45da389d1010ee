/* Results of earlier traces: of the shards of a run, or of sums in a file. */
#ifndef SONJECT_STAGES_HPP
#define SONJECT_STAGES_HPP

#include <sonject/context.hpp>
#include <sonject/progress.hpp>
#include <sonject/run.h>
#include <sonject/scene.hpp>
#include <sonject/stages.h>

namespace sonject
{

/* Makes the result of all shards in params.folder, and of all bands. traced: the traced scene;
 * nullptr: the scene that the shards keep. Returns true if the result was finished already. */
inline bool merge(const context &context, const sonject_merge_params &params,
                  const scene *traced = nullptr, const progress &callback = progress())
{
    return detail::was_finished(
        context.get(), callback, [&](sonject_progress_function tell, void *user, int *answer) {
            return sonject_merge(context.get(), traced ? traced->get() : nullptr, &params, tell,
                                 user, answer);
        });
}

/* Forms the image of the sums that scene::trace kept, into params.folder. other: a scene that
 * differs as sonject_form allows; nullptr: the scene that the file keeps. Returns true if the
 * result was finished already. */
inline bool form(const context &context, const sonject_form_params &params,
                 const scene *other = nullptr, const progress &callback = progress())
{
    return detail::was_finished(
        context.get(), callback, [&](sonject_progress_function tell, void *user, int *answer) {
            return sonject_form(context.get(), other ? other->get() : nullptr, &params, tell, user,
                                answer);
        });
}

} // namespace sonject

#endif
