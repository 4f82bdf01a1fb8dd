#version 450 core
// Transforms a vertex of the panel.
layout(location = 0) in vec2 at;         // px of the window, (0, 0) its upper left corner
layout(location = 1) in vec2 at_in_font;  // 0 .. 1 of the texture
layout(location = 2) in vec4 color;
uniform vec2 size;                        // of the window, px
out vec2 uv;
out vec4 tint;

void main() {
  uv = at_in_font;
  tint = color;
  gl_Position = vec4(2.0 * at.x / size.x - 1.0, 1.0 - 2.0 * at.y / size.y, 0.0, 1.0);
}
