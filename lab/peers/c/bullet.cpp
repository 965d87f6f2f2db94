// Bullet: sequential impulses with a tree of bounding boxes, and its default collision margin. A tick is a step of length 1.
#include "scene.h"

#include <btBulletDynamicsCommon.h>

static btDiscreteDynamicsWorld *world;
static btRigidBody **bodies;

static void tick(uint64_t now) {
    for (uint32_t i = 0; i < blocks; i++) {
        const btVector3 &x = bodies[i]->getWorldTransform().getOrigin(), &v = bodies[i]->getLinearVelocity();
        double at[3] = {x.x(), x.y(), x.z()}, speed[3] = {v.x(), v.y(), v.z()}, out[3];
        push(now, i, at, speed, out);
        bodies[i]->setLinearVelocity(btVector3(out[0], out[1], out[2]));
    }
    world->stepSimulation(1, 0);
}

static void state(uint32_t block, double out[10]) {
    const btTransform &at = bodies[block]->getWorldTransform();
    const btVector3 &x = at.getOrigin(), &v = bodies[block]->getLinearVelocity();
    const btQuaternion q = at.getRotation();
    double s[10] = {x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), q.x(), q.y(), q.z(), q.w()};
    memcpy(out, s, sizeof s);
}

// Bullet also keeps points that are about to touch. Counts only points that do.
static double contacts(void) {
    long points = 0;
    btDispatcher *found = world->getDispatcher();
    for (int i = 0; i < found->getNumManifolds(); i++) {
        const btPersistentManifold *pair = found->getManifoldByIndexInternal(i);
        for (int j = 0; j < pair->getNumContacts(); j++) points += pair->getContactPoint(j).getDistance() <= 0;
    }
    return points;
}

static long complaints(void) { return 0; }

static btRigidBody *add(btScalar mass, btCollisionShape *shape, const btVector3 &inertia, const btVector3 &at) {
    btTransform place(btQuaternion::getIdentity(), at);
    btRigidBody::btRigidBodyConstructionInfo info(mass, new btDefaultMotionState(place), shape, inertia);
    info.m_friction = sqrt(FRICTION); // the friction of a pair is the product
    btRigidBody *body = new btRigidBody(info);
    body->setActivationState(DISABLE_DEACTIVATION);
    world->addRigidBody(body);
    return body;
}

int main(int argc, char **argv) {
    arguments(argc, argv);
    btDefaultCollisionConfiguration *setup = new btDefaultCollisionConfiguration;
    world = new btDiscreteDynamicsWorld(new btCollisionDispatcher(setup), new btDbvtBroadphase,
                                        new btSequentialImpulseConstraintSolver, setup);
    world->setGravity(btVector3(0, 0, 0));
    add(0, new btStaticPlaneShape(btVector3(0, 0, 1), 0), btVector3(0, 0, 0), btVector3(0, 0, 0));
    btBoxShape *cube = new btBoxShape(btVector3(0.5, 0.5, 0.5));
    btVector3 inertia;
    cube->calculateLocalInertia(1, inertia);
    bodies = new btRigidBody *[blocks];
    for (uint32_t i = 0; i < blocks; i++)
        bodies[i] = add(1, cube, inertia, btVector3(start[i][0], start[i][1], start[i][2]));
    char version[64];
    snprintf(version, sizeof version, "Bullet %d.%02d (%s precision)", btGetVersion() / 100, btGetVersion() % 100,
             sizeof(btScalar) == 8 ? "double" : "single");
    return serve(version);
}
