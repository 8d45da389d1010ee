/* Parameters, whose zeros are the library's defaults. */
#ifndef SONJECT_PARAMETERS_HPP
#define SONJECT_PARAMETERS_HPP

#include <sonject/sonject.h>

namespace sonject
{

/* A structure with its size, else of zeros: the defaults. */
template <typename Structure> Structure defaults()
{
    Structure structure = Structure();
    structure.struct_size = sizeof structure;
    return structure;
}

} // namespace sonject

#endif
