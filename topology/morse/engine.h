// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "topology/certified.h"
#include "topology/morse/audit.h"
#include "topology/morse/morse_complex.h"
#include "topology/section_file.h"

namespace morsel::topology {

// Who labels the components.
enum class Engine {
  kCertified,  // the octree's cells, joined where that is proved
  kMorse,      // the paper: critical points and separatrices; cells get their labels by ascents
  kBoth,       // certified labels, the Morse engine's results beside them, and the audit
};
std::string_view to_string(Engine engine);
// Throws std::invalid_argument that names the choices.
Engine engine_named(const std::string& name);

struct EngineOptions {
  // NOLINTNEXTLINE(google-explicit-constructor): an engine by itself is the common case
  EngineOptions(Engine which = Engine::kCertified) : engine(which) {}
  Engine engine;
  double perturbation = 0.0;  // of the Morse engine: see MorseOptions
  AuditOptions audit;         // kBoth
};

// The engines disagree: the message names the places, and a perturbation if there was one.
struct EnginesDisagree : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Labels the solid with the engine's method; the Morse engine's results go into `sections`, with
// kBoth the audit as well. Topology::engine is "both" only where the audit compared everything and
// found agreement; where something was left open it is "certified", since the labels have nothing
// but their own proof, and the audit in `sections` says what was open.
// Throws EnginesDisagree (kBoth), NotIsolated, Cancelled, std::invalid_argument.
Topology run_engine(const EngineOptions& engine, const ScalarField& field,
                    const CertifyOptions& options, Sections& sections,
                    const Execution& execution = {});

}  // namespace morsel::topology
