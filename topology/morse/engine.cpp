// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/engine.h"

#include <fmt/format.h>

#include "topology/morse/morse_sections.h"
#include "topology/morse/streamline_labels.h"

namespace morsel::topology {
namespace {

constexpr std::string_view kNames[] = {"certified", "morse", "both"};
constexpr std::size_t kNamed = 10;  // disagreements that the message spells out

[[noreturn]] void throw_disagreement(const Audit& audit) {
  std::string text = fmt::format(
      "the certified and the Morse engine disagree in {} place{}:", audit.disagreements.size(),
      audit.disagreements.size() == 1 ? "" : "s");
  for (std::size_t i = 0; i < std::min(kNamed, audit.disagreements.size()); ++i) {
    const Audit::Disagreement& d = audit.disagreements[i];
    text +=
        fmt::format("\n  at ({:.9g}, {:.9g}, {:.9g}): {}", d.place.x, d.place.y, d.place.z, d.what);
  }
  if (audit.perturbation > 0.0)
    text += fmt::format(
        "\n  (the Morse engine looked at the field plus a linear term of at most {:g}: pieces that "
        "are joined, parted or there at all by less than this may differ; try a smaller "
        "perturbation)",
        audit.perturbation);
  throw EnginesDisagree(text);
}

}  // namespace

std::string_view to_string(Engine engine) { return kNames[static_cast<int>(engine)]; }

Engine engine_named(const std::string& name) {
  for (const Engine engine : {Engine::kCertified, Engine::kMorse, Engine::kBoth})
    if (to_string(engine) == name) return engine;
  throw std::invalid_argument(
      fmt::format("unknown engine \"{}\"; choices: certified, morse, both", name));
}

Topology run_engine(const EngineOptions& engine, const ScalarField& field,
                    const CertifyOptions& options, Sections& sections, const Execution& execution) {
  Topology topology = certify(field, options, execution);
  if (engine.engine == Engine::kCertified) return topology;
  MorseOptions morse;
  morse.box = topology.box;
  morse.paths = true;
  morse.perturbation = engine.perturbation;
  MorseComplex complex = morse_complex(field, morse, execution);
  if (engine.engine == Engine::kMorse) {
    label_by_streamlines(field, complex, topology, execution);
    put_morse(sections, complex, nullptr);
  } else {
    const Audit result = audit(field, topology, complex, execution, engine.audit);
    if (!result.disagreements.empty()) throw_disagreement(result);
    adopt_labels(result, complex, topology);
    put_morse(sections, complex, &result);
    if (!result.agreed()) return topology;
  }
  topology.engine = to_string(engine.engine);
  return topology;
}

}  // namespace morsel::topology
