"""The worst case of an image's stack, from the compiler's frames and the linked image's calls.

The frame of each function is what GCC wrote (-fstack-usage) beside the object that holds it; run-time routines, which come without, are
followed instruction by instruction. Who calls whom is read from the image itself, so that what was inlined, cloned or dropped is as it is. A call through a
table of functions may reach every function that stands at that member in a table of the image; calls.csv says which calls go through
which tables, and names the functions for tables that are made while running. What is not bounded so is an error, as is a circle of calls, unless calls.csv says that it is gone through once more at most.
"""
import csv
import re
import struct
import subprocess
from bisect import bisect_right
from collections import defaultdict
from fnmatch import fnmatch
from functools import cached_property, lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CALLS = Path(__file__).with_name("calls.csv")


class Unbounded(Exception):
    """Its text says what cannot be bounded, and where."""


class Elf:
    """Symbols and contents of a 32-bit little-endian image."""

    def __init__(self, path):
        self.path = path
        self.data = Path(path).read_bytes()
        if self.data[:6] != b"\x7fELF\x01\x01":
            raise Unbounded(f"{path} is no 32-bit little-endian ELF file")
        (self.machine,) = struct.unpack_from("<H", self.data, 18)
        self.flash_words = self.machine == 83  # AVR: addresses of functions count words, and RAM is apart from flash
        (offset,) = struct.unpack_from("<I", self.data, 32)
        size, count, names = struct.unpack_from("<HHH", self.data, 46)
        headers = [struct.unpack_from("<10I", self.data, offset + i * size) for i in range(count)]
        self.sections = {self._text(headers[names], header[0]): header for header in headers}
        self.symbols = list(self._symbols(headers))

    def _text(self, strings, at):
        begin = strings[4] + at
        return self.data[begin:self.data.index(b"\0", begin)].decode()

    def _symbols(self, headers):
        """(name, address, size, kind, file): kind 1 data, 2 function; file of local symbols alone"""
        _, _, _, _, offset, size, link, _, _, _ = self.sections[".symtab"]
        file = None
        for at in range(offset, offset + size, 16):
            name, address, length, info, _, section = struct.unpack_from("<IIIBBH", self.data, at)
            text = self._text(headers[link], name)
            if info & 15 == 4:
                file = text
            elif section != 0:
                yield text, address, length, info & 15, Path(file).name if file and info >> 4 == 0 else None

    def word(self, address, bytes_):
        for _, kind, flags, start, offset, size, *_ in self.sections.values():
            if kind == 1 and flags & 2 and start <= address and address + bytes_ <= start + size:
                return int.from_bytes(self.data[offset + address - start:offset + address - start + bytes_], "little")
        return 0

    def function_at(self, address):
        """The function to which a pointer at `address` points"""
        if self.flash_words:
            return self.word(address, 2) * 2
        return self.word(address, 4) & (~1 if self.machine == 40 else ~0)

    def pointers(self, array, file):
        """The functions of a constant array of pointers to functions in `file`"""
        width = 2 if self.flash_words else 4
        return {self.function_at(at) for name, address, size, _, of in self.symbols if name.split(".")[0] == array and of == file
                for at in range(address, address + size, width)} - {0}


@lru_cache(maxsize=None)
def rules():
    with CALLS.open() as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@lru_cache(maxsize=None)
def source_lines(path):
    return Path(path).read_text().splitlines()


@lru_cache(maxsize=None)
def source_named(name):
    """A source of that name, or of that end of a path"""
    return next((str(file) for folder in ("firmware", "tests/bench") for file in sorted((ROOT / folder).rglob(Path(name).name))
                 if str(file).endswith(f"/{name}")), name)


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, check=True).stdout


class Tables:
    """The tables of functions in an image, by the debugging information."""

    def __init__(self, elf, prefix):
        self.elf, self.functions = elf, {}
        if ".debug_info" not in elf.sections:
            raise Unbounded(f"{elf.path} has no debugging information")
        wanted = {rule["table"] for rule in rules()}
        dies = re.finditer(r"^ <(\d+)><([0-9a-f]+)>: Abbrev Number: \d+ \((DW_TAG_\w+)\)\n((?:    <.*\n)*)", run(prefix + "readelf", "--debug-dump=info", elf.path), re.M)
        structures, types, variables, names, last = {}, {}, [], {}, None
        for depth, at, tag, text in (match.groups() for match in dies):
            def value(attribute):
                found = re.search(rf"{attribute}\s*: (.*)", text)
                return found and found[1].strip().split("): ")[-1]
            if tag == "DW_TAG_structure_type":
                last = (int(depth), at)
                structures[at] = (value("DW_AT_name"), int(value("DW_AT_byte_size") or 0), {})
            elif tag == "DW_TAG_member" and last and int(depth) == last[0] + 1:
                place = value("DW_AT_data_member_location") or "0"
                structures[last[1]][2][value("DW_AT_name")] = int(re.search(r"(\d+)\)?\s*$", place)[1])
            elif tag in ("DW_TAG_const_type", "DW_TAG_array_type", "DW_TAG_typedef"):
                kind = value("DW_AT_type")
                types[at] = kind and kind.strip("<>").removeprefix("0x")
            elif tag == "DW_TAG_variable":
                place = re.search(r"DW_OP_addr: ([0-9a-f]+)", text)
                kind, of = value("DW_AT_type"), value("DW_AT_specification") or value("DW_AT_abstract_origin")
                names[at] = names.get(of.strip("<>").removeprefix("0x")) if of else (value("DW_AT_name"), kind and kind.strip("<>").removeprefix("0x"))
                if place and names[at]:
                    variables.append((int(place[1], 16), *names[at]))
        # those whose sections were not linked have an address, too, but no symbol
        sizes = {(symbol.split(".")[0], address): size for symbol, address, size, kind, _ in elf.symbols if kind == 1}
        for address, symbol, kind in variables:
            while kind in types:
                kind = types[kind]
            name, stride, members = structures.get(kind, (None, 0, {}))
            if name not in wanted or (symbol, address) not in sizes:
                continue
            for begin in range(address, address + sizes[symbol, address], stride):
                for member, offset in members.items():
                    target = elf.function_at(begin + offset)
                    if target:
                        self.functions.setdefault((name, member), set()).add((symbol, target))


class Machine:
    """How instructions of one family read: what calls, jumps, goes by register, ends a path, and moves the stack pointer."""

    def __init__(self, call, jump, by_register, calls_by_register, ends, change, returned=0):
        self.call, self.jump, self.by_register = re.compile(call), re.compile(jump), re.compile(by_register)
        self.calls_by_register, self.ends, self.change = re.compile(calls_by_register), re.compile(ends), change
        self.returned = returned # bytes that a call itself puts on the stack


def registers(names):
    """How many registers a list names"""
    count = 0
    for part in names.replace(" ", "").split(","):
        ends = [int(number) for number in re.findall(r"\d+", part)]
        count += ends[-1] - ends[0] + 1 if "-" in part else 1
    return count


def arm_change(text):
    found = re.match(r"(v?push|v?pop|stmdb sp!,|ldmia sp!,)(?:\.w)? ?\{(.*)\}", text.replace(".w", ""))
    if found:
        size = registers(found[2]) * (8 if "d" in found[2] else 4)
        return size if "push" in found[1] or "stm" in found[1] else -size
    found = re.match(r"(sub|add)(?:\.w|w)? sp, (?:sp, )?#(\d+)", text)
    if found:
        return int(found[2]) * (1 if found[1] == "sub" else -1)
    found = re.match(r"(?:str|strd)(?:\.w)? .*\[sp, #-(\d+)\]!", text)
    if found:
        return int(found[1])
    found = re.match(r"(?:ldr|ldrd)(?:\.w)? .*\[sp\], #(\d+)", text)
    return -int(found[1]) if found else 0


def riscv_change(text):
    found = re.match(r"(?:c\.)?addi?(?:16sp)? sp,(?:sp,)?(-?\d+)", text)
    return -int(found[1]) if found else 0


def avr_change(text):
    if text.startswith("push "):
        return 1
    if text.startswith("pop "):
        return -1
    if text.startswith("rcall .+0"):
        return 2
    if text.startswith("out 0x3d,"):
        raise Unbounded("a run-time routine writes the stack pointer")
    return 0


MACHINES = {
    40: Machine(r"blx?(\.n|\.w)? ", r"(b([a-z]{2})?(\.n|\.w)?|cbn?z) ", r"blx (r\d+|ip|lr|fp|sl|sb) |bx (r\d+|ip|fp|sl|sb) |tb[bh] |mov pc|ldr.* pc,", r"blx",
                r"b(\.n|\.w)? |bx |pop .*pc|ldmia(\.w)? .*pc|ldr.* pc,|mov pc|tb[bh] |udf|bkpt", arm_change),
    243: Machine(r"(jal|call|jalr) ", r"(j|tail|b[a-z]+) ", r"jalr (?!.*<)|jr (?!ra)", r"jalr", r"(j|jr|tail) |ret|unimp|mret", riscv_change),
    83: Machine(r"r?call ", r"(r?jmp|br[a-z]{2}) ", r"e?icall|e?ijmp", r"e?icall", r"r?jmp |e?ijmp|reti? ", avr_change, returned=2),
}
# helpers that jump back into whoever calls them: switches, and AVR's shared beginnings and ends of functions
JUMP_BACK = re.compile(r"^__(tablejump2?__|prologue_saves__|epilogue_restores__|gnu_thumb1_case_\w+)$")
# RISC-V's shared beginnings: how many registers they save, in blocks of 16 bytes, leaving the stack so
SAVES = re.compile(r"^__riscv_save_(\d+)$")
SKIPS = re.compile(r"sbr[cs] |sbi[cs] |cpse ")


class Function:
    def __init__(self, name, address, frame):
        self.name, self.address, self.frame = name, address, frame # no frame: a run-time routine
        self.calls, self.jumps, self.indirect = set(), set(), []


class Image:
    def __init__(self, path, prefix, usage_files):
        self.elf, self.prefix = Elf(path), prefix
        self.machine = MACHINES[self.elf.machine]
        self._read_frames(usage_files)
        self._disassemble()
        self.known, self.path, self.circled = {}, [], False

    def _read_frames(self, files):
        """(file, function), and (None, function): the largest frame of that name"""
        self.frames, self.lines = defaultdict(int), defaultdict(set)
        self.sources, self.places = {}, defaultdict(set)
        for file in files:
            compiled = str(file).removesuffix(".su").split(".dir/")[-1].replace("__/", "")
            self.sources[Path(compiled).name] = source_named(compiled)
            for line in Path(file).read_text().splitlines():
                place, size, kind = line.split("\t")
                source, first, _, function = place.rsplit(":", 3)
                self.places[function.split(".")[0]].add(self.sources[Path(compiled).name])
                self.lines[function.split(".")[0]].add((Path(source).name, int(first)))
                if kind == "dynamic":
                    raise Unbounded(f"{file}: the frame of {function} has no bound")
                for owner in (Path(file).name.removesuffix(".su"), None):
                    for name in (function, function.split(".")[0]):
                        self.frames[owner, name] = max(self.frames[owner, name], int(size))

    def _frame(self, symbols):
        """What the compiler says of the function by one of these names; None of one that it has not compiled here"""
        for name, file in symbols:
            for key in ((file, name), (file, name.split(".")[0])):
                if key in self.frames:
                    return self.frames[key]
        return None

    def _hidden(self, text):
        """Bytes of a frame that GCC does not tell on ARM: argument registers saved, before all others, beside the rest of a structure that came on the stack"""
        found = re.match(r"sub(?:\.w|w)? sp, (?:sp, )?#(\d+)", text)
        return int(found[1]) if found and self.elf.machine == 40 and int(found[1]) <= 16 else 0

    def _disassemble(self):
        odd = ~1 if self.elf.machine == 40 else ~0
        symbols = defaultdict(list)
        for name, address, _, kind, file in self.elf.symbols:
            if kind in (0, 2):
                symbols[address & odd].append((name, file))
        self.functions, self.code, self.next = {}, {}, {}
        function = previous = None
        hidden, sites = 0, []
        for line in run(self.prefix + "objdump", "-d", "--no-show-raw-insn", self.elf.path).splitlines():
            begins = re.match(r"([0-9a-f]+) <(.*)>:$", line)
            if begins:
                address = int(begins[1], 16)
                function = Function(begins[2], address, self._frame(symbols[address]))
                self.functions[address] = function
                continue
            found = re.match(r"\s*([0-9a-f]+):\s+([^.].*)$", line)
            if not found or function is None:
                continue
            address, text = int(found[1], 16), re.sub(r"\s+", " ", re.split("[;@#](?! ?-?\\d)|;", found[2])[0].strip()) + " "
            target = re.search(r"(?:0x)?([0-9a-f]+) <", found[2])
            self.code[address] = text, target and int(target[1], 16), function
            if address == function.address:
                hidden = self._hidden(text)
            elif hidden and function.frame is not None and re.match(r"v?push|stmdb(\.w)? sp!", text):
                function.frame, hidden = function.frame + hidden, 0
            if previous is not None:
                self.next[previous] = address
            if self.machine.by_register.match(text) and function.frame is not None and not self._returns(text, previous):
                sites.append((function, address, text))
            previous = address
        self.starts = sorted(self.functions)
        for text, target, function in self.code.values():
            if function.frame is not None and target is None and self.machine.call.match(text) and not self.machine.by_register.match(text):
                function.indirect.append(("?", 0, text))
            if function.frame is None or target is None or not (self.machine.call.match(text) or self.machine.jump.match(text)):
                continue
            if target not in self.code:
                function.indirect.append(("?", 0, text))
                continue
            reached = self.function_of(target)
            # GCC's far jumps within a function look like calls
            if self.machine.call.match(text) and not text.startswith("rcall .+0") and (reached is not function or target == function.address):
                function.calls.add(reached)
            elif self.machine.jump.match(text) and reached is not function:
                function.jumps.add(reached)
        self._place(sites)

    def _returns(self, text, previous):
        """`bx` of what has just been taken from the stack"""
        return text.startswith("bx ") and previous in self.code and re.match(rf"(pop|ldr|ldmia) .*\b{text.split()[1]}\b", self.code[previous][0])

    def function_of(self, address):
        at = bisect_right(self.starts, address)
        if at == 0 or address not in self.code:
            raise Unbounded(f"{self.elf.path}: a call of 0x{address:x}, where no function is")
        return self.functions[self.starts[at - 1]]

    def _place(self, sites):
        """The source line of each call by register. Of functions that were not linked there are lines, too, from address 0 on: those are left out."""
        rows, files, live, last = [], {}, False, -1
        for row in run(self.prefix + "readelf", "--debug-dump=decodedline", self.elf.path).splitlines() if sites else ():
            header = re.match(r"(?:CU: )?(\S+\.[chS]):", row)
            entry = re.match(r"(\S+) +(\d+|-) +(?:0x)?([0-9a-f]+)(?: |$)", row)
            if header:
                files[Path(header[1]).name] = header[1] if header[1].startswith("/") else source_named(Path(header[1]).name)
            elif entry:
                address = int(entry[3], 16)
                if address in self.functions and address != last:
                    live = entry[2] != "-" and self._begins(self.functions[address], entry[1], int(entry[2]))
                elif last < 0 or address < last:
                    live = False
                last = -1 if entry[2] == "-" else address
                if live and entry[2] != "-":
                    rows.append((address, entry[1], int(entry[2])))
        rows.sort(key=lambda row: row[0])
        addresses = [row[0] for row in rows]
        for function, address, text in sites:
            at = bisect_right(addresses, address) - 1
            known = at >= 0 and addresses[at] >= function.address
            if not known:
                function.indirect.append(("?", 0, text))
                continue
            _, name, line = rows[at]
            own = [source for source in self.places[function.name.split(".")[0]] if Path(source).name == name]
            function.indirect.append((own[0] if own else self.sources.get(name) or files.get(name) or source_named(name), line, text))

    def _begins(self, function, file, line):
        """Is that line one of the function's?"""
        return any(file == of and first - 3 <= line < first + 400 for of, first in self.lines.get(function.name.split(".")[0], ()))

    @cached_property
    def tables(self):
        return Tables(self.elf, self.prefix)

    def _reached_through(self, function):
        """The functions that the calls by register of `function` may reach: whatever its source calls so, because the compiler joins calls."""
        reached = set()
        for file, line, text in function.indirect:
            if line == 0:
                raise Unbounded(f"{function.name}: where does '{text.strip()}' go?")
            path = str(Path(file).resolve()).removeprefix(f"{ROOT}/")
            # joined calls may bear the line of neither: then whatever the file calls so
            known = self._called_in(enclosing(file, line), path) or self.machine.calls_by_register.match(text) and self._called_in("\n".join(source_lines(file)), path)
            for rule, member in known or ():
                reached |= self._behind(rule, member, Path(path).name)
            if not known and self.machine.calls_by_register.match(text):
                raise Unbounded(f"{path}:{line}: {CALLS.name} does not say what this may call")
        return reached

    def _called_in(self, text, path):
        calls = {(f"{variable}->{member}" if member else plain, member)
                 for variable, member, plain in re.findall(r"(\w+)\)?(?:->|\.)(\w+)\(|\b(\w+)(?:\[\w+\])?\(", text)}
        return [(rule, member) for call, member in calls for rule in rules() if rule["table"] != "again" and fnmatch(path, rule["file"]) and fnmatch(call, rule["call"])]

    def _behind(self, rule, member, file):
        if rule["table"].endswith("[]"):
            found = self.elf.pointers(rule["table"][:-2], file)
        else:
            found = {at for name, at in self.tables.functions.get((rule["table"], member), ()) if rule["named"] in ("", name)}
        return {self.function_of(at) for at in found} | {f for f in self.functions.values() for name in (rule["functions"] or "").split()
                                                         if fnmatch(f.name.split(".")[0], name)}

    def depth(self, root):
        """Bytes below the caller of `root` at worst, and the functions, with their frames, whose calls need them."""
        for function in self.functions.values():
            if function.name == root:
                return self._depth(function.address)
        raise Unbounded(f"{self.elf.path} has no function {root}")

    def _depth(self, address):
        if address in self.known:
            return self.known[address]
        function = self.function_of(address)
        if address in self.path:
            circle = [self.function_of(at).name for at in self.path[self.path.index(address):]]
            if not any({rule["file"], rule["call"]} <= set(circle) for rule in rules() if rule["table"] == "again"):
                raise Unbounded("calls in a circle: " + " -> ".join([*circle, function.name]))
            self.circled = True
            if self.path.count(address) > 1:
                return 0, []
        before, self.circled = self.circled, False
        self.path.append(address)
        found = self._compiled(function) if function.frame is not None else self._routine(address, function)
        self.path.pop()
        if not self.circled or not self.path:
            self.known[address] = found
        self.circled = self.circled or before
        return found

    def _compiled(self, function):
        deepest, through = function.frame, []
        for called in function.calls | self._reached_through(function):
            if not JUMP_BACK.match(called.name):
                below, chain = self._depth(called.address)
                if function.frame + below > deepest:
                    deepest, through = function.frame + below, chain
        for called in function.jumps: # it has left its frame by then
            if not JUMP_BACK.match(called.name):
                below, chain = self._depth(called.address)
                if below > deepest:
                    deepest, through = below, chain
        return deepest, [(function.name, function.frame), *through]

    def _routine(self, entry, function):
        """A run-time routine, instruction by instruction along every path; one that jumps by register, as if it did all that it has at once."""
        inside = [(at, text, target) for at, (text, target, owner) in self.code.items() if owner is function]
        if any(self._jumps_by_register(at, text, target) for at, text, target in inside) and not JUMP_BACK.match(function.name):
            used = self.machine.returned + sum(max(0, self.machine.change(text)) for _, text, _ in inside)
            steps = [(at, used) for at, _, _ in inside]
            follow = False
        else:
            used, steps, follow = self.machine.returned, [(entry, self.machine.returned)], True
        deepest, through, seen = used, [], set()
        while steps:
            address, used = steps.pop()
            if (address, used) in seen or address not in self.code:
                continue
            seen.add((address, used))
            if used > 4096:
                raise Unbounded(f"{function.name}: a loop that lengthens the stack")
            text, target, owner = self.code[address]
            if follow:
                used = max(0, used + self.machine.change(text))
                if used > deepest:
                    deepest, through = used, []
            if target in self.code and self._goes(text):
                reached, called = self.function_of(target), bool(self.machine.call.match(text))
                saves = SAVES.match(reached.name)
                if saves:
                    below = used + (64 if int(saves[1]) > 3 else 16) # while it works
                    if below > deepest:
                        deepest, through = below, []
                    used += 16 * (int(saves[1]) // 4 + 1)
                elif called or reached.frame is not None:
                    if reached is not function or target == function.address or follow:
                        below, chain = self._depth(reached.address if reached.frame is not None else target)
                        left = 0 if called else self.machine.returned # a jump leaves no return address of its own
                        if not JUMP_BACK.match(reached.name) and used + below - left > deepest:
                            deepest, through = used + below - left, chain
                elif not JUMP_BACK.match(reached.name):
                    steps.append((target, used))
            elif self.machine.by_register.match(text) and self.machine.calls_by_register.match(text):
                raise Unbounded(f"{owner.name} of a run-time library calls by register: {text}")
            if follow and not self.machine.ends.match(text) and address in self.next:
                steps.append((self.next[address], used))
                if SKIPS.match(text) and self.next[address] in self.next:
                    steps.append((self.next[self.next[address]], used))
        return deepest, [(function.name, deepest - sum(size for _, size in through)), *through]

    def _goes(self, text):
        return (self.machine.call.match(text) or self.machine.jump.match(text)) and not text.startswith("rcall .+0 ")

    def _jumps_by_register(self, at, text, target):
        if target in self.code and self._goes(text):
            return bool(JUMP_BACK.match(self.function_of(target).name))
        return self.machine.by_register.match(text) and not self.machine.calls_by_register.match(text) and not self._returns(text, at - 2)


@lru_cache(maxsize=None)
def enclosing(file, line):
    """The text of the C function, or other definition, in which a line is"""
    lines = source_lines(file)
    begin = end = line - 1
    while begin > 0 and not re.match(r"\w", lines[begin]):
        begin -= 1
    while end < len(lines) - 1 and not re.match(r"\}", lines[end]):
        end += 1
    return "\n".join(lines[begin + 1 if begin < line - 1 else begin:end + 1])
