/* Arbitrary bytes on the faces of a block, or of the plate with SA_PLATE.
 *
 * The first byte of an input selects a state from which it begins, and its other bytes are steps: a
 * frame, bytes, a contact that opens or closes, or the passing of time. STANDALONE replaces libFuzzer
 * by random inputs. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plate.h"

#define QUEUE 32u
#define FLAG 0x7E
#define ESCAPE 0x7D
/* Most states from which an input can begin. */
#define STATES 256u

#ifdef SA_PLATE
#define UNITS SA_SEEDS
typedef struct sa_plate subject_type;
#else
#define UNITS 1u
typedef struct sa_block subject_type;
#endif

struct state {
    subject_type subject;
    uint8_t docked[UNITS];
};

static struct state states[STATES];
static unsigned state_count;
static subject_type subject;
static uint8_t docked[UNITS];
static uint8_t marks[UNITS];
static uint8_t now;
static uint8_t queue[QUEUE];
static uint8_t queue_at;
static uint8_t queue_length;
static uint8_t queue_face;
static uint16_t queue_unit;
static uint16_t sums[256];
static unsigned sent;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *count, char ***arguments);

static void require(bool holds) {
    if (!holds) {
        abort();
    }
}

static void check_call(uint16_t unit, uint8_t face) {
    require(unit < UNITS && face < SA_FACES);
}

void port_attract(uint16_t unit, uint8_t face) {
    check_call(unit, face);
}

void port_release(uint16_t unit, uint8_t face) {
    check_call(unit, face);
    docked[unit] &= (uint8_t)~(1u << face);
}

bool port_docked(uint16_t unit, uint8_t face) {
    check_call(unit, face);
    return ((docked[unit] >> face) & 1u) != 0;
}

uint8_t port_mark(uint16_t unit, uint8_t face) {
    check_call(unit, face);
    return marks[unit];
}

void port_send(uint16_t unit, uint8_t face, uint8_t byte) {
    check_call(unit, face);
    sent += byte;
}

int16_t port_receive(uint16_t unit, uint8_t face) {
    check_call(unit, face);
    if (unit != queue_unit || face != queue_face || queue_at == queue_length) {
        return -1;
    }
    return queue[queue_at++];
}

uint8_t port_clock(void) {
    return now;
}

static void put(uint8_t byte) {
    if (byte == FLAG || byte == ESCAPE) {
        queue[queue_length++] = ESCAPE;
        byte ^= 0x20;
    }
    queue[queue_length++] = byte;
}

/* Puts a frame with a valid checksum into the queue. */
static void put_frame(uint8_t kind, uint8_t number, uint8_t phase, uint16_t node, uint8_t detail) {
    const uint8_t content[8] = {(uint8_t)((SA_VERSION << 5) | kind),
                                number,
                                phase,
                                SA_READ(0),
                                SA_READ(1),
                                (uint8_t)node,
                                (uint8_t)(node >> 8),
                                detail};
    uint16_t sum = 0xFFFF;
    unsigned i;
    queue[queue_length++] = FLAG;
    for (i = 0; i < sizeof content; i++) {
        sum = (uint16_t)((sum << 8) ^ sums[(sum >> 8) ^ content[i]]);
        put(content[i]);
    }
    put((uint8_t)(sum >> 8));
    put((uint8_t)sum);
    queue[queue_length++] = FLAG;
}

static void check_block(const struct sa_block *block) {
    unsigned parents = 0;
    unsigned face;
    require(block->waiting_count <= SA_WAITING);
    require(sa_role(block) == SA_NO_ROLE || sa_role(block) < (SA_READ(4) | (SA_READ(5) << 8)));
    for (face = 0; face < SA_FACES; face++) {
        uint8_t state = block->faces[face].state;
        parents += state == SA_PARENT || state == SA_NAMED;
        require(block->direction[face] < SA_FACES);
        require(block->node == SA_NO_ROLE || block->direction[face] == (block->direction[face ^ 1] ^ 1));
    }
    require(parents <= 1);
}

static struct sa_block *block_of(unsigned unit) {
#ifdef SA_PLATE
    return &subject.seeds[unit];
#else
    (void)unit;
    return &subject;
#endif
}

/* Lets the block or the plate work once. */
static void work(void) {
    unsigned unit;
#ifdef SA_PLATE
    (void)sa_plate_poll(&subject);
#else
    sa_poll(&subject);
#endif
    for (unit = 0; unit < UNITS; unit++) {
        check_block(block_of(unit));
#ifdef SA_PLATE
        require(sa_role(block_of(unit)) == unit);
#endif
    }
    queue_at = 0;
    queue_length = 0;
}

static void reset(void) {
    unsigned unit;
    for (unit = 0; unit < UNITS; unit++) {
        docked[unit] = 0;
        marks[unit] = SA_NORTH;
    }
    now = 0;
    queue_at = 0;
    queue_length = 0;
    queue_unit = 0;
}

static void keep_state(void) {
    require(state_count < STATES);
    states[state_count].subject = subject;
    memcpy(states[state_count].docked, docked, sizeof docked);
    state_count++;
}

/* Lets a block dock at each open face, and take its role. */
static void attach_children(void) {
    for (queue_unit = 0; queue_unit < UNITS; queue_unit++) {
        for (queue_face = 0; queue_face < SA_FACES; queue_face++) {
            const struct sa_face *face = &block_of(queue_unit)->faces[queue_face];
            if (face->state == SA_OPEN) {
                docked[queue_unit] |= (uint8_t)(1u << queue_face);
                work();
                put_frame(SA_ACK, face->number, 0, 0, 0);
                work();
                put_frame(SA_ACK, face->number, 0, 0, 0);
                work();
                require(face->state == SA_CHILD);
            }
        }
    }
    queue_unit = 0;
}

#ifdef SA_PLATE
/* Keeps the plate at the start of each phase, with and without children. */
static void make_states(void) {
    uint8_t phase;
    sa_plate_start(&subject);
    for (phase = 0; phase < SA_READ(3); phase++) {
        unsigned seed;
        subject.phase = phase;
        subject.stage = 0;
        subject.reports = 0;
        for (seed = 0; seed < SA_SEEDS; seed++) {
            sa_begin(&subject.seeds[seed], phase, 0);
        }
        keep_state();
        work();
        attach_children();
        keep_state();
        subject.stage = SA_STAGE;
        for (seed = 0; seed < SA_SEEDS; seed++) {
            sa_begin(&subject.seeds[seed], phase, SA_STAGE);
        }
        keep_state();
    }
}
#else
/* Keeps a free block, and a block with each role, with and without children. */
static void make_states(void) {
    unsigned roles = (unsigned)(SA_READ(4) | (SA_READ(5) << 8));
    unsigned role;
    uint8_t phase;
    sa_start(&subject, 0);
    keep_state();
    for (role = SA_SEEDS; role < roles; role++) {
        for (phase = 0; phase < SA_READ(3); phase++) {
            reset();
            sa_start(&subject, 0);
            queue_face = SA_DOWN;
            put_frame(SA_NAME, 1, phase, (uint16_t)role, (SA_UP << 4) | SA_EAST);
            work();
            put_frame(SA_PHASE, 2, phase, (uint16_t)role, 0);
            work();
            require(subject.faces[SA_DOWN].state == SA_PARENT);
            if (subject.duty != 0) {
                keep_state();
                attach_children();
                keep_state();
                queue_face = SA_DOWN;
                put_frame(SA_PHASE, 3, (uint8_t)(phase + 1u), (uint16_t)role, 0);
                work();
                keep_state();
            }
        }
    }
}
#endif

int LLVMFuzzerInitialize(int *count, char ***arguments) {
    unsigned i;
    (void)count;
    (void)arguments;
    for (i = 0; i < 256; i++) {
        unsigned bit;
        sums[i] = (uint16_t)(i << 8);
        for (bit = 0; bit < 8; bit++) {
            sums[i] = (uint16_t)((sums[i] & 0x8000) != 0 ? (sums[i] << 1) ^ 0x1021 : sums[i] << 1);
        }
    }
    reset();
    make_states();
    return 0;
}

/* Puts a frame with any content into the queue. */
static void put_any_frame(uint8_t kind, const uint8_t *data) {
    uint8_t number = data[0] & 0x7Fu;
    uint8_t phase = data[2] >> 5;
    if (kind == SA_ACK && number < 64) {
        number = block_of(queue_unit)->faces[queue_face].number;
    }
    put_frame(kind | (data[2] & SA_STAGES), number, phase == 7 ? data[3] : phase,
              (uint16_t)((data[1] & 0x7Fu) | ((data[1] & 0x80u) << 8)), data[3]);
}

/* Puts any bytes into the queue. Returns their number. */
static size_t put_any_bytes(const uint8_t *data, size_t size) {
    size_t length = size < QUEUE ? size : QUEUE;
    memcpy(queue, data, length);
    queue_length = (uint8_t)length;
    return length;
}

/* Carries out a step. Returns its number of bytes. */
static size_t step(const uint8_t *data, size_t size) {
    uint8_t what = data[0] >> 3;
    size_t used = 2;
    if (size < 2) {
        return 2;
    }
    queue_face = (data[0] & 7u) % SA_FACES;
    queue_unit = data[1] % UNITS;
    if (what < 24 && size >= 6) {
        put_any_frame(what & 7u, data + 2);
        used = 6;
    } else if (what < 28) {
        size_t length = data[1] >> 3;
        used += put_any_bytes(data + 2, length < size - 2 ? length : size - 2);
    } else if (what < 31) {
        docked[queue_unit] ^= (uint8_t)(1u << queue_face);
        marks[queue_unit] = data[1] >> 5;
    } else {
        now = (uint8_t)(now + data[1]);
    }
    work();
    return used;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    size_t at = 1;
    if (size == 0) {
        return 0;
    }
    reset();
    subject = states[data[0] % state_count].subject;
    memcpy(docked, states[data[0] % state_count].docked, sizeof docked);
    while (at < size) {
        at += step(data + at, size - at);
    }
    return 0;
}

#ifdef STANDALONE
int main(void) {
    static uint8_t data[4096];
    uint64_t random = 1;
    unsigned run;
    unsigned changed = 0;
    (void)LLVMFuzzerInitialize(NULL, NULL);
    for (run = 0; run < 2000; run++) {
        size_t i;
        for (i = 0; i < sizeof data; i++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            data[i] = (uint8_t)(random >> 56);
        }
        (void)LLVMFuzzerTestOneInput(data, sizeof data);
        changed += memcmp(&subject, &states[data[0] % state_count].subject, sizeof subject) != 0;
    }
    printf("%u of %u inputs have changed the state\n", changed, run);
    return changed > run / 2 ? 0 : 1;
}
#endif
