/* stochc firmware: controller of the seed plate. See plate.h. */
#include "plate.h"

/* Whether the records of the phases contain retries. */
#define HAS_RETRIES (SA_READ(2) != 1u)

/* Positions in the record of a phase. */
#define REPORTS 0u
#define RETRIES 2u
#define ABORT_REPORTS 4u
#define TIMEOUT 6u
#define PAUSE 10u

#define SEEDS ((uint16_t)(SA_READ(6) | ((uint16_t)SA_READ(7) << 8)))

static bool is_complete(const struct sa_plate *plate) {
    return plate->phase >= SA_READ(3);
}

static bool has_aborted(const struct sa_plate *plate) {
    return (plate->stage & SA_STAGE) != 0u;
}

/* Returns a number in the record of the running phase. */
static uint32_t number(const struct sa_plate *plate, uint8_t offset, uint8_t length) {
    uint16_t at = (uint16_t)(2u * plate->phase);
    uint32_t value = 0;
    uint8_t i;
    if (HAS_RETRIES) {
        at = (uint16_t)(7u * at);
    }
    at = (uint16_t)(10u + at + offset);
    for (i = length; i > 0u; i--) {
        value = (value << 8) | SA_READ((uint16_t)(at + i - 1u));
    }
    return value;
}

/* Returns whether all reports that end the phase or the abort have arrived. */
static bool is_reported(const struct sa_plate *plate) {
    uint8_t needed = has_aborted(plate) ? ABORT_REPORTS : REPORTS;
    return plate->reports >= number(plate, needed, 2);
}

static bool can_abort(const struct sa_plate *plate) {
    return HAS_RETRIES && (plate->aborts < number(plate, RETRIES, 2));
}

static void begin_phase(struct sa_plate *plate, uint8_t phase, uint8_t stage) {
    uint16_t seed;
    plate->phase = phase;
    plate->stage = stage & SA_STAGES;
    plate->reports = 0;
    plate->ticks = 0;
    for (seed = 0; seed < SEEDS; seed++) {
        sa_begin(&plate->seeds[seed], phase, plate->stage);
    }
}

static void count_ticks(struct sa_plate *plate) {
    while ((uint8_t)(port_clock() - plate->clock) >= SA_TICK) {
        plate->clock = (uint8_t)(plate->clock + SA_TICK);
        plate->ticks++;
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
    plate->clock = port_clock();
    plate->aborts = 0;
    begin_phase(plate, 0, 0);
}

bool sa_plate_poll(struct sa_plate *plate) {
    uint16_t seed;
    for (seed = 0; seed < SEEDS; seed++) {
        sa_poll(&plate->seeds[seed]);
        take_message(plate, &plate->seeds[seed]);
    }
    count_ticks(plate);
    if (is_complete(plate)) {
        /* Nothing is left to do. */
    } else if (has_aborted(plate)) {
        if (!is_reported(plate)) {
            plate->ticks = 0;
        } else if (plate->ticks >= number(plate, PAUSE, 4)) {
            begin_phase(plate, plate->phase, (uint8_t)(plate->stage + SA_STAGE));
        } else {
            /* The pause is not over. */
        }
    } else if (is_reported(plate)) {
        plate->aborts = 0;
        begin_phase(plate, (uint8_t)(plate->phase + 1u), 0);
    } else if (can_abort(plate) && (plate->ticks >= number(plate, TIMEOUT, 4))) {
        plate->aborts++;
        begin_phase(plate, plate->phase, (uint8_t)(plate->stage + SA_STAGE));
    } else {
        /* The phase continues. */
    }
    return is_complete(plate);
}
