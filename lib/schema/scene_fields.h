/* How lines of the tables of keys are written. */
#ifndef SONJECT_SCHEMA_SCENE_FIELDS_H
#define SONJECT_SCHEMA_SCENE_FIELDS_H

#include "schema/scene_schema.h"

#define COUNT(fields) (sizeof(fields) / sizeof(fields)[0])

#define MEMBER_OF(structure, its) .member = #its, .offset = offsetof(structure, its)

#define QUANTITY(structure, member, kind_of_quantity)                                              \
    .kind = FIELD_QUANTITY, .quantity = kind_of_quantity, MEMBER_OF(structure, member)
#define COUNT32(structure, member, limit)                                                          \
    .kind = FIELD_COUNT32, MEMBER_OF(structure, member), .maximum = limit
#define COUNT64(structure, member, limit)                                                          \
    .kind = FIELD_COUNT64, MEMBER_OF(structure, member), .maximum = limit
#define WORD(structure, member)  .kind = FIELD_WORD, MEMBER_OF(structure, member), .words
#define LABEL(structure, member) .kind = FIELD_LABEL, MEMBER_OF(structure, member)
#define TEXT(structure, member)  .kind = FIELD_TEXT, MEMBER_OF(structure, member)

/* A section that fills a structure of its own, and one that fills its parent's. */
#define PART(structure, member, table)                                                             \
    .kind = FIELD_SECTION, .offset = offsetof(structure, member), .section = &(table)
#define SAME(table) .kind = FIELD_SECTION, .offset = 0, .section = &(table)

/* A list of at most as many entries as the array holds. word: what one is. */
#define ENTRIES(structure, member, number, word, table)                                            \
    .kind = FIELD_ENTRIES, .is_list = true, .unit = word, .section = &(table),                     \
    .offset = offsetof(structure, member), .count_offset = offsetof(structure, number),            \
    .entry_bytes = sizeof((structure *)0)->member[0],                                              \
    .maximum = sizeof((structure *)0)->member / sizeof((structure *)0)->member[0]

#define REQUIRED .is_required = true

#endif
