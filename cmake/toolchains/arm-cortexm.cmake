# Cortex-M with GNU tools and newlib-nano, run under QEMU. -DMOTEHOUND_BOARD=cortex-m0 | cortex-m3 | cortex-m4f | cortex-m33
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES MOTEHOUND_BOARD)
set(MOTEHOUND_PORT cortex-m)

if(MOTEHOUND_BOARD STREQUAL cortex-m0)
  set(cpu "-mcpu=cortex-m0 -mthumb -mfloat-abi=soft")
  set(MOTEHOUND_MACHINE microbit)
elseif(MOTEHOUND_BOARD STREQUAL cortex-m3)
  set(cpu "-mcpu=cortex-m3 -mthumb -mfloat-abi=soft")
  set(MOTEHOUND_MACHINE mps2-an385)
elseif(MOTEHOUND_BOARD STREQUAL cortex-m33)
  set(cpu "-mcpu=cortex-m33 -mthumb -mfloat-abi=hard -mfpu=fpv5-sp-d16")
  set(MOTEHOUND_MACHINE mps2-an505)
elseif(MOTEHOUND_BOARD STREQUAL cortex-m4f)
  set(cpu "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16")
  set(MOTEHOUND_MACHINE mps2-an386)
else()
  message(FATAL_ERROR "MOTEHOUND_BOARD is '${MOTEHOUND_BOARD}': wanted cortex-m0, cortex-m3, cortex-m4f or cortex-m33")
endif()

set(port ${CMAKE_CURRENT_LIST_DIR}/../../firmware/port/cortex-m)
set(CMAKE_C_FLAGS_INIT "${cpu} --specs=nano.specs -ffunction-sections -fdata-sections -fstack-usage")
set(CMAKE_EXE_LINKER_FLAGS_INIT
  "-nostartfiles --specs=nosys.specs -L${port} -T${port}/${MOTEHOUND_MACHINE}.ld -Wl,--gc-sections -Wl,--fatal-warnings")
set(CMAKE_CROSSCOMPILING_EMULATOR
  qemu-system-arm;-M;${MOTEHOUND_MACHINE};-nographic;-monitor;none;-serial;none;-semihosting-config;enable=on,target=native;-kernel)

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
