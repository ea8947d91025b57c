// SPDX-License-Identifier: MIT
#pragma once

// The loops of Sweep that are written once per instruction set.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/aabb.hpp>
#include <spheretree/broad_phase.hpp>
#include <spheretree/simd.hpp>
#include <spheretree/sweep.hpp>

namespace spheretree::detail {

/// Compact coordinates have 15 bits: the spare bit of each lane takes the carry of an addition, so four lanes
/// compare in one 64-bit register, and more in wider ones.
inline constexpr unsigned kCoordinateBits = 15;
inline constexpr std::uint32_t kMaxCoordinate = (1U << kCoordinateBits) - 1;
inline constexpr unsigned kLaneBits = 16;
inline constexpr std::uint64_t kCoordinateLanes = 0x0000'7fff'7fff'7fffU;
inline constexpr std::uint64_t kSpareBits = 0x0000'8000'8000'8000U;
inline constexpr unsigned kNumberLane = 48;  // where a record keeps half of its body's number
inline constexpr std::size_t kCoordinatesPerBox = 6;

/// A layout has no more strips, and none for fewer boxes.
inline constexpr std::uint32_t kMaxStrips = 1024;
inline constexpr std::size_t kLeastBoxesPerStrip = 24;
inline constexpr std::size_t kBoxesPerCell = 2;  // finer cells cost more to sum than they save tests

/// Most records tested in one step.
inline constexpr std::size_t kMostLanes = 8;

/// Records that a scan may read, and ignore, behind the last one.
inline constexpr std::size_t kRecordPadding = 6 * kMostLanes;

/// Writes six coordinates per box (min x y z, max x y z), clamp((v - origin) * scale), which is monotone, and
/// the cell where the box is filed: strip * cells + cell, or strips * cells when it is absent. Returns the
/// index of the first malformed box, or kNoFault. `coordinates` has kCoordinatePadding entries more than
/// needed.
using CompactBoxes = std::size_t (*)(std::span<const Aabb> boxes, const SweepLayout& layout,
                                     std::uint16_t* coordinates, std::uint32_t* homes);

/// Coordinates that kernels may read behind the last box.
inline constexpr std::size_t kCoordinatePadding = 8;

/// The sorted records and what is needed to sweep along the strips.
///
/// Record: low = min x, y, z and the lower 15 bits of the number; high = the same of 0x7fff - max and the
/// upper bits. Two boxes are apart where min of one + 0x7fff - max of the other carries into the spare bit,
/// so they overlap when low + high of the other carries nowhere, both ways.
struct StripScan {
  const std::uint64_t* low = nullptr;
  const std::uint64_t* high = nullptr;
  const std::uint32_t* bounds =
      nullptr;             // where the cells begin, strip by strip; one more than there are cells
  unsigned sweepLane = 0;  // in bits
  unsigned stripLane = 0;  // in bits
  std::uint32_t strips = 1;
  std::uint32_t cells = 1;           // per strip
  std::uint32_t* longest = nullptr;  // per strip: longest record along it; filled by the scan
  const Aabb* boxes = nullptr;
  std::vector<BodyPair>* pairs = nullptr;
  std::uint64_t tests = 0;  // of record against record, so far
};

/// Tests the records of a strip against one another and against those of the strips above, which must have
/// been scanned before.
using ScanStrip = void (*)(StripScan& scan, std::uint32_t strip);

struct SweepKernels {
  CompactBoxes compactBoxes;
  ScanStrip scanStrip;
};

[[nodiscard]] SweepKernels sweepKernels(SimdLevel level) noexcept;

/// Which of `parts` equal parts of an axis, at most 2^15, a coordinate belongs to. Monotone.
[[nodiscard]] constexpr std::uint32_t partOf(std::uint32_t coordinate, std::uint32_t parts) noexcept {
  return (coordinate * parts) >> kCoordinateBits;
}

/// The largest coordinate of a part.
[[nodiscard]] constexpr std::uint32_t lastOfPart(std::uint32_t part, std::uint32_t parts) noexcept {
  return (((part + 1) << kCoordinateBits) - 1) / parts;
}

}  // namespace spheretree::detail
