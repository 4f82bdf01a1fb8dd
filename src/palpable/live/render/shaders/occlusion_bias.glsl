// Also compiled as C++ (occlusion_bias.h, color_map_test.cpp).

/// How much nearer than the body a real surface must be before it hides it, m. The constant is the
/// thickness of a touch (a finger that presses lies on the body, not before it); the other part is
/// the noise of stereo, which grows as Z^2: 0.25 px of disparity at f = 700 px, B = 63 mm are
/// 0.0057 Z^2.
float occlusion_bias(float z) { return 0.001f + 0.006f * z * z; }
