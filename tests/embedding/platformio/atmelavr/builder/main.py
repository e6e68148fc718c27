"""The system's avr-gcc with the flags of the registry's platform of this name, without a framework."""

from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
chip = ["-mmcu=" + env.BoardConfig().get("build.mcu")]
env.Replace(
    AR="avr-gcc-ar", AS="avr-as", CC="avr-gcc", CXX="avr-g++", RANLIB="avr-gcc-ranlib", SIZETOOL="avr-size", PROGNAME="firmware", PROGSUFFIX=".elf"
)
env.Append(
    CCFLAGS=["-Os", "-Wall", "-ffunction-sections", "-fdata-sections", "-flto"] + chip,
    CFLAGS=["-std=gnu11", "-fno-fat-lto-objects"],
    CPPDEFINES=[("F_CPU", "$BOARD_F_CPU")],
    LINKFLAGS=["-Os", "-flto", "-Wl,--gc-sections"] + chip,
    LIBS=["m"],
)
Default(env.BuildProgram())
