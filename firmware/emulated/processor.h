/* Functions that a processor provides to port.c. */
#ifndef SA_PROCESSOR_H
#define SA_PROCESSOR_H

#include <stdint.h>

/* Starts the serial line and the clock. */
void processor_start(void);
/* Returns the next byte of the serial line, or -1. */
int16_t processor_read(void);
/* Sends a byte to the serial line. Waits until there is room for it. */
void processor_write(uint8_t byte);
/* Stops until the next tick. */
void processor_rest(void);

#endif
