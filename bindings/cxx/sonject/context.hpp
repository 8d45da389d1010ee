/* Contexts, and calls that need only a context. */
#ifndef SONJECT_CONTEXT_HPP
#define SONJECT_CONTEXT_HPP

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <sonject/context.h>
#include <sonject/convert.h>
#include <sonject/error.hpp>
#include <sonject/parameters.hpp>
#include <sonject/run.h>
#include <sonject/version.h>

namespace sonject
{

/* Called with a line of the log. Must not throw. */
using log = std::function<void(sonject_log_level level, const char *line)>;

/* The options of a context. Empty texts and null handles stand for the defaults. */
struct context_options {
    std::string device_name;
    sonject::log log;
    bool decodes_in_process = false; /* images and HDF5; false: by a child process */
    std::uint32_t threads = 0; /* threads of a launch on the device native; 0: one per processor */
    sonject_run_tasks_function run_tasks = nullptr; /* runs tasks on the host's own threads; must
                                                       not throw */
    void *run_tasks_user = nullptr;
};

/* One device and its compiled kernels. */
class context
{
  public:
    explicit context(context_options options = context_options())
        : log_(new sonject::log(std::move(options.log))), handle_(nullptr)
    {
        sonject_context_params params = defaults<sonject_context_params>();
        params.device_name = options.device_name.empty() ? nullptr : options.device_name.c_str();
        params.decodes_in_process = options.decodes_in_process;
        params.threads = options.threads;
        params.run_tasks = options.run_tasks;
        params.run_tasks_user = options.run_tasks_user;
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

    /* Returns the handle for calls of the C interface. */
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

    void quicklook(const sonject_quicklook_params &params) const
    {
        check(sonject_quicklook(handle_, &params));
    }

    void convert(const sonject_convert_params &params) const
    {
        check(sonject_convert(handle_, &params));
    }

    /* Throws the error that a status of a call on this context stands for. */
    void check(sonject_status status) const
    {
        detail::check(handle_, status);
    }

  private:
    static void tell(void *user, std::uint32_t level, const char *line) noexcept
    {
        (*static_cast<sonject::log *>(user))(static_cast<sonject_log_level>(level), line);
    }
    sonject::log *log_; /* owned, on the heap, so that moving a context keeps its place */
    sonject_context *handle_;
};

/* Returns the library's version, such as "0.1.0". */
inline std::string version()
{
    return sonject_version();
}

} // namespace sonject

#endif
