/* stochc firmware: interpreter of the event tables of one block. It is the same for every program. */
#ifndef SA_BLOCK_H
#define SA_BLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "program.h"

/* Version of the frames. Blocks ignore frames of other versions. */
#define SA_VERSION 2u
/* Length of a frame [bytes], without delimiters and escapes. */
#define SA_FRAME 10u
/* Clock ticks after which a frame without an acknowledgement is sent again, at most 200. */
#ifndef SA_RETRY
#define SA_RETRY 8u
#endif
/* Clock ticks in a tick of the program, at most 200. All times of a program are in the latter. */
#ifndef SA_TICK
#define SA_TICK 1u
#endif

#define SA_FACES 6u
/* Role of a free block. */
#define SA_NO_ROLE 0xFFFFu
/* Bit of a node (role and trigger): the block was captured during the running phase. */
#define SA_ANCHORED 0x8000u

/* An abort or a retry in the stage of a phase. The bit SA_STAGE is set during an abort. */
#define SA_STAGE 0x08u
#define SA_STAGES 0x18u

/* Faces of a block, in its own frame. The opposite of face f is f ^ 1. */
enum { SA_EAST, SA_WEST, SA_NORTH, SA_SOUTH, SA_UP, SA_DOWN };

/* Kinds of frames. */
enum { SA_NONE, SA_NAME, SA_PHASE, SA_FREE, SA_NOTIFY, SA_REPORT, SA_ASK, SA_ACK };

/* States of a face. SA_NAMED: the parent has sent a role, and has not confirmed it yet. */
enum { SA_OFF, SA_OPEN, SA_NAMING, SA_CHILD, SA_FREEING, SA_PARENT, SA_NAMED };

/* A face and its link to the neighbour. */
struct sa_face {
    uint8_t state;
    bool tells;       /* The child has not acknowledged the phase or its role. */
    bool is_new;      /* The child was captured during the running phase. */
    uint8_t sending;  /* Kind of the frame that waits for an acknowledgement. */
    uint8_t number;   /* Number of the last frame sent. */
    uint8_t heard;    /* Number of the last frame accepted. */
    uint8_t since;    /* Clock when the frame was last sent. */
    uint8_t count;    /* Bytes received, and the escape bit. */
    uint8_t frame[SA_FRAME];
    uint16_t role; /* Role of the child. */
};

/* A message that waits for its next hop, or for a future descendant. */
struct sa_message {
    uint8_t kind;
    uint8_t detail; /* Observation of the receiver. */
    uint16_t node;  /* Receiver of a notification, or sender of a report or request. */
};

/* A block. The plate has one for each seed. */
struct sa_block {
    uint16_t unit; /* Number that the port receives with each call. */
    uint16_t node; /* Role, with SA_ANCHORED if captured during the running phase. */
    uint16_t duty; /* Offset of the duty in the program. 0 without a duty. */
    uint8_t phase;
    uint8_t stage; /* SA_STAGE for each abort and retry of the phase so far, modulo 4. */
    uint8_t direction[SA_FACES]; /* Direction of each own face in the structure. */
    uint8_t down_face;
    uint8_t clock;  /* When the ticks of the delay were last counted. */
    uint32_t delay; /* Ticks until the block asks for its release, and 1. 0 if it does not. */
    uint16_t waiting_count;
    struct sa_message up;   /* To the parent. */
    struct sa_message down; /* To the child at `down_face`. */
    uint8_t seen[(SA_SEEN + 7u) / 8u];
    uint8_t fired[(SA_RULES + 7u) / 8u];
    struct sa_face faces[SA_FACES];
    struct sa_message waiting[SA_WAITING];
};

/* Starts a free block. Also call this after a restart. */
void sa_start(struct sa_block *block, uint16_t unit);

/* Works once on everything that has happened. Call it again and again, at least every 50 ticks. */
void sa_poll(struct sa_block *block);

/* Returns the role of a block, or SA_NO_ROLE. */
uint16_t sa_role(const struct sa_block *block);

/* For the plate: gives a role to a seed, begins a phase, finds the seed whose branch contains a
 * node, and delivers a notification. */
void sa_seed(struct sa_block *block, uint16_t unit, uint16_t role);
void sa_begin(struct sa_block *block, uint8_t phase, uint8_t stage);
uint16_t sa_root(uint16_t node, uint8_t phase);
bool sa_deliver(struct sa_block *block, uint16_t node, uint8_t detail);

/* ---- The port: you write these seven functions. ---- */

/* Makes a face capture: magnet on or valve open. If every face always attracts: nothing. */
void port_attract(uint16_t unit, uint8_t face);
/* Ends the hold of a face: magnet off, valve closed, or an impulse. */
void port_release(uint16_t unit, uint8_t face);
/* Returns whether a face holds a block that it has captured. */
bool port_docked(uint16_t unit, uint8_t face);
/* Returns the own face towards which the mark of the neighbour's face points. The mark of face f
 * points towards face (f + 2) % 6. */
uint8_t port_mark(uint16_t unit, uint8_t face);
/* Sends a byte to the neighbour at a face. */
void port_send(uint16_t unit, uint8_t face, uint8_t byte);
/* Returns the next byte received at a face, or -1. */
int16_t port_receive(uint16_t unit, uint8_t face);
/* Returns the time [ticks]. It may wrap at 256 or above. */
uint8_t port_clock(void);

#endif
