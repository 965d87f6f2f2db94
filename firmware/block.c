/* stochc firmware: interpreter of the event tables of one block. See block.h. */
#include "block.h"

#include <string.h>

/* Frame delimiter and escape, as in HDLC. */
#define FLAG 0x7Eu
#define ESCAPE 0x7Du
#define ESCAPED 0x80u

/* Positions in a frame. */
enum { AT_KIND, AT_NUMBER, AT_PHASE, AT_PROGRAM, AT_NODE = 5, AT_DETAIL = 7, AT_CHECK = 8 };

/* Positions in the program. */
enum { PROGRAM_ID = 0, PROGRAM_ROLES = 4, PROGRAM_RECORDS = 8 };

/* Actions of rules. */
enum { DO_OPEN, DO_CLOSE, DO_ASK, DO_NOTIFY, DO_REPORT, DO_ASK_LATER };

/* Observations with a role, in the two upper bits. */
#define DOCKED 0x0000u
#define ASKED 0x4000u
#define RELEASED 0x8000u

/* No number of a frame. */
#define NO_NUMBER 0xFFu

/* Bytes taken from a face in one call of sa_poll. */
#define BYTES_PER_POLL 32u

/* Directions of a message, other than the number of a face. */
enum { HERE = 6, UP, KEEP, NOWHERE };

/* ---- Program ---- */

static uint16_t word(uint16_t at) {
    return (uint16_t)(SA_READ(at) | ((uint16_t)SA_READ((uint16_t)(at + 1u)) << 8));
}

/* Returns the offset of the record of a node. */
static uint16_t record(uint16_t node) {
    uint16_t role = node & (uint16_t)~SA_ANCHORED;
    return word((uint16_t)(word(PROGRAM_RECORDS) + (2u * role)));
}

/* Returns the node that captures a node. Returns SA_NO_ROLE for a seed. */
static uint16_t captor(uint16_t node, uint8_t phase) {
    uint16_t at = record(node);
    uint8_t count = SA_READ(at);
    uint16_t found = SA_NO_ROLE;
    at++;
    for (; count > 0u; count--) {
        uint8_t when = SA_READ(at);
        if ((node & SA_ANCHORED) != 0u) {
            if (when == phase) {
                found = word((uint16_t)(at + 1u));
            }
        } else if (when < phase) {
            /* A block that was attached before this phase has a parent that was, too. */
            found = word((uint16_t)(at + 1u)) & (uint16_t)~SA_ANCHORED;
        } else {
            /* A later capture. */
        }
        at = (uint16_t)(at + 3u);
    }
    return found;
}

/* Returns the offset of the duty of a node in a phase, or 0. */
static uint16_t find_duty(uint16_t node, uint8_t phase) {
    uint8_t trigger = ((node & SA_ANCHORED) != 0u) ? 0x80u : 0u;
    uint16_t at = record(node);
    uint8_t count;
    at = (uint16_t)(at + 1u + (3u * SA_READ(at)));
    count = SA_READ(at);
    at++;
    for (; count > 0u; count--) {
        uint16_t duty = (uint16_t)(at + 3u);
        if ((SA_READ(at) == phase) && ((SA_READ(duty) & 0x80u) == trigger)) {
            return duty;
        }
        at = (uint16_t)(duty + word((uint16_t)(at + 1u)));
    }
    return 0u;
}

/* ---- Bits ---- */

static bool has(const uint8_t *bits, uint8_t i) {
    return (bits[i >> 3] & (uint8_t)((uint16_t)1u << (i & 7u))) != 0u;
}

static void set(uint8_t *bits, uint8_t i) {
    bits[i >> 3] = (uint8_t)(bits[i >> 3] | (uint8_t)((uint16_t)1u << (i & 7u)));
}

/* ---- Observations ---- */

static void see_slot(struct sa_block *block, uint8_t slot) {
    if (slot < SA_SEEN) {
        set(block->seen, slot);
    }
}

/* Stores an observation of an own face. */
static void see(struct sa_block *block, uint16_t kind, uint16_t role) {
    uint16_t at = block->duty;
    uint8_t count;
    uint8_t i;
    if (at == 0u) {
        return;
    }
    count = SA_READ(at) & 0x7Fu;
    at++;
    for (i = 0; i < count; i++) {
        if (word(at) == (kind | role)) {
            see_slot(block, i);
        }
        at = (uint16_t)(at + 2u);
    }
}

/* ---- Orientation ---- */

/* Returns the direction of the cross product of the normals of two perpendicular faces. */
static uint8_t cross(uint8_t a, uint8_t b) {
    uint8_t first = a >> 1;
    uint8_t second = b >> 1;
    uint8_t next = (first == 2u) ? 0u : (uint8_t)(first + 1u);
    uint8_t against = (next != second) ? 1u : 0u;
    return (uint8_t)((2u * (3u - first - second)) + ((uint8_t)(a + b + against) & 1u));
}

static bool perpendicular(uint8_t a, uint8_t b) {
    return (a < SA_FACES) && (b < SA_FACES) && ((a ^ b) > 1u);
}

/* Stores that an own face points to a direction. */
static void point(struct sa_block *block, uint8_t face, uint8_t to) {
    block->direction[face] = to;
    block->direction[face ^ 1u] = to ^ 1u;
}

/* Stores that the own faces `a` and `b` point to `to_a` and `to_b`. */
static void orient(struct sa_block *block, uint8_t a, uint8_t to_a, uint8_t b, uint8_t to_b) {
    point(block, a, to_a);
    point(block, b, to_b);
    point(block, cross(a, b), cross(to_a, to_b));
}

/* Returns the own face that points in a direction of the structure. */
static uint8_t own_face(const struct sa_block *block, uint8_t direction) {
    uint8_t face = 0;
    while ((face < (SA_FACES - 1u)) && (block->direction[face] != direction)) {
        face++;
    }
    return face;
}

/* ---- Frames ---- */

static uint16_t check(uint16_t sum, uint8_t byte) {
    uint16_t next = sum ^ (uint16_t)((uint16_t)byte << 8);
    uint8_t bit;
    for (bit = 0; bit < 8u; bit++) {
        next = (uint16_t)(((next & 0x8000u) != 0u) ? (((uint16_t)(next << 1)) ^ 0x1021u)
                                                   : ((uint16_t)(next << 1)));
    }
    return next;
}

static void send_byte(uint16_t unit, uint8_t face, uint8_t byte) {
    if ((byte == FLAG) || (byte == ESCAPE)) {
        port_send(unit, face, ESCAPE);
        port_send(unit, face, byte ^ 0x20u);
    } else {
        port_send(unit, face, byte);
    }
}

static void send(const struct sa_block *block, uint8_t face, uint8_t kind, uint8_t number,
                 uint16_t node, uint8_t detail) {
    uint16_t sum = 0xFFFFu;
    uint8_t frame[AT_CHECK];
    uint8_t i;
    frame[AT_KIND] = (uint8_t)((SA_VERSION << 5) | block->stage | kind);
    frame[AT_NUMBER] = number;
    frame[AT_PHASE] = block->phase;
    frame[AT_PROGRAM] = SA_READ(PROGRAM_ID);
    frame[AT_PROGRAM + 1] = SA_READ(PROGRAM_ID + 1);
    frame[AT_NODE] = (uint8_t)(node & 0xFFu);
    frame[AT_NODE + 1] = (uint8_t)(node >> 8);
    frame[AT_DETAIL] = detail;
    port_send(block->unit, face, FLAG);
    for (i = 0; i < (uint8_t)AT_CHECK; i++) {
        sum = check(sum, frame[i]);
        send_byte(block->unit, face, frame[i]);
    }
    send_byte(block->unit, face, (uint8_t)(sum >> 8));
    send_byte(block->unit, face, (uint8_t)(sum & 0xFFu));
    port_send(block->unit, face, FLAG);
}

/* ---- Routing ---- */

/* Returns the next hop of a notification: a face, HERE, UP or KEEP. */
static uint8_t next_hop(const struct sa_block *block, uint16_t node) {
    uint16_t at = node;
    uint16_t limit = word(PROGRAM_ROLES);
    if ((node & (uint16_t)~SA_ANCHORED) >= limit) {
        return NOWHERE;
    }
    if (node == block->node) {
        return HERE;
    }
    for (; limit > 0u; limit--) {
        uint16_t above = captor(at, block->phase);
        if (above == SA_NO_ROLE) {
            return UP;
        }
        if (above == block->node) {
            uint8_t face;
            for (face = 0; face < SA_FACES; face++) {
                const struct sa_face *child = &block->faces[face];
                if ((child->state == SA_CHILD) &&
                    ((child->role | (child->is_new ? SA_ANCHORED : 0u)) == at)) {
                    return face;
                }
            }
            /* A block that was attached at the start of the phase has left and needs nothing. */
            return ((at & SA_ANCHORED) != 0u) ? (uint8_t)KEEP : (uint8_t)NOWHERE;
        }
        at = above;
    }
    return NOWHERE;
}

/* Stores a message. Returns whether there was room for it. */
static bool put(struct sa_message *place, uint8_t kind, uint16_t node, uint8_t detail) {
    if (place->kind != SA_NONE) {
        return false;
    }
    place->kind = kind;
    place->node = node;
    place->detail = detail;
    return true;
}

/* Sends a report or a request. Returns whether there was room for it. */
static bool send_up(struct sa_block *block, uint8_t kind) {
    return put(&block->up, kind, block->node, 0);
}

static void keep(struct sa_block *block, uint16_t node, uint8_t detail) {
    uint16_t i;
    for (i = 0; i < block->waiting_count; i++) {
        if ((block->waiting[i].node == node) && (block->waiting[i].detail == detail)) {
            return;
        }
    }
    if (block->waiting_count < SA_WAITING) {
        block->waiting[block->waiting_count].node = node;
        block->waiting[block->waiting_count].detail = detail;
        block->waiting_count++;
    }
}

/* Delivers a notification, or passes it on. Returns whether there was room for it. `from` is the
 * face that it came from: a notification never goes back. */
static bool route(struct sa_block *block, uint16_t node, uint8_t detail, uint8_t from) {
    uint8_t hop = next_hop(block, node);
    if (hop == (uint8_t)HERE) {
        see_slot(block, detail);
    } else if (hop == (uint8_t)KEEP) {
        keep(block, node, detail);
    } else if (hop == (uint8_t)UP) {
        if ((from >= SA_FACES) || (block->faces[from].state != SA_PARENT)) {
            return put(&block->up, SA_NOTIFY, node, detail);
        }
    } else if ((hop < SA_FACES) && (hop != from)) {
        if (!put(&block->down, SA_NOTIFY, node, detail)) {
            return false;
        }
        block->down_face = hop;
    } else {
        /* Only a damaged message comes here. */
    }
    return true;
}

/* Sends a kept notification whose next hop is now known. */
static void send_waiting(struct sa_block *block) {
    uint16_t i;
    for (i = 0; (i < block->waiting_count) && (block->down.kind == SA_NONE); i++) {
        struct sa_message *message = &block->waiting[i];
        if (next_hop(block, message->node) < SA_FACES) {
            (void)route(block, message->node, message->detail, SA_FACES);
            block->waiting_count--;
            *message = block->waiting[block->waiting_count];
            return;
        }
    }
}

/* ---- Rules ---- */

static bool open_face(struct sa_block *block, uint8_t face, uint16_t child) {
    struct sa_face *open = &block->faces[face];
    if (open->state != SA_OFF) {
        return false;
    }
    open->state = SA_OPEN;
    open->role = child;
    port_attract(block->unit, face);
    return true;
}

static bool close_face(struct sa_block *block, uint8_t face, uint16_t child) {
    struct sa_face *closed = &block->faces[face];
    if ((closed->state != SA_CHILD) || (closed->role != child)) {
        return false;
    }
    closed->state = SA_FREEING;
    closed->sending = SA_NONE;
    return true;
}

/* Carries out an action. Returns false if it must wait for room. */
static bool act(struct sa_block *block, uint8_t action, uint16_t at) {
    uint8_t face = own_face(block, (uint8_t)(action >> 3) & 7u);
    switch (action & 7u) {
    case DO_OPEN:
        return open_face(block, face, word(at));
    case DO_CLOSE:
        return close_face(block, face, word(at));
    case DO_ASK:
        return send_up(block, SA_ASK);
    case DO_NOTIFY:
        return route(block, word(at), SA_READ((uint16_t)(at + 2u)), SA_FACES);
    case DO_ASK_LATER:
        block->delay = word(at) | ((uint32_t)word((uint16_t)(at + 2u)) << 16);
        block->clock = port_clock();
        return true;
    default:
        return send_up(block, SA_REPORT);
    }
}

/* Tests the conditions of a rule, and moves `at` behind them. */
static bool test(const struct sa_block *block, uint16_t *at) {
    bool holds = true;
    uint8_t count = SA_READ(*at);
    (*at)++;
    for (; count > 0u; count--) {
        uint8_t needed = 1;
        uint8_t of = 1;
        uint8_t slot = SA_READ(*at);
        if ((slot & 0x80u) != 0u) {
            needed = slot & 0x7Fu;
            (*at)++;
            of = SA_READ(*at);
            (*at)++;
        }
        for (; of > 0u; of--) {
            if (has(block->seen, SA_READ(*at)) && (needed > 0u)) {
                needed--;
            }
            (*at)++;
        }
        holds = holds && (needed == 0u);
    }
    return holds;
}

/* Fires the first rule that is ready. Returns whether there may be another. */
static bool fire_one(struct sa_block *block) {
    uint16_t at = block->duty;
    uint8_t count;
    uint8_t i;
    if (at == 0u) {
        return false;
    }
    at = (uint16_t)(at + 1u + (2u * (SA_READ(at) & 0x7Fu)));
    count = SA_READ(at);
    at++;
    for (i = 0; i < count; i++) {
        uint8_t action = SA_READ(at);
        bool holds;
        at++;
        holds = test(block, &at);
        if (holds && !has(block->fired, i)) {
            if (act(block, action, at)) {
                set(block->fired, i);
                return true;
            }
            return false;
        }
        /* The upper bits are the number of operand bytes, less one. */
        action >>= 6;
        at = (uint16_t)(at + action + ((action != 0u) ? 1u : 0u));
    }
    return false;
}

/* Asks for the release of a block after its delay. */
static void count_down(struct sa_block *block) {
    uint8_t now = port_clock();
    while ((block->delay > 1u) && ((uint8_t)(now - block->clock) >= SA_TICK)) {
        block->clock = (uint8_t)(block->clock + SA_TICK);
        block->delay--;
    }
    if ((block->delay == 1u) && send_up(block, SA_ASK)) {
        block->delay = 0;
    }
}

/* ---- Events ---- */

/* Returns a number in the frame received at a face. */
static uint16_t frame_word(const struct sa_face *face, uint8_t at) {
    return (uint16_t)(face->frame[at] | ((uint16_t)face->frame[at + 1u] << 8));
}

static bool is_aborting(const struct sa_block *block) {
    return (block->stage & SA_STAGE) != 0u;
}

/* Forgets all observations and messages, and switches the faces off that have no child yet. An abort
 * `keeps` the captures of the phase in mind. */
static void clear(struct sa_block *block, bool keeps) {
    uint8_t at;
    block->up.kind = SA_NONE;
    block->down.kind = SA_NONE;
    block->waiting_count = 0;
    block->delay = 0;
    (void)memset(block->seen, 0, sizeof block->seen);
    (void)memset(block->fired, 0, sizeof block->fired);
    for (at = 0; at < SA_FACES; at++) {
        struct sa_face *face = &block->faces[at];
        if ((face->state == SA_OPEN) || (face->state == SA_NAMING)) {
            face->state = SA_OFF;
            port_release(block->unit, at);
        }
        face->tells = (face->state == SA_CHILD);
        if (!keeps) {
            face->is_new = false;
        }
        face->sending = SA_NONE;
        face->heard = NO_NUMBER; /* The neighbour may have restarted. */
    }
}

/* Forgets everything about the previous phase or attempt, and begins the duty of the block. */
static void begin(struct sa_block *block, uint8_t phase, uint8_t stage) {
    bool keeps = (stage & SA_STAGE) != 0u;
    if (phase != block->phase) {
        /* The first frame of a phase may already abort it. Its children are not new. */
        block->node &= (uint16_t)~SA_ANCHORED;
        keeps = false;
    }
    block->phase = phase;
    block->stage = stage;
    block->duty = find_duty(block->node, phase);
    clear(block, keeps);
}

/* Ends the role of a block. Bytes received so far remain. */
static void forget(struct sa_block *block) {
    uint8_t face;
    block->node = SA_NO_ROLE;
    block->duty = 0;
    block->stage = 0;
    clear(block, false);
    for (face = 0; face < SA_FACES; face++) {
        block->faces[face].state = SA_OFF;
    }
}

/* Returns whether a face holds a block that the abort releases. */
static bool is_retreating(const struct sa_block *block, const struct sa_face *face) {
    return (face->state == SA_CHILD) && face->is_new && is_aborting(block);
}

/* Works on an abort. A block without captures of the phase asks for its release, or reports if it
 * stood before the phase. */
static void retreat(struct sa_block *block) {
    uint8_t at;
    uint8_t kind = SA_NONE;
    for (at = 0; at < SA_FACES; at++) {
        const struct sa_face *face = &block->faces[at];
        if ((face->state == SA_FREEING) || is_retreating(block, face)) {
            return;
        }
    }
    if ((block->node & SA_ANCHORED) != 0u) {
        kind = SA_ASK;
    } else if (block->duty != 0u) {
        kind = SA_REPORT;
    } else {
        /* This block only forwards messages. */
    }
    if ((block->fired[0] == 0u) && (kind != SA_NONE) && send_up(block, kind)) {
        block->fired[0] = 1;
    }
}

/* Returns whether a block holds other blocks, or is a seed. */
static bool is_bound(const struct sa_block *block) {
    bool is_seed = block->node != SA_NO_ROLE;
    uint8_t face;
    for (face = 0; face < SA_FACES; face++) {
        uint8_t state = block->faces[face].state;
        if ((state == SA_CHILD) || (state == SA_FREEING)) {
            return true;
        }
        if (state >= SA_PARENT) {
            is_seed = false;
        }
    }
    return is_seed;
}

/* Takes the role in a frame from the parent at a face. The block may have an earlier role, if its
 * former parent has not learnt about it or has lost the contact. */
static bool take_role(struct sa_block *block, uint8_t face) {
    struct sa_face *parent = &block->faces[face];
    uint16_t role = frame_word(parent, AT_NODE);
    uint8_t to_face = (uint8_t)(parent->frame[AT_DETAIL] >> 4) ^ 1u;
    uint8_t to_mark = parent->frame[AT_DETAIL] & 0x0Fu;
    uint8_t mark = port_mark(block->unit, face);
    if ((role >= word(PROGRAM_ROLES)) || !perpendicular(to_face, to_mark) ||
        !perpendicular(face, mark) || is_bound(block)) {
        return false;
    }
    forget(block);
    orient(block, face, to_face, mark, to_mark);
    block->node = role | SA_ANCHORED;
    block->phase = parent->frame[AT_PHASE];
    block->stage = parent->frame[AT_KIND] & SA_STAGES;
    parent->state = SA_NAMED;
    parent->heard = parent->frame[AT_NUMBER];
    return true;
}

/* Begins the duty of a role. The parent has received the acknowledgement of the name. */
static void confirm(struct sa_block *block, uint8_t from) {
    block->faces[from].state = SA_PARENT;
    begin(block, block->phase, block->stage);
}

/* Processes a message of the running phase. Returns whether there was room for it. */
static bool process(struct sa_block *block, uint8_t from, uint8_t kind) {
    struct sa_face *face = &block->faces[from];
    uint16_t node = frame_word(face, AT_NODE);
    if (kind == (uint8_t)SA_NOTIFY) {
        return route(block, node, face->frame[AT_DETAIL], from);
    }
    if (face->state != SA_PARENT) {
        if (kind == (uint8_t)SA_REPORT) {
            return put(&block->up, SA_REPORT, node, 0);
        }
        if (kind == (uint8_t)SA_ASK) {
            if (is_aborting(block)) {
                face->state = SA_FREEING;
                face->sending = SA_NONE;
            } else {
                see(block, ASKED, face->role);
            }
        }
    }
    return true;
}

/* Processes a frame. Returns whether to acknowledge it. */
static bool accept(struct sa_block *block, uint8_t from, uint8_t kind) {
    struct sa_face *face = &block->faces[from];
    uint8_t number = face->frame[AT_NUMBER];
    uint8_t stage = face->frame[AT_KIND] & SA_STAGES;
    uint8_t phase = face->frame[AT_PHASE];
    if (kind == (uint8_t)SA_NAME) {
        return take_role(block, from);
    }
    if (block->node == SA_NO_ROLE) {
        /* The parent may have missed the last acknowledgement, or this block has restarted. */
        if ((kind == (uint8_t)SA_PHASE) && take_role(block, from)) {
            confirm(block, from);
        }
        return (kind != (uint8_t)SA_REPORT) && (kind != (uint8_t)SA_ASK);
    }
    if ((face->state == SA_OFF) || (face->state == SA_OPEN) || (face->state == SA_NAMING)) {
        return false;
    }
    if (face->state == SA_NAMED) {
        confirm(block, from);
    }
    if ((phase != block->phase) || (stage != block->stage)) {
        if (face->state != SA_PARENT) {
            /* Messages of an earlier phase or attempt are void. */
            face->heard = number;
            return true;
        }
        begin(block, phase, stage);
    }
    if (number == face->heard) {
        return true;
    }
    if ((face->state == SA_PARENT) && (kind == (uint8_t)SA_FREE)) {
        if (block->up.kind != SA_NONE) {
            return false;
        }
        forget(block);
        return true;
    }
    if (!process(block, from, kind)) {
        return false;
    }
    face->heard = number;
    return true;
}

/* Ends the hold of a face. */
static void end_hold(struct sa_block *block, uint8_t at) {
    struct sa_face *face = &block->faces[at];
    face->state = SA_OFF;
    if (block->down_face == at) {
        block->down.kind = SA_NONE;
    }
    port_release(block->unit, at);
    see(block, RELEASED, face->role);
}

/* Processes an acknowledgement of the last frame sent. */
static void acknowledged(struct sa_block *block, uint8_t from) {
    struct sa_face *face = &block->faces[from];
    uint8_t sent = face->sending;
    if ((sent == (uint8_t)SA_NONE) || (face->frame[AT_NUMBER] != face->number)) {
        return;
    }
    if ((sent == (uint8_t)SA_PHASE) && face->is_new && is_aborting(block)) {
        /* Repeat the frame: the child may restart before it asks for its release. */
        return;
    }
    face->sending = SA_NONE;
    switch (face->state) {
    case SA_NAMING:
        face->state = SA_CHILD;
        face->is_new = true;
        face->tells = true; /* The next frame confirms the role. */
        see(block, DOCKED, face->role);
        break;
    case SA_FREEING:
        end_hold(block, from);
        break;
    case SA_PARENT:
        block->up.kind = SA_NONE;
        break;
    case SA_CHILD:
        if (sent == (uint8_t)SA_PHASE) {
            face->tells = false;
        } else {
            block->down.kind = SA_NONE;
        }
        break;
    default:
        break;
    }
}

/* Processes the frame received at a face. */
static void receive_frame(struct sa_block *block, uint8_t from) {
    struct sa_face *face = &block->faces[from];
    uint16_t sum = 0xFFFFu;
    uint8_t kind = face->frame[AT_KIND] & 7u;
    uint8_t i;
    for (i = 0; i < SA_FRAME; i++) {
        sum = check(sum, face->frame[i]);
    }
    if ((sum != 0u) || ((face->frame[AT_KIND] >> 5) != SA_VERSION) ||
        (face->frame[AT_PROGRAM] != SA_READ(PROGRAM_ID)) ||
        (face->frame[AT_PROGRAM + 1] != SA_READ(PROGRAM_ID + 1))) {
        return;
    }
    if (kind == (uint8_t)SA_ACK) {
        acknowledged(block, from);
    } else if (accept(block, from, kind)) {
        send(block, from, SA_ACK, face->frame[AT_NUMBER], 0, 0);
    } else {
        /* The sender repeats the frame. */
    }
}

static void receive_byte(struct sa_block *block, uint8_t from, uint8_t byte) {
    struct sa_face *face = &block->faces[from];
    if (byte == FLAG) {
        if (face->count == SA_FRAME) {
            receive_frame(block, from);
        }
        face->count = 0;
    } else if (byte == ESCAPE) {
        face->count |= ESCAPED;
    } else {
        uint8_t value = byte;
        if ((face->count & ESCAPED) != 0u) {
            value ^= 0x20u;
            face->count &= (uint8_t)~ESCAPED;
        }
        if (face->count < SA_FRAME) {
            face->frame[face->count] = value;
            face->count++;
        } else {
            face->count = SA_FRAME + 1u;
        }
    }
}

/* Reacts to a block that has docked at a face or left it. */
static void watch(struct sa_block *block, uint8_t at) {
    struct sa_face *face = &block->faces[at];
    bool docked = port_docked(block->unit, at);
    if (docked) {
        if (face->state == SA_OPEN) {
            face->state = SA_NAMING;
            face->sending = SA_NONE;
            face->heard = NO_NUMBER;
            face->count = 0; /* A frame of the last neighbour may lack its end. */
        } else if ((face->state == SA_OFF) && (block->node != SA_NO_ROLE)) {
            port_release(block->unit, at);
        } else {
            /* Nothing has changed. */
        }
    } else if (face->state == SA_NAMING) {
        face->state = SA_OPEN;
    } else if ((face->state == SA_FREEING) || is_retreating(block, face)) {
        end_hold(block, at);
    } else if ((face->state == SA_CHILD) && (block->down_face == at)) {
        /* A lost child must not block the messages to the others. */
        block->down.kind = SA_NONE;
    } else {
        /* Nothing has changed. */
    }
}

/* Sends the next frame at a face, or sends the last one again. */
static void transmit(struct sa_block *block, uint8_t at) {
    struct sa_face *face = &block->faces[at];
    const struct sa_message *message = NULL;
    uint8_t kind = SA_NONE;
    uint16_t node = face->role;
    uint8_t detail = 0;
    uint8_t now = port_clock();
    uint8_t directions =
        (uint8_t)((block->direction[at] << 4) | block->direction[(at + 2u) % SA_FACES]);
    switch (face->state) {
    case SA_NAMING:
        kind = SA_NAME;
        detail = directions;
        break;
    case SA_FREEING:
        kind = SA_FREE;
        break;
    case SA_PARENT:
        message = &block->up;
        break;
    case SA_CHILD:
        if (face->tells) {
            kind = SA_PHASE;
            detail = face->is_new ? directions : 0u;
        } else if (block->down_face == at) {
            message = &block->down;
        } else {
            /* Nothing to send. */
        }
        break;
    default:
        break;
    }
    if (message != NULL) {
        kind = message->kind;
        node = message->node;
        detail = message->detail;
    }
    if (kind == (uint8_t)SA_NONE) {
        return;
    }
    if (face->sending != kind) {
        face->sending = kind;
        face->number = (uint8_t)((face->number + 1u) & 0x7Fu);
    } else if ((uint8_t)(now - face->since) < SA_RETRY) {
        return;
    } else {
        /* The frame or its acknowledgement was lost. */
    }
    face->since = now;
    send(block, at, kind, face->number, node, detail);
}

/* ---- Interface ---- */

void sa_start(struct sa_block *block, uint16_t unit) {
    (void)memset(block, 0, sizeof *block);
    block->unit = unit;
    forget(block);
}

uint16_t sa_role(const struct sa_block *block) {
    return (block->node == SA_NO_ROLE) ? SA_NO_ROLE : (block->node & (uint16_t)~SA_ANCHORED);
}

void sa_seed(struct sa_block *block, uint16_t unit, uint16_t role) {
    sa_start(block, unit);
    block->node = role;
    orient(block, SA_EAST, SA_EAST, SA_NORTH, SA_NORTH);
}

void sa_begin(struct sa_block *block, uint8_t phase, uint8_t stage) {
    begin(block, phase, stage);
}

uint16_t sa_root(uint16_t node, uint8_t phase) {
    uint16_t at = node;
    uint16_t limit = word(PROGRAM_ROLES);
    if ((node & (uint16_t)~SA_ANCHORED) >= limit) {
        return SA_NO_ROLE;
    }
    for (; limit > 0u; limit--) {
        uint16_t above = captor(at, phase);
        if (above == SA_NO_ROLE) {
            return at;
        }
        at = above;
    }
    return SA_NO_ROLE;
}

bool sa_deliver(struct sa_block *block, uint16_t node, uint8_t detail) {
    return route(block, node, detail, SA_FACES);
}

void sa_poll(struct sa_block *block) {
    uint8_t face;
    for (face = 0; face < SA_FACES; face++) {
        uint8_t left = BYTES_PER_POLL;
        int16_t byte;
        /* An acknowledgement does not count if its sender has left. */
        watch(block, face);
        byte = port_receive(block->unit, face);
        while (byte >= 0) {
            receive_byte(block, face, (uint8_t)byte);
            left--;
            byte = (left > 0u) ? port_receive(block->unit, face) : (int16_t)-1;
        }
    }
    if (is_aborting(block)) {
        retreat(block);
    } else {
        while (fire_one(block)) {
            /* One rule at a time. */
        }
        count_down(block);
    }
    send_waiting(block);
    for (face = 0; face < SA_FACES; face++) {
        transmit(block, face);
    }
}
