"""configure.py MODULE CONF... OUT: reads a module's module.yml and, with the settings in CONF, its Kconfig; writes them as CMake variables."""

import sys
from pathlib import Path

import kconfiglib
import yaml

module, *configurations, out = map(Path, sys.argv[1:])
build = yaml.safe_load((module / "zephyr/module.yml").read_text())["build"]
kconfig = kconfiglib.Kconfig(str(module / build["kconfig"]), warn_to_stderr=False)
for number, configuration in enumerate(configurations):
    kconfig.load_config(str(configuration), replace=number == 0)
# symbols of Zephyr itself, which a module may select or a sample may set
zephyrs = ("REQUIRES_FULL_LIBC", "MAIN_STACK_SIZE")
warnings = [line for line in kconfig.warnings if not any(name in line for name in zephyrs)]
if warnings:
    sys.exit("\n".join(warnings))
lines = [f'set(MODULE_CMAKE "{module / build["cmake"]}")\n']
lines += [f'set(CONFIG_{symbol.name} "{symbol.str_value}")\n' for symbol in kconfig.unique_defined_syms if symbol.str_value != "n"]
out.write_text("".join(lines))
