#!/bin/sh
# installed.sh SOURCE FOLDER BUILD CC: this build installed somewhere serves find_package, pkg-config and the simulator's users, also after the folder was moved.
set -eu
source=$1 folder=$2 build=$3 cc=$4
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cmake --install "$build" --prefix "$folder/first" >log
mv first prefix
says() { "$@" >said && test "$(grep -cE '^frame of|^3 reports' said)" -eq 5; }

cp -r "$source/examples/cmake_project" project
cmake -S project -B find -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_C_COMPILER="$cc" >>log
cmake --build find >>log
says find/my_node
# a program that the library's structures have another size in than in the library cannot come about: the definitions travel
PKG_CONFIG_PATH=$(dirname "$(find prefix -name motehound.pc)")
export PKG_CONFIG_PATH
"$cc" -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror project/main.c $(pkg-config --cflags --libs motehound) -o with_pkg_config
says ./with_pkg_config
pkg-config --cflags motehound | tr ' ' '\n' | grep '^-D' | sort >told
tr ' ' '\n' <find/CMakeFiles/my_node.dir/flags.make | grep '^-DMH_' | sort >found
test -s told
cmp told found
# a version that is not this one is refused
sed 's/find_package(motehound/& 0.2/' project/CMakeLists.txt >changed && mv changed project/CMakeLists.txt
! cmake -S project -B other -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_C_COMPILER="$cc" >>log 2>&1

prefix/bin/motehound run luo_exp1 --out "$folder/out" >>log 2>&1 || { tail -5 log; exit 1; }
test -s out/summary.json
