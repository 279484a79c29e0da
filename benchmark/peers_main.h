#pragma once

#include <cstdio>
#include <cstring>
#include <exception>

namespace tccm::peers {

/// What a program that compares does: NAME [--quick]. @param run (bool quick) prints JSON.
template <typename Run>
int main(int argc, char** argv, const char* name, Run&& run) {
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 2 || (argc == 2 && !quick)) {
    std::fprintf(stderr, "usage: %s [--quick]\n", name);
    return 2;
  }
  try {
    run(quick);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace tccm::peers
