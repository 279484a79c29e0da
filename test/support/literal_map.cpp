#include "literal_map.h"

#include <algorithm>

namespace tccm::test {
namespace {

bool overlap(const LiteralCuboid& a, const LiteralCuboid& b) {
  return a.bottom() < b.u && b.bottom() < a.u;
}

bool overlapOrTouch(const LiteralCuboid& a, const LiteralCuboid& b) {
  return a.bottom() <= b.u && b.bottom() <= a.u;
}

/// Addition of one cuboid (section III.C.1, and equation 1 for a single return): what it overlaps
/// or touches becomes part of it, again until nothing changes.
void addCuboid(LiteralColumn& column, LiteralCuboid added) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (auto other = column.begin(); other != column.end(); ++other) {
      if (!overlapOrTouch(*other, added)) continue;
      const int top = std::max(other->u, added.u);
      const int bottom = std::min(other->bottom(), added.bottom());
      added.u = top;
      added.d = top - bottom;
      added.msnlist.splice(added.msnlist.end(), other->msnlist);
      column.erase(other);
      changed = true;
      break;
    }
  }
  added.msnlist.sort();
  added.msnlist.unique();
  column.push_back(std::move(added));
}

/// Shortens a stored column by a newer cuboid: none, one or two pieces of each cuboid remain.
void shorten(LiteralColumn& column, const LiteralCuboid& newer) {
  for (auto old = column.begin(); old != column.end();) {
    if (!overlap(*old, newer)) {
      ++old;
      continue;
    }
    if (old->u > newer.u) column.push_front({old->u, old->u - newer.u, old->msnlist});
    if (old->bottom() < newer.bottom()) {
      column.push_front({newer.bottom(), newer.bottom() - old->bottom(), old->msnlist});
    }
    old = column.erase(old);
  }
}

}  // namespace

LiteralPartMap literalPartMap(const std::vector<MappedReturn>& returns, int thickness,
                              std::uint32_t serial) {
  LiteralPartMap part_map;
  for (const MappedReturn& entry : returns) {
    addCuboid(part_map[entry.cell], {entry.height, thickness, {serial}});
  }
  return part_map;
}

std::vector<LiteralColumn> additionOfAll(const std::deque<LiteralPartMap>& part_maps,
                                         CellIndex cells) {
  std::vector<LiteralColumn> columns(cells);
  for (const LiteralPartMap& part_map : part_maps) {
    for (const auto& [cell, column] : part_map) {
      for (const LiteralCuboid& cuboid : column) addCuboid(columns[cell], cuboid);
    }
  }
  return columns;
}

void LiteralMap::add(const std::vector<MappedReturn>& returns) {
  const std::uint32_t serial = next_serial_++;
  LiteralPartMap newest = literalPartMap(returns, thickness_, serial);
  deform(newest);
  for (const auto& [cell, column] : newest) {
    for (const LiteralCuboid& cuboid : column) addCuboid(columns_[cell], cuboid);
  }
  stored_.push_back({serial, std::move(newest)});
}

void LiteralMap::deform(const LiteralPartMap& newest) {
  for (const auto& [cell, column] : newest) {
    for (const LiteralCuboid& newer : column) {
      for (const LiteralCuboid& integrated : columns_[cell]) {
        if (!overlap(integrated, newer)) continue;
        for (const std::uint32_t serial : integrated.msnlist) {
          LiteralPartMap& older = stored_[serial - stored_.front().serial].part_map;
          const auto found = older.find(cell);
          if (found != older.end()) shorten(found->second, newer);
        }
      }
    }
  }
}

void LiteralMap::expireOldest() {
  const Stored oldest = std::move(stored_.front());
  stored_.pop_front();
  for (const auto& [cell, column] : oldest.part_map) {
    for (const LiteralCuboid& part : column) subtract(cell, part, oldest.serial);
  }
  // A deformed part map may have nothing left in a cuboid that still names it.
  for (const auto& entry : oldest.part_map) {
    for (LiteralCuboid& cuboid : columns_[entry.first]) cuboid.msnlist.remove(oldest.serial);
  }
}

void LiteralMap::subtract(CellIndex cell, const LiteralCuboid& part, std::uint32_t serial) {
  LiteralColumn& column = columns_[cell];
  const auto whole = std::find_if(column.begin(), column.end(),
                                  [&](const LiteralCuboid& c) { return overlap(c, part); });
  if (whole == column.end()) return;
  whole->msnlist.remove(serial);
  if (whole->u == part.u && whole->d == part.d) {
    column.erase(whole);
  } else if (whole->u == part.u) {
    whole->u -= part.d;
    whole->d -= part.d;
  } else if (whole->bottom() == part.bottom()) {
    whole->d -= part.d;
  } else {
    const LiteralCuboid lower{part.bottom(), part.bottom() - whole->bottom(), whole->msnlist};
    whole->d = whole->u - part.u;
    column.push_back(lower);
  }
}

}  // namespace tccm::test
