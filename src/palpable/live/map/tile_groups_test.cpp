#include "palpable/live/map/tile_groups.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using enum TileGroups::Label;

constexpr int kWidth = 40, kHeight = 30;

struct Tiles {
  DepthImage depth{kWidth, kHeight, 1.0F};
  Image<std::uint8_t> label{kWidth, kHeight, kStatic};

  void set(int x0, int y0, int x1, int y1, float Z, std::uint8_t is) {
    for (int j = y0; j < y1; ++j) {
      for (int i = x0; i < x1; ++i) {
        depth(i, j) = Z;
        label(i, j) = is;
      }
    }
  }
  [[nodiscard]] auto count(std::uint8_t is) const {
    return std::count(label.begin(), label.end(), is);
  }
};

TileGroups groups(const TileGroupSettings& settings = {}) {
  TileGroups made(settings);
  made.resize(kWidth, kHeight);
  return made;
}

TEST_CASE("a small group of moving tiles is a mismatch", "[map][tile_groups]") {
  Tiles tiles;
  tiles.set(2, 2, 6, 7, 0.4F, kMoving);      // 20 tiles
  tiles.set(20, 2, 39, 3, 0.4F, kMoving);    // 19
  tiles.set(20, 20, 29, 21, 0.4F, kMoving);  // 9 and 10, which meet at a corner,
  tiles.set(29, 21, 39, 22, 0.4F, kChanged);
  CHECK(groups().find(tiles.depth, tiles.label));
  CHECK(tiles.count(kMoving) == 20);
  CHECK(tiles.count(kChanged) == 0);  // are too few together
  CHECK(tiles.label(2, 2) == kMoving);

  tiles.set(0, 0, kWidth, kHeight, 1.0F, kStatic);
  tiles.set(20, 2, 39, 3, 0.4F, kMoving);
  CHECK_FALSE(groups().find(tiles.depth, tiles.label));
  CHECK(tiles.count(kMoving) == 0);
}

TEST_CASE("what nothing explains moves where it continues a group and is no deeper",
          "[map][tile_groups]") {
  Tiles tiles;
  tiles.set(5, 5, 10, 10, 0.4F, kMoving);
  tiles.set(10, 5, 15, 10, 0.41F, kUnexplained);  // continues the group
  tiles.set(15, 5, 20, 10, 0.5F, kUnexplained);   // a jump
  tiles.set(5, 10, 10, 13, 0.418F, kUnexplained);
  tiles.set(5, 13, 10, 16, 0.438F, kUnexplained);  // no jump, but beyond 1.1 times the group's 0.4
  tiles.set(5, 16, 10, 19, 0.455F, kUnexplained);
  groups().find(tiles.depth, tiles.label);
  CHECK(tiles.label(14, 9) == kMoving);
  CHECK(tiles.label(15, 9) == kUnexplained);
  CHECK(tiles.label(9, 15) == kMoving);
  CHECK(tiles.label(9, 16) == kUnexplained);
  CHECK(tiles.count(kMoving) == 25 + 25 + 15 + 15);
}

TEST_CASE("a new part of the scene that a group touches stays, and another group may take of it",
          "[map][tile_groups]") {
  Tiles tiles;
  tiles.set(0, 0, 5, 5, 0.4F, kMoving);
  tiles.set(5, 0, 30, 10, 0.4F, kUnexplained);  // 250 tiles: more than eight times 25
  TileGroups of_one = groups();
  of_one.find(tiles.depth, tiles.label);
  CHECK(tiles.count(kUnexplained) == 250);

  tiles.set(30, 0, 37, 5, 0.4F, kMoving);  // 35 tiles
  of_one.find(tiles.depth, tiles.label);
  CHECK(tiles.count(kUnexplained) == 0);
}

TEST_CASE("what moved a moment ago goes on moving at its depth while it is not explained",
          "[map][tile_groups]") {
  const TileGroupSettings settings;
  TileGroups memory = groups(settings);
  Tiles tiles;
  tiles.set(5, 5, 15, 15, 0.4F, kMoving);
  memory.find(tiles.depth, tiles.label);
  CHECK(memory.label_of_unexplained(5, 5, 0.41F) == kCarried);
  CHECK(memory.label_of_unexplained(5, 5, 0.43F) == kUnexplained);  // 7 %: another thing
  CHECK(memory.label_of_unexplained(4, 5, 0.4F) == kUnexplained);
  // Without evidence of motion it is carried only for some frames.
  int frames = 0;
  while (memory.label_of_unexplained(5, 5, 0.4F) == kCarried) {
    tiles.set(5, 5, 15, 15, 0.4F, kCarried);
    REQUIRE(memory.find(tiles.depth, tiles.label));
    REQUIRE(++frames <= settings.frames_to_carry);
  }
  CHECK(frames == settings.frames_to_carry);
  // As long as a tenth of the group moves by evidence, the whole group is carried.
  for (int frame = 0; frame < 2 * settings.frames_to_carry; ++frame) {
    tiles.set(5, 5, 15, 15, 0.4F, kCarried);
    tiles.set(5, 5, 6, 15, 0.4F, kMoving);
    memory.find(tiles.depth, tiles.label);
  }
  CHECK(memory.label_of_unexplained(14, 14, 0.4F) == kCarried);
  // A frame in which nothing moves ends it at once.
  tiles.set(0, 0, kWidth, kHeight, 0.4F, kStatic);
  memory.find(tiles.depth, tiles.label);
  CHECK(memory.label_of_unexplained(14, 14, 0.4F) == kUnexplained);
}

TEST_CASE("a group without any depth moves, and nothing joins it", "[map][tile_groups]") {
  Tiles tiles;
  tiles.set(5, 5, 10, 10, std::nanf(""), kChanged);
  tiles.set(10, 5, 12, 10, 0.4F, kUnexplained);
  CHECK(groups().find(tiles.depth, tiles.label));
  CHECK(tiles.count(kMoving) == 25);
  CHECK(tiles.count(kUnexplained) == 10);
}

TEST_CASE("settings of groups out of their range are refused", "[map][tile_groups]") {
  TileGroupSettings settings;
  settings.frames_to_carry = 127;  // an age of 127 is "long ago"
  CHECK_THROWS_AS(TileGroups(settings), ContractViolation);
  settings = {};
  settings.same_share = 0;
  CHECK_THROWS_AS(TileGroups(settings), ContractViolation);
}

}  // namespace
}  // namespace palpable
