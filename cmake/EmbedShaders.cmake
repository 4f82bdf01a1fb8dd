# palpable_embed_shaders(render)
#
# Compiles every file of src/palpable/<module>/shaders into palpable::<module>, as
#   std::span<const ShaderFile> palpable::<module>_shader_files();     (declare it where you use it)
# Run as a script (-P) it writes that one .cpp; a shader that changes is embedded again by the build.
if(CMAKE_SCRIPT_MODE_FILE)
  set(text "// Written by cmake/EmbedShaders.cmake.\n#include \"palpable/render/gl_objects.h\"\n\n")
  string(APPEND text "#include <array>\n\nnamespace palpable {\n")
  string(APPEND text "std::span<const ShaderFile> ${MODULE}_shader_files();\n")
  string(APPEND text "namespace {\nconstexpr std::array kFiles{\n")
  foreach(file ${FILES})
    file(READ ${file} content)
    get_filename_component(name ${file} NAME)
    string(APPEND text "ShaderFile{\"${name}\", R\"glsl(${content})glsl\"},\n")
  endforeach()
  string(APPEND text "};\n}  // namespace\n")
  string(APPEND text "std::span<const ShaderFile> ${MODULE}_shader_files() { return kFiles; }\n")
  string(APPEND text "}  // namespace palpable\n")
  file(WRITE ${OUTPUT} "${text}")
  return()
endif()

set(PALPABLE_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(palpable_embed_shaders module)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/palpable/${module}/shaders/*)
  if(NOT files)
    return()
  endif()
  set(output ${PROJECT_BINARY_DIR}/generated/${module}_shaders.cpp)
  add_custom_command(
    OUTPUT ${output} VERBATIM
    COMMAND ${CMAKE_COMMAND} "-DMODULE=${module}" "-DFILES=${files}" "-DOUTPUT=${output}"
            -P ${PALPABLE_EMBED_SCRIPT}
    DEPENDS ${files} ${PALPABLE_EMBED_SCRIPT}
    COMMENT "Embedding the shaders of ${module}")
  target_sources(palpable_${module} PRIVATE ${output})
endfunction()
