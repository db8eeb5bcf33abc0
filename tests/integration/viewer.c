/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A small viewer on Embree that shows a hypertexture among triangles, written against the installed package alone.
 *
 *   viewer KEEP CACHE PICTURE.ppm [WIDTH HEIGHT]
 *
 * One light, shadows, no materials: the rock comes out reddish, triangles bluish, the background grey.
 */
#if EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <math.h>
#include <morsel/hypertexture_geom.h>
#include <pmmintrin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

static const char kRock[] =
    "{\"density\": {\"type\": \"sphere\", \"radius\": 1},"
    " \"modulations\": [{\"type\": \"fbm\", \"noise\": \"sparse_convolution\", \"amplitude\": 0.8,"
    "                  \"frequency\": 3, \"layers\": 1, \"seed\": 1, \"impulses_per_cell\": 3}]}";

static void check(MorselResult result, const char* what) {
  if (result == MORSEL_OK) return;
  fprintf(stderr, "%s: %s: %s\n", what, morsel_result_name(result), morsel_last_error_text());
  exit(1);
}

static void report(void* user, double fraction, const char* phase) {
  int* percent = user;
  const int now = (int)(100.0 * fraction);
  if (now / 25 != *percent / 25) fprintf(stderr, "%s %d%%\n", phase, now);
  *percent = now;
}

/* ---- the triangles: a floor, and a pyramid that stands in front ---- */

static unsigned add_triangles(RTCDevice device, RTCScene scene) {
  static const float corners[9][3] = {{-6, -6, -1.7f}, {6, -6, -1.7f},     {6, 6, -1.7f},
                                      {-6, 6, -1.7f},  {1.2f, -2, -1.7f},  {2.2f, -2, -1.7f},
                                      {2.2f, -1, -1.7f}, {1.2f, -1, -1.7f}, {1.7f, -1.5f, -0.6f}};
  static const unsigned triangles[6][3] = {{0, 1, 2}, {0, 2, 3}, {4, 5, 8},
                                           {5, 6, 8}, {6, 7, 8}, {7, 4, 8}};
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 3 * sizeof(float), 9),
         corners, sizeof corners);
  memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                 3 * sizeof(unsigned), 6),
         triangles, sizeof triangles);
  rtcCommitGeometry(mesh);
  const unsigned id = rtcAttachGeometry(scene, mesh);
  rtcReleaseGeometry(mesh);
  return id;
}

/* ---- vectors and rays ---- */

static float dot(const float a[3], const float b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void normalize(float a[3]) {
  const float s = 1.0f / sqrtf(dot(a, a));
  for (int i = 0; i < 3; ++i) a[i] *= s;
}

static struct RTCRay ray_of(const float o[3], const float d[3], float tnear) {
  struct RTCRay ray;
  memset(&ray, 0, sizeof ray);
  ray.org_x = o[0], ray.org_y = o[1], ray.org_z = o[2];
  ray.dir_x = d[0], ray.dir_y = d[1], ray.dir_z = d[2];
  ray.tnear = tnear;
  ray.tfar = INFINITY;
  ray.mask = 0xffffffffu;
  return ray;
}

static struct RTCRayHit intersect(RTCScene scene, const float o[3], const float d[3]) {
  struct RTCRayHit r;
  memset(&r.hit, 0, sizeof r.hit);
  r.ray = ray_of(o, d, 0.0f);
  r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if EMBREE_MAJOR >= 4
  rtcIntersect1(scene, &r, NULL);
#else
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &r);
#endif
  return r;
}

static int occluded(RTCScene scene, const float o[3], const float d[3], float tnear) {
  struct RTCRay ray = ray_of(o, d, tnear);
#if EMBREE_MAJOR >= 4
  rtcOccluded1(scene, &ray, NULL);
#else
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
  return ray.tfar < 0.0f;
}

/* ---- pictures ---- */

struct World {
  RTCScene scene;
  unsigned rock_id;
  MorselGeometry rock;
  unsigned long rock_pixels, triangle_pixels;
};

static void colour_of(struct World* world, const float eye[3], const float d[3], float rgb[3]) {
  static const float reddish[3] = {0.9f, 0.55f, 0.35f}, bluish[3] = {0.35f, 0.5f, 0.9f};
  float light[3] = {-0.5f, -0.7f, 1.0f};
  normalize(light);
  const struct RTCRayHit h = intersect(world->scene, eye, d);
  if (h.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    rgb[0] = rgb[1] = rgb[2] = 0.75f + 0.2f * d[2];
    return;
  }
  float p[3], n[3], start[3], tnear = 0.0f;
  const float* base = bluish;
  for (int i = 0; i < 3; ++i) p[i] = eye[i] + h.ray.tfar * d[i];
  if (h.hit.geomID == world->rock_id) {
    MorselShading s;
    s.struct_size = sizeof s;
    check(morsel_shade(world->rock, h.hit.primID, p, h.ray.tfar * 2.4e-7f, &s), "shading");
    memcpy(n, s.normal, sizeof n);
    /* No epsilon: the point is on the outer side of the surface, by evaluation. */
    memcpy(start, s.spawn_front, sizeof start);
    base = reddish;
    ++world->rock_pixels;
  } else {
    n[0] = h.hit.Ng_x, n[1] = h.hit.Ng_y, n[2] = h.hit.Ng_z;
    normalize(n);
    memcpy(start, p, sizeof start);
    tnear = 1e-4f;
    ++world->triangle_pixels;
  }
  if (dot(n, d) > 0.0f)
    for (int i = 0; i < 3; ++i) n[i] = -n[i];
  float brightness = 0.25f;
  const float facing = dot(n, light);
  if (facing > 0.0f && !occluded(world->scene, start, light, tnear)) brightness += 0.75f * facing;
  for (int i = 0; i < 3; ++i) rgb[i] = base[i] * brightness;
}

static void write_picture(struct World* world, const char* path, int width, int height) {
  FILE* file = fopen(path, "wb");
  if (!file) {
    perror(path);
    exit(1);
  }
  fprintf(file, "P6\n%d %d\n255\n", width, height);
  const float eye[3] = {0.0f, -5.5f, 1.2f};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float scale = 0.9f / (float)height;
      float d[3] = {((float)x + 0.5f - 0.5f * (float)width) * scale, 1.0f,
                    -0.25f - ((float)y + 0.5f - 0.5f * (float)height) * scale};
      float rgb[3];
      normalize(d);
      colour_of(world, eye, d, rgb);
      for (int i = 0; i < 3; ++i) fputc((int)(255.0f * fminf(fmaxf(rgb[i], 0.0f), 1.0f)), file);
    }
  if (fclose(file) != 0) {
    perror(path);
    exit(1);
  }
}

int main(int argc, char** argv) {
  if (argc != 4 && argc != 6) {
    fprintf(stderr, "Usage: viewer KEEP CACHE PICTURE.ppm [WIDTH HEIGHT]\n");
    return 2;
  }
  const int width = argc == 6 ? atoi(argv[4]) : 200, height = argc == 6 ? atoi(argv[5]) : 150;
  if (width < 1 || height < 1 || width > 10000 || height > 10000) {
    fprintf(stderr, "viewer: the picture's sides must be from 1 to 10000\n");
    return 2;
  }
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  if (morsel_api_version() >> 16 != MORSEL_API_VERSION_MAJOR ||
      morsel_embree_version() / 10000 != RTC_VERSION_MAJOR) {
    fprintf(stderr, "viewer: does not fit %s\n", morsel_version_text());
    return 1;
  }

  RTCDevice device = rtcNewDevice(NULL);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  add_triangles(device, scene);

  MorselField field;
  check(morsel_create_field(kRock, "rock", &field), "field");
  int percent = 0;
  MorselBuildOptions build;
  memset(&build, 0, sizeof build);
  build.struct_size = sizeof build;
  build.progress = report;
  build.user = &percent;
  MorselTopology topology;
  check(morsel_open_topology(field, argv[2], &build, &topology), "topology");
  MorselGeometryOptions options;
  memset(&options, 0, sizeof options);
  options.struct_size = sizeof options;
  options.keep = argv[1];
  MorselGeometry geometry;
  check(morsel_create_geometry(field, topology, &options, &geometry), "geometry");
  RTCGeometry rock;
  check(morsel_create_rtc_geometry(geometry, device, 0, &rock), "Embree geometry");
  struct World world = {scene, rtcAttachGeometry(scene, rock), geometry, 0, 0};
  rtcReleaseGeometry(rock);
  rtcCommitScene(scene);

  MorselTopologyInfo info;
  info.struct_size = sizeof info;
  check(morsel_topology_info(topology, &info), "information");
  write_picture(&world, argv[3], width, height);
  MorselGeometryInfo used;
  used.struct_size = sizeof used;
  check(morsel_geometry_info(geometry, &used), "information");
  printf("components %llu certified %u kept %llu rock %lu triangles %lu step_limits %llu\n",
         (unsigned long long)info.components, info.certified,
         (unsigned long long)used.kept_components, world.rock_pixels, world.triangle_pixels,
         (unsigned long long)used.step_limits);

  /* The scene first: it points into the geometry. */
  rtcReleaseScene(scene);
  check(morsel_release_geometry(geometry), "release");
  check(morsel_release_topology(topology), "release");
  check(morsel_release_field(field), "release");
  const int failed = rtcGetDeviceError(device) != RTC_ERROR_NONE;
  rtcReleaseDevice(device);
  return failed;
}
