# Compiles files into a module, each as {name, content}, so that a program needs nothing beside it.
#
#   palpable_embed_shaders(live/render)    every file of src/palpable/live/render/shaders, as
#       std::span<const ShaderFile> palpable::render_shader_files();   (declare it where you use it)
#   palpable_embed_pages(bake/exchange FILE...)   of src/palpable/bake/exchange/pages, and the given files, as
#       std::span<const PageFile> palpable::exchange_page_files();
#   palpable_embed(reproduce text PageFile HEADER FILE...)   the given files, as the type of that header, as
#       std::span<const PageFile> palpable::reproduce_text_files();
#
# Run as a script (-P) it writes the one .cpp; a file that changes is embedded again by the build.
if(CMAKE_SCRIPT_MODE_FILE)
  set(text "// Written by cmake/EmbedFiles.cmake.\n#include \"${HEADER}\"\n\n")
  string(APPEND text "#include <array>\n#include <span>\n\nnamespace palpable {\n")
  string(APPEND text "std::span<const ${TYPE}> ${FUNCTION}();\n")
  string(APPEND text "namespace {\nconstexpr std::array kFiles{\n")
  foreach(file ${FILES})
    file(READ ${file} content)
    get_filename_component(name ${file} NAME)
    string(APPEND text "${TYPE}{\"${name}\", R\"palpable(${content})palpable\"},\n")
  endforeach()
  string(APPEND text "};\n}  // namespace\n")
  string(APPEND text "std::span<const ${TYPE}> ${FUNCTION}() { return kFiles; }\n")
  string(APPEND text "}  // namespace palpable\n")
  file(WRITE ${OUTPUT} "${text}")
  return()
endif()

set(PALPABLE_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(palpable_embed module what type header files)
  if(NOT files)
    return()
  endif()
  set(output ${PROJECT_BINARY_DIR}/generated/${module}_${what}s.cpp)
  add_custom_command(
    OUTPUT ${output} VERBATIM
    COMMAND ${CMAKE_COMMAND} "-DTYPE=${type}" "-DHEADER=${header}"
            "-DFUNCTION=${module}_${what}_files" "-DFILES=${files}" "-DOUTPUT=${output}"
            -P ${PALPABLE_EMBED_SCRIPT}
    DEPENDS ${files} ${PALPABLE_EMBED_SCRIPT}
    COMMENT "Embedding the ${what}s of ${module}")
  target_sources(palpable_${module} PRIVATE ${output})
endfunction()

function(palpable_embed_shaders folder)
  get_filename_component(module ${folder} NAME)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/palpable/${folder}/shaders/*)
  palpable_embed(${module} shader ShaderFile palpable/live/render/gl_objects.h "${files}")
endfunction()

function(palpable_embed_pages folder)
  get_filename_component(module ${folder} NAME)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/palpable/${folder}/pages/*)
  palpable_embed(${module} page PageFile palpable/${folder}/web_page.h "${files};${ARGN}")
endfunction()
