"""The host's own compiler, as the registry's platform of this name has it."""

from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
env.Replace(PROGNAME="program")
Default(env.BuildProgram())
