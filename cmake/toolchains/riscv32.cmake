# RV32IMAC with GNU tools and picolibc, run under QEMU's `virt` machine.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(MOTEHOUND_PORT riscv)

set(port ${CMAKE_CURRENT_LIST_DIR}/../../firmware/port/riscv)
set(CMAKE_C_FLAGS_INIT
  "-march=rv32imac -mabi=ilp32 -mcmodel=medany --specs=picolibc.specs -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostartfiles -T${port}/virt.ld -Wl,--gc-sections")
set(CMAKE_CROSSCOMPILING_EMULATOR
  qemu-system-riscv32;-M;virt;-bios;none;-nographic;-monitor;none;-serial;none;-semihosting-config;enable=on,target=native;-kernel)
set(MOTEHOUND_LINE_EMULATOR qemu-system-riscv32;-M;virt;-bios;none;-display;none;-monitor;none;-serial;stdio;-kernel)

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
