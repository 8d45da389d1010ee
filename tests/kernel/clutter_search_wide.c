#define WIDTH          16
#define CLUTTER_SEARCH clutter_search_wide
#include "clutter_search_one.c"
