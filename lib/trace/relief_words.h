/* The relief as kernels know it (kernels/relief_records.h). */
#ifndef SONJECT_TRACE_RELIEF_WORDS_H
#define SONJECT_TRACE_RELIEF_WORDS_H

#include <stddef.h>
#include <stdint.h>

#include "scene/relief.h"

/* Four-byte words that it takes: record, heights, slopes, blocks. */
size_t relief_word_count(const struct relief *relief);

/* Writes them. words: room for relief_word_count. */
void relief_words_init(uint32_t *words, const struct relief *relief);

#endif
