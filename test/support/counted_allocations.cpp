#include "support/counted_allocations.h"

#include <cstdlib>
#include <new>

namespace {

void* allocated(std::size_t size) {
  if (tccm::test::is_counting) ++tccm::test::allocations;
  return std::malloc(size > 0 ? size : 1);
}

void* allocatedOrThrow(std::size_t size) {
  if (void* memory = allocated(size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocatedOrThrow(size); }
void* operator new[](std::size_t size) { return allocatedOrThrow(size); }
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return allocated(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t& /*tag*/) noexcept { std::free(memory); }
