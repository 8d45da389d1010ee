/* Progress callbacks, and the exceptions that they throw. */
#ifndef SONJECT_PROGRESS_HPP
#define SONJECT_PROGRESS_HPP

#include <exception>
#include <functional>

#include <sonject/error.hpp>
#include <sonject/status.h>

namespace sonject
{

/* Called with the finished fraction 0...1 and the stage's name; false cancels. An exception of the
 * callback ends the call, which throws it on. */
using progress = std::function<bool(double fraction, const char *stage)>;

namespace detail
{

/* Carries a progress callback through C, and its exceptions around C. */
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

/* Makes a call that tells its progress: call(function, user) returns the status. Throws the
 * callback's exception, or the error that the status stands for. */
template <typename Call>
void tell_progress(sonject_context *context, const progress &callback, const Call &call)
{
    progress_bridge bridge(callback);
    const sonject_status status = call(bridge.function(), static_cast<void *>(&bridge));
    bridge.rethrow();
    check(context, status);
}

/* Makes a call that tells its progress, too, and returns whether its result was finished before. */
template <typename Call>
bool was_finished(sonject_context *context, const progress &callback, const Call &call)
{
    int answer = 0;
    tell_progress(context, callback, [&](sonject_progress_function tell, void *user) {
        return call(tell, user, &answer);
    });
    return answer != 0;
}

} // namespace detail

} // namespace sonject

#endif
