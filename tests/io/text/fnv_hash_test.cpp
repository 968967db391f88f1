#include "io/text/fnv_hash.hpp"

#include <gtest/gtest.h>

namespace gear3k::io::fnv_hash_test {
namespace {

// Test vectors: Fowler, Noll, Vo, Eastlake, "The FNV Non-Cryptographic Hash Algorithm" (64 bit).
TEST(FnvHash, GivesThePublishedHashes) {
  EXPECT_EQ(hashed(kHashBasis, ""), 0xcbf29ce484222325U);
  EXPECT_EQ(hashed(kHashBasis, "a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(hashed(kHashBasis, "foobar"), 0x85944171f73967e8U);
}

TEST(FnvHash, GoesOnFromTextToText) {
  EXPECT_EQ(hashed(hashed(kHashBasis, "foo"), "bar"), hashed(kHashBasis, "foobar"));
}

TEST(FnvHash, OfAWholeNumberIsThatOfItsBytesFromTheLowestOn) {
  EXPECT_EQ(hashed_bytes(kHashBasis, 0x6867666564636261U), hashed(kHashBasis, "abcdefgh"));
}

TEST(FnvHash, OfNumbersDoesNotSeeTheSignOfZero) {
  EXPECT_EQ(hashed(kHashBasis, -0.0), hashed(kHashBasis, 0.0));
  EXPECT_NE(hashed(kHashBasis, 1.0), hashed(kHashBasis, -1.0));
}

}  // namespace
}  // namespace gear3k::io::fnv_hash_test
