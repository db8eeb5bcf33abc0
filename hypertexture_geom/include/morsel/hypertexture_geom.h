/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Morsel: hypertextured implicit surfaces, without their detached pieces, as Embree user geometry.
 *
 * Plain C99. The order of work: a field from JSON, its topology (built, or loaded from a file), a
 * geometry of the components to keep, an RTCGeometry on a device of yours. Attach that to a scene,
 * trace, and ask for shading data by the primID of a hit.
 *
 * Conventions, all of which hold for every function:
 *  - Handles are opaque and counted: a create function gives one reference, retain adds one,
 * release gives one back. NULL, a handle of another kind's function, or one that was released to
 * the end is answered with MORSEL_ERROR_INVALID_HANDLE; so a double release is an error and no
 * crash.
 *  - Functions that can fail return a result: MORSEL_OK (0) or an error (negative). They then leave
 *    their outputs untouched. morsel_last_error_text says what was wrong in this thread's last
 * failed call, morsel_object_error_text in the last failed call on a handle.
 *  - Structs may grow at their end: an old program works with a new library and the other way
 *    round. All but MorselRay say how large the caller's are: by their first member, struct_size,
 *    or where they are written as entries of an array, by the parameter that is named after it
 *    (component_size, point_size, hit_size), which is sizeof the struct. Of options, a caller's
 *    zeros mean the defaults, reserved members must be 0, and so must all be that a newer struct
 * has beyond those this library knows: anything else is MORSEL_ERROR_INVALID_ARGUMENT. Of results,
 *    what a newer struct has and this library does not know is set to 0; morsel_api_version tells.
 *    MorselRay is as it is for good.
 *  - No exception and no signal leaves the library; it never writes to stdout or stderr.
 *  - Everything may be called from several threads at once; the last reference must not be released
 *    while another thread is in a call with that handle.
 *  - Points, normals and lengths are in the geometry's own space.
 */
#pragma once

/* It is C too: NOLINTBEGIN(modernize-use-using,modernize-deprecated-headers) */
#include <stddef.h>
#include <stdint.h>

#define MORSEL_API_VERSION_MAJOR 0
#define MORSEL_API_VERSION_MINOR 3

#if defined(__GNUC__)
#define MORSEL_API __attribute__((visibility("default")))
#else
#define MORSEL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Embree's types, of version 3 or 4; see morsel_embree_version. */
struct RTCDeviceTy;
struct RTCGeometryTy;

typedef struct MorselFieldHandle* MorselField;       /* a field, where to look, how finely */
typedef struct MorselTopologyHandle* MorselTopology; /* its labelled components */
typedef struct MorselGeometryHandle* MorselGeometry; /* the surface of the kept ones */
typedef struct MorselQueryHandle* MorselQuery;       /* ray queries of one geometry */

typedef int32_t MorselResult;
#define MORSEL_OK 0
#define MORSEL_ERROR_INVALID_HANDLE (-1)   /* NULL, of another kind, or already released */
#define MORSEL_ERROR_INVALID_ARGUMENT (-2) /* a null pointer, a bad number, a bad keep rule */
#define MORSEL_ERROR_INVALID_INPUT (-3)    /* the JSON text: the message names the place in it */
#define MORSEL_ERROR_FILE (-4)             /* a cache file: missing, damaged, of another field */
#define MORSEL_ERROR_CANCELLED (-5)
#define MORSEL_ERROR_OUT_OF_MEMORY (-6)
#define MORSEL_ERROR_EMBREE (-7)
#define MORSEL_ERROR_INTERNAL (-8)

#define MORSEL_NO_COMPONENT 0xffffffffu

/* ---- versions and errors ---- */
MORSEL_API uint32_t morsel_api_version(void);
MORSEL_API uint32_t morsel_embree_version(void);
MORSEL_API const char* morsel_version_text(void);
MORSEL_API const char* morsel_result_name(MorselResult result);
MORSEL_API MorselResult morsel_last_error(void);
MORSEL_API const char* morsel_last_error_text(void);
MORSEL_API const char* morsel_object_error_text(const void* handle);

/* ---- fields ---- */
MORSEL_API MorselResult morsel_create_field(const char* json, const char* name, MorselField* field);
MORSEL_API MorselResult morsel_retain_field(MorselField field);
MORSEL_API MorselResult morsel_release_field(MorselField field);
MORSEL_API MorselResult morsel_field_json(MorselField field, const char** json);
MORSEL_API MorselResult morsel_field_hash(MorselField field, const char** hash);
MORSEL_API MorselResult morsel_field_bounds(MorselField field, double lower[3], double upper[3]);
MORSEL_API MorselResult morsel_evaluate_field(MorselField field, const double* points, size_t count,
                                              double* values, double* gradients);

/* ---- topology ---- */
#define MORSEL_ENGINE_CERTIFIED 0u /* proved labels of the octree's cells */
#define MORSEL_ENGINE_MORSE 1u     /* critical points and separatrices alone */
#define MORSEL_ENGINE_BOTH 2u /* proved labels, critical points, and one checked by the other */

typedef struct MorselBuildOptions {
  size_t struct_size;
  uint32_t threads; /* 0: all processors */
  uint32_t reserved;
  /* Called now and then, from any thread but never twice at once: how much of all is done, from 0
     to 1 and never less than before, and a word for what is being done. May be NULL. */
  void (*progress)(void* user, double fraction, const char* phase);
  /* Called now and then likewise; anything but 0 stops the work. May be NULL. */
  int32_t (*cancel)(void* user);
  void* user;
  uint32_t engine; /* since 0.2: MORSEL_ENGINE_... */
  uint32_t reserved2;
} MorselBuildOptions;

typedef struct MorselTopologyInfo {
  size_t struct_size;
  uint64_t components;    /* entries of the table */
  uint64_t components_lo; /* proved: at least so many components */
  uint64_t components_hi; /* proved: at most so many; UINT64_MAX where there is no bound */
  uint32_t certified;     /* 1: nothing is unresolved, and components is the proved count */
  uint32_t main_component;
  uint64_t unresolved_cells;
  uint64_t unresolved_faces;
  uint64_t leaves; /* of the octree */
  uint64_t bytes;  /* of the cache file; 0 when there is none */
  double seconds;  /* the build took */
  double lower[3]; /* the box that was searched */
  double upper[3];
  uint64_t critical_points; /* since 0.2: that it knows; 0 when the Morse engine did not run */
} MorselTopologyInfo;

typedef struct MorselComponent {
  double lower[3]; /* of the cells that hold it */
  double upper[3];
  double volume_lo; /* proved bounds */
  double volume_hi;
  uint64_t cells;
  double seed[3];  /* a point in it or, where it has no cell of its own, next to it */
  uint64_t maxima; /* since 0.3: of F in it; 0 where the Morse engine did not run */
} MorselComponent;

#define MORSEL_CRITICAL_MAXIMUM 0u
#define MORSEL_CRITICAL_SADDLE2 1u /* two negative eigenvalues of the Hessian */
#define MORSEL_CRITICAL_SADDLE1 2u
#define MORSEL_CRITICAL_MINIMUM 3u
#define MORSEL_CRITICAL_DEGENERATE 4u /* the sign of an eigenvalue is not certain */

typedef struct MorselCriticalPoint {
  double position[3];
  double radius;         /* the true point is within this of position along every axis */
  double value;          /* of F there, positive */
  double eigenvalues[3]; /* of the Hessian, ascending */
  double axis[3];        /* unit eigenvector of the last of them */
  uint32_t type;         /* MORSEL_CRITICAL_... */
  uint32_t component;    /* MORSEL_NO_COMPONENT where that is unresolved */
} MorselCriticalPoint;

MORSEL_API MorselResult morsel_build_topology(MorselField field, const MorselBuildOptions* options,
                                              MorselTopology* topology);
MORSEL_API MorselResult morsel_load_topology(MorselField field, const char* path,
                                             MorselTopology* topology);
MORSEL_API MorselResult morsel_load_topology_with(MorselField field, const char* path,
                                                  const MorselBuildOptions* options,
                                                  MorselTopology* topology);
MORSEL_API MorselResult morsel_open_topology(MorselField field, const char* path,
                                             const MorselBuildOptions* options,
                                             MorselTopology* topology);
MORSEL_API MorselResult morsel_save_topology(MorselTopology topology, const char* path);
MORSEL_API MorselResult morsel_retain_topology(MorselTopology topology);
MORSEL_API MorselResult morsel_release_topology(MorselTopology topology);
MORSEL_API MorselResult morsel_topology_info(MorselTopology topology, MorselTopologyInfo* info);
MORSEL_API MorselResult morsel_topology_components(MorselTopology topology, size_t first,
                                                   size_t count, size_t component_size,
                                                   MorselComponent* components);
MORSEL_API MorselResult morsel_topology_critical_points(MorselTopology topology, size_t first,
                                                        size_t count, size_t point_size,
                                                        MorselCriticalPoint* points);

/* ---- geometry ---- */
#define MORSEL_SOLVER_MODEL 0u   /* a certified cubic for each primitive; F polishes the root */
#define MORSEL_SOLVER_SEGMENT 1u /* ranges of slopes for each primitive */
#define MORSEL_SOLVER_SPHERE 2u  /* sphere tracing, one primitive, for comparison: slow */

#define MORSEL_MEMBERSHIP_LABELS 0u     /* by the labelled octree */
#define MORSEL_MEMBERSHIP_STREAMLINE 1u /* by an ascent to a maximum, for comparison: slow */
#define MORSEL_MEMBERSHIP_OFF 2u        /* every component is kept */

typedef struct MorselGeometryOptions {
  size_t struct_size;
  /* Which components to keep: "main" (the default, also for NULL), "largest:K", "volume:V",
     "touching:X,Y,Z", "all", "detached", "ids:I,J,...". */
  const char* keep;
  double far_distance; /* how far ray origins may be, in diameters of the object; 0: 100 */
  uint32_t threads;    /* 0: all processors */
  uint32_t reserved;
  uint32_t solver;     /* since 0.2: MORSEL_SOLVER_... */
  uint32_t membership; /* since 0.2: MORSEL_MEMBERSHIP_... */
  void (*progress)(void* user, double fraction, const char* phase); /* since 0.3: as for a build */
  int32_t (*cancel)(void* user);
  void* user;
} MorselGeometryOptions;

typedef struct MorselGeometryInfo {
  size_t struct_size;
  uint64_t primitives;  /* primID is below this */
  uint64_t bytes;       /* all that it holds, but for the field and Embree's own hierarchy */
  uint64_t step_limits; /* ray tests so far that ended at the limit of evaluations: see the page */
  double lower[3];      /* lower > upper when nothing is kept */
  double upper[3];
  double padding; /* what the bounds that Embree gets add to that */
  uint64_t kept_components;
  uint32_t main_component;
  uint32_t reserved;
} MorselGeometryInfo;

typedef struct MorselShading {
  size_t struct_size;
  float normal[3];       /* unit, outward */
  float spawn_front[3];  /* origin for rays that leave outward */
  float spawn_behind[3]; /* origin for rays that go inward */
  uint32_t component;
  uint32_t spawn_verified; /* 1: F was evaluated at both, and they are on their sides */
  uint32_t reserved;
  double position[3];
  double position_error; /* the surface is within this of position, if spawn_verified */
} MorselShading;

typedef struct MorselDetail {
  size_t struct_size;
  double density;        /* D before modulations */
  double noise;          /* F - D */
  double reference[3];   /* the point before domain warps */
  double gradient[3];    /* of F, pointing inward */
  double mean_curvature; /* positive where convex */
  double gaussian_curvature;
  uint32_t component;
  uint32_t reserved;
} MorselDetail;

MORSEL_API MorselResult morsel_create_geometry(MorselField field, MorselTopology topology,
                                               const MorselGeometryOptions* options,
                                               MorselGeometry* geometry);
MORSEL_API MorselResult morsel_retain_geometry(MorselGeometry geometry);
MORSEL_API MorselResult morsel_release_geometry(MorselGeometry geometry);
MORSEL_API MorselResult morsel_geometry_info(MorselGeometry geometry, MorselGeometryInfo* info);
MORSEL_API MorselResult morsel_geometry_keeps(MorselGeometry geometry, uint32_t component,
                                              int32_t* kept);
MORSEL_API MorselResult morsel_geometry_component(MorselGeometry geometry, uint32_t prim_id,
                                                  uint32_t* component);
#define MORSEL_RTC_OCCLUSION_FILTER 1u /* the geometry gets an occlusion filter function */
MORSEL_API MorselResult morsel_create_rtc_geometry(MorselGeometry geometry,
                                                   struct RTCDeviceTy* device, uint32_t flags,
                                                   struct RTCGeometryTy** rtc_geometry);
MORSEL_API MorselResult morsel_shade(MorselGeometry geometry, uint32_t prim_id,
                                     const float point[3], float extra_error,
                                     MorselShading* shading);
MORSEL_API MorselResult morsel_shade_detail(MorselGeometry geometry, uint32_t prim_id,
                                            const double point[3], MorselDetail* detail);

/* ---- ray queries of one geometry ---- */
typedef struct MorselRay { /* does not grow */
  float origin[3];
  float direction[3]; /* of any length */
  float tnear;        /* >= 0 */
  float tfar;         /* may be infinite */
} MorselRay;

typedef struct MorselHit {
  double t;
  double gradient[3]; /* of F, pointing inward */
  uint32_t prim_id;
  uint32_t component;
  uint32_t entering; /* 1: from outside to inside */
  uint32_t reserved;
} MorselHit;

MORSEL_API MorselResult morsel_create_query(MorselGeometry geometry, struct RTCDeviceTy* device,
                                            MorselQuery* query);
MORSEL_API MorselResult morsel_retain_query(MorselQuery query);
MORSEL_API MorselResult morsel_release_query(MorselQuery query);
MORSEL_API MorselResult morsel_query_all_hits(MorselQuery query, const MorselRay* ray,
                                              size_t hit_size, MorselHit* hits, size_t capacity,
                                              size_t* count);
MORSEL_API MorselResult morsel_query_first_hit(MorselQuery query, const MorselRay* ray,
                                               size_t hit_size, MorselHit* hit, int32_t* found);
MORSEL_API MorselResult morsel_query_any_hit(MorselQuery query, const MorselRay* ray,
                                             int32_t* found);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-use-using,modernize-deprecated-headers) */
