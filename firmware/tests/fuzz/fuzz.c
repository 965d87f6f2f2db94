/* Arbitrary bytes and frames on the faces of a block.
 *
 * With libFuzzer: clang -g -fsanitize=fuzzer,address,undefined. With STANDALONE: a fixed sequence. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "block.h"

static struct sa_block block;
static const uint8_t *input;
static size_t left;
static uint8_t frame[2 * SA_FRAME + 4];
static unsigned frame_at;
static unsigned frame_length;
static uint8_t frame_face;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint8_t next(void) {
    if (left == 0) {
        return 0;
    }
    left--;
    return *input++;
}

void port_attract(uint16_t unit, uint8_t face) {
    (void)unit;
    (void)face;
}

void port_release(uint16_t unit, uint8_t face) {
    (void)unit;
    (void)face;
}

bool port_docked(uint16_t unit, uint8_t face) {
    (void)unit;
    (void)face;
    return (next() & 1u) != 0u;
}

uint8_t port_mark(uint16_t unit, uint8_t face) {
    (void)unit;
    (void)face;
    return next() & 7u;
}

void port_send(uint16_t unit, uint8_t face, uint8_t byte) {
    (void)unit;
    (void)face;
    (void)byte;
}

/* Puts a frame with a valid checksum into the queue. Its content is arbitrary. */
static void make_frame(uint8_t face) {
    uint16_t sum = 0xFFFF;
    uint8_t content[SA_FRAME];
    unsigned i;
    for (i = 0; i < 8; i++) {
        content[i] = next();
    }
    content[0] = (uint8_t)((SA_VERSION << 4) | (content[0] & 7u));
    content[1] &= 0x7F;
    content[3] = SA_READ(0);
    content[4] = SA_READ(1);
    content[6] &= 0x83;
    for (i = 0; i < 8; i++) {
        unsigned bit;
        sum ^= (uint16_t)(content[i] << 8);
        for (bit = 0; bit < 8; bit++) {
            sum = (uint16_t)((sum & 0x8000) != 0 ? (sum << 1) ^ 0x1021 : sum << 1);
        }
    }
    content[8] = (uint8_t)(sum >> 8);
    content[9] = (uint8_t)sum;
    frame_length = 0;
    frame_at = 0;
    frame_face = face;
    frame[frame_length++] = 0x7E;
    for (i = 0; i < SA_FRAME; i++) {
        if (content[i] == 0x7E || content[i] == 0x7D) {
            frame[frame_length++] = 0x7D;
            content[i] ^= 0x20;
        }
        frame[frame_length++] = content[i];
    }
    frame[frame_length++] = 0x7E;
}

int16_t port_receive(uint16_t unit, uint8_t face) {
    (void)unit;
    if (frame_at < frame_length) {
        return face == frame_face ? (int16_t)frame[frame_at++] : (int16_t)-1;
    }
    if (left == 0) {
        return -1;
    }
    switch (next() & 3u) {
    case 0:
        return next();
    case 1:
        make_frame(face);
        return frame[frame_at++];
    default:
        return -1;
    }
}

uint8_t port_clock(void) {
    return next();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    input = data;
    left = size;
    frame_at = 0;
    frame_length = 0;
    sa_start(&block, 0);
    while (left > 0) {
        unsigned face;
        sa_poll(&block);
        for (face = 0; face < SA_FACES; face++) {
            if (block.waiting_count > SA_WAITING || block.direction[face] >= SA_FACES) {
                abort();
            }
        }
    }
    return 0;
}

#ifdef STANDALONE
int main(void) {
    static uint8_t data[4096];
    uint64_t state = 1;
    unsigned run;
    unsigned named = 0;
    for (run = 0; run < 2000; run++) {
        size_t i;
        for (i = 0; i < sizeof data; i++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            data[i] = (uint8_t)(state >> 56);
        }
        (void)LLVMFuzzerTestOneInput(data, sizeof data);
        named += sa_role(&block) != SA_NO_ROLE;
    }
    printf("%u of %u blocks have a role\n", named, run);
    return named > 0 ? 0 : 1;
}
#endif
