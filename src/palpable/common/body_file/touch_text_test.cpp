#include "palpable/common/body_file/touch_text.h"

#include "palpable/common/response/stated_error.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("the text states whether a body can be touched anywhere, and to which order",
          "[body_file]") {
  const SurfaceMesh skin = sphere_surface({0, 0, 0}, 0.05, 1);
  CHECK(touch_text(std::nullopt) == "at its sites, one at a time");
  CHECK(touch_json(std::nullopt).is_null());

  TouchTables tables = test::some_touch_tables(skin, 0);
  CHECK(touch_text(tables).starts_with("anywhere, several at a time, 1st order: small touches; "));
  CHECK(touch_json(tables)["response_order"].get<int>() == 1);

  tables = test::some_touch_tables(skin, 3);
  CHECK_THAT(touch_text(tables), Catch::Contains(", 3rd order; 3 regions; "));
  const Json json = touch_json(tables);
  CHECK(json["response_order"].get<int>() == 3);
  CHECK(json["error_estimate_factors"].is_null());
  CHECK_THAT(touch_text(tables), Catch::Contains("; does not state its error live"));
  CHECK_THAT(touch_text(tables), !Catch::Contains("friction"));
  CHECK(json["friction"].get<double>() == 0);
  tables.friction = 0.6;
  CHECK_THAT(touch_text(tables), Catch::Contains("; 3 regions; friction 0.6; "));
  tables.friction = 0;
  CHECK(json["clusters"].get<int>() == 3);
  CHECK(json["regions"].get<int>() == 3);
  CHECK(json["cross_modes"].get<int>() == 48);
  CHECK(json["table_mb"].get<double>() == static_cast<double>(bytes_of(tables)) / 1e6);
  CHECK_THAT(touch_line(tables),
             Catch::Contains("compliance of 42 vertices in 3 clusters: 32 directions") &&
                 Catch::Contains("; 3 regions of 16 modes, 5 of them") &&
                 Catch::Contains("; 48 modes in which touches act on each other"));

  tables.held_out.assign(8, {PressingThing::kFinger, 0.002, 0.01, 0.02, 0.03, 0.02});
  CHECK(touch_json(tables)["error_estimate_factors"]["displacement"].get<double>() ==
        Approx(0.5 * kOnTheSafeSide));
  CHECK_THAT(touch_text(tables), Catch::Contains("its indicators of error times 0.88 for "
                                                 "displacement, times 2.62 for stress"));

  CHECK_THAT(vibration_text(tables.vibration), Catch::Contains("no mass"));
  CHECK_THAT(touch_text(tables), !Catch::Contains("mass") && !Catch::Contains("vibration"));
  CHECK(touch_json(tables)["vibration"].is_null());
  const std::size_t without = bytes_of(tables), stress_without = stress_bytes_of(tables);
  tables.vibration = test::some_vibration(tables.shell.nodes());
  CHECK_THAT(
      touch_text(tables),
      Catch::Contains(" MB; 5 vibration modes from 4.77 to 9.55 Hz, damping ratio 0.075; 0.4 "
                      "kg of 1070 kg/m^3"));
  CHECK(touch_json(tables)["vibration"]["frequencies_hz"][4].get<double>() ==
        Approx(60 / (2 * 3.14159265)));
  CHECK_THAT(touch_line(tables), Catch::Contains("; 5 vibration modes up to 9.55 Hz"));
  CHECK(bytes_of(tables) == without + 5 * 8 + 5 * 3 * 43 * 4);
  CHECK(stress_bytes_of(tables) == stress_without + 5 * 3 * 4);

  for (RegionTable& region : tables.regions) region.quartic = {0, 4, {}, {}};
  CHECK_THAT(touch_text(tables), Catch::Contains(", 2nd order; 3 regions; "));
}

}  // namespace
}  // namespace palpable
