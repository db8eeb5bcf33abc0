/* SPDX-License-Identifier: Apache-2.0 */
/* The header by itself, as C99: what structs of version 0 look like to programs that were compiled with them. */
#include <morsel/hypertexture_geom.h>

#define HOLDS(name, condition) typedef char name[(condition) ? 1 : -1]
#define SIZE(type, bytes) HOLDS(size_of_##type, sizeof(type) == (bytes))
#define AT(type, member, bytes) \
  HOLDS(type##_##member, offsetof(type, member) == (bytes))

HOLDS(handles_are_pointers, sizeof(MorselField) == sizeof(void*));
HOLDS(results_are_32_bits, sizeof(MorselResult) == 4);
#if UINTPTR_MAX == UINT64_MAX
SIZE(MorselBuildOptions, 48);
AT(MorselBuildOptions, progress, 16);
AT(MorselBuildOptions, user, 32);
AT(MorselBuildOptions, engine, 40); /* the end of version 0.1 */
SIZE(MorselTopologyInfo, 136);
AT(MorselTopologyInfo, certified, 32);
AT(MorselTopologyInfo, seconds, 72);
AT(MorselTopologyInfo, upper, 104);
AT(MorselTopologyInfo, critical_points, 128); /* the end of version 0.1 */
SIZE(MorselComponent, 104);
AT(MorselComponent, seed, 72);
AT(MorselComponent, maxima, 96); /* the end of version 0.2 */
SIZE(MorselCriticalPoint, 96);
AT(MorselCriticalPoint, type, 88);
SIZE(MorselGeometryOptions, 64);
AT(MorselGeometryOptions, threads, 24);
AT(MorselGeometryOptions, solver, 32);   /* the end of version 0.1 */
AT(MorselGeometryOptions, progress, 40); /* the end of version 0.2 */
AT(MorselGeometryOptions, user, 56);
SIZE(MorselGeometryInfo, 104);
AT(MorselGeometryInfo, step_limits, 24);
AT(MorselGeometryInfo, main_component, 96);
SIZE(MorselShading, 88);
AT(MorselShading, component, 44);
AT(MorselShading, position, 56);
SIZE(MorselDetail, 96);
AT(MorselDetail, component, 88);
SIZE(MorselHit, 48);
AT(MorselHit, gradient, 8);
AT(MorselHit, prim_id, 32);
/* MorselRay does not say its size: it is this for good. */
SIZE(MorselRay, 32);
AT(MorselRay, origin, 0);
AT(MorselRay, direction, 12);
AT(MorselRay, tnear, 24);
AT(MorselRay, tfar, 28);
#endif

/* Called from the C++ test, so that it is C that makes the calls. */
MorselResult c99_evaluate(const char* json, const double* points, size_t count, double* values);
MorselResult c99_evaluate(const char* json, const double* points, size_t count, double* values) {
  MorselField field;
  MorselResult result = morsel_create_field(json, NULL, &field);
  if (result != MORSEL_OK) return result;
  result = morsel_evaluate_field(field, points, count, values, NULL);
  morsel_release_field(field);
  return result;
}
