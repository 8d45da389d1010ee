/* The exceptions that failed calls throw. */
#ifndef SONJECT_ERROR_HPP
#define SONJECT_ERROR_HPP

#include <stdexcept>
#include <string>

#include <sonject/context.h>
#include <sonject/status.h>

namespace sonject
{

/* A failed call: status(), and the message of sonject_context_message. */
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

/* A call that a progress callback asked to stop; nothing was published. */
class cancelled : public error
{
  public:
    explicit cancelled(const std::string &message) : error(SONJECT_CANCELLED, message)
    {
    }
};

namespace detail
{

/* Throws the error that a status of a call on this context stands for. */
inline void check(sonject_context *context, sonject_status status)
{
    if (status == SONJECT_CANCELLED)
        throw cancelled(sonject_context_message(context));
    if (status != SONJECT_OK)
        throw error(status, sonject_context_message(context));
}

} // namespace detail

} // namespace sonject

#endif
