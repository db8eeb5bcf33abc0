// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/scene_reference.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "tools/commands.h"
#include "tools/output_file.h"

namespace morsel::tools {

void add_scene_schema(CLI::App& parent, Session& session) {
  auto output = std::make_shared<std::string>();
  CLI::App* command = parent.add_subcommand(
      "schema", "Print the JSON Schema of scene files, by which editors complete and check them");
  command->add_option("-o,--output", *output, "File to write instead of the standard output");
  command->callback([output, &session] {
    session.run = [output] {
      const std::string text = render::scene_schema().dump(2) + "\n";
      if (output->empty()) {
        std::cout << text;
        return kDone;
      }
      OutputFile file(*output);
      file.stream() << text;
      file.commit();
      std::cout << *output << '\n';
      return kDone;
    };
  });
}

}  // namespace morsel::tools
