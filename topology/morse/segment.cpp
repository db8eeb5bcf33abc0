// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/segment.h"

#include <algorithm>

#include "topology/union_find.h"

namespace morsel::topology {

void segment(MorseComplex& complex, const std::vector<std::uint32_t>& ends) {
  std::vector<CriticalPoint>& points = complex.points;
  UnionFind joined(points.size());
  std::vector<std::uint32_t> one_end(points.size(), Separatrix::kNoMaximum);  // of each 2-saddle
  for (const Separatrix& s : complex.separatrices) {
    std::uint32_t& first = one_end[s.saddle];
    if (s.maximum == Separatrix::kNoMaximum) continue;
    if (first == Separatrix::kNoMaximum)
      first = s.maximum;
    else
      joined.unite(first, s.maximum);
  }
  // A set's root is its first maximum, the highest: sets come out by decreasing F.
  complex.sets.clear();
  std::vector<std::uint32_t> set_of(points.size(), kNoSet);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (points[i].type != CriticalType::kMaximum) continue;
    const std::uint32_t root = joined.find(i);
    if (root == i) {
      set_of[i] = static_cast<std::uint32_t>(complex.sets.size());
      complex.sets.push_back({});
      complex.sets.back().highest = i;
    }
    set_of[i] = set_of[root];
  }
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    CriticalPoint& p = points[i];
    const std::uint32_t maximum = p.type == CriticalType::kMaximum   ? i
                                  : p.type == CriticalType::kSaddle2 ? one_end[i]
                                                                     : ends[i];
    p.set = maximum == Separatrix::kNoMaximum ? kNoSet : set_of[maximum];
    if (p.set == kNoSet) continue;
    complex.sets[p.set].add(p.type);
  }
  complex.main = kNoSet;
  for (std::uint32_t s = 0; s < complex.sets.size(); ++s)
    if (complex.main == kNoSet || complex.sets[s].maxima > complex.sets[complex.main].maxima)
      complex.main = s;
  // Each 2-saddle with a lost ascent may join two of the sets; a degenerate point any number.
  std::uint64_t open = 0;
  bool degenerate = complex.unresolved_boxes > 0;
  std::vector<bool> counted(points.size(), false);
  for (const LostStreamline& l : complex.lost) {
    if (points[l.point].type != CriticalType::kSaddle2 || counted[l.point]) continue;
    counted[l.point] = true;
    ++open;
  }
  for (const CriticalPoint& p : points) degenerate |= p.type == CriticalType::kDegenerate;
  const std::uint64_t sets = complex.sets.size();
  complex.sets_hi = sets;
  complex.sets_lo = degenerate ? std::min<std::uint64_t>(sets, 1)
                               : sets - std::min(open, sets > 0 ? sets - 1 : 0);
}

}  // namespace morsel::topology
