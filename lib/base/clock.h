/* Wall-clock time for reports. */
#ifndef SONJECT_BASE_CLOCK_H
#define SONJECT_BASE_CLOCK_H

/* Seconds since some fixed moment; for differences. */
double clock_seconds(void);

#endif
