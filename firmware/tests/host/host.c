/* Runs one interpreter per block, with bytes between them, as a test tells it on the standard input. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plate.h"

#ifdef SMALL
#define QUEUE 64u
#else
#define QUEUE 512u
#endif
/* Most stored states. */
#define SLOTS 4096u

struct contact {
    int unit; /* -1 without a neighbour */
    uint8_t face;
    uint8_t mark;
    bool holds;
    bool is_mute; /* All bytes sent here are lost. */
};

struct queue {
    uint8_t bytes[QUEUE];
    unsigned first;
    unsigned count;
};

uint8_t sa_program[65536];

static struct sa_plate plate;
static struct sa_block *blocks;
static struct contact *contacts;
static struct queue *queues;
static unsigned seeds;
static unsigned units;
static unsigned loss; /* of each byte [1/1000] */
static unsigned noise; /* bytes per poll [1/1000] */
static uint32_t now;
static uint32_t told; /* time that the test has been told */
static uint8_t phase; /* of the plate, as told */
static uint8_t stage;
static uint64_t state;
static unsigned waiting_most;
static unsigned plate_waiting_most;
static bool busy;
static uint8_t late; /* ticks that the clock is ahead */
static uint8_t *slots[SLOTS];

static unsigned draw(unsigned below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)((state >> 33) % below);
}

static struct sa_block *block_of(unsigned unit) {
    return unit < seeds ? &plate.seeds[unit] : &blocks[unit - seeds];
}

static struct contact *contact_of(unsigned unit, uint8_t face) {
    return &contacts[unit * SA_FACES + face];
}

static void put(unsigned unit, uint8_t face, uint8_t byte) {
    struct queue *queue = &queues[unit * SA_FACES + face];
    if (queue->count < QUEUE) {
        queue->bytes[(queue->first + queue->count) % QUEUE] = byte;
        queue->count++;
    }
}

static void note_time(void) {
    if (now != told) {
        printf("@ %u\n", now);
        told = now;
    }
}

/* Tells what the plate has begun. */
static void note_plate(void) {
    if (plate.phase != phase || plate.stage != stage) {
        busy = true;
        note_time();
        if (plate.timed_out) {
            printf("E\n");
        } else if (plate.phase != phase) {
            printf("P %u\n", plate.phase);
        } else {
            printf((plate.stage & SA_STAGE) != 0 ? "A\n" : "Y\n");
        }
        phase = plate.phase;
        stage = plate.stage;
    }
}

void port_attract(uint16_t unit, uint8_t face) {
    busy = true;
    note_time();
    printf("O %u %u\n", unit, face);
}

void port_release(uint16_t unit, uint8_t face) {
    struct contact *contact = contact_of(unit, face);
    note_plate();
    busy = true;
    note_time();
    if (contact->holds) {
        struct contact *other = contact_of((unsigned)contact->unit, contact->face);
        printf("C %u %u\n", unit, face);
        other->unit = -1;
        contact->unit = -1;
        contact->holds = false;
    } else {
        printf("F %u %u\n", unit, face);
    }
}

static void mute(FILE *in) {
    unsigned unit, face, is_mute;
    if (fscanf(in, "%u %u %u", &unit, &face, &is_mute) != 3) {
        exit(2);
    }
    contact_of(unit, (uint8_t)face)->is_mute = is_mute != 0;
}

bool port_docked(uint16_t unit, uint8_t face) {
    return contact_of(unit, face)->holds;
}

uint8_t port_mark(uint16_t unit, uint8_t face) {
    return contact_of(unit, face)->mark;
}

void port_send(uint16_t unit, uint8_t face, uint8_t byte) {
    const struct contact *contact = contact_of(unit, face);
    if (contact->unit < 0 || contact->is_mute) {
        return;
    }
    if (loss > 0 && draw(1000) < loss) {
        if (draw(2) == 0) {
            return;
        }
        byte = (uint8_t)(byte ^ (1u << draw(8)));
    }
    put((unsigned)contact->unit, contact->face, byte);
}

int16_t port_receive(uint16_t unit, uint8_t face) {
    struct queue *queue = &queues[unit * SA_FACES + face];
    int16_t byte = -1;
    if (noise > 0 && draw(1000) < noise) {
        /* Delimiters are the likeliest to do harm. */
        return (int16_t)(draw(4) == 0 ? 0x7E : draw(256));
    }
    if (queue->count > 0) {
        byte = queue->bytes[queue->first];
        queue->first = (queue->first + 1) % QUEUE;
        queue->count--;
    }
    return byte;
}

uint8_t port_clock(void) {
    return (uint8_t)(now + late);
}

static void poll_plate(void) {
    unsigned seed;
    (void)sa_plate_poll(&plate);
    note_plate();
    for (seed = 0; seed < seeds; seed++) {
        if (plate.seeds[seed].waiting_count > plate_waiting_most) {
            plate_waiting_most = plate.seeds[seed].waiting_count;
        }
    }
}

/* Ends all times that a block or the plate waits for. */
static void end_times(unsigned unit) {
    if (unit < seeds) {
        plate.ticks = UINT32_MAX;
    } else if (block_of(unit)->delay > 1) {
        block_of(unit)->delay = 1;
    }
}

static void poll_block(unsigned number) {
    sa_poll(&blocks[number]);
    if (blocks[number].waiting_count > waiting_most) {
        waiting_most = blocks[number].waiting_count;
    }
}

/* Polls the plate or a block, drawn at random. */
static void poll_one(void) {
    unsigned which = draw(units - seeds + 1);
    if (which == 0) {
        poll_plate();
    } else {
        poll_block(which - 1);
    }
    if (draw(units - seeds + 1) == 0) {
        now++;
    }
}

static bool is_quiet(void) {
    unsigned unit;
    uint8_t face;
    for (unit = 0; unit < units; unit++) {
        const struct sa_block *block = block_of(unit);
        if (block->up.kind != SA_NONE || block->down.kind != SA_NONE) {
            return false;
        }
        for (face = 0; face < SA_FACES; face++) {
            if (block->faces[face].sending != SA_NONE || queues[unit * SA_FACES + face].count > 0) {
                return false;
            }
        }
    }
    return true;
}

/* Polls all once. */
static void poll_all(void) {
    unsigned number;
    poll_plate();
    for (number = 0; number < units - seeds; number++) {
        poll_block(number);
    }
    now++;
}

/* Polls all until nothing is in transit and nothing happens for some rounds. */
static void settle(void) {
    unsigned idle = 0;
    unsigned left = 20000;
    unsigned quiet = noise;
    noise = 0;
    do {
        busy = false;
        poll_all();
        left--;
        idle = busy || !is_quiet() ? 0 : idle + 1;
    } while (left > 0 && idle < 4);
    noise = quiet;
    if (left == 0) {
        printf("! does not settle\n");
    }
}

static void show(void) {
    unsigned unit;
    uint8_t face;
    for (unit = 0; unit < units; unit++) {
        const struct sa_block *block = block_of(unit);
        if (sa_role(block) == SA_NO_ROLE) {
            continue;
        }
        printf("B %u %u %u", unit, sa_role(block), block->phase);
        for (face = 0; face < SA_FACES; face++) {
            printf(" %u", block->direction[face]);
        }
        for (face = 0; face < SA_FACES; face++) {
            printf(" %u", block->faces[face].state);
        }
        printf("\n");
    }
}

static void load(FILE *in) {
    unsigned length;
    unsigned i;
    unsigned long seed;
    if (fscanf(in, "%u %u %u %u %lu %u", &seeds, &units, &loss, &noise, &seed, &length) != 6) {
        exit(2);
    }
    state = seed;
    memset(sa_program, 0, sizeof sa_program);
    for (i = 0; i < length; i++) {
        unsigned byte;
        if (fscanf(in, "%2x", &byte) != 1) {
            exit(2);
        }
        sa_program[i] = (uint8_t)byte;
    }
    free(blocks);
    free(contacts);
    free(queues);
    for (i = 0; i < SLOTS; i++) {
        free(slots[i]);
        slots[i] = NULL;
    }
    memset(&plate, 0, sizeof plate);
    blocks = calloc(units - seeds + 1, sizeof *blocks);
    contacts = calloc((size_t)units * SA_FACES, sizeof *contacts);
    queues = calloc((size_t)units * SA_FACES, sizeof *queues);
    if (blocks == NULL || contacts == NULL || queues == NULL) {
        exit(3);
    }
    for (i = 0; i < units * SA_FACES; i++) {
        contacts[i].unit = -1;
    }
    now = 0;
    told = 0;
    phase = 0;
    stage = 0;
    waiting_most = 0;
    plate_waiting_most = 0;
    for (i = seeds; i < units; i++) {
        sa_start(block_of(i), (uint16_t)i);
    }
    sa_plate_start(&plate);
}

/* Clears everything that has no effect any more, so that equal states have equal bytes. */
static void normalize(void) {
    unsigned unit, i;
    uint8_t at;
    plate.ticks = 0;
    plate.clock = 0;
    for (unit = 0; unit < units; unit++) {
        struct sa_block *block = block_of(unit);
        if (block->up.kind == SA_NONE) {
            memset(&block->up, 0, sizeof block->up);
        }
        if (block->down.kind == SA_NONE) {
            memset(&block->down, 0, sizeof block->down);
            block->down_face = 0;
        }
        for (i = block->waiting_count; i < SA_WAITING; i++) {
            memset(&block->waiting[i], 0, sizeof block->waiting[i]);
        }
        if (block->node == SA_NO_ROLE) {
            memset(block->direction, 0, sizeof block->direction);
        }
        for (at = 0; at < SA_FACES; at++) {
            struct sa_face *face = &block->faces[at];
            struct queue *queue = &queues[unit * SA_FACES + at];
            uint8_t bytes[QUEUE] = {0};
            for (i = face->count; i < SA_FRAME; i++) {
                face->frame[i] = 0;
            }
            face->since = 0;
            if (face->state == SA_OFF) {
                face->role = 0;
            }
            for (i = 0; i < queue->count; i++) {
                bytes[i] = queue->bytes[(queue->first + i) % QUEUE];
            }
            memcpy(queue->bytes, bytes, sizeof bytes);
            queue->first = 0;
        }
    }
}

/* Stores the state, or restores it, and returns its hash (FNV-1a). */
static uint64_t copy_state(unsigned slot, bool stores) {
    const size_t sizes[] = {sizeof plate, (units - seeds) * sizeof *blocks,
                            units * SA_FACES * sizeof *contacts, units * SA_FACES * sizeof *queues,
                            sizeof phase, sizeof stage};
    void *const parts[] = {&plate, blocks, contacts, queues, &phase, &stage};
    uint64_t hash = 14695981039346656037u;
    enum { PARTS = 6 };
    size_t length = 0;
    size_t i, k;
    if (slot >= SLOTS) {
        exit(4);
    }
    for (i = 0; i < PARTS; i++) {
        length += sizes[i];
    }
    if (slots[slot] == NULL && (slots[slot] = malloc(length)) == NULL) {
        exit(3);
    }
    for (length = 0, i = 0; i < PARTS; length += sizes[i], i++) {
        if (stores) {
            memcpy(slots[slot] + length, parts[i], sizes[i]);
        } else {
            memcpy(parts[i], slots[slot] + length, sizes[i]);
        }
        for (k = 0; k < sizes[i]; k++) {
            hash = (hash ^ ((uint8_t *)parts[i])[k]) * 1099511628211u;
        }
    }
    return hash;
}

/* Tells the hash of the state, the faces with bytes, and the blocks that can send a frame again. */
static void store(unsigned slot) {
    unsigned unit;
    uint8_t at;
    normalize();
    printf("H %llu\n", (unsigned long long)copy_state(slot, true));
    for (unit = 0; unit < units; unit++) {
        bool repeats = false;
        for (at = 0; at < SA_FACES; at++) {
            const struct contact *contact = contact_of(unit, at);
            bool is_empty = queues[unit * SA_FACES + at].count == 0;
            if (!is_empty) {
                printf("N %u %u\n", unit, at);
            }
            if (block_of(unit)->faces[at].sending != SA_NONE && contact->unit >= 0) {
                is_empty = is_empty &&
                           queues[(unsigned)contact->unit * SA_FACES + contact->face].count == 0;
                repeats = repeats || is_empty;
            }
        }
        if (repeats) {
            printf("I %u\n", unit);
        }
        if (unit < seeds ? unit == 0 && plate.phase < SA_READ(3) : block_of(unit)->delay > 1) {
            printf("V %u\n", unit);
        }
    }
}

static void dock(FILE *in) {
    unsigned parent, parent_face, child, child_face, mark;
    struct contact *above;
    struct contact *below;
    if (fscanf(in, "%u %u %u %u %u", &parent, &parent_face, &child, &child_face, &mark) != 5) {
        exit(2);
    }
    above = contact_of(parent, (uint8_t)parent_face);
    below = contact_of(child, (uint8_t)child_face);
    above->unit = (int)child;
    above->face = (uint8_t)child_face;
    above->holds = true;
    below->unit = (int)parent;
    below->face = (uint8_t)parent_face;
    below->mark = (uint8_t)mark;
    queues[parent * SA_FACES + parent_face].count = 0;
    queues[child * SA_FACES + child_face].count = 0;
}

int main(void) {
    char command;
    while (scanf(" %c", &command) == 1) {
        unsigned count = 0;
        switch (command) {
        case 'L':
            load(stdin);
            break;
        case 'D':
            dock(stdin);
            break;
        case 'R':
            if (scanf("%u", &count) != 1) {
                return 2;
            }
            for (; count > 0; count--) {
                poll_one();
            }
            break;
        case 'T':
            if (scanf("%u", &count) != 1) {
                return 2;
            }
            if (count < seeds) {
                poll_plate();
            } else {
                poll_block(count - seeds);
            }
            break;
        case 'U': {
            unsigned face;
            if (scanf("%u %u", &count, &face) != 2) {
                return 2;
            }
            port_release((uint16_t)count, (uint8_t)face);
            break;
        }
        case 'G':
            poll_all();
            break;
        case 'M':
            mute(stdin);
            break;
        case 'X':
            if (scanf("%u", &count) != 1) {
                return 2;
            }
            sa_start(block_of(count), (uint16_t)count);
            break;
        case 'Q':
            settle();
            break;
        case 'S':
            show();
            break;
        case 'Z':
        case 'J':
            if (scanf("%u", &count) != 1) {
                return 2;
            }
            if (command == 'Z') {
                store(count);
            } else {
                (void)copy_state(count, false);
            }
            break;
        case 'P':
        case 'V':
            if (scanf("%u", &count) != 1) {
                return 2;
            }
            if (command == 'V') {
                end_times(count);
            } else {
                late = SA_RETRY;
            }
            if (count < seeds) {
                poll_plate();
            } else {
                poll_block(count - seeds);
            }
            late = 0;
            break;
        case 'Y': {
            unsigned face;
            if (scanf("%u %u", &count, &face) != 2) {
                return 2;
            }
            queues[count * SA_FACES + face].count = 0;
            break;
        }
        case 'W':
            printf("W %u %u\n", waiting_most, plate_waiting_most);
            break;
        default:
            return 2;
        }
        note_time();
        printf(".\n");
        fflush(stdout);
    }
    return 0;
}
