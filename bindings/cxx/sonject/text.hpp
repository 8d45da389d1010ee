/* Texts passed from and to C. */
#ifndef SONJECT_TEXT_HPP
#define SONJECT_TEXT_HPP

#include <string>
#include <vector>

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

/* Makes an array of C texts; the originals must outlive it. */
inline std::vector<const char *> pointers_to(const std::vector<std::string> &texts)
{
    std::vector<const char *> pointers;
    for (const std::string &each : texts)
        pointers.push_back(each.c_str());
    return pointers;
}

} // namespace detail

} // namespace sonject

#endif
