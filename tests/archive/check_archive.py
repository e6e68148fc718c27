#!/usr/bin/env python3
"""Proves what the firmware library promises not to contain, from its archive alone.

    check_archive.py --objdump OBJDUMP ARCHIVE [--avr] [--must-find REGEX...]

Kinds of violation:
    heap        malloc and its family
    stdio       printf and its family
    double      64-bit floating point: a run-time routine, a function of <math.h>, or an instruction
    external    any other symbol that the archive needs and that is not on the list of what it may need
    recursion   a cycle in the graph of direct calls and tail calls
    state       a variable that lives on between calls
Calls through the tables of functions (struct mh_tracker, struct mh_protocol, struct mh_port) are data and not followed: their
headers say who may call whom.

With --must-find, the check of the checker, every expression has to match a violation and every violation an expression. --avr: there double is
float (so sqrtf is spelled sqrt), and 64-bit floating point does not exist.
Exit status: 0 clean, 1 not.
"""
import argparse
import re
import subprocess
import sys
from collections import defaultdict

HEAP = re.compile(r"^_*(malloc|calloc|realloc|free|memalign|aligned_alloc|posix_memalign|alloca|strdup|sbrk)(_r)?$")
STDIO = re.compile(r"^_*(v?[sfd]?n?i?printf|v?s?f?scanf|puts|putchar|fputs|fputc|putc|fwrite|fread|fopen|fclose|perror"
                   r"|stdout|stderr|stdin|impure_ptr|iob)(_chk|_r)?$")
MATH = ("sqrt exp exp2 expm1 log log2 log10 log1p pow sin cos tan asin acos atan atan2 sinh cosh tanh hypot cbrt fabs floor ceil round "
        "lround trunc fmod fmin fmax copysign ldexp frexp erf erfc").split()
DOUBLE_RUNTIME = re.compile(r"^__(aeabi_(d\w+|cd\w+|\w+2d)|\w*df\w*)$")
X86_DOUBLE = re.compile(r"^((add|sub|mul|div|sqrt|comi|ucomi|min|max)[sp]d|v?cvt\w*[sp]d(2\w+)?|f(ld|st|stp|add|sub|mul|div)l)$")
ALLOWED = re.compile(
    r"^(mem(cpy|move|set|cmp|chr)"                                                 # the compiler itself calls the first four
    r"|__aeabi_mem(cpy|move|set|clr)[48]?"
    r"|__aeabi_(f\w+|cf\w+|u?i2f|u?l2f|u?idiv(mod)?|u?ldivmod|lmul|ll?s[lr]|lasr|u?lcmp)"  # float and integers, Arm
    r"|__gnu_thumb1_case_\w+"
    r"|__[a-z]*(qi|hi|si|di|sf)(qi|hi|psi|si|di|sf)?[234]?(_s8)?"                  # the same in GCC's own names
    r"|__tablejump2?__|__do_(copy_data|clear_bss)|__(prologue_saves|epilogue_restores)__"  # AVR
    r"|_GLOBAL_OFFSET_TABLE_|__x86\.get_pc_thunk\.\w+)$")                          # i386

# lcm-gen computes a message type's fingerprint at first use and keeps it: the same value whoever computes it.
KNOWN_STATE = re.compile(r"^mh_\w+_t\.c\.o(bj)?$"), re.compile(r"^__mh_\w+_t_hash(_computed)?$")

CALL = re.compile(r"^(call|callq|bl|blx|rcall|jal)$")  # leaves a return address behind
BRANCH = re.compile(r"^(callq?|r?call|r?jmp|jmpq?|j[a-z]*|bl?x?|b[a-z]{2,3}|cbn?z|auipc|tail)(\.[nw])?$")
WRITABLE = re.compile(r"^(\.s?data|\.s?bss|\.tdata|\.tbss|\*COM\*|\.noinit)(?!\.rel\.ro)")

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("archive")
parser.add_argument("--objdump", required=True)
parser.add_argument("--avr", action="store_true")
parser.add_argument("--must-find", metavar="REGEX", nargs="+")
arguments = parser.parse_args()


def objdump(*options):
    run = subprocess.run([arguments.objdump, *options, arguments.archive], capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{arguments.objdump} {' '.join(options)}: {run.stderr}")
    member = None
    for line in run.stdout.splitlines():
        head = re.match(r"^(\S+):\s+file format", line)
        if head:
            member = head[1]
        elif member and line:
            yield member, line


violations = defaultdict(set)

# the symbol tables: which function is in which section, what is defined, what is needed, what is writable
function_of_section, functions, defined, needed = {}, {}, {}, defaultdict(set)
for member, line in objdump("-t"):
    row = re.match(r"^[0-9a-f]+ (.{7}) (\S+)\s+([0-9a-f]+)\s+(?:\.hidden )?(\S+)$", line)
    if not row:
        continue
    flags, section, size, name = row[1], row[2], int(row[3], 16), row[4]
    if section == "*UND*":
        needed[name].add(member)
        continue
    if "g" in flags or "w" in flags or section == "*COM*":
        defined[name] = member
    if "F" in flags:
        function = (member, re.sub(r"\.cold$", "", name))  # the rarely taken part of a function, laid elsewhere
        if function_of_section.setdefault((member, section), function) != function:
            violations["recursion"].add(f"{member}: {section} holds several functions, so calls cannot be told apart")
        functions[member, name] = function
    if WRITABLE.match(section) and "d" not in flags and size > 0:
        if not (KNOWN_STATE[0].match(member) and KNOWN_STATE[1].match(name)):
            violations["state"].add(f"{member}: {name} ({size} bytes in {section})")

for name in sorted(set(needed) - set(defined)):
    where = f"{name} (needed by {', '.join(sorted(needed[name]))})"
    plain_math = name in MATH
    if HEAP.match(name):
        violations["heap"].add(where)
    elif STDIO.match(name):
        violations["stdio"].add(where)
    elif DOUBLE_RUNTIME.match(name) or (plain_math and not arguments.avr):
        violations["double"].add(where)
    elif not (ALLOWED.match(name) or plain_math or (name.endswith("f") and name[:-1] in MATH)):
        violations["external"].add(where)

# the code: who calls whom, and on x86, where double needs no routine, with which instructions
calls = defaultdict(set)
here, mnemonic, calls_itself = None, "", False
for member, line in objdump("-dr", "--no-show-raw-insn"):
    section = re.match(r"^Disassembly of section (\S+):", line)
    if section:
        here = function_of_section.get((member, section[1]))
        continue
    relocation = re.match(r"^\s+[0-9a-f]+: (R_\w+)\s+(\S+)$", line)
    if calls_itself and not relocation:  # with one, the address in the instruction was only a place-holder
        calls[here].add(here)
    calls_itself = False
    if relocation:
        if BRANCH.match(mnemonic) and not relocation[1].startswith(("R_RISCV_PCREL", "R_RISCV_GOT")):
            target = re.sub(r"[+-]0x[0-9a-f]+$", "", relocation[2])
            if target.startswith(".L"):
                continue
            into_the_middle = "+0x" in relocation[2]  # AVR reserves stack with "rcall" to the next instruction
            callee = function_of_section.get((member, target)) or functions.get((member, target)) \
                or functions.get((defined.get(target), target))
            if here and callee and (callee != here or not into_the_middle and (CALL.match(mnemonic) or mnemonic == "auipc")):
                calls[here].add(callee)
        continue
    instruction = re.match(r"^\s+[0-9a-f]+:\s+(\S+)\s*(.*)$", line)
    if instruction and here:
        mnemonic = instruction[1]
        resolved = re.search(r"<([^+>]+)>$", instruction[2])
        calls_itself = resolved and CALL.match(mnemonic) and functions.get((member, resolved[1])) == here
        if X86_DOUBLE.match(mnemonic):
            violations["double"].add(f"{here[0]}: {here[1]} uses {mnemonic}")

finished, path = set(), []


def visit(function):
    """Depth-first search; `path` is the chain of calls that leads to `function`."""
    if function in path:
        cycle = path[path.index(function):] + [function]
        violations["recursion"].add(" -> ".join(name for _, name in cycle))
    elif function not in finished:
        path.append(function)
        for callee in sorted(calls[function]):
            visit(callee)
        path.pop()
        finished.add(function)


for function in sorted(functions.values()):
    visit(function)

found = [f"{kind}: {text}" for kind in sorted(violations) for text in sorted(violations[kind])]
print("\n".join(found + [f"{len(finished)} functions, {sum(map(len, calls.values()))} direct calls, "
                         f"{len(set(needed) - set(defined))} symbols needed from outside"]))
if not finished:
    sys.exit("no function found: not an archive of this objdump's kind?")
if arguments.must_find is None:
    sys.exit(1 if found else 0)
missed = [regex for regex in arguments.must_find if not any(re.search(regex, line) for line in found)]
surplus = [line for line in found if not any(re.search(regex, line) for regex in arguments.must_find)]
if missed or surplus:
    sys.exit(f"missed: {missed}\nnot expected: {surplus}")
