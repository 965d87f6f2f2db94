// The scene and the protocol of the drivers in C and C++. src/scene.rs and src/drive.rs define the same in Rust and explain it.
// Everything is in block units: block length 1, mass 1, tick 1.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const float WALL = 0.01f;    // acceleration per depth [1 / tick^2]
static const double DRAG = 0.01;    // [1 / tick]
static const double FRICTION = 0.2; // restitution is 0

// Functions that every driver defines. A state is position, velocity and rotation (x, y, z, w).
static void tick(uint64_t now);
static void state(uint32_t block, double out[10]);
static double contacts(void);
static long complaints(void);

static uint32_t blocks;
static double kick, radius; // [side / tick], [side]
static float keep;
static double (*start)[3];

// Returns word number `place` of the sequence SplitMix64, seed 1.
static inline uint64_t draw(uint64_t place) {
    uint64_t z = 1 + (place + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline double unit(uint64_t bits) { return ((double)bits + 0.5) / 4294967296.0; }

// Returns a change of velocity with a speed uniform up to `most` and an isotropic direction.
static inline void draw_kick(uint64_t now, uint32_t block, double most, float out[3]) {
    uint64_t place = 2 * (now * blocks + block);
    uint64_t a = draw(place), b = draw(place + 1);
    float speed = (float)(most * unit(a >> 32));
    double z = 2.0 * unit(a & 0xffffffffu) - 1.0;
    float across = (float)sqrt(1.0 - z * z), s, c;
    sincosf((float)(2.0 * M_PI * unit(b >> 32)), &s, &c);
    out[0] = speed * across * c;
    out[1] = speed * across * s;
    out[2] = speed * (float)z;
}

// Applies wall, kick and drag.
static inline void push(uint64_t now, uint32_t block, const double at[3], const double v[3],
                        double out[3]) {
    float x = (float)at[0], y = (float)at[1], z = (float)at[2];
    float distance = sqrtf(x * x + y * y + z * z);
    float wall = distance > (float)radius ? WALL * (distance - (float)radius) / distance : 0.0f;
    float k[3];
    draw_kick(now, block, kick, k);
    out[0] = ((float)v[0] - x * wall + k[0]) * keep;
    out[1] = ((float)v[1] - y * wall + k[1]) * keep;
    out[2] = ((float)v[2] - z * wall + k[2]) * keep;
}

// Writes the sites of a cubic lattice in the hemisphere. `out` may be null.
static size_t lattice(double within, double spacing, double (*out)[3]) {
    long reach = (long)(within / spacing) + 1;
    size_t count = 0;
    for (long k = 0; k <= reach; k++)
        for (long j = -reach; j < reach; j++)
            for (long i = -reach; i < reach; i++) {
                double x = (i + 0.5) * spacing, y = (j + 0.5) * spacing, z = (k + 0.5) * spacing;
                if (z < 1.0 || sqrt(x * x + y * y + z * z) > within) continue;
                if (out) out[count][0] = x, out[count][1] = y, out[count][2] = z;
                count++;
            }
    return count;
}

static void arrange(void) {
    double within = 0.2 * radius / 0.2 - 1.0, fits = 1.1, fails = 2.0 * within + 2.0;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (fits + fails);
        if (lattice(within, middle, NULL) >= blocks)
            fits = middle;
        else
            fails = middle;
    }
    size_t sites = lattice(within, fits, NULL);
    double(*all)[3] = (double(*)[3])malloc(sites * sizeof *all);
    start = (double(*)[3])malloc(blocks * sizeof *start);
    lattice(within, fits, all);
    for (size_t i = 0; i < blocks; i++) memcpy(start[i], all[i * sites / blocks], sizeof *start);
    free(all);
}

// Returns the engine's name in the arguments, and sets the scene up.
static const char *arguments(int argc, char **argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: ENGINE BLOCKS KICK\n");
        exit(2);
    }
    blocks = (uint32_t)atol(argv[2]);
    kick = atof(argv[3]);
    radius = 25.0 * cbrt(blocks / 300.0);
    keep = (float)exp(-DRAG);
    arrange();
    return argv[1];
}

static inline double weighted(uint32_t i, double x, double y, double z) {
    return (1.0 + i % 7) * (x + 2.0 * y + 3.0 * z);
}

static int64_t now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void run(uint64_t *now, long ticks) {
    int64_t time = 0;
    long before = complaints();
    double square = 0.0, points = 0.0, looks = 0.0, s[10];
    while (ticks > 0) {
        long stride = ticks < 10 ? ticks : 10;
        ticks -= stride;
        int64_t begin = now_ns();
        for (long i = 0; i < stride; i++) tick((*now)++);
        time += now_ns() - begin;
        for (uint32_t i = 0; i < blocks; i++) {
            state(i, s);
            square += s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
        }
        looks += blocks;
        points += contacts();
    }
    printf("%ld %.9g %.9g %ld\n", (long)time, square / looks, points / looks,
           complaints() - before);
}

// Executes commands until the input ends.
static int serve(const char *version) {
    double digest = 0.0, kicks = 0.0, s[10];
    for (uint32_t i = 0; i < blocks; i++) {
        float k[3];
        state(i, s);
        draw_kick(7, i, 1.0, k);
        digest += weighted(i, s[0], s[1], s[2]);
        kicks += weighted(i, k[0], k[1], k[2]);
    }
    printf("ready %.12g %.12g %s\n", digest, kicks, version);
    fflush(stdout);
    char line[64];
    uint64_t now = 0;
    while (fgets(line, sizeof line, stdin)) {
        if (strncmp(line, "run ", 4) == 0)
            run(&now, atol(line + 4));
        else
            for (uint32_t i = 0; i < blocks; i++) {
                state(i, s);
                for (int j = 0; j < 10; j++) printf(j < 9 ? "%.9g " : "%.9g\n", s[j]);
            }
        fflush(stdout);
    }
    return 0;
}
