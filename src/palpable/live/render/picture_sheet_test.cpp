#include "palpable/live/render/picture_sheet.h"

#include "tests/support/test.h"

#include <vector>

namespace palpable {
namespace {

TEST_CASE("a sheet holds its cells row by row, on white", "[render]") {
  const std::vector<ColorImage> cells{ColorImage(10, 6, Rgb{1, 0, 0}),
                                      ColorImage(10, 6, Rgb{2, 0, 0}),
                                      ColorImage(10, 6, Rgb{3, 0, 0})};
  const ColorImage sheet = sheet_of(cells, 2);
  CHECK(sheet.width() == 2 * 10 + 3 * 8);
  CHECK(sheet.height() == 2 * 6 + 3 * 8);
  CHECK(sheet(8, 8) == Rgb{1, 0, 0});
  CHECK(sheet(17, 13) == Rgb{1, 0, 0});
  CHECK(sheet(18, 13) == Rgb{255, 255, 255});
  CHECK(sheet(26, 8) == Rgb{2, 0, 0});
  CHECK(sheet(8, 22) == Rgb{3, 0, 0});
  CHECK(sheet(26, 22) == Rgb{255, 255, 255});
}

}  // namespace
}  // namespace palpable
