// SPDX-License-Identifier: MIT
#include "nvdb_codes.h"

#include <cstring>

namespace kelp::bake {
namespace {

// nanovdb::GridType.
enum NanoType : std::uint32_t {
  kFloat = 1,
  kDouble,
  kInt16,
  kInt32,
  kInt64,
  kVec3f,
  kVec3d,
  kMask,
  kUint32 = 10,
  kBool,
  kFp4 = 13,
  kFp8,
  kFp16,
  kFpN
};

template <class T>
double nanoAs(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

std::size_t nanoScalarBytes(std::uint32_t type) {
  switch (type) {
    case kDouble:
    case kInt64:
    case kVec3d:
      return 8;
    case kInt16:
      return 2;
    case kBool:
      return 1;
    default:
      return 4;
  }
}

}  // namespace

GridKind nanoKind(std::uint32_t type) {
  switch (type) {
    case kFloat:
    case kDouble:
    case kInt16:
    case kInt32:
    case kInt64:
    case kUint32:
    case kFp4:
    case kFp8:
    case kFp16:
    case kFpN:
      return GridKind::kScalar;
    case kVec3f:
    case kVec3d:
      return GridKind::kVector;
    case kMask:
    case kBool:
      return GridKind::kBinary;
    default:
      return GridKind::kOther;
  }
}

std::string nanoTypeName(std::uint32_t type) {
  constexpr const char* kNames[] = {"?",     "float", "double", "int16",  "int32", "int64", "vec3f",
                                    "vec3d", "mask",  "half",   "uint32", "bool",  "rgba8", "Fp4",
                                    "Fp8",   "Fp16",  "FpN",    "vec4f",  "vec4d", "index"};
  return type < std::size(kNames) ? kNames[type] : "type " + std::to_string(type);
}

int nanoComponents(std::uint32_t type) { return type == kVec3f || type == kVec3d ? 3 : 1; }

bool nanoIsWide(std::uint32_t type) {
  return type == kDouble || type == kInt32 || type == kInt64 || type == kVec3d || type == kUint32;
}

double nanoValue(std::span<const std::uint8_t> bytes, std::size_t i, std::uint32_t type, bool active) {
  if (type == kMask) return active ? 1 : 0;
  const std::uint8_t* at = bytes.subspan(i * nanoScalarBytes(type), nanoScalarBytes(type)).data();
  switch (type) {
    case kDouble:
    case kVec3d:
      return nanoAs<double>(at);
    case kInt16:
      return nanoAs<std::int16_t>(at);
    case kInt32:
      return nanoAs<std::int32_t>(at);
    case kInt64:
      return nanoAs<std::int64_t>(at);
    case kUint32:
      return nanoAs<std::uint32_t>(at);
    case kBool:
      return *at != 0 ? 1 : 0;
    default:
      return nanoAs<float>(at);
  }
}

NanoCodes nanoCodes(std::uint32_t type, const std::uint8_t* head, std::uint64_t table) {
  constexpr std::uint64_t kVoxels = SparseGrid::kLeafVoxels;
  switch (type) {
    case kMask:
      return {};
    case kBool:
      return {table - 16, kVoxels / 8, 0};  // after the mask of active voxels
    case kFp4:
      return {table, kVoxels / 2, 4};
    case kFp8:
      return {table, kVoxels, 8};
    case kFp16:
      return {table, kVoxels * 2, 16};
    case kFpN: {
      const int log2 = head[15] >> 5, bits = 1 << (log2 < 4 ? log2 : 4);
      return {table, kVoxels * static_cast<std::uint64_t>(bits) / 8, bits};
    }
    default:
      return {table, kVoxels * nanoScalarBytes(type) * static_cast<std::uint64_t>(nanoComponents(type)), 0};
  }
}

double nanoLeafValue(std::span<const std::uint8_t> values, std::span<const std::uint8_t> scale,
                     const NanoCodes& codes, std::size_t i, std::uint32_t type, bool active) {
  if (type == kBool) return values[i / 8] >> (i % 8) & 1 ? 1 : 0;
  if (codes.bits == 0)
    return nanoValue(type == kMask ? values : values.subspan(i * nanoScalarBytes(type)), 0, type, active);
  const std::size_t bit = i * static_cast<std::size_t>(codes.bits);
  std::uint32_t code = values[bit / 8];
  if (codes.bits == 16) code |= static_cast<std::uint32_t>(values[bit / 8 + 1]) << 8;
  code = code >> (bit % 8) & ((1u << codes.bits) - 1);
  // In floats, as NanoVDB has it.
  float least = 0, step = 0;
  std::memcpy(&least, scale.data(), sizeof(least));
  std::memcpy(&step, scale.data() + sizeof(least), sizeof(step));
  return static_cast<double>(static_cast<float>(code) * step + least);
}

}  // namespace kelp::bake
