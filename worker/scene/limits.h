#pragma once

#include <cstdint>

/// Bounds on what a scene file may ask for, so that a small hostile file cannot ask for all memory.
/// Far above what real scenes need; everything within them still has to fit the machine.
namespace tilefarm {

inline constexpr uint64_t kMaxFileBytes = uint64_t{16} << 30;
inline constexpr uint64_t kMaxBufferBytes = uint64_t{16} << 30;  // what byteLength and byteOffset may say
inline constexpr uint64_t kMaxElements = uint64_t{1} << 31;  // of an accessor; triangle corners are uint32
inline constexpr uint64_t kMaxUnbackedBytes = uint64_t{256}
                                              << 20;  // read from accessors that no buffer view backs
inline constexpr uint64_t kMaxImageTexels = uint64_t{1} << 28;  // 16384 x 16384
inline constexpr uint64_t kMaxSceneTexels = uint64_t{1} << 31;
inline constexpr uint64_t kMaxInstances = uint64_t{1} << 24;
inline constexpr uint64_t kMaxWorldTriangles = uint64_t{1} << 31;

}  // namespace tilefarm
