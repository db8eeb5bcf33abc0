// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstddef>
#include <new>

namespace morsel::render {

// For large tables that are read here and there: in pages of 2 MB where the system has them, since
// finding a page of 4 kB takes longer than fetching from it. An allocator for std::vector.
template <class T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) {}  // NOLINT: allocators convert

  T* allocate(std::size_t count) {
    const std::size_t bytes = rounded(count * sizeof(T));
    void* memory = ::operator new(bytes, alignment_of(bytes));
#ifdef MADV_HUGEPAGE
    // A wish: whether it is granted changes nothing but the time.
    if (bytes >= kPage) madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    ::operator delete(memory, alignment_of(rounded(count * sizeof(T))));
  }
  template <class U>
  bool operator==(const HugePageAllocator<U>&) const {
    return true;
  }

 private:
  static constexpr std::size_t kPage = std::size_t{1} << 21;
  // A page is given as a whole: to what fills a quarter of one.
  static std::size_t rounded(std::size_t bytes) {
    return bytes >= kPage / 4 ? (bytes + kPage - 1) / kPage * kPage : bytes;
  }
  static std::align_val_t alignment_of(std::size_t bytes) {
    return std::align_val_t{bytes >= kPage ? kPage : alignof(T) < 16 ? 16 : alignof(T)};
  }
};

}  // namespace morsel::render
