# Draws the letters of the pictures' captions at build time (tools/make_font.cpp) and compiles them
# into palpable::render. See dependencies.cmake for the font and for stb.
add_executable(palpable_make_font tools/make_font.cpp)
# A tool of the build, not a program of ours: it stays out of bin/.
set_target_properties(palpable_make_font PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tools)
target_include_directories(palpable_make_font SYSTEM PRIVATE ${STB_INCLUDE_DIR})
set(palpable_font_table ${PROJECT_BINARY_DIR}/generated/font_table.cpp)
add_custom_command(OUTPUT ${palpable_font_table} VERBATIM
                   COMMAND palpable_make_font ${DEJAVU_FONT} ${palpable_font_table}
                   DEPENDS palpable_make_font ${DEJAVU_FONT}
                   COMMENT "Drawing the built-in font")
target_sources(palpable_render PRIVATE ${palpable_font_table})
