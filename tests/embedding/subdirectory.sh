#!/bin/sh
# subdirectory.sh SOURCE FOLDER: an empty project with the README's lines, and motehound as a part of it through FetchContent. Its tests, simulator and examples
# stay away, and nothing of the project changes.
set -eu
source=$1 folder=$2
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cp "$source/examples/cmake_project/main.c" .
{
    cat <<'END'
cmake_minimum_required(VERSION 3.25)
project(my_node C)
include(CTest)
add_executable(my_node main.c)
get_cmake_property(before VARIABLES)
END
    awk '/^### CMake$/ {here = 1} here && /^```cmake$/ {on = 1; next} /^```$/ {on = 0} on' "$source/README.md" | sed "s|^find_package.*|\
include(FetchContent)\nFetchContent_Declare(motehound SOURCE_DIR $source)\nFetchContent_MakeAvailable(motehound)|"
    cat <<'END'
get_directory_property(tests DIRECTORY ${motehound_SOURCE_DIR} TESTS)
get_directory_property(options COMPILE_OPTIONS)
get_target_property(flags motehound INTERFACE_COMPILE_OPTIONS)
get_target_property(definitions motehound INTERFACE_COMPILE_DEFINITIONS)
foreach(target motehound_sim motehound_command unity sensor_node track_source)
  if(TARGET ${target})
    message(FATAL_ERROR "${target} is here")
  endif()
endforeach()
if(tests OR options OR flags OR definitions OR CMAKE_MODULE_PATH OR CMAKE_C_STANDARD OR DEFINED CACHE{MOTEHOUND_SIMULATOR})
  message(FATAL_ERROR "of motehound's: ${tests} ${options} ${flags} ${definitions} ${CMAKE_MODULE_PATH}")
endif()
END
} >CMakeLists.txt
cmake -G Ninja -S . -B build >log 2>&1 || { tail -20 log; exit 1; }
cmake --build build -j 2 >>log 2>&1 || { tail -20 log; exit 1; }
cmake --install build --prefix installed >>log
test ! -e installed/include # the library is a part of the program
test "$(build/my_node | grep -cE '^frame of|^3 reports')" -eq 5
