/// @file
/// The skin of the body as a result drew it, frame by frame: from meshes/ or, with the body file of
/// the run, from its touches.
#pragma once

#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/scorecard/folders.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// Whether the stress is evaluated, which is slow.
enum class Stress { kNotWanted, kWanted };

/// The skin of a frame is RESULT/meshes/%06d.ply if there is such a folder, else the reduced body
/// deformed by the frame's first touch (site and level; the response to several touches at once is
/// not known). All skins are in the body frame.
///
/// A skin that at rest differs from that of the filmed body is refused, since it belongs to another
/// body, scale or frame.
class DrawnSkins {
 public:
  /// Largest offset between a skin at rest and the true one (skin_offset()), ratio to the body's
  /// height. The Stanford bunny, 150 mm high and remeshed with edges of 4.27, 7.5, 10 and 15 mm
  /// (3,892 to 310 vertices), has offsets of 0.14 to 0.58 % from itself, 1.0 to 1.1 % when scaled
  /// by 1.03, and 1.1 % when shifted by 3 mm.
  static constexpr double kSameBody = 0.01;

  /// All arguments must outlive this object. @param body  reduced body of the run; may be null
  /// @throws Error naming a file that cannot be read, or a skin that is not that of the true body
  DrawnSkins(const TruthFolder& truth, const ResultFolder& result, const ReducedBody* body);

  /// The skin of a processed frame, with the von Mises stress at its vertices if it is wanted and
  /// known. Nothing when the mesh of the frame is missing. Without meshes, nothing for all frames
  /// when some touch of the result lacks site or level: the frame with the unknown shape might be
  /// the worst.
  /// @throws Error naming a mesh that cannot be read or has another number of vertices, or a site
  /// that
  ///         the body does not have
  [[nodiscard]] std::optional<ValuedSurface> at(int frame, Stress stress);

  /// The skin at rest: with meshes/ its rest.ply, else the mesh of the first processed frame if
  /// nothing truly touches in it; without meshes/ that of the reduced body. Nothing when not known.
  [[nodiscard]] const std::optional<SurfaceMesh>& rest() const { return rest_; }

  /// Largest depth of an obstacle that is scored, m: a tenth of the height of the true body at
  /// rest, else of the drawn one; deeper, a hand passes through it. Infinite for a body in a scene
  /// of several. Nothing when no skin is known.
  [[nodiscard]] std::optional<double> deepest_scored() const;

 private:
  [[nodiscard]] std::filesystem::path mesh_file(int frame) const;
  [[nodiscard]] std::optional<ValuedSurface> from_file(const std::filesystem::path& path);
  [[nodiscard]] ValuedSurface from_touch(int frame, Stress stress) const;
  void find_rest_among_meshes();
  void expect_true_body(const SurfaceMesh& rest, const std::string& what) const;

  const TruthFolder& truth_;
  const ResultFolder& result_;
  const ReducedBody* body_;
  bool meshes_;
  bool touches_give_skins_ = false;  // whether the first touch of every frame has site and level
  int vertices_ = 0;                 // number in every mesh; 0 until the first is read
  std::optional<SurfaceMesh> rest_;
  std::optional<double> height_;  // m, of the drawn skin
};

}  // namespace palpable
