/* Files as OpenImageIO's encoders see them. */
#ifndef SONJECT_IO_RASTER_STREAMS_HPP
#define SONJECT_IO_RASTER_STREAMS_HPP

#include <cerrno>
#include <cstdint>
#include <cstdio>

#include <OpenImageIO/filesystem.h>

namespace raster
{

/* Where encoders write to. They must not learn of a failure, for they would print it or end the
 * process: the bytes are dropped, and whoever drives the encoder asks for the error. */
class file_sink final : public OIIO::Filesystem::IOProxy
{
  public:
    explicit file_sink(const char *path)
        : IOProxy(path, Write), file(std::fopen(path, "wb")), error_number(file ? 0 : errno)
    {
    }
    ~file_sink() override
    {
        finish();
    }
    file_sink(const file_sink &) = delete;
    file_sink &operator=(const file_sink &) = delete;

    /* not "file": OpenImageIO would take this for a proxy of its own and look for a FILE in it */
    const char *proxytype() const override
    {
        return "sink";
    }
    int64_t tell() override
    {
        return position;
    }
    bool seek(int64_t offset) override
    {
        position = offset;
        if (file && error_number == 0)
            check(fseeko(file, offset, SEEK_SET) == 0);
        return true;
    }
    size_t write(const void *bytes, size_t count) override
    {
        if (file && error_number == 0)
            check(std::fwrite(bytes, 1, count, file) == count);
        position += int64_t(count);
        end = position > end ? position : end;
        return count;
    }
    size_t size() const override
    {
        return size_t(end);
    }

    /* 0, or the errno of the first failure. */
    int error_so_far() const
    {
        return error_number;
    }
    int finish()
    {
        if (file && std::fclose(file) != 0)
            check(false);
        file = nullptr;
        return error_number;
    }

  private:
    void check(bool is_good)
    {
        if (!is_good && error_number == 0)
            error_number = errno != 0 ? errno : EIO;
    }

    std::FILE *file;
    int error_number;
    int64_t position = 0;
    int64_t end = 0;
};

} // namespace raster

#endif
