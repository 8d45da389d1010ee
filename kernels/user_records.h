/* What the kernels know of a shape that a user wrote, behind the records of all objects. */
#ifndef SONJECT_KERNELS_USER_RECORDS_H
#define SONJECT_KERNELS_USER_RECORDS_H

#include "record_types.h"

#define USER_PARAMETERS 16

struct user_record {
    RECORD_INT snippet; /* number of the code among the program's */
    RECORD_INT is_open; /* no inside: the normal turns to the side that the ray comes from */
    float parameters[USER_PARAMETERS]; /* 0 beyond those that are given */
};

#endif
