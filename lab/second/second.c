/* A second implementation of the scene `hemisphere`, written from docs/concepts/physical-model.md and docs/reference/language.md only.
 *
 * It computes one chain of captures, such as the programs `line` and `open_platform`, in uniform steps and in double
 * precision. It shares no code with stochc. Lengths are in block lengths, masses in blocks, times in ticks.
 *
 * cc -O2 -o second second.c -lm
 * ./second UUUUUUUUUUUUU --runs 100 --seed 1 --steps 16
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BLOCKS = 1000, MAX_CHAIN = 64, MAX_PAIRS = 20000, MAX_PATCH = 16 };

/* Scene, in SI units. */
static struct {
    double tick, side, mass, radius, wall, speed, drag, stiffness, damping, friction;
    double pull, reach, align, align_reach, anchor, tilt;
    int blocks;
} scene = {
    .tick = 0.02, .side = 0.2, .mass = 1, .radius = 5, .wall = 250, .speed = 0.8, .drag = 1.3,
    .stiffness = 535, .damping = 8.78, .friction = 0.5,
    .pull = 18, .reach = 0.2, .align = 0.803, .align_reach = 0.1, .anchor = 0.001, .tilt = 26,
    .blocks = 300,
};

/* Scene, in block units. */
static double R, WALL, SPEED, DRAG, K, C, MU, PULL, REACH, ALIGN, ALIGN_REACH, ANCHOR, COS_TILT;
static const double INERTIA = 1.0 / 6.0;

static void to_block_units(void)
{
    double a = scene.side, m = scene.mass, t = scene.tick;
    R = scene.radius / a;
    WALL = scene.wall * t * t / m;
    SPEED = scene.speed * t / a;
    DRAG = scene.drag * t;
    K = scene.stiffness * t * t / m;
    C = scene.damping * t / m;
    MU = scene.friction;
    PULL = scene.pull * t * t / (m * a);
    REACH = scene.reach / a;
    ALIGN = scene.align * t * t / (m * a);
    ALIGN_REACH = scene.align_reach / a;
    ANCHOR = scene.anchor / a;
    COS_TILT = cos(scene.tilt * M_PI / 180);
}

/* Vectors. */
typedef struct { double x, y, z; } vec;

static vec v3(double x, double y, double z) { return (vec){x, y, z}; }
static vec add(vec a, vec b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static vec sub(vec a, vec b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static vec mul(double s, vec a) { return v3(s * a.x, s * a.y, s * a.z); }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static double len(vec a) { return sqrt(dot(a, a)); }

/* Random numbers: xoshiro256++ (D. Blackman, S. Vigna), seeded by splitmix64. */
static uint64_t rng[4];

static uint64_t rotl(uint64_t x, int k) { return x << k | x >> (64 - k); }

static void seed_rng(uint64_t seed)
{
    for (int i = 0; i < 4; i++) {
        uint64_t z = seed += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        rng[i] = z ^ z >> 31;
    }
}

static double uniform(void)
{
    uint64_t result = rotl(rng[0] + rng[3], 23) + rng[0], t = rng[1] << 17;
    rng[2] ^= rng[0];
    rng[3] ^= rng[1];
    rng[1] ^= rng[2];
    rng[0] ^= rng[3];
    rng[2] ^= t;
    rng[3] = rotl(rng[3], 45);
    return (result >> 11) * 0x1p-53;
}

/* Blocks. The axes are the columns of the rotation at the time `at`. A fixed block has no inverse mass. */
typedef struct {
    vec x, v, w, axis[3];
    double q[4], im, ii, at;
} block;

static double now;

static block blocks[MAX_BLOCKS], built[MAX_CHAIN];
static int free_blocks, built_blocks;

static void set_axes(block *b)
{
    double w = b->q[0], x = b->q[1], y = b->q[2], z = b->q[3];
    b->axis[0] = v3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y));
    b->axis[1] = v3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x));
    b->axis[2] = v3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));
}

/* Updates the orientation of a block. This is exact, because a cube's spin does not change between contacts. */
static void turn(block *b)
{
    double rate = len(b->w), angle = rate * (now - b->at) / 2;
    b->at = now;
    if (angle == 0)
        return;
    double s = sin(angle) / rate, d[4] = {cos(angle), s * b->w.x, s * b->w.y, s * b->w.z}, q[4];
    memcpy(q, b->q, sizeof q);
    b->q[0] = d[0] * q[0] - d[1] * q[1] - d[2] * q[2] - d[3] * q[3];
    b->q[1] = d[0] * q[1] + d[1] * q[0] + d[2] * q[3] - d[3] * q[2];
    b->q[2] = d[0] * q[2] - d[1] * q[3] + d[2] * q[0] + d[3] * q[1];
    b->q[3] = d[0] * q[3] + d[1] * q[2] - d[2] * q[1] + d[3] * q[0];
    double n = 0;
    for (int i = 0; i < 4; i++)
        n += b->q[i] * b->q[i];
    n = 1 / sqrt(n);
    for (int i = 0; i < 4; i++)
        b->q[i] *= n;
    set_axes(b);
}

static block at_rest(vec x, int fixed)
{
    block b = {.x = x, .q = {1, 0, 0, 0}, .im = fixed ? 0 : 1, .ii = fixed ? 0 : 1 / INERTIA, .at = now};
    set_axes(&b);
    return b;
}

static void push(block *b, vec point, vec impulse)
{
    b->v = add(b->v, mul(b->im, impulse));
    b->w = add(b->w, mul(b->ii, cross(sub(point, b->x), impulse)));
}

static vec velocity_at(const block *b, vec point) { return add(b->v, cross(b->w, sub(point, b->x))); }

/* Returns the inverse mass of a block at a point along a direction. */
static double yielding(const block *b, vec point, vec along)
{
    vec arm = cross(sub(point, b->x), along);
    return b->im + b->ii * dot(arm, arm);
}

/* Returns the number of sites of `free N uniform`, and writes them if `points` is given. They are
 * ((i + 1/2) s, (j + 1/2) s, (k + 1/2) s), at least one block length from shell and floor. */
static int lattice(double s, vec *points)
{
    int n = 0, most = (int)(R / s) + 1;
    for (int k = 0; k < most; k++)
        for (int j = -most; j < most; j++)
            for (int i = -most; i < most; i++) {
                vec p = mul(s, v3(i + 0.5, j + 0.5, k + 0.5));
                if (p.z >= 1 && len(p) <= R - 1 && n < 8 * MAX_BLOCKS) {
                    if (points)
                        points[n] = p;
                    n++;
                }
            }
    return n;
}

/* Places the free blocks with the largest spacing that has enough sites. Their number is not monotonic in the spacing, so
 * the search goes down in small steps. */
static void fill(void)
{
    static vec points[8 * MAX_BLOCKS];
    double s = R;
    while (lattice(s, NULL) < scene.blocks)
        s *= 0.99999;
    int found = lattice(s, points);
    free_blocks = scene.blocks;
    for (int i = 0; i < free_blocks; i++)
        blocks[i] = at_rest(points[(long)i * found / free_blocks], 0);
}

/* A contact: its depth, the normal from a to b, and the point of its force. */
typedef struct { double depth; vec normal, point; } contact;

/* Returns the depth of points below a plane. A level patch is pushed in its middle, a tilted one at its deepest point. */
static vec patch_point(const vec *points, const double *depths, int n)
{
    const double level = 2e-3;
    double deepest = -1e9, total = 0;
    vec sum = v3(0, 0, 0);
    for (int i = 0; i < n; i++)
        deepest = fmax(deepest, depths[i]);
    for (int i = 0; i < n; i++) {
        double weight = exp((depths[i] - deepest) / level);
        sum = add(sum, mul(weight, points[i]));
        total += weight;
    }
    return mul(1 / total, sum);
}

/* Cuts a polygon by the half space dot(n, p) <= limit. */
static int clip(vec *polygon, int n, vec normal, double limit)
{
    vec in[MAX_PATCH];
    int kept = 0;
    memcpy(in, polygon, n * sizeof *in);
    for (int i = 0; i < n; i++) {
        vec a = in[i], b = in[(i + 1) % n];
        double da = dot(normal, a) - limit, db = dot(normal, b) - limit;
        if (da <= 0)
            polygon[kept++] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0))
            polygon[kept++] = add(a, mul(da / (da - db), sub(b, a)));
    }
    return kept;
}

/* Returns the corner of a cube that is farthest along a direction. */
static vec corner(const block *b, vec along)
{
    vec p = b->x;
    for (int i = 0; i < 3; i++)
        p = add(p, mul(dot(along, b->axis[i]) > 0 ? 0.5 : -0.5, b->axis[i]));
    return p;
}

/* Returns the point of a contact along the normal of a face of `a`, given by `axis`. n points out of `a`. */
static vec face_point(const block *a, int axis, const block *b, vec n)
{
    int other = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(dot(b->axis[i], n)) > fabs(dot(b->axis[other], n)))
            other = i;
    double side = dot(b->axis[other], n) > 0 ? -0.5 : 0.5;
    vec middle = add(b->x, mul(side, b->axis[other]));
    vec e = mul(0.5, b->axis[(other + 1) % 3]), f = mul(0.5, b->axis[(other + 2) % 3]);
    vec patch[MAX_PATCH] = {add(add(middle, e), f), add(sub(middle, e), f), sub(sub(middle, e), f), sub(add(middle, e), f)};
    int size = 4;
    for (int i = 1; i < 3 && size; i++) {
        vec s = a->axis[(axis + i) % 3];
        double place = dot(s, a->x);
        size = clip(patch, size, s, place + 0.5);
        if (size)
            size = clip(patch, size, mul(-1, s), -place + 0.5);
    }
    double plane = dot(n, a->x) + 0.5, depths[MAX_PATCH];
    if (!size) {
        patch[0] = corner(b, mul(-1, n));
        size = 1;
    }
    for (int i = 0; i < size; i++)
        depths[i] = plane - dot(n, patch[i]);
    vec p = patch_point(patch, depths, size);
    return add(p, mul((plane - dot(n, p)) / 2, n));
}

/* Returns the point halfway between the two edges of an edge contact. */
static vec edge_point(const block *a, int i, const block *b, int j, vec n)
{
    vec p = corner(a, n), q = corner(b, mul(-1, n)), s = a->axis[i], t = b->axis[j];
    p = sub(p, mul(dot(sub(p, a->x), s), s));
    q = sub(q, mul(dot(sub(q, b->x), t), t));
    double c = dot(s, t), d = 1 - c * c;
    vec r = sub(q, p);
    /* Nearly parallel edges have no close intersection. The point stays on both edges. */
    p = add(p, mul(fmax(-0.5, fmin(0.5, (dot(r, s) - c * dot(r, t)) / d)), s));
    q = add(q, mul(fmax(-0.5, fmin(0.5, dot(sub(p, q), t))), t));
    return mul(0.5, add(p, q));
}

/* Finds the least overlap of two cubes along fifteen axes. Returns whether they overlap. */
static int meet(block *a, block *b, contact *found)
{
    vec d = sub(b->x, a->x);
    if (dot(d, d) >= 3)
        return 0;
    turn(a);
    turn(b);
    double c[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c[i][j] = dot(a->axis[i], b->axis[j]);
    int kind = -1;
    found->depth = 1e9;
    for (int k = 0; k < 6; k++) {
        vec n = k < 3 ? a->axis[k] : b->axis[k - 3];
        double reach = 0.5, s = dot(d, n);
        for (int i = 0; i < 3; i++)
            reach += 0.5 * fabs(k < 3 ? c[k][i] : c[i][k - 3]);
        double depth = reach - fabs(s);
        if (depth <= 0)
            return 0;
        if (depth < found->depth) {
            *found = (contact){depth, mul(s < 0 ? -1 : 1, n), d};
            kind = k;
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            vec n = cross(a->axis[i], b->axis[j]);
            double l = len(n), reach = 0;
            if (l < 1e-5)
                continue;
            n = mul(1 / l, n);
            for (int m = 0; m < 3; m++)
                reach += 0.5 * (fabs(dot(n, a->axis[m])) + fabs(dot(n, b->axis[m])));
            double s = dot(d, n), depth = reach - fabs(s);
            if (depth <= 0)
                return 0;
            if (depth < found->depth - 1e-9) {
                *found = (contact){depth, mul(s < 0 ? -1 : 1, n), d};
                kind = 6 + 3 * i + j;
            }
        }
    vec n = found->normal;
    if (kind < 3)
        found->point = face_point(a, kind, b, n);
    else if (kind < 6)
        found->point = face_point(b, kind - 3, a, mul(-1, n));
    else
        found->point = edge_point(a, (kind - 6) / 3, b, (kind - 6) % 3, n);
    return 1;
}

/* Finds the contact of a block with the floor z = 0, which is `a`. */
static int land(block *b, contact *found)
{
    if (b->x.z > 0.8661)
        return 0;
    turn(b);
    vec points[8];
    double depths[8], deepest = 0;
    for (int i = 0; i < 8; i++) {
        points[i] = b->x;
        for (int k = 0; k < 3; k++)
            points[i] = add(points[i], mul(i >> k & 1 ? 0.5 : -0.5, b->axis[k]));
        depths[i] = -points[i].z;
        deepest = fmax(deepest, depths[i]);
    }
    if (deepest <= 0)
        return 0;
    vec p = patch_point(points, depths, 8);
    p.z /= 2;
    *found = (contact){deepest, v3(0, 0, 1), p};
    return 1;
}

/* Applies spring, damper and friction of a contact over a step. */
static void respond(block *a, block *b, const contact *at, double h)
{
    double y = yielding(a, at->point, at->normal) + yielding(b, at->point, at->normal);
    vec u = sub(velocity_at(b, at->point), velocity_at(a, at->point));
    /* The damper acts on the mean of the speeds before and after. */
    double normal = h * (K * at->depth - C * dot(u, at->normal)) / (1 + h * C * y / 2);
    if (normal <= 0)
        return;
    push(a, at->point, mul(-normal, at->normal));
    push(b, at->point, mul(normal, at->normal));
    u = sub(velocity_at(b, at->point), velocity_at(a, at->point));
    vec slip = sub(u, mul(dot(u, at->normal), at->normal));
    double speed = len(slip);
    if (speed < 1e-12)
        return;
    vec t = mul(1 / speed, slip);
    y = yielding(a, at->point, t) + yielding(b, at->point, t);
    double impulse = fmin(MU * normal, speed / y);
    push(a, at->point, mul(impulse, t));
    push(b, at->point, mul(-impulse, t));
}

/* Magnetized face. */
static vec magnet, outward, sideways[2];

/* Finds the face of a block that is nearest to the magnet: its normal and its centre. */
static vec nearest_face(const block *b, vec *normal)
{
    vec d = sub(magnet, b->x);
    int best = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(dot(d, b->axis[i])) > fabs(dot(d, b->axis[best])))
            best = i;
    *normal = mul(dot(d, b->axis[best]) < 0 ? -1 : 1, b->axis[best]);
    return add(b->x, mul(0.5, *normal));
}

/* Returns a force towards a point. It is reduced if a step would take the block past the point. */
static void attract(block *b, vec from, vec to, double force, double range, double h)
{
    vec d = sub(to, from);
    double distance = len(d);
    if (distance > 0)
        push(b, from, mul(h * force * fmin(1, distance / range) / distance, d));
}

static void pull(block *b, double h)
{
    vec d = sub(magnet, b->x);
    if (dot(d, d) > (REACH + 0.8661) * (REACH + 0.8661))
        return;
    turn(b);
    vec normal, centre = nearest_face(b, &normal);
    double distance = len(sub(magnet, centre));
    if (distance >= REACH)
        return;
    vec x = b->x;
    attract(b, centre, magnet, PULL, 2.5 * PULL * h * h, h);
    if (distance >= ALIGN_REACH)
        return;
    /* Corners in one sense of rotation, as seen from outside of the magnet. */
    vec theirs[4], ours[4], e = v3(0, 0, 0);
    for (int i = 0; i < 3; i++)
        if (fabs(dot(b->axis[i], normal)) < 0.5) {
            e = b->axis[i];
            break;
        }
    vec f = cross(normal, e);
    static const double sign[4][2] = {{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}};
    for (int i = 0; i < 4; i++) {
        theirs[i] = add(magnet, add(mul(sign[i][0], sideways[0]), mul(sign[i][1], sideways[1])));
        ours[i] = add(add(x, mul(0.5, normal)), add(mul(sign[i][0], e), mul(-sign[i][1], f)));
    }
    int best = 0;
    double least = 1e9;
    for (int turn = 0; turn < 4; turn++) {
        double sum = 0;
        for (int i = 0; i < 4; i++) {
            vec r = sub(theirs[i], ours[(i + turn) % 4]);
            sum += dot(r, r);
        }
        if (sum < least) {
            least = sum;
            best = turn;
        }
    }
    for (int i = 0; i < 4; i++)
        attract(b, ours[(i + best) % 4], theirs[i], ALIGN, 12 * ALIGN * h * h, h);
}

/* Returns whether a block docks on the straight path of its nearest face from `old` to `b`. Sets the least distance. */
static int docks(const block *b, const block *old, double *distance)
{
    vec normal, now = nearest_face(b, &normal), before = old->x;
    for (int i = 0; i < 3; i++)
        before = add(before, mul(0.5 * dot(normal, b->axis[i]), old->axis[i]));
    vec way = sub(now, before), r = sub(magnet, before);
    double l = dot(way, way), t = l > 0 ? fmax(0, fmin(1, dot(r, way) / l)) : 0;
    *distance = len(sub(r, mul(t, way)));
    return *distance < ANCHOR && dot(normal, outward) < -COS_TILT;
}

static void magnetize(vec parent, char face)
{
    static const char names[] = "EWNSUD";
    static const double out[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const char *place = strchr(names, face);
    if (!face || !place) {
        fprintf(stderr, "a chain is made of the letters E, W, N, S, U and D\n");
        exit(2);
    }
    const double *n = out[place - names];
    outward = v3(n[0], n[1], n[2]);
    sideways[0] = fabs(outward.z) > 0.5 ? v3(1, 0, 0) : v3(0, 0, 1);
    sideways[1] = cross(outward, sideways[0]);
    magnet = add(parent, mul(0.5, outward));
}

typedef struct { short a, b; } pair;
static pair pairs[MAX_PAIRS];
static int pair_count;

/* Pairs that may touch within a tick. A negative b is a built block. */
static void list_pairs(void)
{
    static float x[MAX_BLOCKS], y[MAX_BLOCKS], z[MAX_BLOCKS], range[MAX_BLOCKS];
    pair_count = 0;
    /* Kicks, pull, wall and collisions add much less than 0.4 to a block's path in a tick. */
    for (int i = 0; i < free_blocks; i++) {
        x[i] = blocks[i].x.x;
        y[i] = blocks[i].x.y;
        z[i] = blocks[i].x.z;
        range[i] = len(blocks[i].v) + 0.4 + 1.7321 / 2;
    }
    for (int i = 0; i < free_blocks; i++) {
        for (int j = 0; j < i; j++) {
            float dx = x[j] - x[i], dy = y[j] - y[i], dz = z[j] - z[i], r = range[i] + range[j];
            if (dx * dx + dy * dy + dz * dz < r * r && pair_count < MAX_PAIRS)
                pairs[pair_count++] = (pair){i, j};
        }
        for (int j = 0; j < built_blocks; j++)
            if (len(sub(built[j].x, blocks[i].x)) < range[i] + 1.7321 / 2 && pair_count < MAX_PAIRS)
                pairs[pair_count++] = (pair){i, -1 - j};
    }
    if (pair_count == MAX_PAIRS) {
        fprintf(stderr, "more than %d pairs\n", MAX_PAIRS);
        exit(1);
    }
}

static void kick(block *b)
{
    double size = SPEED * uniform(), z = 2 * uniform() - 1, angle = 2 * M_PI * uniform(), s = sqrt(1 - z * z);
    b->v = add(b->v, mul(size, v3(s * cos(angle), s * sin(angle), z)));
}

/* Makes one step. Returns the block that docks, or -1. */
static int step(double h)
{
    double keep = exp(-DRAG * h), nearest = 1e9, distance;
    int docked = -1;
    contact at;
    block ground = {.x = {0, 0, 0}};
    for (int i = 0; i < free_blocks; i++) {
        block *b = &blocks[i];
        double out = len(b->x) - R;
        if (out > 0)
            b->v = sub(b->v, mul(h * WALL * out / len(b->x), b->x));
        pull(b, h);
        if (land(b, &at))
            respond(&ground, b, &at, h);
    }
    for (int k = 0; k < pair_count; k++) {
        block *a = &blocks[pairs[k].a], *b = pairs[k].b < 0 ? &built[-1 - pairs[k].b] : &blocks[pairs[k].b];
        if (meet(a, b, &at))
            respond(a, b, &at, h);
    }
    for (int i = 0; i < free_blocks; i++) {
        block *b = &blocks[i], old;
        vec d = sub(magnet, b->x);
        int looks = dot(d, d) < 9;
        if (looks) {
            turn(b);
            old = *b;
        }
        b->v = mul(keep, b->v);
        b->x = add(b->x, mul(h, b->v));
        if (!looks)
            continue;
        now += h;
        turn(b);
        now -= h;
        if (docks(b, &old, &distance) && distance < nearest) {
            nearest = distance;
            docked = i;
        }
    }
    now += h;
    return docked;
}

/* Simulates a chain. Returns its time, or -1 if it takes more than `most` ticks. */
static long simulate(const char *chain, int steps, long most)
{
    vec parent = v3(0, 0, -0.5);
    now = 0;
    fill();
    built_blocks = 0;
    magnetize(parent, chain[0]);
    for (long tick = 1; tick <= most; tick++) {
        for (int i = 0; i < free_blocks; i++)
            kick(&blocks[i]);
        list_pairs();
        for (int k = 0; k < steps; k++) {
            int docked = step(1.0 / steps);
            if (docked < 0)
                continue;
            parent = add(parent, outward);
            built[built_blocks++] = at_rest(parent, 1);
            blocks[docked] = blocks[--free_blocks];
            if (!chain[built_blocks])
                return tick;
            magnetize(parent, chain[built_blocks]);
            list_pairs();
        }
    }
    return -1;
}

int main(int count, char **words)
{
    long runs = 100, seed = 1, steps = 16, most = 100000, done = 0;
    if (count < 2 || strlen(words[1]) > MAX_CHAIN || count % 2) {
        fprintf(stderr, "usage: second CHAIN [--runs N] [--seed N] [--steps N] [--max-ticks N]\n");
        return 2;
    }
    for (int i = 2; i + 1 < count; i += 2) {
        long value = atol(words[i + 1]);
        if (!strcmp(words[i], "--runs"))
            runs = value;
        else if (!strcmp(words[i], "--seed"))
            seed = value;
        else if (!strcmp(words[i], "--steps"))
            steps = value;
        else if (!strcmp(words[i], "--max-ticks"))
            most = value;
        else {
            fprintf(stderr, "unknown option %s\n", words[i]);
            return 2;
        }
    }
    to_block_units();
    double sum = 0, squares = 0;
    for (long run = 0; run < runs; run++) {
        seed_rng((uint64_t)seed << 32 | run);
        long ticks = simulate(words[1], steps, most);
        printf("%ld\t%ld\n", run, ticks);
        fflush(stdout);
        if (ticks >= 0) {
            done++;
            sum += ticks;
            squares += (double)ticks * ticks;
        }
    }
    double mean = sum / done, sd = sqrt((squares - sum * mean) / (done - 1));
    printf("%ld of %ld runs: mean %.0f +- %.0f, SD %.0f\n", done, runs, mean, 1.96 * sd / sqrt(done), sd);
    return 0;
}
