# gear3k_library(NAME [TEXT|LOOPS] SOURCES source... LINK library...): the library gear3k_NAME of a
# folder of src/, compiled as a few large sources.
#
# Levels of optimisation compile faster where no higher one gains; the bytes of results are those of
# -O3 (no flag lets arithmetic be reordered).  TEXT, what reads and writes and does not compute for
# long: -Og, a fifth to a third faster to compile than -O1 (-O0 is no faster).  LOOPS, whose loops
# over many gearboxes or components are vectorised: -O3.  Else -O2: at -O1 `calibrate` and `optimize`
# compile a sixth faster, and diagnoses and searches run 5 to 16 % longer.
set(text_level -Og)
function(gear3k_library name)
  cmake_parse_arguments(arg "TEXT;LOOPS" "" "SOURCES;LINK" ${ARGN})
  set(level -O2)
  if(arg_TEXT)
    set(level ${text_level})
  elseif(arg_LOOPS)
    set(level -O3)
  endif()
  list(TRANSFORM arg_SOURCES PREPEND ${name}/)
  add_library(gear3k_${name} STATIC ${arg_SOURCES})
  set_target_properties(gear3k_${name} PROPERTIES UNITY_BUILD ${GEAR3K_UNITY}
                                                  UNITY_BUILD_BATCH_SIZE 32
                                                  EXPORT_NAME ${name})
  target_link_libraries(gear3k_${name} PUBLIC gear3k_flags ${arg_LINK})
  target_compile_options(gear3k_${name} PRIVATE $<$<CONFIG:Release>:${level}>)
  if(NOT arg_TEXT)
    set_property(GLOBAL APPEND PROPERTY gear3k_computing_libraries gear3k_${name})
  endif()
  # The library's face and all that it stands on: what cmake/install.cmake installs.
  if(NOT name STREQUAL cli)
    set_property(GLOBAL APPEND PROPERTY gear3k_libraries gear3k_${name})
  endif()
endfunction()

# The text of a file of the project, as a variable for configure_file().
function(gear3k_embed variable file)
  file(READ ${PROJECT_SOURCE_DIR}/${file} content)
  set(${variable} "${content}" PARENT_SCOPE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
endfunction()
