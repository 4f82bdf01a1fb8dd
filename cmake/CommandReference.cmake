# Manual pages and completion for shells, made by tools/command_reference.py from what the programs declare of
# their commands. The target command_reference makes them; what was made is installed. Packages always have them.
if(NOT TARGET palpable OR NOT TARGET palpable-bake)
  return()
endif()
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)

set(tool ${PROJECT_SOURCE_DIR}/tools/command_reference.py)
set(declared "")
foreach(program palpable palpable-bake)
  set(file ${PROJECT_BINARY_DIR}/generated/${program}.json)
  # As a command of its own, so that a program for another processor is started by its emulator.
  add_custom_command(OUTPUT ${file} COMMAND ${program} help --reference > ${file} DEPENDS ${program} VERBATIM)
  list(APPEND declared ${file})
endforeach()

set(completion ${PROJECT_BINARY_DIR}/completion)
set(pages ${PROJECT_BINARY_DIR}/man)
add_custom_command(OUTPUT ${completion}/bash/palpable ${completion}/zsh/_palpable
  COMMAND ${Python3_EXECUTABLE} ${tool} completion --json ${declared} -o ${completion}
  DEPENDS ${tool} ${declared} VERBATIM)
# One file stands for all pages: which there are, only the programs know.
add_custom_command(OUTPUT ${pages}/palpable/palpable.1.gz
  COMMAND ${Python3_EXECUTABLE} ${tool} man --gzip --json ${declared} --release ${PALPABLE_VERSION} -o ${pages}
  DEPENDS ${tool} ${declared} VERBATIM)
add_custom_target(command_reference
  DEPENDS ${completion}/bash/palpable ${completion}/zsh/_palpable ${pages}/palpable/palpable.1.gz)

install(FILES ${completion}/bash/palpable DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT palpable OPTIONAL)
install(FILES ${completion}/zsh/_palpable DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
        COMPONENT palpable OPTIONAL)
foreach(program palpable palpable-bake)
  install(DIRECTORY ${pages}/${program}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${program} OPTIONAL
          FILES_MATCHING PATTERN "*.1.gz")
endforeach()
