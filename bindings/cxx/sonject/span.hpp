/* Views of memory that know their size. */
#ifndef SONJECT_SPAN_HPP
#define SONJECT_SPAN_HPP

#include <cstddef>
#include <utility>

namespace sonject
{

/* Elements in somebody else's memory. A span is made of anything with data() and size(): vectors,
 * arrays, and the spans of later C++. */
template <typename Element> class span
{
  public:
    span() noexcept : data_(nullptr), size_(0)
    {
    }
    span(Element *data, std::size_t size) noexcept : data_(data), size_(size)
    {
    }
    template <typename Container,
              typename = decltype(static_cast<Element *>(std::declval<Container &>().data()))>
    span(Container &container) : data_(container.data()), size_(container.size())
    {
    }
    template <typename Container,
              typename = decltype(static_cast<Element *>(std::declval<const Container &>().data()))>
    span(const Container &container) : data_(container.data()), size_(container.size())
    {
    }
    Element *data() const noexcept
    {
        return data_;
    }
    std::size_t size() const noexcept
    {
        return size_;
    }

  private:
    Element *data_;
    std::size_t size_;
};

} // namespace sonject

#endif
