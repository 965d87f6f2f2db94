/* stochc firmware: controller of the seed plate. See plate.h. */
#include "plate.h"

#define SEEDS ((uint16_t)(SA_READ(6) | ((uint16_t)SA_READ(7) << 8)))

static bool is_complete(const struct sa_plate *plate) {
    return plate->phase >= SA_READ(3);
}

static uint16_t reports_needed(const struct sa_plate *plate) {
    uint16_t at = (uint16_t)(8u + (2u * plate->phase));
    return (uint16_t)(SA_READ(at) | ((uint16_t)SA_READ((uint16_t)(at + 1u)) << 8));
}

static void begin_phase(struct sa_plate *plate, uint8_t phase) {
    uint16_t seed;
    plate->phase = phase;
    plate->reports = 0;
    for (seed = 0; seed < SEEDS; seed++) {
        sa_begin(&plate->seeds[seed], phase);
    }
}

/* Takes the message of a seed to the plate or to another seed. */
static void take_message(struct sa_plate *plate, struct sa_block *seed) {
    struct sa_message *message = &seed->up;
    bool taken = true;
    if (message->kind == (uint8_t)SA_REPORT) {
        plate->reports++;
    } else if (message->kind == (uint8_t)SA_NOTIFY) {
        uint16_t root = sa_root(message->node, plate->phase);
        if ((root < SEEDS) && (&plate->seeds[root] != seed)) {
            taken = sa_deliver(&plate->seeds[root], message->node, message->detail);
        }
    } else {
        /* A seed is never released. */
    }
    if (taken) {
        message->kind = SA_NONE;
    }
}

void sa_plate_start(struct sa_plate *plate) {
    uint16_t seed;
    for (seed = 0; seed < SEEDS; seed++) {
        sa_seed(&plate->seeds[seed], seed, seed);
    }
    begin_phase(plate, 0);
}

bool sa_plate_poll(struct sa_plate *plate) {
    uint16_t seed;
    for (seed = 0; seed < SEEDS; seed++) {
        sa_poll(&plate->seeds[seed]);
        take_message(plate, &plate->seeds[seed]);
    }
    if (!is_complete(plate) && (plate->reports >= reports_needed(plate))) {
        begin_phase(plate, (uint8_t)(plate->phase + 1u));
    }
    return is_complete(plate);
}
