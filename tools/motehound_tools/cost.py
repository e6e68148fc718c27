"""What a benchmark or an image costs on a board: flash, static RAM, stack, and instructions or cycles a step.

Flash is what one step needs from the library and from the compiler's and the C library's archives (floating point, mathematics), read from the
linker's map. RAM is the state plus the library's variables; on the ATmega128 constants lie in RAM, too. The stack is bounded by stack.py, and measured by
painting it. Steps are counted by the emulators, on this machine by callgrind. All figures are exact and repeat.
"""
import os
import re
import subprocess
import sys
from pathlib import Path

from motehound_tools import stack

ROOT = Path(__file__).resolve().parents[2]

# board: title, prefix of its tools, unit, bytes of RAM, QEMU's processor and machine
BOARDS = {
    "host": ("this machine", "", "instructions", None, None),
    "cortex-m0": ("Cortex-M0", "arm-none-eabi-", "instructions", 16384, ("arm", "microbit")),
    "cortex-m3": ("Cortex-M3", "arm-none-eabi-", "instructions", 4 << 20, ("arm", "mps2-an385")),
    "cortex-m4f": ("Cortex-M4F", "arm-none-eabi-", "instructions", 4 << 20, ("arm", "mps2-an386")),
    "cortex-m33": ("Cortex-M33", "arm-none-eabi-", "instructions", 2 << 20, ("arm", "mps2-an505")),
    "riscv32": ("RV32IMAC", "riscv64-unknown-elf-", "instructions", 2 << 20, ("riscv32", "virt")),
    "atmega128": ("ATmega128", "avr-", "cycles", 4096, None),
}
AVR_HZ = 7372800
CONFIGURATIONS = ("float", "fixed")
# variables that are the state, where it is not `bench_state`
STATES = {"kalman": ["filter", "F", "Q"], "kalman_dense": ["filter", "F", "Q"], "known": []}
COUNTED = 10 # steps, BENCH_COUNTED of bench.h
# the C library chooses its functions by the processor: the same ones everywhere
COUNTED_ALIKE = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX512F,-FMA,-FMA4"}


def run(*command, check=True, env=None):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=ROOT, env=env)
    if check and done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done


def build_folder(board, configuration):
    return ROOT / "build" / (board if configuration == "float" else f"{board}-fixed")


def build(board, configuration, *what):
    """Make everything that fits the board; what does not is measured without."""
    folder = build_folder(board, configuration)
    if not (folder / "build.ninja").exists():
        run("cmake", "--preset", folder.name)
    done = run("ninja", "-C", folder, "-k", "0", *what, check=False)
    errors = [block for block in done.stdout.split("FAILED: ")[1:]
              if not re.search("will not fit in region|overflowed by|is not within region|No space left", block)]
    if errors or done.returncode != 0 and "FAILED: " not in done.stdout:
        sys.exit(f"{folder.name}: {errors[0] if errors else done.stdout + done.stderr}")


def programs(board, configuration, under):
    """Names of what the build links in a folder"""
    targets = run("ninja", "-C", build_folder(board, configuration), "-t", "targets", "all").stdout
    return sorted(re.findall(rf"^{under}/(\w+): C_EXECUTABLE_LINKER", targets, re.M))


def benches(board, configuration):
    return [name[6:] for name in programs(board, configuration, "tests/bench") if name.startswith("bench_") and not name.endswith(("_flash", "_known"))]


def has_images(board, configuration):
    return board != "host" and (build_folder(board, configuration) / "firmware" / "apps" / "cmake_install.cmake").exists()


def images(board, configuration):
    folder = build_folder(board, configuration) / "firmware" / "apps"
    return [name for name in programs(board, configuration, "firmware/apps") if (folder / name).exists() and not name.endswith("_corrupted")] if has_images(board, configuration) else []


def symbols(board, *files):
    """name: (address, size)"""
    table = {}
    for file in files:
        for line in run(BOARDS[board][1] + "nm", "-S", file).stdout.splitlines():
            parts = line.split()
            if len(parts) == 4:
                table[parts[3]] = int(parts[0], 16), int(parts[1], 16)
    return table


def flash_of(map_file):
    """Bytes of code and constants: (library, run-time archives), and the library's variables and constants."""
    text = map_file.read_text().split("Linker script and memory map", 1)[1]
    library = runtime = variables = constants = 0
    for section, size, file in re.findall(r"^ (\.[\w.$-]+)\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S.*)$", text, re.M):
        size = int(size, 16)
        ours = "libmotehound.a(" in file
        if re.match(r"\.(text|rodata|srodata|data|sdata|progmem)", section):
            library += size if ours else 0
            runtime += size if not ours and ".a(" in file else 0
        if ours and re.match(r"\.(s?data|s?bss)", section):
            variables += size
        if ours and re.match(r"\.rodata", section):
            constants += size
    return library, runtime, variables, constants


def emulate(board, folder, image):
    """(painted stack, mean, largest, particles drawn on average), or None if the stack has run into the variables"""
    table = symbols(board, image)
    start, stop = table["bench_counted"][0], table["bench_counted_end"][0]
    if board == "atmega128":
        command = [folder / "simavr_runner", "-m", "atmega128", "-c", f"step=0x{start:x}", image]
    else:
        processor, machine = BOARDS[board][4]
        command = [f"qemu-system-{processor}", "-M", machine, "-bios", "none", "-nographic", "-monitor", "none", "-serial", "none",
                   "-semihosting-config", "enable=on,target=native",
                   "-plugin", f"file={folder}/qcount.so,name=step,start=0x{start:x},stop=0x{stop:x}", "-kernel", image]
    done = run(*command, check=False)
    told = done.stdout + done.stderr
    depth = re.search(r"stack 0x([0-9a-f]+)", told)
    step = re.search(r"step calls=\d+ min=\d+ max=(\d+) mean=([\d.]+)", told)
    if done.returncode != 0 or not depth or not step:
        if "stack has run into the variables" not in told:
            sys.exit(f"{image}:\n{told}")
        return None
    draws = re.search(r"draws 0x([0-9a-f]+)", told)
    return int(depth[1], 16), float(step[2]), int(step[1]), int(draws[1], 16) / COUNTED


def callgrind(image):
    done = run("valgrind", "--tool=callgrind", "--toggle-collect=bench_counted", "--callgrind-out-file=/dev/null", image, check=False, env=COUNTED_ALIKE)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not collected:
        sys.exit(f"{image}:\n{done.stdout}{done.stderr}")
    return int(collected[1]) / COUNTED


def usage_files(folder, target):
    """What the compiler wrote of the stack beside each object of a target"""
    inputs = run("ninja", "-C", folder, "-t", "inputs", target).stdout.splitlines()
    files = (folder / (line.strip().rsplit(".", 1)[0] + ".su") for line in inputs if line.strip().endswith((".o", ".obj")))
    return [file for file in files if file.exists()]


def bound(board, folder, image, root):
    """Worst case of the stack"""
    return stack.Image(image, BOARDS[board][1], usage_files(folder, os.path.relpath(image, folder))).depth(root)[0]


def measure(board, configuration, item, count=True):
    """A benchmark. Without `count` its steps are neither run nor counted."""
    folder = build_folder(board, configuration)
    bench = folder / "tests" / "bench"
    image, sized = bench / f"bench_{item}", bench / f"bench_{item}_flash"
    result = {}
    if board == "host":
        return {"mean": callgrind(image)} if count else {}
    parts = symbols(board, *sorted((bench / "CMakeFiles" / f"bench_{item}_objects.dir").glob("*.obj")))
    result["state"] = sum(parts[name][1] for name in STATES.get(item, ["bench_state"]))
    inputs = sum(parts[name][1] for name in ("measurements", "estimate") if name in parts)
    if sized.exists():
        library, runtime, variables, constants = flash_of(Path(f"{sized}.map"))
        result.update(library=library, runtime=runtime, ram=result["state"] + variables + (constants if board == "atmega128" else 0))
    if image.exists():
        result["stack"] = bound(board, folder, image, "bench_counted")
    elif sized.exists():
        result["stack"] = bound(board, folder, sized, "bench_step")
    counted = emulate(board, folder, image) if count and image.exists() else None
    if counted:
        result["painted"], result["mean"], result["max"], result["draws"] = counted
    elif count or not image.exists():
        result["too_large"] = result["state"] + inputs
    return result


# what an interrupt begins with, and the bytes that a Cortex-M puts on the stack for it, aligned. One at a time: nobody lets them nest. Faults begin the stack anew.
INTERRUPT = re.compile(r"(uart|timer)_interrupt$|interrupt_of$|__vector_\d+$")
INTERRUPTED = {"cortex-m0": 36, "cortex-m3": 36, "cortex-m4f": 108, "cortex-m33": 108}


def measure_image(board, configuration, name):
    """An application: the linked image as it is flashed"""
    folder = build_folder(board, configuration)
    image = folder / "firmware" / "apps" / name
    sizes = {}
    for line in run(BOARDS[board][1] + "size", "-A", image).stdout.splitlines():
        parts = line.split()
        if len(parts) == 3 and parts[1].isdigit() and not parts[0].startswith((".debug", ".comment", ".ARM.attr", ".riscv", ".note")):
            sizes[parts[0]] = int(parts[1])
    variables = {".data", ".sdata", ".bss", ".sbss", ".noinit", ".tdata", ".tbss"}
    return {"flash": sum(size for section, size in sizes.items() if section not in variables - {".data", ".sdata", ".tdata"} and "stack" not in section and "heap" not in section),
            "ram": sum(size for section, size in sizes.items() if section in variables),
            "stack": image_bound(board, folder, image)}


def image_bound(board, folder, image):
    whole = stack.Image(image, BOARDS[board][1], usage_files(folder, os.path.relpath(image, folder)))
    handlers = [function.name for function in whole.functions.values() if INTERRUPT.match(function.name)]
    interrupted = max((whole.depth(name)[0] for name in handlers), default=0) + (INTERRUPTED.get(board, 0) if handlers else 0)
    return whole.depth("main")[0] + interrupted
