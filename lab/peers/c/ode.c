// ODE: `worldstep` with sweep and prune, `quickstep` with a hash space.
#include "scene.h"

#include <ode/ode.h>
#include <stdarg.h>

#define MOST_POINTS 8 // of two cubes; ODE never finds more

static dWorldID world;
static dSpaceID space;
static dJointGroupID group;
static dBodyID *bodies;
static int quick;
static long points, messages;

static void near(void *data, dGeomID a, dGeomID b) {
    (void)data;
    dContact contact[MOST_POINTS];
    int count = dCollide(a, b, MOST_POINTS, &contact[0].geom, sizeof(dContact));
    for (int i = 0; i < count; i++) {
        contact[i].surface.mode = dContactApprox1;
        contact[i].surface.mu = FRICTION;
        dJointID joint = dJointCreateContact(world, group, &contact[i]);
        dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
    }
    points += count;
}

static void tick(uint64_t now) {
    for (uint32_t i = 0; i < blocks; i++) {
        const dReal *x = dBodyGetPosition(bodies[i]), *v = dBodyGetLinearVel(bodies[i]);
        double at[3] = {x[0], x[1], x[2]}, speed[3] = {v[0], v[1], v[2]}, out[3];
        push(now, i, at, speed, out);
        dBodySetLinearVel(bodies[i], out[0], out[1], out[2]);
    }
    points = 0;
    dSpaceCollide(space, NULL, near);
    if (quick)
        dWorldQuickStep(world, 1.0);
    else
        dWorldStep(world, 1.0);
    dJointGroupEmpty(group);
}

static void state(uint32_t block, double out[10]) {
    const dReal *x = dBodyGetPosition(bodies[block]), *v = dBodyGetLinearVel(bodies[block]);
    const dReal *q = dBodyGetQuaternion(bodies[block]);
    double s[10] = {x[0], x[1], x[2], v[0], v[1], v[2], q[1], q[2], q[3], q[0]};
    memcpy(out, s, sizeof s);
}

static double contacts(void) { return points; }

static long complaints(void) { return messages; }

// ODE leaves out a group of contacts that it cannot solve, and prints a message. Counts these messages.
static void complain(int number, const char *text, va_list rest) {
    (void)number, (void)text, (void)rest;
    messages++;
}

// Returns the precision of numbers, from ODE's build configuration.
static const char *precision(void) {
    return dCheckConfiguration("ODE_double_precision") ? "double" : "single";
}

int main(int argc, char **argv) {
    quick = strcmp(arguments(argc, argv), "quickstep") == 0;
    dInitODE2(0);
    dSetMessageHandler(complain);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    group = dJointGroupCreate(0);
    space = quick ? dHashSpaceCreate(0) : dSweepAndPruneSpaceCreate(0, dSAP_AXES_XYZ);
    dCreatePlane(space, 0, 0, 1, 0);
    bodies = malloc(blocks * sizeof *bodies);
    dMass mass;
    dMassSetBoxTotal(&mass, 1, 1, 1, 1);
    for (uint32_t i = 0; i < blocks; i++) {
        bodies[i] = dBodyCreate(world);
        dBodySetMass(bodies[i], &mass);
        dBodySetGyroscopicMode(bodies[i], 0); // a cube's inertia is equal about all axes
        dBodySetPosition(bodies[i], start[i][0], start[i][1], start[i][2]);
        dGeomSetBody(dCreateBox(space, 1, 1, 1), bodies[i]);
    }
    char version[64];
    snprintf(version, sizeof version, "ODE %s (%s precision)", dODE_VERSION, precision());
    return serve(version);
}
