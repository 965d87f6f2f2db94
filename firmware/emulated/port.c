/* Port of a block or plate in an emulator. A serial line stands for all faces: each packet has
 * three bytes, which are kind and face, unit, and value. The other end of the line is `run`. */
#include "processor.h"

#ifdef SA_PLATE
#include "plate.h"
#define UNITS SA_SEEDS
#else
#include "block.h"
#define UNITS 1u
#endif

/* Kinds of packets. BYTE has both directions, and the last three come from `run`. */
enum { BYTE, ATTRACT, RELEASE, PHASE, STACK, ROLE, DOCKED, TOUCHED, ASK };

/* Content of the stack before it is used. */
#define PAINT 0xA5u
/* Bytes below the frame of a function that it may use. */
#define MARGIN 16

/* Bounds of the stack, from the linker. */
extern uint8_t _end[];
extern uint8_t stack_top[];

static uint8_t packet[3];
static uint8_t received; /* Bytes of the packet. */
static uint8_t docked[UNITS];
static uint8_t marks[UNITS][SA_FACES];

#ifdef SA_PLATE
static struct sa_plate plate;
#else
static struct sa_block block;
#endif

static void tell(uint8_t kind, uint8_t face, uint8_t unit, uint8_t value) {
    processor_write((uint8_t)((kind << 4) | face));
    processor_write(unit);
    processor_write(value);
}

/* Returns whether a packet is complete. */
static bool has_packet(void) {
    while (received < sizeof packet) {
        int16_t byte = processor_read();
        if (byte < 0) {
            return false;
        }
        packet[received] = (uint8_t)byte;
        received++;
    }
    return true;
}

void port_attract(uint16_t unit, uint8_t face) {
    tell(ATTRACT, face, (uint8_t)unit, 0);
}

void port_release(uint16_t unit, uint8_t face) {
    docked[unit] &= (uint8_t)~(1u << face);
    tell(RELEASE, face, (uint8_t)unit, 0);
}

bool port_docked(uint16_t unit, uint8_t face) {
    return ((docked[unit] >> face) & 1u) != 0u;
}

uint8_t port_mark(uint16_t unit, uint8_t face) {
    return marks[unit][face];
}

void port_send(uint16_t unit, uint8_t face, uint8_t byte) {
    tell(BYTE, face, (uint8_t)unit, byte);
}

int16_t port_receive(uint16_t unit, uint8_t face) {
    if (!has_packet() || (packet[0] != ((BYTE << 4) | face)) || (packet[1] != unit)) {
        return -1;
    }
    received = 0;
    return packet[2];
}

static void paint_stack(void) {
    uint8_t *at;
    for (at = _end; at < (uint8_t *)__builtin_frame_address(0) - MARGIN; at++) {
        *at = PAINT;
    }
}

static uint16_t stack_depth(void) {
    const uint8_t *at = _end;
    while (*at == PAINT) {
        at++;
    }
    return (uint16_t)(stack_top - at);
}

static void answer(void) {
#ifdef SA_PLATE
    uint16_t role = 0;
#else
    uint16_t role = sa_role(&block);
#endif
    uint16_t depth = stack_depth();
    tell(ROLE, 0, (uint8_t)(role >> 8), (uint8_t)role);
    tell(STACK, 0, (uint8_t)(depth >> 8), (uint8_t)depth);
}

/* Processes packets until the next one contains a byte for a face. */
static void take_packets(void) {
    while (has_packet() && ((packet[0] >> 4) != BYTE)) {
        uint8_t face = packet[0] & 7u;
        uint8_t unit = packet[1];
        received = 0;
        switch (packet[0] >> 4) {
        case DOCKED:
            docked[unit] |= (uint8_t)(1u << face);
            break;
        case TOUCHED:
            marks[unit][face] = packet[2];
            break;
        default:
            answer();
            break;
        }
    }
}

int main(void) {
#ifdef SA_PLATE
    uint8_t phase = 0;
#endif
    paint_stack();
    processor_start();
#ifdef SA_PLATE
    sa_plate_start(&plate);
#else
    sa_start(&block, 0);
#endif
    for (;;) {
        take_packets();
#ifdef SA_PLATE
        (void)sa_plate_poll(&plate);
        if (plate.phase != phase) {
            phase = plate.phase;
            tell(PHASE, 0, 0, phase);
        }
#else
        sa_poll(&block);
#endif
        if (!has_packet()) {
            processor_rest();
        }
    }
}
