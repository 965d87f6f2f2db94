/* stochc firmware: plate and blocks as processes, joined by sockets. It shows the protocol without
 * hardware: one process per block runs the interpreter, and the first process is the medium. It
 * lets free blocks dock at random faces that attract. */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "plate.h"

/* Packets between a process and the medium. */
enum { BYTE, ATTRACT, RELEASE, PHASE, DOCKED, GONE, TOUCHED };

struct packet {
    uint8_t kind;
    uint8_t face;
    uint16_t unit;
    uint8_t value;
};

#define QUEUE 256u
#define SEEDS ((unsigned)(SA_READ(6) | (SA_READ(7) << 8)))
#define ROLES ((unsigned)(SA_READ(4) | (SA_READ(5) << 8)))

static const char *const face_names[] = {"east", "west", "north", "south", "up", "down"};

/* Whether this process is the medium. The medium fails if another process ends. */
static bool is_medium;

static void fail(const char *what) {
    perror(what);
    exit(1);
}

static void transfer(int socket, struct packet *packet, bool is_sent) {
    size_t done = 0;
    while (done < sizeof *packet) {
        uint8_t *at = (uint8_t *)packet + done;
        size_t left = sizeof *packet - done;
        ssize_t count = is_sent ? write(socket, at, left) : read(socket, at, left);
        if (count > 0) {
            done += (size_t)count;
        } else if (count == 0 || errno != EINTR) {
            if (is_medium) {
                fprintf(stderr, "a block or the plate has ended\n");
            }
            exit(is_medium ? 1 : 0);
        }
    }
}

/* ---- Processes with blocks ---- */

static struct {
    bool docked[SA_FACES];
    uint8_t mark[SA_FACES];
    uint8_t bytes[SA_FACES][QUEUE];
    unsigned first[SA_FACES];
    unsigned count[SA_FACES];
} *ports;
static int medium;
static unsigned first_unit;

static void tell(uint8_t kind, uint16_t unit, uint8_t face, uint8_t value) {
    struct packet packet;
    memset(&packet, 0, sizeof packet);
    packet.kind = kind;
    packet.unit = unit;
    packet.face = face;
    packet.value = value;
    transfer(medium, &packet, true);
}

void port_attract(uint16_t unit, uint8_t face) {
    tell(ATTRACT, unit, face, 0);
}

void port_release(uint16_t unit, uint8_t face) {
    ports[unit - first_unit].docked[face] = false;
    tell(RELEASE, unit, face, 0);
}

bool port_docked(uint16_t unit, uint8_t face) {
    return ports[unit - first_unit].docked[face];
}

uint8_t port_mark(uint16_t unit, uint8_t face) {
    return ports[unit - first_unit].mark[face];
}

void port_send(uint16_t unit, uint8_t face, uint8_t byte) {
    tell(BYTE, unit, face, byte);
}

int16_t port_receive(uint16_t unit, uint8_t face) {
    unsigned port = unit - first_unit;
    int16_t byte;
    if (ports[port].count[face] == 0) {
        return -1;
    }
    byte = ports[port].bytes[face][ports[port].first[face]];
    ports[port].first[face] = (ports[port].first[face] + 1) % QUEUE;
    ports[port].count[face]--;
    return byte;
}

uint8_t port_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint8_t)(now.tv_sec * 1000 + now.tv_nsec / 1000000);
}

static void take_packets(void) {
    struct pollfd ready = {.fd = medium, .events = POLLIN, .revents = 0};
    while (poll(&ready, 1, 0) > 0) {
        struct packet packet;
        unsigned port;
        uint8_t face;
        transfer(medium, &packet, false);
        port = packet.unit - first_unit;
        face = packet.face;
        switch (packet.kind) {
        case BYTE:
            if (ports[port].count[face] < QUEUE) {
                unsigned at = (ports[port].first[face] + ports[port].count[face]) % QUEUE;
                ports[port].bytes[face][at] = packet.value;
                ports[port].count[face]++;
            }
            break;
        case DOCKED:
            ports[port].docked[face] = true;
            ports[port].count[face] = 0;
            break;
        case TOUCHED:
            ports[port].mark[face] = packet.value;
            ports[port].count[face] = 0;
            break;
        default:
            break;
        }
    }
}

static void rest(void) {
    struct timespec time = {.tv_sec = 0, .tv_nsec = 1000000};
    nanosleep(&time, NULL);
}

static void run_block(unsigned unit) {
    static struct sa_block block;
    first_unit = unit;
    ports = calloc(1, sizeof *ports);
    sa_start(&block, (uint16_t)unit);
    for (;;) {
        take_packets();
        sa_poll(&block);
        rest();
    }
}

static void run_plate(void) {
    static struct sa_plate plate;
    uint8_t phase = 0;
    ports = calloc(SEEDS, sizeof *ports);
    sa_plate_start(&plate);
    for (;;) {
        take_packets();
        (void)sa_plate_poll(&plate);
        if (plate.phase != phase) {
            phase = plate.phase;
            tell(PHASE, 0, plate.timed_out ? 1 : 0, phase);
        }
        rest();
    }
}

/* ---- The medium ---- */

struct site {
    bool is_open;
    bool holds;
    int unit; /* Block in contact, or -1. */
    uint8_t face;
};

static int *sockets;
static struct site *sites;
static unsigned units;
static int exit_status;

static struct site *site(unsigned unit, uint8_t face) {
    return &sites[unit * SA_FACES + face];
}

static void send_to(unsigned unit, uint8_t kind, uint8_t face, uint8_t value) {
    medium = sockets[unit < SEEDS ? 0 : unit - SEEDS + 1];
    tell(kind, (uint16_t)unit, face, value);
}

static bool is_free(unsigned unit) {
    uint8_t face;
    for (face = 0; face < SA_FACES; face++) {
        if (site(unit, face)->unit >= 0) {
            return false;
        }
    }
    return true;
}

/* Lets a random free block dock at a random open face. */
static void dock(void) {
    unsigned at = (unsigned)rand() % (units * SA_FACES);
    unsigned child = SEEDS + (unsigned)rand() % (units - SEEDS);
    uint8_t face = (uint8_t)(at % SA_FACES);
    uint8_t child_face = (uint8_t)(rand() % (int)SA_FACES);
    uint8_t mark = (uint8_t)((child_face + 2 + rand() % 4) % (int)SA_FACES);
    unsigned parent = at / SA_FACES;
    struct site *open = site(parent, face);
    if (!open->is_open || open->unit >= 0 || !is_free(child) || child == parent ||
        mark / 2 == child_face / 2) {
        return;
    }
    open->is_open = false;
    open->holds = true;
    open->unit = (int)child;
    open->face = child_face;
    site(child, child_face)->unit = (int)parent;
    site(child, child_face)->face = face;
    printf("block %u docks on face %s of block %u\n", child, face_names[face], parent);
    send_to(child, TOUCHED, child_face, mark);
    send_to(parent, DOCKED, face, 0);
}

static void carry(const struct packet *packet) {
    struct site *from = site(packet->unit, packet->face);
    switch (packet->kind) {
    case BYTE:
        if (from->unit >= 0) {
            send_to((unsigned)from->unit, BYTE, from->face, packet->value);
        }
        break;
    case ATTRACT:
        printf("face %s of block %u attracts\n", face_names[packet->face], packet->unit);
        from->is_open = true;
        break;
    case RELEASE:
        if (from->holds) {
            printf("block %u releases block %d\n", packet->unit, from->unit);
            site((unsigned)from->unit, from->face)->unit = -1;
            from->unit = -1;
            from->holds = false;
        }
        from->is_open = false;
        break;
    default:
        if (packet->face != 0) {
            printf("a phase has timed out\n");
            exit_status = 1;
        } else {
            printf("phase %u is complete\n", packet->value);
        }
        break;
    }
}

static void run_medium(unsigned processes, const pid_t *children) {
    struct pollfd *ready = calloc(processes, sizeof *ready);
    bool has_ended = false;
    unsigned i;
    while (!has_ended) {
        for (i = 0; i < processes; i++) {
            ready[i].fd = sockets[i];
            ready[i].events = POLLIN;
        }
        if (poll(ready, processes, 2) < 0) {
            fail("poll");
        }
        for (i = 0; i < processes; i++) {
            if ((ready[i].revents & POLLIN) != 0) {
                struct packet packet;
                transfer(sockets[i], &packet, false);
                carry(&packet);
                has_ended = has_ended || (packet.kind == PHASE && packet.value == SA_READ(3));
            }
        }
        dock();
        fflush(stdout);
    }
    for (i = 0; i < processes; i++) {
        kill(children[i], SIGTERM);
    }
    if (exit_status == 0) {
        printf("all phases are complete\n");
    }
    free(ready);
}

int main(int count, char **arguments) {
    unsigned processes = ROLES - SEEDS + 3;
    pid_t *children = calloc(processes, sizeof *children);
    unsigned i;
    units = SEEDS + processes - 1;
    sockets = calloc(processes, sizeof *sockets);
    sites = calloc((size_t)units * SA_FACES, sizeof *sites);
    signal(SIGPIPE, SIG_IGN);
    srand(count > 1 ? (unsigned)atoi(arguments[1]) : 1u);
    for (i = 0; i < units * SA_FACES; i++) {
        sites[i].unit = -1;
    }
    for (i = 0; i < processes; i++) {
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0) {
            fail("socketpair");
        }
        children[i] = fork();
        if (children[i] < 0) {
            fail("fork");
        }
        if (children[i] == 0) {
            close(pair[0]);
            medium = pair[1];
            if (i == 0) {
                run_plate();
            } else {
                run_block(SEEDS + i - 1);
            }
        }
        close(pair[1]);
        sockets[i] = pair[0];
    }
    is_medium = true;
    run_medium(processes, children);
    return exit_status;
}
