# ATmega128 with GNU tools and avr-libc, run under simavr by tools/emulator/simavr_runner.c, which the build makes.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR avr)
set(CMAKE_C_COMPILER avr-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(MOTEHOUND_PORT avr)

set(CMAKE_C_FLAGS_INIT "-mmcu=atmega128 -DF_CPU=7372800UL -ffunction-sections -fdata-sections")
# the linker's own script takes RAM to be 64 KB: an image that does not fit must not link
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections -Wl,--defsym=__DATA_REGION_LENGTH__=4096")
set(CMAKE_CROSSCOMPILING_EMULATOR ${CMAKE_BINARY_DIR}/simavr_runner;-m;atmega128)
set(MOTEHOUND_LINE_EMULATOR ${CMAKE_BINARY_DIR}/simavr_runner;-m;atmega128;-s)

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
