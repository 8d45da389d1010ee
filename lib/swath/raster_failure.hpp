/* How failures pass through raster_*.cpp: as exceptions within, as a status to the outside. */
#ifndef SONJECT_IO_RASTER_FAILURE_HPP
#define SONJECT_IO_RASTER_FAILURE_HPP

#include <exception>
#include <new>
#include <stdexcept>

#include "base/report.h"

namespace raster
{

/* Thrown where a report has the message already. */
struct failure {
    sonject_status status;
};

inline void require(sonject_status status)
{
    if (status != SONJECT_OK)
        throw failure{status};
}

/* Runs work and turns every exception into a status. */
template <typename Work> sonject_status guarded(struct report *report, const char *path, Work work)
{
    try {
        work();
        return SONJECT_OK;
    } catch (const failure &known) {
        return known.status;
    } catch (const std::bad_alloc &) {
        return report_out_of_memory(report, path);
    } catch (const std::length_error &) {
        return report_out_of_memory(report, path);
    } catch (const std::exception &unforeseen) {
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: %s", path, unforeseen.what());
    } catch (...) {
        return report_failure(report, SONJECT_ERROR_INPUT, "%s: cannot be processed", path);
    }
}

} // namespace raster

#endif
