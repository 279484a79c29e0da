/// Prints all parameters with their defaults, as YAML or as a page of the documentation.

#include <CLI/CLI.hpp>
#include <iostream>

#include "monitor_config.h"

int main(int argc, char** argv) {
  CLI::App app("Prints every parameter of the nodelets with its default, as YAML to be copied.",
               "print_parameters");
  bool page = false;
  app.add_flag("--page", page, "prints docs/parameters.md instead, with units and ranges");
  CLI11_PARSE(app, argc, argv);
  std::cout << (page ? tccm::parametersPage() : tccm::defaultYaml());
  return 0;
}
