#define WIDTH          8
#define CLUTTER_SEARCH clutter_search_wide
#include "clutter_search_one.c"
