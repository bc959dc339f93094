# Folders are floors: fails on an include that looks up, in a source or in a public header, on a
# foreign library's header outside of its one door, and on a program that sees more than the
# public headers.
# Run as: cmake -DROOT=<the project> -P tests/floors.cmake

cmake_minimum_required(VERSION 3.25)

set(folders base image scene keyframe description tracer render encode sequence cli)

# What each folder may see besides itself, folders and public headers alike.
set(sees_base)
set(sees_image base)
set(sees_scene base image)
set(sees_keyframe base image scene)
set(sees_description base image scene keyframe)
set(sees_tracer base image scene)
set(sees_render base image scene tracer)
set(sees_encode base image)
set(sees_sequence base image scene keyframe tracer render encode)
set(sees_cli)

# The floor that each public header belongs to.
set(header_status base)
set(header_rate base)
set(header_wish base)
set(header_hash base)
set(header_color image)
set(header_image image)
set(header_aov image)
set(header_compare image)
set(header_sampling scene)
set(header_animation keyframe)
set(header_explain keyframe)
set(header_output encode)
set(header_drawing encode)
set(header_precision tracer)
set(header_renderer sequence)
set(header_diff sequence)
set(header_film sequence)
set(header_frames sequence)
set(header_ladder sequence)
set(header_manifest sequence)
set(header_replay sequence)
set(header_reproduce sequence)
set(header_stats sequence)
set(header_zoetrope cli)

# Each foreign header, by the beginning of its name, and its one door: a pattern, where that has
# several files.
set(doors
    "dlfcn.h|base/module.c"
    "pthread.h|base/pool.c"
    "xxh|base/hash.c"
    "OpenImageIO/|image/file[a-z_]*.(cpp|h)"
    "lua|keyframe/expression(_state)?.[ch]"
    "yaml.h|description/document.c"
    "embree|tracer/embree.c"
    "immintrin.h|tracer/look.c"
    "libav|encode/video[a-z_]*.[ch]"
    "libsw|encode/video[a-z_]*.[ch]"
    "librsvg/|encode/raster.c")

# Headers of C, POSIX and the compiler that any file may include, and those of C++, which have no ending.
set(common "^[a-z_]+$|^(assert|ctype|dirent|errno|fcntl|fenv|float|inttypes|limits|locale|math|memory|sched|setjmp|\
signal|stdalign|stdarg|stdatomic|stdbool|stddef|stdint|stdio|stdlib|string|strings|threads|time|\
unistd|xmmintrin|sys/[a-z]+)(\\.h)?$")

set(mistakes "")
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/src/* ${ROOT}/include/*)
list(REMOVE_ITEM files src/README.md)
list(LENGTH files file_count)
if(file_count EQUAL 0)
  message(FATAL_ERROR "no sources below ${ROOT}")
endif()

foreach(file IN LISTS files)
  set(folder "")
  if(file MATCHES "^include/zoetrope/([a-z]+)\\.h$")
    set(folder "${header_${CMAKE_MATCH_1}}")
  elseif(file MATCHES "^src/([^/]+)/")
    set(folder ${CMAKE_MATCH_1})
  endif()
  if(NOT folder IN_LIST folders)
    list(APPEND mistakes "${file}: its folder is no floor")
    continue()
  endif()
  set(allowed ${folder} ${sees_${folder}})
  file(STRINGS ${ROOT}/${file} lines REGEX "^[ \t]*#.*include")
  foreach(line IN LISTS lines)
    string(REGEX MATCH "[<\"]([^>\"]+)[>\"]" _ "${line}")
    set(name "${CMAKE_MATCH_1}")
    if(name MATCHES "\\.\\.")
      list(APPEND mistakes "${file} includes ${name}, which is not written from the root")
    elseif(line MATCHES "\"")
      string(REGEX REPLACE "/.*" "" target "${name}")
      if(NOT target IN_LIST allowed)
        list(APPEND mistakes "${file} includes \"${name}\", which ${folder} may not see")
      elseif(NOT EXISTS ${ROOT}/src/${name})
        list(APPEND mistakes "${file} includes \"${name}\", which is not written from the root")
      endif()
    elseif(name MATCHES "^zoetrope/([a-z]+)\\.h$")
      set(floor "${header_${CMAKE_MATCH_1}}")
      if(NOT floor)
        list(APPEND mistakes "${file} includes <${name}>, which belongs to no floor")
      elseif(NOT folder STREQUAL "cli" AND NOT floor IN_LIST allowed)
        list(APPEND mistakes "${file} includes <${name}> of ${floor}, which ${folder} may not see")
      endif()
    elseif(NOT name MATCHES "${common}")
      set(door "")
      foreach(pair IN LISTS doors)
        string(REGEX MATCH "^([^|]+)\\|(.+)$" _ "${pair}")
        set(door_file "${CMAKE_MATCH_2}")
        string(FIND "${name}" "${CMAKE_MATCH_1}" at)
        if(at EQUAL 0)
          set(door "${door_file}")
        endif()
      endforeach()
      if(NOT door)
        list(APPEND mistakes "${file} includes <${name}>, a foreign library without a door")
      elseif(NOT file MATCHES "^src/${door}$")
        list(APPEND mistakes "${file} includes <${name}>, whose one door is ${door}")
      endif()
    endif()
  endforeach()
endforeach()

if(mistakes)
  list(JOIN mistakes "\n  " text)
  message(FATAL_ERROR "floors:\n  ${text}")
endif()
message(STATUS "floors: ${file_count} files look only down")
