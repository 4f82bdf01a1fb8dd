#include "palpable/bake/truth/episodes.h"

#include "tests/support/test.h"

#include <algorithm>

namespace palpable {
namespace {

using Eigen::Vector3d;

std::vector<ContactLine> touching_in(const std::vector<int>& frames, int count) {
  std::vector<ContactLine> contacts;
  for (int n = 0; n < count; ++n) {
    const bool touches = std::find(frames.begin(), frames.end(), n) != frames.end();
    contacts.push_back({.frame = n, .touching = touches, .depth = touches ? 1e-3 * n : 0.0});
  }
  return contacts;
}

TEST_CASE("wanted frames are spread over the touching ones and belong to their touch", "[truth]") {
  const auto contacts = touching_in({3, 4, 5, 6, 10, 11, 12, 13}, 16);
  const std::vector<Episode> all = episodes_of(contacts, 100, 1.0);
  REQUIRE(all.size() == 2);
  CHECK(all[0].first == 3);
  CHECK(all[0].wanted == std::vector{3, 4, 5, 6});
  CHECK(all[1].first == 10);
  CHECK(all[1].wanted == std::vector{10, 11, 12, 13});

  const std::vector<Episode> four = episodes_of(contacts, 4, 1.0);
  CHECK(four[0].wanted == std::vector{4, 6});
  CHECK(four[1].wanted == std::vector{11, 13});

  // Too deep ones are not wanted, but the touch still begins where it begins.
  const std::vector<Episode> shallow = episodes_of(contacts, 100, 11.5e-3);
  CHECK(shallow[1].first == 10);
  CHECK(shallow[1].wanted == std::vector{10, 11});
  CHECK(episodes_of(touching_in({}, 5), 24, 1.0).empty());
}

TEST_CASE("a touch may go on over frames without one", "[truth]") {
  const auto contacts = touching_in({0, 1, 4, 5, 9, 10}, 12);
  const auto firsts = [&](int apart) {
    std::vector<int> found;
    for (const Episode& episode : episodes_of(contacts, 100, 1.0, apart)) {
      found.push_back(episode.first);
    }
    return found;
  };
  CHECK(firsts(1) == std::vector{0, 4, 9});
  CHECK(firsts(2) == std::vector{0, 4, 9});
  CHECK(firsts(3) == std::vector{0, 9});
  CHECK(firsts(4) == std::vector{0});
  CHECK(firsts(30) == std::vector{0});
}

TEST_CASE("between two frames a capsule's ends go straight", "[truth]") {
  ClipHands hands;
  hands.contacts.resize(3);
  hands.capsules = {{{{0, 0, 0}, {0, 0, 1}, 0.1, 0.2}}, {{{1, 0, 0}, {1, 0, 2}, 0.3, 0.2}}, {}};
  const std::vector<Capsule> quarter = capsules_at(hands, 0.25);
  REQUIRE(quarter.size() == 1);
  CHECK((quarter[0].a - Vector3d(0.25, 0, 0)).norm() < 1e-15);
  CHECK((quarter[0].b - Vector3d(0.25, 0, 1.25)).norm() < 1e-15);
  CHECK(quarter[0].ra == Approx(0.15));
  CHECK(capsules_at(hands, -1.0).size() == 1);
  // Between frames with different numbers of capsules, those of the nearer frame are returned.
  CHECK(capsules_at(hands, 1.4).size() == 1);
  CHECK(capsules_at(hands, 1.6).empty());
  CHECK(capsules_at(hands, 9.0).empty());
}

}  // namespace
}  // namespace palpable
