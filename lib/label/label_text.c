#include "label/label_text.h"

#include <math.h>
#include <string.h>

#include "base/text.h"

void label_text_number(struct growing_text *text, double value)
{
    char digits[40];
    if (isfinite(value))
        growing_text_add(text, "%s", text_of_number(digits, sizeof digits, value, 12));
}

/* U+FFFE and U+FFFF are UTF-8, but no characters of XML. */
static bool is_noncharacter(const char *bytes)
{
    return strncmp(bytes, "\xEF\xBF\xBE", 3) == 0 || strncmp(bytes, "\xEF\xBF\xBF", 3) == 0;
}

void label_text_xml(struct growing_text *text, const char *words)
{
    const bool is_printable = text_is_printable(words);
    for (; *words; words++) {
        const unsigned char byte = (unsigned char)*words;
        if (byte == '&')
            growing_text_add(text, "&amp;");
        else if (byte == '<')
            growing_text_add(text, "&lt;");
        else if (byte == '>')
            growing_text_add(text, "&gt;");
        else if (byte == '"')
            growing_text_add(text, "&quot;");
        else if (!is_printable && (byte < 0x20 || byte >= 0x7F))
            growing_text_add(text, "?");
        else if (is_noncharacter(words)) {
            growing_text_add(text, "?");
            words += 2;
        } else
            growing_text_add(text, "%c", byte);
    }
}

void label_text_csv(struct growing_text *text, const char *words)
{
    growing_text_add(text, *words && strchr("=+-@\t\r", *words) ? "\"'" : "\"");
    for (; *words; words++)
        growing_text_add(text, *words == '"' ? "\"\"" : "%c", *words);
    growing_text_add(text, "\"");
}
