/// @file
/// Cubic interpolation of a function of one parameter between samples.
///
///   n  samples
#pragma once

#include <Eigen/Core>

namespace palpable {

/// Slopes at the samples of the cubic spline through them with not-a-knot ends: twice continuously
/// differentiable, fourth order, exact for cubics. The condition at the ends matters: the error of
/// the natural spline, whose curvature there is zero, is three to four times as large on our
/// bodies.
///
/// Two samples give the straight line, three the parabola, one the slope 0.
/// @param x  (n) strictly increasing
/// @param g  (n x m) one function per column
/// @returns  (n x m) dg/dx
[[nodiscard]] Eigen::MatrixXd spline_slopes(const Eigen::VectorXd& x, const Eigen::MatrixXd& g);

/// The same slopes, limited so that the cubic between two samples stays in the range of their
/// values: if g increases strictly, so does the interpolation. By the sufficient condition of
/// Fritsch and Carlson (1980): each slope lies between 0 and three times the slope of the secant on
/// either side.
[[nodiscard]] Eigen::MatrixXd increasing_slopes(const Eigen::VectorXd& x, const Eigen::MatrixXd& g);

/// The weights of the values g and slopes s at both ends in a cubic on [x_k, x_k+1]:
///
///     G = value[0] g_k + value[1] s_k + value[2] g_k+1 + value[3] s_k+1,   G' likewise with slope
///
/// At a sample, and beyond the first and the last sample, only the entries of k are nonzero.
struct CubicWeights {
  Eigen::Index left = 0;   ///< k
  Eigen::Index right = 0;  ///< k + 1, or k at a sample
  double value[4] = {1, 0, 0, 0};
  double slope[4] = {0, 0, 0, 0};
};

/// The weights at `at`. Beyond the ends the value is that at the nearest end, and the slope is 0.
/// Allocates nothing. @pre `at` is a number; x increases strictly
[[nodiscard]] CubicWeights cubic_weights(const Eigen::Ref<const Eigen::VectorXd>& x, double at);

}  // namespace palpable
