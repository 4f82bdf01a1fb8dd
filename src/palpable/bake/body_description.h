/// @file
/// What to bake, as text (TOML): shape, material, support, sites, loads, reduction. Schema with
/// examples: docs/body.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpable {

/// The axis of the shape's file that points up in the body frame.
enum class UpAxis { kX, kY, kZ };

/// A body to be baked. Defaults are those of the schema; fields without one are required there.
struct BodyDescription {
  std::string name;

  struct Shape {
    std::filesystem::path file;    ///< a surface (.stl .ply .obj .3ds .off) or a volume (.msh)
    UpAxis up = UpAxis::kZ;        ///< of the file
    std::optional<double> height;  ///< m, scaled to; none: lengths in the file are metres
    std::optional<double> edge;    ///< m, remeshed to; none: the surface as it is
    [[nodiscard]] bool is_volume() const;
  } shape;

  struct MaterialLaw {
    std::string law = "neo-hookean";
    double young = 0;    ///< Pa
    double poisson = 0;  ///< -
  } material;

  struct Support {
    double below = 0.03;  ///< fraction of the height: lower nodes are held
  } support;

  struct Sites {
    int count = 0;
    double above = 0.10;  ///< fraction of the height: no site lower
    int patch = 2;        ///< graph distance
  } sites;

  struct Press {
    double depth = 0.10;  ///< fraction of the height, along the load
    int levels = 10;      ///< solved load levels, 1 / levels .. 1
  } press;

  struct Reduction {
    double tolerance = 5e-4;  ///< relative pooled L2 error, for displacement and for stress
    int max_modes = 300;
  } reduction;

  std::filesystem::path source;  ///< the TOML file
};

/// Reads and checks a description. Paths in it are relative to the file.
/// @throws Error naming file, line and key: missing file, not TOML, a key that is unknown (with the
///         nearest known one), missing, of the wrong kind, without a unit, or out of range
[[nodiscard]] BodyDescription read_body_description(const std::filesystem::path& path);

/// The same from memory; @param path for messages and relative paths
[[nodiscard]] BodyDescription parse_body_description(std::string_view text,
                                                     const std::filesystem::path& path);

}  // namespace palpable
