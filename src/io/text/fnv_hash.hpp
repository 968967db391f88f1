#pragma once
// Hashes of texts and numbers, 64 bit.

#include <bit>
#include <cstdint>
#include <string_view>

namespace gear3k::io {

inline constexpr std::uint64_t kHashBasis = 14695981039346656037U, kHashPrime = 1099511628211U;

/// Goes on with a hash, byte by byte.
///
///   h ← (h XOR byte) · prime  (modulo 2⁶⁴), from kHashBasis on
///
/// Source: Fowler, Noll and Vo, FNV-1a.
inline std::uint64_t hashed(std::uint64_t hash, std::string_view bytes) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * kHashPrime;
  return hash;
}

/// The same with the bytes of a whole number, the lowest first.
inline std::uint64_t hashed_bytes(std::uint64_t hash, std::uint64_t number) {
  constexpr unsigned kByte = 8;
  for (unsigned k = 0; k < sizeof number; ++k, number >>= kByte) {
    hash = (hash ^ (number & 0xFFU)) * kHashPrime;
  }
  return hash;
}

/// The same with a number, -0 as 0.
inline std::uint64_t hashed(std::uint64_t hash, double value) {
  // Word by word: quick and good enough to find candidates, which are then compared.
  auto bits = std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value);
  for (int half = 0; half < 2; ++half, bits >>= 32U) {
    hash = (hash ^ (bits & 0xFFFFFFFFU)) * kHashPrime;
    hash ^= hash >> 29U;
  }
  return hash;
}

}  // namespace gear3k::io
