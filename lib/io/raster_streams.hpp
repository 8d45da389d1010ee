/* Files as OpenImageIO's decoders and encoders see them. */
#ifndef SONJECT_IO_RASTER_STREAMS_HPP
#define SONJECT_IO_RASTER_STREAMS_HPP

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string>

#include <OpenImageIO/filesystem.h>

#include "io/byte_file.h"

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

/* Parts of a file as if there were nothing between them. */
class file_view final : public OIIO::Filesystem::IOProxy
{
  public:
    /* parts must stay where they are */
    file_view(const std::string &path, const struct byte_ranges &chosen)
        : IOProxy(path, Read), parts(chosen), file(byte_file_open(path.c_str(), &file_bytes))
    {
        for (size_t i = 0; i < parts.count; i++)
            total += parts.list[i].count;
    }
    ~file_view() override
    {
        if (file)
            std::fclose(file);
    }
    file_view(const file_view &) = delete;
    file_view &operator=(const file_view &) = delete;

    const char *proxytype() const override
    {
        return "view";
    }
    int64_t tell() override
    {
        return position;
    }
    bool seek(int64_t offset) override
    {
        position = offset;
        return offset >= 0;
    }
    size_t read(void *bytes, size_t count) override
    {
        const size_t got = pread(bytes, count, position);
        position += int64_t(got);
        return got;
    }
    size_t pread(void *bytes, size_t count, int64_t offset) override
    {
        unsigned char *to = static_cast<unsigned char *>(bytes);
        size_t got = 0;
        uint64_t start = uint64_t(offset);
        for (size_t i = 0; file && i < parts.count && got < count; i++) {
            const struct byte_range &part = parts.list[i];
            if (start >= part.count) {
                start -= part.count;
                continue;
            }
            const uint64_t left = part.count - start;
            const size_t some = left < count - got ? size_t(left) : count - got;
            if (!byte_file_read(file, part.place + start, to + got, some))
                break;
            got += some;
            start = 0;
        }
        return got;
    }
    size_t size() const override
    {
        return size_t(total);
    }

  private:
    const struct byte_ranges &parts;
    uint64_t file_bytes = 0;
    std::FILE *file;
    uint64_t total = 0;
    int64_t position = 0;
};

} // namespace raster

#endif
