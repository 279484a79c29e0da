#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "tccm_monitor/time.h"

namespace tccm {

/// The last records, in memory that is taken once: chunks of equal size, of which the oldest is
/// used again. One thread writes; another may read chunks that were pinned for it meanwhile.
class RecordRing {
 public:
  static constexpr std::size_t kHeader = 13;  ///< bytes before each record's own

  class Chunk {
   public:
    struct Record {
      std::uint8_t topic;
      Time stamp;
      const std::uint8_t* bytes;
      std::uint32_t size;
    };
    /// Calls visit(record) for each.
    template <typename Visit>
    void visit(Visit&& visit) const {
      for (std::size_t at = 0; at < used_;) {
        const Record record = recordAt(at);
        visit(record);
        at += kHeader + record.size;
      }
    }
    /// By whoever read it: it may be used again.
    void unpin() { pins_.fetch_sub(1, std::memory_order_release); }

   private:
    friend class RecordRing;
    [[nodiscard]] Record recordAt(std::size_t at) const;

    std::vector<std::uint8_t> bytes_;  ///< as many as fit
    std::size_t used_ = 0;
    std::atomic<int> pins_{0};
  };

  static constexpr std::size_t kHistory = 8;  ///< chunks that records are kept in

  /// @param bytes all that it ever takes: twice the history, and a chunk, as while a history is
  /// read the next one grows.
  explicit RecordRing(std::size_t bytes);

  /// Whether a record of that size begins a new chunk.
  [[nodiscard]] bool startsChunk(std::size_t size) const;
  /// The next record begins a new chunk, whatever its size.
  void endChunk() { sealed_ = true; }
  /// The next record's bytes, to be filled at once.
  /// @return null where it is larger than a chunk, or none is free.
  [[nodiscard]] std::uint8_t* append(std::uint8_t topic, Time stamp, std::size_t size);
  /// The chunks with all records so far, the oldest first, each to be unpinned by whoever reads
  /// them. The next record begins a new chunk.
  /// @param chunks room for kHistory of them, reused.
  void pin(std::vector<Chunk*>& chunks);
  [[nodiscard]] std::size_t chunkBytes() const { return all_.front()->bytes_.size(); }
  /// That are kept now.
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] bool startChunk();

  std::vector<std::unique_ptr<Chunk>> all_;
  std::vector<Chunk*> kept_;  ///< the oldest first
  bool sealed_ = true;        ///< the newest takes no more
};

}  // namespace tccm
