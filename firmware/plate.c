/* stochc firmware: controller of the seed plate. See plate.h. */
#include "plate.h"

/* Position and length of the records of the phases, and positions in a record. */
#define PHASES 10u
#define PHASE_LENGTH 18u
#define REPORTS 0u
#define RETRIES 2u
#define ABORT_REPORTS 4u
#define TIMEOUT 6u
#define PAUSE 10u
#define WAIT 14u

#define SEEDS ((uint16_t)(SA_READ(6) | ((uint16_t)SA_READ(7) << 8)))

static bool has_ended(const struct sa_plate *plate) {
    return plate->phase >= SA_READ(3);
}

static bool has_aborted(const struct sa_plate *plate) {
    return (plate->stage & SA_STAGE) != 0u;
}

/* Returns a number in the record of the running phase. */
static uint32_t number(const struct sa_plate *plate, uint8_t offset, uint8_t length) {
    uint16_t at = (uint16_t)(PHASES + (PHASE_LENGTH * plate->phase) + offset);
    uint32_t value = 0;
    uint8_t i;
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
    return plate->aborts < number(plate, RETRIES, 2);
}

/* Returns whether a time of the program is over. */
static bool is_over(const struct sa_plate *plate, uint8_t offset) {
    return plate->ticks >= number(plate, offset, 4);
}

static bool is_late(const struct sa_plate *plate) {
    return (number(plate, TIMEOUT, 4) != 0u) && is_over(plate, TIMEOUT);
}

static void begin_phase(struct sa_plate *plate, uint8_t phase, uint8_t stage) {
    uint16_t seed;
    plate->phase = phase;
    plate->stage = stage & SA_STAGES;
    plate->reports = 0;
    plate->ticks = 0;
    plate->clock = port_clock();
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
    plate->aborts = 0;
    plate->timed_out = false;
    begin_phase(plate, 0, 0);
}

bool sa_plate_poll(struct sa_plate *plate) {
    uint16_t seed;
    for (seed = 0; seed < SEEDS; seed++) {
        sa_poll(&plate->seeds[seed]);
        take_message(plate, &plate->seeds[seed]);
    }
    count_ticks(plate);
    if (has_ended(plate)) {
        /* Nothing is left to do. */
    } else if (has_aborted(plate)) {
        if (!is_reported(plate)) {
            plate->ticks = 0;
        } else if (is_over(plate, PAUSE)) {
            begin_phase(plate, plate->phase, (uint8_t)(plate->stage + SA_STAGE));
        } else {
            /* The pause is not over. */
        }
    } else if (is_reported(plate) && is_over(plate, WAIT)) {
        plate->aborts = 0;
        begin_phase(plate, (uint8_t)(plate->phase + 1u), 0);
    } else if (!is_late(plate)) {
        /* The phase continues. */
    } else if (can_abort(plate)) {
        plate->aborts++;
        begin_phase(plate, plate->phase, (uint8_t)(plate->stage + SA_STAGE));
    } else {
        /* All faces that wait are switched off, and all captured blocks remain. */
        plate->timed_out = true;
        begin_phase(plate, SA_READ(3), 0);
    }
    return has_ended(plate);
}
