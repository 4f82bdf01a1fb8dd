#include "palpable/common/base/fnv1a.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

// The values of the function's authors (Fowler, Noll, Vo), list of 64-bit FNV-1a test vectors.
TEST_CASE("FNV-1a gives its authors' values, in one piece or in two", "[base]") {
  CHECK(fnv1a("") == 0xcbf29ce484222325u);
  CHECK(fnv1a("a") == 0xaf63dc4c8601ec8cu);
  CHECK(fnv1a("foobar") == 0x85944171f73967e8u);
  CHECK(fnv1a("bar", fnv1a("foo")) == fnv1a("foobar"));
}

}  // namespace
}  // namespace palpable
