// Loaded into the programs of a soak: has glibc give back what was freed. Else it keeps what bursts
// left behind in pieces, and that looks like growth where nothing leaks.
#include <malloc.h>

#include <chrono>
#include <thread>

namespace {

struct Trimmer {
  Trimmer() {
    std::thread([] {
      while (true) {
        std::this_thread::sleep_for(std::chrono::seconds(2));
        malloc_trim(0);
      }
    }).detach();
  }
};

const Trimmer kTrimmer;

}  // namespace
