# What results say of how the program was built (src/core/base/record.h).

# radiafit_library(NAME VERSION): a library that a layer has found; its version, or "" where that is not told.
function(radiafit_library name)
  set_property(GLOBAL APPEND_STRING PROPERTY RADIAFIT_LIBRARIES "    {\"${name}\", \"${ARGN}\"},  \\\n")
endfunction()

# Once all layers are known: the header that names the libraries.
function(radiafit_write_libraries file)
  get_property(libraries GLOBAL PROPERTY RADIAFIT_LIBRARIES)
  file(CONFIGURE OUTPUT ${file} CONTENT "#pragma once\n// Made at configure time; see cmake/provenance.cmake.\n#define RADIAFIT_LIBRARIES  \\\n${libraries}\n" @ONLY)
endfunction()

# What the compiler makes of -march=${RADIAFIT_ARCH}, such as znver3 of native; "" if it does not tell.
function(radiafit_resolved_march variable)
  set(${variable} "" PARENT_SCOPE)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=${RADIAFIT_ARCH} -Q --help=target
                  OUTPUT_VARIABLE gcc_says ERROR_QUIET)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=${RADIAFIT_ARCH} "-###" -E -x c++ /dev/null
                  OUTPUT_QUIET ERROR_VARIABLE clang_says)
  if(gcc_says MATCHES "-march=[ \t]+([^ \t\n]+)")
    set(${variable} ${CMAKE_MATCH_1} PARENT_SCOPE)
  elseif(clang_says MATCHES "\"-target-cpu\" \"([^\"]+)\"")
    set(${variable} ${CMAKE_MATCH_1} PARENT_SCOPE)
  endif()
endfunction()
