#define WIDTH       8
#define MESH_NATIVE mesh_native_wide
#include "mesh_native_one.c"
