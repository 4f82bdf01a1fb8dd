/// @file
/// What to bake, as text (TOML): shape, material, support, sites, loads, reduction. Schema with
/// examples: docs/body.md.
#pragma once

#include "palpable/bake/separate/reduction.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace palpable {

/// The axis of the shape's file that points up in the body frame.
enum class UpAxis { kX, kY, kZ };

/// A part of the body, in the body frame, in m.
struct Where {
  /// The lowest fraction of the height, or what is above one.
  struct Below {
    double fraction;
  };
  struct Above {
    double fraction;
  };
  /// Nodes and faces within `distance` of the plane, by default within a millionth of the body's
  /// diagonal: mesh files have six digits and more; elements on the side to which it points.
  struct Plane {
    Eigen::Vector3d point, normal;
    std::optional<double> distance = std::nullopt;
  };
  struct Box {
    Eigen::Vector3d low, high;
  };
  /// The node nearest to each point.
  struct Nearest {
    std::vector<Eigen::Vector3d> points;
  };
  /// A set of the mesh's file.
  struct Named {
    std::string name;
  };
  std::variant<Below, Above, Plane, Box, Nearest, Named> what = Below{0};
  /// "cube.toml:12: 'below' in [support]": how messages about it begin.
  std::string place = {};
};

/// A body to be baked. Defaults are those of the schema; fields without one are required there.
struct BodyDescription {
  std::string name;

  struct Shape {
    std::filesystem::path
        file;  ///< a surface (.stl .ply .obj .3ds .off) or a volume (.msh .inp .vtu .vtk)
    UpAxis up = UpAxis::kZ;        ///< of the file
    std::optional<double> height;  ///< m, scaled to; none: lengths in the file are in `unit`
    std::optional<double> edge;    ///< m, remeshed to; none: the surface as it is
    std::optional<double> inner_edge = {};  ///< m, of tetrahedra far inside; none: as on the skin
    std::optional<double> wrap = {};  ///< m, wrapped around the file's triangles; none: as they are
    double unit = 1.0;                ///< m, of lengths in the file
    /// Nodes of a tetrahedron: 1: four, 2: ten. None: as the file has it, four for a surface.
    std::optional<int> order = {};
    std::string order_place = {};  ///< how messages about it begin
    std::string place = {};        ///< likewise, about the shape: "cube.toml:2: [shape]"
    [[nodiscard]] bool is_volume() const;
  } shape;

  /// Young's modulus and Poisson's ratio, or the law's own constants.
  struct MaterialLaw {
    std::string law = "neo-hookean";
    double young = 0;                    ///< Pa
    double poisson = 0;                  ///< -
    std::vector<double> constants = {};  ///< SI, as law_constants(); empty: the two above
  } material;

  /// Elements that are made of something else; by their middles.
  struct MaterialPart {
    MaterialLaw material;
    Where where;
    std::string name = {};  ///< for parameters; may be empty
  };
  std::vector<MaterialPart> groups = {};

  /// What a campaign varies beside site and level.
  struct Parameter {
    enum class What {
      kStiffness,  ///< a factor of all constants that are pressures
      kYoung,      ///< Pa
      kPoisson
    };
    std::string name;
    int group = -1;  ///< of `groups`; -1: `material`
    What what = What::kStiffness;
    std::vector<double> values;  ///< increasing, at least one
    std::string place = {};      ///< how messages about it begin
  };
  std::vector<Parameter> parameters = {};

  /// Nodes that are held.
  struct Support {
    Where where = {Where::Below{0.03}, {}};
    Eigen::Array<bool, 3, 1> held = {true, true, true};      ///< x, y, z
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m; 0 where not held
  };
  std::vector<Support> supports = {Support{}};
  std::string supports_place = {};  ///< how messages about all of them begin

  /// The body's own weight.
  struct Gravity {
    double density;                                    ///< kg/m^3
    Eigen::Vector3d acceleration = {0.0, 0.0, -9.81};  ///< m/s^2
  };
  std::optional<Gravity> gravity = {};

  struct Pressure {
    double pressure;  ///< Pa, > 0 pushes into the body
    Where where;      ///< faces of the skin, all of whose corners lie there
  };
  std::vector<Pressure> pressures = {};

  struct Sites {
    int count = 0;         ///< of sites that are chosen; not with `at`
    bool salient = false;  ///< by curvature; otherwise far apart
    double above = 0.10;   ///< fraction of the height: no such site lower
    int patch = 2;         ///< graph distance
    /// The linear response of every vertex of the skin to its own patch load is stored, too.
    bool linear = false;
    /// Towards the centre of mass, along the inward normal of the patch, or this way.
    struct ToCentre {};
    struct AlongNormal {};
    std::variant<ToCentre, AlongNormal, Eigen::Vector3d> direction = ToCentre{};
    /// The skin's vertices nearest to points, or those of sets; none: `count` of them, far apart.
    std::vector<Where> at = {};
  } sites;

  struct Press {
    double depth = 0.10;                ///< along the load: a fraction of the height
    std::optional<double> length = {};  ///< m, instead of the fraction
    std::optional<double> force = {};   ///< N, instead of a depth
    int levels = 10;                    ///< solved load levels, 1 / levels .. 1
  } press;

  /// Of displacement and of stress.
  ReductionSettings reduction = {.tolerance = default_tolerance(ReductionMethod::kPerSite),
                                 .weight_snapshots = true};

  /// What a body file holds beside its sites, to be touched anywhere (response/touch_tables.h).
  struct Touch {
    enum class Tables {
      kNone,    ///< at its sites, one touch at a time
      kLinear,  ///< exact for small touches
      kFull     ///< large ones, too
    };
    Tables tables = Tables::kFull;
    bool by_default = true;  ///< nobody asked for them: left out where they would be too much
    std::optional<int> regions = {};      ///< at most; none: as many as the skin asks for
    std::optional<int> cross_modes = {};  ///< a multiple of 16; none: as touch_bake has it
    /// m, of a coarser mesh that tables are made on and that carries the skin; none: of a fine skin
    /// as touch_edge() has it, of others the body's own mesh.
    std::optional<double> edge = {};
    int held_out = 20;  ///< touches solved in full, that tell how good tables are
  } touch;

  /// A load that travels, for `bake --method intrusive-pgd`: no campaign, other sites and loads.
  struct Intrusive {
    std::vector<Where> positions;  ///< sets of nodes; each on the skin is a position
    double force = 0;              ///< N, at each position
    /// Sets of nodes that something may push back at, the other way, while the load acts; none:
    /// the body file answers one load at a time.
    std::vector<Where> reactions = {};
    int levels = 6;  ///< load sizes 1 / levels .. 1 at which fields are tabulated
    int modes = 32;  ///< of displacement
    int stress_modes = 150;
    /// Positions nearer to what is held than so many patch radii are left out.
    double clearance = 2.0;
    std::string place = {};  ///< how messages about it begin
  };
  std::optional<Intrusive> intrusive = {};

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
