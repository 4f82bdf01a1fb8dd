#include "palpable/contact/part_labels.h"

#include "tests/support/test.h"

#include <limits>
#include <string_view>
#include <vector>

namespace palpable {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// A picture of letters: '.' nothing, others a thing at 0.4 m, 'F' one at 0.5 m.
struct Drawn {
  explicit Drawn(const std::vector<std::string_view>& rows) {
    depth = DepthImage(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), kNone);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        const char c = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
        if (c != '.') depth(x, y) = c == 'F' ? 0.5f : 0.4f;
      }
    }
    labels.find(depth, {}, {0, 0, depth.width(), depth.height()}, {});
  }
  DepthImage depth;
  PartLabels labels;
};

TEST_CASE("things apart are different parts, and a thing that bends back is one",
          "[contact][parts]") {
  // The two arms of the U meet in the last row only, and are counted apart until then.
  const Drawn d({"a..a...b", "a..a..bb", "aaaa...b"});
  CHECK(d.labels.count() == 2);
  CHECK(d.labels.at(0, 0) == d.labels.at(3, 0));
  CHECK(d.labels.at(0, 0) == d.labels.at(2, 2));
  CHECK(d.labels.at(7, 0) == d.labels.at(6, 1));
  CHECK(d.labels.at(0, 0) != d.labels.at(7, 0));
  CHECK(d.labels.at(1, 0) == PartLabels::kNone);
}

TEST_CASE("a thing behind another is another part, though their pixels touch",
          "[contact][parts]") {
  const Drawn d({"aaFF", "aaFF"});
  CHECK(d.labels.count() == 2);
  CHECK(d.labels.at(1, 0) != d.labels.at(2, 0));
}

TEST_CASE("parts that are joined late keep one number each, and none is left out",
          "[contact][parts]") {
  const Drawn d({"a.a.a.c", "a.a.a.c", "aaaaa..", "......d"});
  CHECK(d.labels.count() == 3);
  for (const int x : {0, 2, 4}) CHECK(d.labels.at(x, 0) == d.labels.at(0, 2));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 7; ++x) CHECK(d.labels.at(x, y) < 3);
  }
}

}  // namespace
}  // namespace palpable
