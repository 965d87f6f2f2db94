/* stochc firmware: controller of the seed plate. It runs the seeds, counts reports and begins the phases. */
#ifndef SA_PLATE_H
#define SA_PLATE_H

#include "block.h"

struct sa_plate {
    uint8_t phase; /* Running phase, or the number of phases at the end. */
    uint8_t stage; /* Of the phase, as in a block. */
    uint8_t clock; /* When the ticks were last counted. */
    uint16_t reports;
    uint16_t aborts; /* Of the phase. */
    uint32_t ticks;  /* Since the attempt began, or since all blocks of it were released. */
    bool timed_out;  /* Whether a timeout has ended the program. */
    struct sa_block seeds[SA_SEEDS];
};

/* Begins the first phase. The units of the seeds are their roles, 0 to SA_SEEDS - 1. */
void sa_plate_start(struct sa_plate *plate);

/* Works once on everything that has happened. Returns whether the program has ended: all phases are
 * complete, or one has timed out for the last time. */
bool sa_plate_poll(struct sa_plate *plate);

#endif
