# Installs what is built into a scratch folder, with manual, completion and examples; builds examples/cpp against it from outside the tree
# and runs it.
set(scratch ${BINARY_DIR}/installed)
file(REMOVE_RECURSE ${scratch})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(code)
    message(FATAL_ERROR "${ARGN}: ${code}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${scratch}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples/cpp -B ${scratch}/build -G ${GENERATOR}
    -D CMAKE_PREFIX_PATH=${scratch}/prefix -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${scratch}/build)
run(${scratch}/build/analyze ${SOURCE_DIR}/examples/designs/bilateral_drive_gear.toml)
if(NOT output MATCHES "^bilateral drive gear, 96.2")
  message(FATAL_ERROR "the example prints:\n${output}")
endif()
run(${scratch}/prefix/bin/gear3k --version)
foreach(file share/man/man1/gear3k-optimize.1.gz share/bash-completion/completions/gear3k
             share/doc/gear3k/docs/interface.md share/doc/gear3k/examples/ratio-96.toml)
  if(NOT EXISTS ${scratch}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
message(STATUS "installed, built against and run")
