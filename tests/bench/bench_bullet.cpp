/* SPDX-License-Identifier: MIT */
#include <btBulletCollisionCommon.h>

#include "others.h"

namespace
{

struct World {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btCollisionWorld world{&dispatcher, &broadphase, &configuration};
    btCollisionObject object;

    explicit World(btCollisionShape *shape)
    {
        object.setCollisionShape(shape);
        world.addCollisionObject(&object);
    }
};

btVector3 vector(const float *x)
{
    return btVector3(x[0], x[1], x[2]);
}

btCollisionShape *hull(const float *centers, const float *radii, const uint32_t *spheres, int count)
{
    btVector3 c[3];
    btScalar r[3];
    for (int i = 0; i < count; ++i) {
        c[i] = vector(centers + 3 * spheres[i]);
        r[i] = radii[spheres[i]];
    }
    return new btMultiSphereShape(c, r, count);
}

} // namespace

/* What is made here lives as long as the program. */
void *bench_bullet_mesh(const bench_mesh *mesh)
{
    auto *triangles = new btTriangleMesh;
    for (size_t i = 0; i < mesh->triangle_count; ++i) {
        const uint32_t *t = mesh->triangles + 3 * i;
        triangles->addTriangle(vector(mesh->positions + 3 * t[0]), vector(mesh->positions + 3 * t[1]),
                               vector(mesh->positions + 3 * t[2]));
    }
    return new World(new btBvhTriangleMeshShape(triangles, true));
}

void *bench_bullet_compound(const float *centers, const float *radii, const sph_level_arrays *level)
{
    auto *compound = new btCompoundShape;
    for (size_t i = 0; i < level->triangle_count; ++i)
        compound->addChildShape(btTransform::getIdentity(), hull(centers, radii, level->triangles + 3 * i, 3));
    for (size_t i = 0; i < level->edge_count; ++i)
        compound->addChildShape(btTransform::getIdentity(), hull(centers, radii, level->edges + 2 * i, 2));
    return new World(compound);
}

size_t bench_bullet_cast(void *handle, const sph_sweep *sweeps, size_t count)
{
    auto *w = static_cast<World *>(handle);
    size_t hits = 0;
    for (size_t i = 0; i < count; ++i) {
        const btVector3 from = vector(sweeps[i].from), to = vector(sweeps[i].to);
        if (sweeps[i].radius > 0) {
            btSphereShape sphere(sweeps[i].radius);
            btTransform a(btQuaternion::getIdentity(), from), b(btQuaternion::getIdentity(), to);
            btCollisionWorld::ClosestConvexResultCallback result(from, to);
            w->world.convexSweepTest(&sphere, a, b, result);
            hits += result.hasHit();
        } else {
            btCollisionWorld::ClosestRayResultCallback result(from, to);
            w->world.rayTest(from, to, result);
            hits += result.hasHit();
        }
    }
    return hits;
}
