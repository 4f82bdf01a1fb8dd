// Also compiled as C++ (occlusion_bias.h, color_map_test.cpp).

/// The distance (m) by which a real surface must be nearer than the body to hide it. The constant
/// term is for contact: a finger that presses lies on the body, not before it. The other term is
/// the noise of stereo, which grows as Z^2: 0.25 px of disparity at f = 700 px, B = 63 mm are
/// 0.0057 Z^2. Larger values let the body cover thin things before it; smaller ones make outlines
/// flicker.
float occlusion_bias(float z) { return 0.001f + 0.006f * z * z; }
