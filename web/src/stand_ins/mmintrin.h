// Eigen includes it beside emmintrin.h, and uses nothing of it: MMX, which emscripten does not emulate.
