/* SPDX-License-Identifier: MIT */
#include <cstring>

#include <embree3/rtcore.h>

#include "others.h"

void *bench_embree_mesh(const bench_mesh *mesh)
{
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *xyz = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                        mesh->vertex_count);
    void *index = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                          mesh->triangle_count);
    std::memcpy(xyz, mesh->positions, 3 * sizeof(float) * mesh->vertex_count);
    std::memcpy(index, mesh->triangles, 3 * sizeof(uint32_t) * mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcCommitScene(scene);
    return scene;
}

size_t bench_embree_cast(void *handle, const sph_sweep *sweeps, size_t count)
{
    size_t hits = 0;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < count; ++i) {
        const sph_sweep &s = sweeps[i];
        RTCRayHit ray = {};
        ray.ray.org_x = s.from[0], ray.ray.org_y = s.from[1], ray.ray.org_z = s.from[2];
        ray.ray.dir_x = s.to[0] - s.from[0], ray.ray.dir_y = s.to[1] - s.from[1], ray.ray.dir_z = s.to[2] - s.from[2];
        ray.ray.tfar = 1;
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(static_cast<RTCScene>(handle), &context, &ray);
        hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}
