// MuJoCo, in metres and seconds: a block has 0.2 m, a tick 0.02 s.
#include "scene.h"

#include <mujoco/mujoco.h>
#include <unistd.h>

static const double SIDE = 0.2, TICK = 0.02;
static mjModel *model;
static mjData *data;

static void tick(uint64_t now) {
    const double length = 1 / SIDE, speed = TICK / SIDE;
    for (uint32_t i = 0; i < blocks; i++) {
        const mjtNum *x = data->qpos + 7 * i;
        mjtNum *v = data->qvel + 6 * i;
        double at[3] = {x[0] * length, x[1] * length, x[2] * length};
        double was[3] = {v[0] * speed, v[1] * speed, v[2] * speed}, out[3];
        push(now, i, at, was, out);
        for (int j = 0; j < 3; j++) v[j] = out[j] / speed;
    }
    mj_step(model, data);
}

static void state(uint32_t block, double out[10]) {
    const mjtNum *x = data->qpos + 7 * block, *v = data->qvel + 6 * block;
    for (int j = 0; j < 3; j++) {
        out[j] = x[j] / SIDE;
        out[3 + j] = v[j] * TICK / SIDE;
        out[6 + j] = x[4 + j];
    }
    out[9] = x[3];
}

static double contacts(void) { return data->ncon; }

static long complaints(void) {
    long sum = 0;
    for (int i = 0; i < mjNWARNING; i++) sum += data->warning[i].number;
    return sum;
}

// The scene in MuJoCo's language. Unused features are switched off, which saves a few per cent.
static char *text(void) {
    char *out;
    size_t size;
    FILE *file = open_memstream(&out, &size);
    fprintf(file,
            "<mujoco><size memory=\"4G\"/>"
            "<option timestep=\"%g\" gravity=\"0 0 0\" solver=\"Newton\">"
            "<flag equality=\"disable\" frictionloss=\"disable\" limit=\"disable\""
            " spring=\"disable\" damper=\"disable\" actuation=\"disable\" sensor=\"disable\""
            " eulerdamp=\"disable\" autoreset=\"disable\"/></option>"
            "<default><geom friction=\"%g\"/></default><worldbody>"
            "<geom type=\"plane\" size=\"0 0 1\"/>",
            TICK, FRICTION);
    for (uint32_t i = 0; i < blocks; i++)
        fprintf(file,
                "<body pos=\"%.17g %.17g %.17g\"><freejoint/>"
                "<geom type=\"box\" size=\"0.1 0.1 0.1\" mass=\"1\"/></body>",
                start[i][0] * SIDE, start[i][1] * SIDE, start[i][2] * SIDE);
    fprintf(file, "</worldbody></mujoco>");
    fclose(file);
    return out;
}

// The compiled scene. Compiling takes quadratic time in the number of blocks, minutes for 30,000.
// The result is stored next to the program, in a file named after the text and the version.
static mjModel *compiled(const char *program) {
    char *xml = text();
    uint64_t hash = (uint64_t)mj_version();
    for (const char *c = xml; *c; c++) hash = (hash ^ (unsigned char)*c) * 0x100000001b3u;
    char name[4096], error[500] = "";
    snprintf(name, sizeof name, "%s-%u-%016lx.mjb", program, blocks, (unsigned long)hash);
    mjModel *found = access(name, R_OK) == 0 ? mj_loadModel(name, NULL) : NULL;
    if (!found) {
        mjSpec *spec = mj_parseXMLString(xml, NULL, error, sizeof error);
        found = spec ? mj_compile(spec, NULL) : NULL;
        if (!found) {
            fprintf(stderr, "%s\n", spec ? mjs_getError(spec) : error);
            exit(1);
        }
        mj_deleteSpec(spec);
        mj_saveModel(found, name, NULL, 0);
    }
    free(xml);
    return found;
}

int main(int argc, char **argv) {
    arguments(argc, argv);
    model = compiled(argv[0]);
    data = mj_makeData(model);
    char version[64];
    snprintf(version, sizeof version, "MuJoCo %s", mj_versionString());
    return serve(version);
}
