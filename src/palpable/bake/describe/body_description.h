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
  /// The lowest fraction of the height, or everything above a fraction of it.
  struct Below {
    double fraction;
  };
  struct Above {
    double fraction;
  };
  /// Nodes and faces within `distance` of the plane (by default a millionth of the body's diagonal,
  /// since mesh files have at least six digits); elements on the side to which the normal points.
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
  /// A named set of the mesh file.
  struct Named {
    std::string name;
  };
  std::variant<Below, Above, Plane, Box, Nearest, Named> what = Below{0};
  /// Prefix of messages about it: "cube.toml:12: 'below' in [support]".
  std::string place = {};
};

/// A body to be baked. Defaults are those of the schema; fields without one are required there.
struct BodyDescription {
  std::string name;

  struct Shape {
    std::filesystem::path
        file;  ///< a surface (.stl .ply .obj .3ds .off) or a volume (.msh .inp .vtu .vtk)
    UpAxis up = UpAxis::kZ;        ///< of the file
    std::optional<double> height;  ///< m, after scaling; none: lengths in the file are in `unit`
    std::optional<double> edge;    ///< m, after remeshing; none: the surface is not remeshed
    std::optional<double> inner_edge = {};  ///< m, edge far inside; none: as on the skin
    std::optional<double> wrap = {};        ///< m, size of a wrap (wrap_surface()); none: no wrap
    double unit = 1.0;                      ///< m, of lengths in the file
    /// Who made the shape, a page about it (http, https), and its terms; empty: not stated.
    std::string credit = {}, credit_url = {}, terms = {};
    /// Order of the elements: 1 (four nodes) or 2 (ten nodes). None: as in the file, 1 for a
    /// surface.
    std::optional<int> order = {};
    std::string order_place = {};  ///< prefix of messages about it
    std::string place = {};        ///< prefix of messages about the shape
    [[nodiscard]] bool is_volume() const;
  } shape;

  /// Young's modulus and Poisson's ratio, or the law's own constants.
  struct MaterialLaw {
    std::string law = "neo-hookean";
    double young = 0;                    ///< Pa
    double poisson = 0;                  ///< -
    std::vector<double> constants = {};  ///< SI, as law_constants(); empty: the two above
    std::string place = {};              ///< prefix of messages about it
  } material;

  /// What makes the body heavy and damps its vibration; of all its materials alike.
  struct Inertia {
    double density = 0;      ///< kg/m^3; that of [gravity] where [material] states none
    double loss_factor = 0;  ///< 0 <= eta < 1; of a vibration, see VibrationTable::damping()
  };
  std::optional<Inertia> inertia = {};  ///< none: no density is stated

  /// Elements of another material, chosen by their middles.
  struct MaterialPart {
    MaterialLaw material;
    Where where;
    std::string name = {};  ///< for parameters; may be empty
  };
  std::vector<MaterialPart> groups = {};

  /// A parameter that a campaign varies beside site and level.
  struct Parameter {
    enum class What {
      kStiffness,  ///< a factor on all moduli
      kYoung,      ///< Pa
      kPoisson
    };
    std::string name;
    int group = -1;  ///< index in `groups`; -1: `material`
    What what = What::kStiffness;
    std::vector<double> values;  ///< increasing, at least one
    std::string place = {};      ///< prefix of messages about it
  };
  std::vector<Parameter> parameters = {};

  /// Nodes that are held.
  struct Support {
    Where where = {Where::Below{0.03}, {}};
    Eigen::Array<bool, 3, 1> held = {true, true, true};      ///< x, y, z
    Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m; 0 where not held
  };
  std::vector<Support> supports = {Support{}};
  std::string supports_place = {};  ///< prefix of messages about all supports

  /// The body's own weight.
  struct Gravity {
    double density;                                    ///< kg/m^3
    Eigen::Vector3d acceleration = {0.0, 0.0, -9.81};  ///< m/s^2
    std::string place = {};                            ///< how messages about it begin
  };
  std::optional<Gravity> gravity = {};

  struct Pressure {
    double pressure;  ///< Pa, > 0 pushes into the body
    Where where;      ///< faces of the skin, all of whose corners lie there
  };
  std::vector<Pressure> pressures = {};

  struct Sites {
    int count = 0;         ///< number of sites to choose; not used with `at`
    bool salient = false;  ///< chosen by curvature; otherwise far apart
    double above = 0.10;   ///< fraction of the height below which no site is chosen
    int patch = 2;         ///< radius of a patch in edges
    /// Whether the linear response of every vertex of the skin to its own patch load is stored.
    bool linear = false;
    /// Towards the centre of mass, along the inward normal of the patch, or along a given vector.
    struct ToCentre {};
    struct AlongNormal {};
    std::variant<ToCentre, AlongNormal, Eigen::Vector3d> direction = ToCentre{};
    /// The skin's vertices nearest to points, or those of sets; empty: `count` sites are chosen.
    std::vector<Where> at = {};
  } sites;

  struct Press {
    double depth = 0.10;                ///< along the load, ratio to the height
    std::optional<double> length = {};  ///< m, instead of `depth`
    std::optional<double> force = {};   ///< N, instead of a depth
    int levels = 10;                    ///< solved load levels, 1 / levels .. 1
    /// The largest displacement of a node, by any load, at which the model means anything: a ratio
    /// to the body's largest extent. Not its smallest: slender bodies bend by many times their
    /// thickness while their strains are small. Where it is not given, a press by depth, which has
    /// a bound of its own, may also move nodes by six times the depth: the tips of what it bends.
    double range = kUsualRange;
    std::optional<double> range_length = {};  ///< m, instead of `range`
    static constexpr double kUsualRange = 1.0 / 3.0;
    [[nodiscard]] bool has_usual_range() const { return range == kUsualRange && !range_length; }
  } press;

  /// Reduction of displacement and of stress.
  ReductionSettings reduction = {.tolerance = default_tolerance(ReductionMethod::kPerSite),
                                 .weight_snapshots = true};

  /// Tables with which a body can be touched anywhere, not only at its sites
  /// (response/touch_tables.h).
  struct Touch {
    enum class Tables {
      kNone,    ///< touched at its sites only, one at a time
      kLinear,  ///< exact for small touches
      kFull     ///< also for large touches
    };
    Tables tables = Tables::kFull;
    bool by_default = true;           ///< not requested explicitly: bake_touch() may leave them out
    std::optional<int> regions = {};  ///< at most; none: as many as the skin needs
    std::optional<int> cross_modes = {};  ///< a multiple of 16; none: the default of touch_bake
    /// Smaller tables than the default of touch_bake: clusters of the compliance, at most; columns
    /// of the basis of each (a multiple of 16); modes of a region (likewise), and how many of them
    /// have a third order.
    std::optional<int> clusters = {}, cluster_modes = {}, region_modes = {}, leading_modes = {};
    /// m, edge of the coarser mesh on which tables are made and which carries the skin. None:
    /// touch_edge() for a fine skin; for others tables are made on the body's own mesh.
    std::optional<double> edge = {};
    int held_out = 20;  ///< held-out touches, to measure the error of tables
    /// Coulomb's coefficient of friction of the skin; 0: none, as in descriptions without the key.
    double friction = 0;
    /// Vibration modes, at least, of a body with a density; 0: none.
    int modes = 20;
  } touch;

  /// A travelling load, for `bake --intrusive`, which uses neither a campaign nor its
  /// sites and loads.
  struct Intrusive {
    std::vector<Where> positions;  ///< sets of nodes; each node on the skin is a position
    double force = 0;              ///< N, at each position
    /// Sets of nodes at which a second load may act against the first one at the same time; empty:
    /// the body file can respond to one load at a time.
    std::vector<Where> reactions = {};
    int levels = 6;  ///< load sizes 1 / levels .. 1 at which fields are tabulated
    int modes = 32;  ///< of displacement
    int stress_modes = 150;
    /// Ratio to the patch radius: positions nearer to held nodes than that are left out.
    double clearance = 2.0;
    std::string place = {};  ///< prefix of messages about it
  };
  std::optional<Intrusive> intrusive = {};

  std::filesystem::path source;  ///< the TOML file
};

/// Reads and checks a description. Paths in it are relative to the file.
/// @throws Error naming file, line and key: missing file, not TOML, a key that is unknown (with the
///         nearest known one), missing, of the wrong kind, without a unit, or out of range
[[nodiscard]] BodyDescription read_body_description(const std::filesystem::path& path);

/// The same from memory; @param path  for messages and relative paths
[[nodiscard]] BodyDescription parse_body_description(std::string_view text,
                                                     const std::filesystem::path& path);

}  // namespace palpable
