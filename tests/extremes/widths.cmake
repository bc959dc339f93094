# Fails where the tracer's answers differ, in any bit, with the width of instructions.
# Run as: cmake -DPROGRAM=<extremes> -P widths.cmake
foreach(isa scalar base avx2 avx512) # what the machine has not is run as base
  execute_process(COMMAND ${CMAKE_COMMAND} -E env ZOETROPE_ISA=${isa} ${PROGRAM} --digest --rays 20000
                  OUTPUT_VARIABLE said RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "${isa}: ${result}")
  endif()
  if(DEFINED expected AND NOT said STREQUAL expected)
    string(REPLACE "\n" ";" lines "${said}")
    string(REPLACE "\n" ";" others "${expected}")
    foreach(line other IN ZIP_LISTS lines others)
      if(NOT line STREQUAL other)
        message("${isa}: ${line}, not ${other}")
      endif()
    endforeach()
    message(FATAL_ERROR "${isa} gives other answers than scalar")
  endif()
  set(expected "${said}")
endforeach()
