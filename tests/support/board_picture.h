/// @file
/// The picture of a chessboard seen through a lens.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/calibrate/board_calibration.h"

#include <Eigen/Core>

#include <cmath>
#include <cstdint>

namespace palpable::test {

/// Ray-traced with `samples` x `samples` rays per pixel: a white sheet with black squares. The
/// origin of the board's frame is the first inner corner; X points along the columns.
inline ColorImage board_picture(const DistortedCamera& eye, const Rigid3& camera_from_board,
                                const BoardPattern& board, int samples = 7) {
  const PinholeCamera& camera = eye.pinhole;
  // Removes the lens distortion by fixed-point iteration, which suffices for a mild one.
  const auto straight = [&](double u, double v) {
    Eigen::Vector2d p((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d off =
          eye.project(Eigen::Vector3d(p.x(), p.y(), 1)) - Eigen::Vector2d(u, v);
      if (off.norm() < 1e-9) break;
      p -= Eigen::Vector2d(off.x() / camera.fx_px, off.y() / camera.fy_px);
    }
    return Eigen::Vector3d(p.x(), p.y(), 1);
  };
  const Rigid3 board_from_camera = camera_from_board.inverse();
  const Eigen::Vector3d eye_on_board = board_from_camera.translation();
  ColorImage image(camera.width, camera.height, Rgb{});
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = board_from_camera.linear() * straight(u, v);
      // Within a pixel the lens is treated as linear.
      const Eigen::Vector3d du = board_from_camera.linear() * straight(u + 0.5, v) - ray;
      const Eigen::Vector3d dv = board_from_camera.linear() * straight(u, v + 0.5) - ray;
      int sum = 0;
      for (int i = 0; i < samples * samples; ++i) {
        const int across = i % samples, down = i / samples;
        const double a = 2.0 * (across + 0.5) / samples - 1;
        const double b = 2.0 * (down + 0.5) / samples - 1;
        const Eigen::Vector3d through = ray + a * du + b * dv;
        const Eigen::Vector3d x = eye_on_board - eye_on_board.z() / through.z() * through;
        const int column = static_cast<int>(std::floor(x.x() / board.square)) + 1;
        const int row = static_cast<int>(std::floor(x.y() / board.square)) + 1;
        const bool on_board =
            column >= 0 && row >= 0 && column <= board.columns && row <= board.rows;
        sum += on_board && (row + column) % 2 == 0 ? 20 : 230;
      }
      const auto value = static_cast<std::uint8_t>(sum / (samples * samples));
      image(u, v) = Rgb{value, value, value};
    }
  }
  return image;
}

}  // namespace palpable::test
