/* Messages on the standard error output. */
#ifndef SONJECT_TOOLS_MESSAGE_H
#define SONJECT_TOOLS_MESSAGE_H

/* Prints "sonject: ", the texts up to a NULL, and a newline, as one line whatever the texts hold.
 */
#define message(...) message_line((const char *const[]){__VA_ARGS__, NULL})

void message_line(const char *const *texts);

#endif
