# Keeps the plan of the house: fails when a source file of src/ includes a room that comes after its
# own.  A room is a folder, or a folder within calibrate/ or io/.
set(order
    units
    numerics
    geometry
    train
    backlash
    efficiency
    inertia
    strength
    design
    optimize
    calibrate/loops
    calibrate/measurement
    calibrate/model
    calibrate/causes
    calibrate/fit
    calibrate/search
    calibrate/laws
    calibrate/verdict
    calibrate/series
    calibrate/dynamic
    actuator
    motion
    io/text
    io/keys
    io/files
    report
    drawing
    papers
    sweep
    app
    cli)
# Rooms that may print or read the clock, and rooms that may have threads.
set(talkative "^cli$")
set(threaded "^(numerics|backlash|optimize|calibrate/[a-z]+|cli)$")

# The room of a path below src/.
function(room_of path result)
  if(path MATCHES "^(calibrate|io)/")
    string(REGEX REPLACE "^([^/]*/[^/]*)/.*" "\\1" room ${path})
  else()
    string(REGEX REPLACE "/.*" "" room ${path})
  endif()
  set(${result} "${room}" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR}/src ${SOURCE_DIR}/src/*.hpp ${SOURCE_DIR}/src/*.cpp)
set(seen 0)
foreach(file IN LISTS files)
  room_of(${file} room)
  list(FIND order ${room} own)
  if(own LESS 0)
    message(SEND_ERROR "src/${file}: ${room} has no place in the order: ${order}")
    continue()
  endif()
  file(STRINGS ${SOURCE_DIR}/src/${file} forbidden
       REGEX "std::cout|std::cerr|fmt::print|printf\\(|fputs|<iostream>|<chrono>|<ctime>")
  if(forbidden AND NOT room MATCHES "${talkative}")
    message(SEND_ERROR "src/${file}: prints or reads the clock below cli/: ${forbidden}")
  endif()
  file(STRINGS ${SOURCE_DIR}/src/${file} threads REGEX "#pragma omp|<omp.h>|<thread>")
  if(threads AND NOT room MATCHES "${threaded}")
    message(SEND_ERROR "src/${file}: threads live in numerics/, optimize/, calibrate/ and backlash/: ${threads}")
  endif()
  file(STRINGS ${SOURCE_DIR}/src/${file} lines REGEX "^#include \"")
  foreach(line IN LISTS lines)
    math(EXPR seen "${seen}+1")
    string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" target ${line})
    room_of(${target} room_of_target)
    list(FIND order ${room_of_target} other)
    if(other LESS 0)
      message(SEND_ERROR "src/${file}: ${line} is not written from the include root src/")
    elseif(other GREATER own)
      message(SEND_ERROR "src/${file}: ${line} goes against the direction ${room} < ${room_of_target}")
    endif()
  endforeach()
endforeach()
if(seen LESS 20)
  message(SEND_ERROR "only ${seen} includes seen: the search is broken")
endif()
message(STATUS "${seen} includes follow the order")
