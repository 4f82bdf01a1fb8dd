#include "palpable/bake/describe/first_description.h"

#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/size_text.h"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

namespace palpable {
namespace {

struct GuessedUnit {
  const char* name;
  double size;     // m
  double largest;  // longest side that is plausible in this unit, in the unit; 0: any
};
// The largest unit first: a shape of up to 2 units is more often in m than a thing of 2 mm.
constexpr std::array kUnits{GuessedUnit{"m", 1.0, 2.0}, GuessedUnit{"cm", 1e-2, 20.0},
                            GuessedUnit{"mm", 1e-3, 0.0}};

std::string lower_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

bool is_surface_ending(std::string_view ending) {
  constexpr std::array<std::string_view, 5> kEndings{".stl", ".ply", ".obj", ".3ds", ".off"};
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

Eigen::Vector3d size_of(const Eigen::Matrix3Xd& points) { return extent_of(points); }

// To two digits, without an exponent.
double rounded(double x) {
  const double digit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return std::round(x / digit) * digit;
}

// A TOML string in quotes: file names may hold any character.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') result += '\\';
    if (code < 0x20 || code == 0x7f) {
      result += fmt::format("\\u{:04x}", code);
    } else {
      result += c;
    }
  }
  return result + "\"";
}

}  // namespace

bool is_shape_file(const std::filesystem::path& path) {
  return is_surface_ending(lower_ending(path)) || is_volume_file(path);
}

std::string first_description(const std::filesystem::path& shape) {
  PALPABLE_EXPECT(is_shape_file(shape), "a file of a surface or of tetrahedra");
  const bool surface = is_surface_ending(lower_ending(shape));
  const Eigen::Vector3d size = surface
                                   ? size_of(value_or_throw(read_surface_file(shape)).vertices)
                                   : size_of(value_or_throw(read_volume_file(shape)).mesh.nodes);
  const double longest = size.maxCoeff();
  const GuessedUnit& unit = *std::find_if(kUnits.begin(), kUnits.end(), [&](const GuessedUnit& u) {
    return longest <= u.largest || u.largest == 0.0;
  });
  const Eigen::Vector3d in_metres = unit.size * size;
  const std::string name = shape.filename().string();
  // Twenty edges along the longest side: some thousand nodes, a bake of a minute.
  const std::string edge =
      surface ? fmt::format(", edge = \"{:.6g} mm\"", rounded(1e3 * in_metres.maxCoeff() / 20))
              : std::string();
  return fmt::format(
      "name = {}\n"
      "shape = {{ {} = {}, unit = \"{}\"{} }}  # then it is {}\n"
      "material = {{ young = \"60 kPa\", poisson = 0.4 }}  # a soft rubber\n"
      "support = {{ below = 0.03 }}  # the lowest 3 % of the height stand on the ground\n"
      "sites = {{ count = 24 }}  # places that can be pressed\n",
      quoted(shape.stem().string()), surface ? "surface" : "mesh", quoted(name), unit.name, edge,
      size_text(in_metres));
}

}  // namespace palpable
