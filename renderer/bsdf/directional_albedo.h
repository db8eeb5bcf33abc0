// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/bsdf/albedo_table.h"

namespace morsel::render {

// Share of light that a GGX mirror with F = 1 reflects in a single bounce (the rest would bounce
// again). Integrated at first use (about 20 ms).
const AlbedoTable& ggx_albedo();

// The single bounces at a GGX interface between two media with exact Fresnel terms: `reflected`
// alone, and `total` with what is refracted, energies, not radiances.
struct InterfaceAlbedo {
  AlbedoTable reflected, total;
};

// Both sides of an interface of relative index `ior` > 0: seen from the side of index 1, and from
// the side of index `ior`.
struct InterfaceTables {
  float ior = 1.0f;
  float normal = 0.0f;  // reflectance at normal incidence
  InterfaceAlbedo outside, inside;

  const InterfaceAlbedo& side(bool from_outside) const { return from_outside ? outside : inside; }
};

// Integrated when an index is asked for the first time (about 40 ms), then kept for the life of the
// process. Thread-safe, but takes a lock: not for every hit.
const InterfaceTables& interface_albedo(float ior);

// Share of light that the sheen lobe of colour 1 reflects (sheen.h).
const AlbedoTable& sheen_albedo();

// What a GGX lobe loses because light bounces more than once, given back as a lobe that is
// reciprocal and complements the albedo exactly: f = (1 - E(wo)) (1 - E(wi)) / (pi (1 - E_avg))
// (Kelemen & Szirmay-Kalos 2001; Kulla & Conty, "Revisiting Physically Based Shading at
// Imageworks", 2017). Returns f * wi.z, `wi` being the direction's absolute cosine.
inline float complement(const AlbedoTable& table_o, const AlbedoTable& table_i,
                        const AlbedoTable::Place& alpha, float cos_o, float cos_i) {
  const float rest = 1.0f - table_i.average(alpha);
  if (rest <= 1e-6f) return 0.0f;
  return (1.0f - table_o.at(AlbedoTable::cosine_place(cos_o), alpha)) *
         (1.0f - table_i.at(AlbedoTable::cosine_place(cos_i), alpha)) * cos_i * kInvPi / rest;
}
inline float complement(const AlbedoTable& table_o, const AlbedoTable& table_i, float alpha,
                        float cos_o, float cos_i) {
  return complement(table_o, table_i, AlbedoTable::alpha_place(alpha), cos_o, cos_i);
}

}  // namespace morsel::render
