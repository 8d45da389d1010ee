/* Texts passed from and to C. */
#ifndef SONJECT_TEXT_HPP
#define SONJECT_TEXT_HPP

#include <string>
#include <vector>

#include <sonject/error.hpp>
#include <sonject/run.h>

namespace sonject
{

namespace detail
{

/* A text that the library made, and that is given back to the library. */
class text
{
  public:
    text() : text_(nullptr)
    {
    }
    text(const text &) = delete;
    text &operator=(const text &) = delete;
    ~text()
    {
        sonject_text_release(&text_);
    }
    char **out() noexcept
    {
        return &text_;
    }
    std::string copy() const
    {
        return text_ ? text_ : "";
    }

  private:
    char *text_;
};

/* Returns a text as C takes it. Throws where C would see only the beginning. */
inline const char *c_text(const std::string &text)
{
    if (text.find('\0') != std::string::npos)
        throw error(SONJECT_ERROR_ARGUMENT, "a text has a character 0, where it would end");
    return text.c_str();
}

/* Makes an array of C texts; the originals must outlive it. */
inline std::vector<const char *> pointers_to(const std::vector<std::string> &texts)
{
    std::vector<const char *> pointers;
    for (const std::string &each : texts)
        pointers.push_back(c_text(each));
    return pointers;
}

} // namespace detail

} // namespace sonject

#endif
