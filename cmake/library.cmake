# gear3k_library(NAME [TEXT|LOOPS] [BATCH n] SOURCES source... [SELDOM source...] LINK library...): the
# library gear3k_NAME of a folder of src/, compiled as a few large sources, of n of its own each
# (40 by default; fewer are quicker to compile after a change, and slower the first time).
#
# Levels of optimisation compile faster where no higher one gains; the bytes of results are those of
# -O3 (no flag lets arithmetic be reordered).  TEXT, what reads and writes and does not compute for
# long: -Og, a fifth to a third faster to compile than -O1 (-O0 is no faster).  LOOPS, whose loops
# over many gearboxes or components are vectorised: -O3 (at -O1 Monte Carlo runs 51 % longer).  Else
# -O2: at -O1 `strength` and `design` compile a fifth faster, `numerics` no faster, and the program
# runs longer whichever folder it is: floors up to `strength` 3 to 5 %, `optimize` 3 to 9 %,
# `calibrate` 4 to 7 %, all of them 7 to 13 %; `design` alone less than 3 % but for maps.  SELDOM, the
# sources of a folder that computes which decide, order and tell what others compute: -Og, two fifths
# faster than -O2; a profile of the tests of the folder has none above a thousandth of the time.
set(text_level -Og)
set(loops_level -O3)
set(computing_level -O2)

# How a target of a folder is compiled: LEVEL is text, loops or computing.
function(gear3k_compiled target level)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${GEAR3K_UNITY}
                                             UNITY_BUILD_BATCH_SIZE 40)
  target_link_libraries(${target} PUBLIC gear3k_flags ${ARGN})
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:${${level}_level}>")
endfunction()

function(gear3k_library name)
  cmake_parse_arguments(arg "TEXT;LOOPS" "BATCH" "SOURCES;SELDOM;LINK" ${ARGN})
  set(level computing)
  if(arg_TEXT)
    set(level text)
  elseif(arg_LOOPS)
    set(level loops)
  endif()
  list(TRANSFORM arg_SOURCES PREPEND ${name}/)
  list(TRANSFORM arg_SELDOM PREPEND ${name}/)
  add_library(gear3k_${name} STATIC ${arg_SOURCES})
  if(arg_SELDOM)
    add_library(gear3k_${name}_seldom OBJECT ${arg_SELDOM})
    gear3k_compiled(gear3k_${name}_seldom text ${arg_LINK})
    target_sources(gear3k_${name} PRIVATE $<TARGET_OBJECTS:gear3k_${name}_seldom>)
  endif()
  set_target_properties(gear3k_${name} PROPERTIES EXPORT_NAME ${name})
  gear3k_compiled(gear3k_${name} ${level} ${arg_LINK})
  if(arg_BATCH)
    set_target_properties(gear3k_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE ${arg_BATCH})
  endif()
  if(NOT arg_TEXT)
    set_property(GLOBAL APPEND PROPERTY gear3k_computing_libraries gear3k_${name})
  endif()
  # The library's face and all that it stands on: what cmake/install.cmake installs.
  if(NOT name STREQUAL cli)
    set_property(GLOBAL APPEND PROPERTY gear3k_libraries gear3k_${name})
  endif()
endfunction()

# The libraries that compute among those that the given targets stand on.
function(gear3k_computing_libraries variable)
  set(found "")
  set(left ${ARGN})
  get_property(computing GLOBAL PROPERTY gear3k_computing_libraries)
  while(left)
    list(POP_FRONT left target)
    list(APPEND seen ${target})
    if(target IN_LIST computing)
      list(APPEND found ${target})
    endif()
    get_target_property(links ${target} LINK_LIBRARIES)
    foreach(link IN LISTS links)
      if(link MATCHES "^gear3k_" AND NOT link IN_LIST seen AND NOT link IN_LIST left)
        list(APPEND left ${link})
      endif()
    endforeach()
  endwhile()
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()

# Of an inline function that several objects have, the linker takes the first: let it be that of a
# library that computes, which is optimised, and not that of a program or of a room that writes
# (calibrate_test takes a quarter less time).
function(gear3k_computing_first program)
  gear3k_computing_libraries(computing ${ARGN})
  foreach(library IN LISTS computing)
    target_link_options(${program} PRIVATE $<$<CONFIG:Release>:$<TARGET_OBJECTS:${library}>>)
  endforeach()
endfunction()

# The text of a file of the project, as a variable for configure_file().
function(gear3k_embed variable file)
  file(READ ${PROJECT_SOURCE_DIR}/${file} content)
  set(${variable} "${content}" PARENT_SCOPE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
endfunction()
