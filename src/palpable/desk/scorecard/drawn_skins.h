/// @file
/// The body as a result drew it, frame by frame: from meshes/ or, with the body of the run, from
/// its touches.
#pragma once

#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/scorecard/folders.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// Whether the stress is asked for, which takes its time.
enum class Stress { kNotWanted, kWanted };

/// The skin of a frame is RESULT/meshes/%06d.ply where there is such a folder, else the body
/// deformed by the frame's first touch (site and level; of several touches at once no answer is
/// known). All of it in the body frame.
///
/// A skin whose rest does not lie on that of the body that was filmed is refused: another body,
/// another scale or another frame.
class DrawnSkins {
 public:
  /// Of the body's height: how far a skin at rest may lie off the true one (skin_fit.h). The
  /// Stanford bunny, 150 mm high and remeshed to edges of 4.27, 7.5, 10 and 15 mm (3,892 to 310
  /// vertices), lies 0.14 to 0.58 % off itself; 3 % larger 1.0 to 1.1 %, and 3 mm beside itself 1.1
  /// %.
  static constexpr double kSameBody = 0.01;

  /// All arguments must live as long as this. @param body  of the run; may be null
  /// @throws Error naming the file that cannot be read, or what is not the body of the truth
  DrawnSkins(const TruthFolder& truth, const ResultFolder& result, const ReducedBody* body);

  /// The skin of a processed frame, and von Mises stress at its vertices where it is wanted and
  /// known. Nothing when the frame's skin is not known: there is no such mesh, or some touch of the
  /// result does not say site and level (a frame of an unknown shape leaves none: it might be the
  /// worst one).
  /// @throws Error naming the mesh that cannot be read or is of another body, or the site that the
  ///         body does not have
  [[nodiscard]] std::optional<ValuedSurface> at(int frame, Stress stress);

  /// The skin at rest: that of the body; with meshes/ its rest.ply, else the mesh of the first
  /// processed frame if nothing truly touches in it. Nothing when it is not known.
  [[nodiscard]] const std::optional<SurfaceMesh>& rest() const { return rest_; }

  /// How deep an object may be to be scored, m: beyond a tenth of the body's height (of the true
  /// body at rest, else of the one that was drawn) a hand passes through it. Nothing when no skin
  /// is known.
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
  bool touches_say_it_ = false;
  int vertices_ = 0;  // of every mesh; 0 until the first was read
  std::optional<SurfaceMesh> rest_;
  std::optional<double> height_;  // m, of what was drawn
};

}  // namespace palpable
