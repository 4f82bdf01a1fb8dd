#include "palpable/common/base/quantity.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

TEST_CASE("a quantity is a number and a unit of its kind", "[base]") {
  CHECK(to_quantity("7mm", Quantity::kLength) == 7 * 1e-3);
  CHECK(to_quantity("7 mm", Quantity::kLength) == 7 * 1e-3);
  CHECK(to_quantity("-1.5e1 cm", Quantity::kLength) == -15 * 1e-2);
  CHECK(to_quantity("2 m", Quantity::kLength) == 2.0);
  CHECK(to_quantity("0.2 in", Quantity::kLength) == 0.2 * 0.0254);
  CHECK(to_quantity("2in", Quantity::kLength) == 2 * 0.0254);
  CHECK(to_quantity("60 kPa", Quantity::kPressure) == 60e3);
  CHECK(to_quantity("3 mN", Quantity::kForce) == 3 * 1e-3);
  CHECK(to_quantity("1 g/cm^3", Quantity::kDensity) == 1000.0);
  for (const Quantity kind : {Quantity::kLength, Quantity::kPressure, Quantity::kPerPressure,
                              Quantity::kForce, Quantity::kDensity, Quantity::kAcceleration}) {
    CHECK(to_quantity(example_of(kind), kind).has_value());
  }
}

TEST_CASE("units are read as people write them", "[base]") {
  const auto density = [](const char* text) { return to_quantity(text, Quantity::kDensity); };
  for (const char* text :
       {"1050 kg/m^3", "1050 kg/m3", "1050kg/m³", "1050 kg / m^3", "1050 kg/m**3", "1050 g/l"}) {
    CAPTURE(text);
    CHECK(density(text) == 1050.0);
  }
  CHECK(density("1.05 g/cm3") == 1.05 * 1e3);
  CHECK(density("1.05 g/ml") == 1.05 * 1e3);
  // Steel in the tonnes and millimetres of finite elements.
  CHECK(density("7.85e-9 t/mm^3") == 7.85e-9 * 1e12);
  CHECK(density("7.85e-9 tonne/mm3") == 7.85e-9 * 1e12);
  CHECK(to_quantity("2 N/mm^2", Quantity::kPressure) == 2e6);
  CHECK(to_quantity("2 N/mm²", Quantity::kPressure) == 2e6);
  CHECK(to_quantity("2 bar", Quantity::kPressure) == 2e5);
  CHECK(to_quantity("0.5 mm^2/N", Quantity::kPerPressure) == 0.5e-6);
  CHECK(to_quantity("2 MPa^-1", Quantity::kPerPressure) == 2e-6);
  CHECK(to_quantity("9810 mm/s^2", Quantity::kAcceleration) == 9810 * 1e-3);
  CHECK(to_quantity("2 inch", Quantity::kLength) == 2 * 0.0254);
  CHECK(to_quantity("3 µm", Quantity::kLength) == 3 * 1e-6);
  // A pound is 0.45359237 kg at 9.80665 m/s^2 on a square inch; the tolerance is its rounding.
  const double psi = 0.45359237 * 9.80665 / (0.0254 * 0.0254);
  CHECK(std::abs(to_quantity("1 psi", Quantity::kPressure).value() - psi) < 1e-12 * psi);
  CHECK(std::abs(to_quantity("1 ksi", Quantity::kPressure).value() - 1e3 * psi) < 1e-9 * psi);
}

TEST_CASE("what is no quantity is answered with the units that are known", "[base][errors]") {
  const std::string known = why_no_quantity("60 kips", Quantity::kPressure);
  for (const char* unit : {"\"60 kPa\"", "Pa, kPa, MPa, GPa", "N/mm2", "psi", "ksi"}) {
    CHECK(known.find(unit) != std::string::npos);
  }
  CHECK(why_no_quantity("7,5 mm", Quantity::kLength).find("decimal comma") != std::string::npos);
  CHECK_FALSE(to_quantity("1 mPa", Quantity::kPressure).has_value());
  CHECK_FALSE(to_quantity("1 kg/m3", Quantity::kPressure).has_value());
}

TEST_CASE("every unit of length that has a name is read after a number", "[base]") {
  for (const std::string& name : length_unit_names()) {
    CAPTURE(name);
    CHECK(to_quantity("3 " + name, Quantity::kLength) == 3 * length_unit(name).value());
  }
  CHECK(length_unit_names() == std::vector<std::string>{"m", "cm", "mm", "in"});
  CHECK(length_unit("inch") == 0.0254);
  CHECK_FALSE(length_unit("yd").has_value());
}

TEST_CASE("a text without a unit, or with another's, is no quantity", "[base][errors]") {
  for (const char* text : {"", "7", "mm", "7 kPa", "7 mm ", "7mmm", "0x7mm", "7,5 mm", "+7mm", "in",
                           "inf in ", "7\"", "7 IN", "7 ^mm", "7 m m", "7 m3"}) {
    CAPTURE(text);
    CHECK_FALSE(to_quantity(text, Quantity::kLength).has_value());
  }
}

}  // namespace
}  // namespace palpable
