/* Structures of parameters with the library's defaults. */
#ifndef SONJECT_PARAMETERS_HPP
#define SONJECT_PARAMETERS_HPP

#include <sonject/sonject.h>

namespace sonject
{

/* Returns a structure with its size set and zeros otherwise: the defaults. */
template <typename Structure> Structure defaults()
{
    Structure structure = Structure();
    structure.struct_size = sizeof structure;
    return structure;
}

} // namespace sonject

#endif
