/// @file
/// Makes the lines of a hands file (session/things_line.h) from what others wrote: a table of a
/// hand tracker's joints, or the true hand of a filmed clip.
#pragma once

#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/live/session/things_line.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// What a table of joints does not say itself.
struct JointsTable {
  std::optional<HandLayout> layout = {};  ///< nothing: the number of columns says it
  HandSide side = HandSide::kRight;       ///< of lines without a column for it
  double metres = 1;                      ///< one unit of its coordinates
  double seconds = 1;                     ///< one unit of its times
  bool has_y_up = false;                  ///< (x, y, z) is turned to (x, -z, y): Z up
};

/// What was found in a table of joints.
struct JointsFound {
  HandLayout layout = HandLayout::kOpenXr;  ///< of the first hand
  bool is_counted = false;                  ///< the number of columns said which layout it is
  bool has_radii = false;
  bool has_left = false, has_right = false;
  std::string first_name;  ///< of the first joint's first column; empty: there are no names
};
struct JointsRead {
  std::vector<ThingsLine> lines;
  JointsFound found;
};

/// The lines of a table of joints. One row is one hand at one time:
///
///     time,side,x0,y0,z0,x1,...           side: left or right; the column may be left out
///     0.033,right,0.01,-0.02,0.21,...     3 numbers a joint, or 4 with its radius
///
/// The columns are separated by commas, semicolons, tabs or spaces. A first row of names and rows
/// that begin with # are skipped. Rows of the same time become one line; a row without joints, or
/// with nan among them, is a hand that was not tracked. The right hand has the id 1, the left 2.
/// Times begin at 0.
/// @throws Error naming file and row of what cannot be read, and of what is no hand
/// (tracked_hand())
[[nodiscard]] JointsRead read_joints_table(const std::filesystem::path& path,
                                           const JointsTable& table);

/// The true hand of a clip (clip_files/clip_hands.h), a line for each frame, in the frame of the
/// body: without --place the body stands where it stood in the film. The capsules of everything
/// that moves in the film form one thing, with the id 1.
/// @param body  name of the body in a clip of several; empty: the clip has one body
/// @throws Error naming the file that is missing or cannot be read
[[nodiscard]] std::vector<ThingsLine> read_clip_things(const std::filesystem::path& clip,
                                                       const std::string& body = {});

/// A hands file as text, and what is in it.
struct HandsText {
  std::string text;
  std::size_t lines = 0;
  std::size_t pressing = 0;  ///< lines with something that may press
  double seconds = 0;        ///< from the first line to the last
  double step = 0;           ///< s, the usual one from line to line; 0: there are not two lines
  Eigen::AlignedBox3d box;  ///< m, of the axes of all capsules: little more than that of the joints
};
[[nodiscard]] HandsText hands_text(const std::vector<ThingsLine>& lines);

/// What in a table seems to be something else than what it was taken for; each names the option.
[[nodiscard]] std::vector<std::string> joints_warnings(const HandsText& made,
                                                       const JointsTable& table,
                                                       const JointsFound& found);

}  // namespace palpable
