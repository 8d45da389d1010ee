#include "mesh_embree.h"

#ifndef HAS_EMBREE

struct embree_scene *embree_open(const struct mesh *mesh, double *build_s)
{
    (void)mesh;
    *build_s = 0.0;
    return NULL;
}

void embree_close(struct embree_scene *scene)
{
    (void)scene;
}

void embree_trace(struct embree_scene *scene, bool is_coherent, const float *input, float *output,
                  uint32_t rays, uint32_t first, uint32_t last)
{
    (void)scene, (void)is_coherent, (void)input, (void)output;
    (void)rays, (void)first, (void)last;
}

#else

#include <stdlib.h>
#include <string.h>

#include <embree3/rtcore.h>

#include "base/report.h"
#include "kernel/mesh_probe.h"

/* Embree does not look behind a ray's origin. It is put where the ray begins, at most so far before
 * the mesh's middle, m. */
#define BEFORE 3.0f

struct embree_scene {
    RTCDevice device;
    RTCScene scene;
};

struct embree_scene *embree_open(const struct mesh *mesh, double *build_s)
{
    struct embree_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        return NULL;
    scene->device = rtcNewDevice("threads=1");
    scene->scene = rtcNewScene(scene->device);
    const RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             12, mesh->vertex_count);
    void *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            12, mesh->triangle_count);
    memcpy(vertices, mesh->vertices, 12 * mesh->vertex_count);
    memcpy(corners, mesh->corners, 12 * mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene->scene, geometry);
    rtcReleaseGeometry(geometry);
    const double start = clock_seconds();
    rtcCommitScene(scene->scene);
    *build_s = clock_seconds() - start;
    return scene;
}

void embree_close(struct embree_scene *scene)
{
    if (!scene)
        return;
    rtcReleaseScene(scene->scene);
    rtcReleaseDevice(scene->device);
    free(scene);
}

void embree_trace(struct embree_scene *scene, bool is_coherent, const float *input, float *output,
                  uint32_t rays, uint32_t first, uint32_t last)
{
    struct RTCIntersectContext context;
    int valid[16] __attribute__((aligned(64)));
    rtcInitIntersectContext(&context);
    context.flags =
        is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    memset(valid, 0xff, sizeof valid);
    for (uint32_t ray = first; ray < last; ray += 16) {
        struct RTCRayHit16 packet __attribute__((aligned(64)));
        for (uint32_t i = 0; i < 16; i++) {
            const float *at = input + ray + i;
            const float minimum = at[PROBE_MINIMUM * rays];
            const float start = minimum < -BEFORE ? -BEFORE : minimum;
            packet.ray.org_x[i] = at[0] + start * at[PROBE_DIRECTION * rays];
            packet.ray.org_y[i] = at[rays] + start * at[(PROBE_DIRECTION + 1) * rays];
            packet.ray.org_z[i] = at[2 * rays] + start * at[(PROBE_DIRECTION + 2) * rays];
            packet.ray.dir_x[i] = at[PROBE_DIRECTION * rays];
            packet.ray.dir_y[i] = at[(PROBE_DIRECTION + 1) * rays];
            packet.ray.dir_z[i] = at[(PROBE_DIRECTION + 2) * rays];
            packet.ray.tnear[i] = 0.0f;
            packet.ray.tfar[i] = FAR_AWAY;
            packet.ray.time[i] = 0.0f;
            packet.ray.mask[i] = ~0u;
            packet.ray.flags[i] = 0;
            packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene->scene, &context, &packet);
        for (uint32_t i = 0; i < 16; i++) {
            const bool is_hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            const int32_t triangle = is_hit ? (int32_t)packet.hit.primID[i] : -1;
            output[PROBE_DISTANCE * rays + ray + i] = packet.ray.tfar[i];
            memcpy(&output[PROBE_TRIANGLE * rays + ray + i], &triangle, sizeof triangle);
        }
    }
}

#endif
