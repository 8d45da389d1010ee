#include "transfer_argument.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "message.h"
#include "number.h"

const char *next_piece(const char *text, char *piece, size_t capacity)
{
    size_t length = strcspn(text, ":");
    snprintf(piece, capacity, "%.*s", (int)(length < capacity ? length : capacity - 1), text);
    return text[length] == ':' ? text + length + 1 : NULL;
}

static bool read_kind(const char *name, uint32_t *kind)
{
    static const char *const names[] = {"amplitude", "intensity", "decibel", "gamma", "schlick"};
    static const uint32_t kinds[] = {SONJECT_TRANSFER_AMPLITUDE, SONJECT_TRANSFER_INTENSITY,
                                     SONJECT_TRANSFER_DECIBEL, SONJECT_TRANSFER_GAMMA,
                                     SONJECT_TRANSFER_SCHLICK};
    for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
        if (strcmp(name, names[i]) == 0) {
            *kind = kinds[i];
            return true;
        }
    }
    return false;
}

bool transfer_parse(const char *verb, const char *text, sonject_transfer_params *transfer)
{
    char kind[64], number[64];
    const char *rest = next_piece(text, kind, sizeof(kind));
    bool is_good = read_kind(kind, &transfer->kind);
    if (is_good && rest) {
        rest = next_piece(rest, number, sizeof(number));
        is_good = number_parse(number, &transfer->parameter);
    }
    if (is_good && rest)
        is_good = number_parse(rest, &transfer->offset);
    if (!is_good)
        message(verb,
                ": --transfer takes amplitude, intensity, decibel:DB[:OFFSET], gamma:EXPONENT or "
                "schlick:B, not \"",
                text, "\"");
    return is_good;
}
