#!/usr/bin/env python3
"""Looks for expressions that mean something with mh_real as float and something else with mh_real as a fixed-point number, in clang's syntax trees of the
library's fixed-point sources: mh_real is a type of its own there, though the compiler takes it for the integer that it is.

    check_reals.py CLANG compile_commands.json FOLDER...

reads what compile_commands.json compiles out of the folders. Each finding is a line FILE:LINE: what. Exit status 1 if there are any."""

import json
import multiprocessing
import os
import re
import shlex
import subprocess
import sys

PASS_THROUGH = ("ParenExpr", "ConstantExpr")
WIDE = ("int64_t", "long", "long long", "uint64_t", "unsigned long", "unsigned long long")


class Place:
    """Where the reader is: a tree names a file or line only where it differs from the one named before."""

    file, line = None, 0

    def read(self, at):
        for part in ("spellingLoc", "expansionLoc"):
            if part in at:
                self.read(at[part])
        self.file = at.get("file", self.file)
        self.line = at.get("line", self.line)


def bare(type_of):
    return re.sub(r"\b(const|volatile) ?", "", type_of).strip()


def parameters(function_type):
    """'mh_real (mh_real, int)' -> ('mh_real', ['mh_real', 'int'])"""
    result, _, rest = function_type.partition("(")
    if rest.startswith("*"):  # a pointer to a function
        result, rest = result, rest.partition("(")[2]
    parts, depth = [""], 0
    for char in rest:
        depth += (char == "(") - (char == ")")
        if depth < 0:
            break
        if char == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += char
    return bare(result), [bare(part) for part in parts]


class Reader:
    def __init__(self):
        self.place, self.fields, self.found = Place(), {}, set()

    def say(self, node, what):
        # what mh_real is made of, and what has formats of its own, takes it for an integer
        if not any(re.search(r"(^|/)(real|\w+_fixed|share)\.[ch]$", file or "") for file in (node["_file"], node["_spelled"])):
            self.found.add("%s:%d: %s" % (node["_file"], node["_line"], what))

    def mark(self, node):
        """Gives each node its place, in the order of the text, and notes the structures."""
        for key, value in list(node.items()):
            if key == "loc" or key == "range":
                if key == "range":
                    begin = value.get("begin", {})
                    self.place.read(begin.get("spellingLoc", begin)) # of a macro: where it is defined
                    node["_spelled"] = self.place.file
                    self.place.read(begin.get("expansionLoc", {}))
                    node["_file"], node["_line"] = self.place.file, self.place.line
                    self.place.read(value.get("end", {}))
                else:
                    self.place.read(value)
            elif key == "inner":
                for child in value:
                    self.mark(child)
        if node.get("kind") == "RecordDecl" and "name" in node:
            fields = [bare(f["type"]["qualType"]) for f in node.get("inner", []) if f.get("kind") == "FieldDecl"]
            if fields:
                self.fields["struct " + node["name"]] = fields

    def real(self, node):
        """True, False, or None for what may be either: nought."""
        kind, inner = node.get("kind"), node.get("inner", [])
        if kind in PASS_THROUGH:
            return self.real(inner[0])
        if kind == "IntegerLiteral":
            return None if node["value"] == "0" else False
        if kind == "ImplicitValueInitExpr":
            return None
        if kind == "UnaryOperator" and node["opcode"] in "+-":
            return self.real(inner[0])
        if kind == "ImplicitCastExpr" and node.get("castKind") in ("NoOp", "LValueToRValue"):
            return bare(node["type"]["qualType"]) == "mh_real" or self.real(inner[0])
        if kind == "BinaryOperator" and node["opcode"] in ("+", "-", "*", "/"):
            return True if True in (self.real(inner[0]), self.real(inner[1])) else False
        if kind == "ConditionalOperator":
            parts = [self.real(inner[1]), self.real(inner[2])]
            return True if True in parts else None if parts == [None, None] else False
        return bare(node.get("type", {}).get("qualType", "")) == "mh_real"

    def taken(self, node, wanted, where):
        """node as a value of the type `wanted`."""
        if wanted == "mh_real" and self.real(node) is False:
            self.say(node, "an integer as mh_real (%s)" % where)

    def check(self, node, returns=None):
        kind, inner = node.get("kind"), node.get("inner", [])
        if kind == "FunctionDecl":
            returns = parameters(node["type"]["qualType"])[0]
        elif kind in ("BinaryOperator", "CompoundAssignOperator"):
            left, right, op = self.real(inner[0]), self.real(inner[1]), node["opcode"]
            if op in ("*", "/", "*=", "/=") and left and right:
                self.say(node, "mh_real %s mh_real: mh_mul, mh_div" % op[0])
            elif op in ("/",) and right:
                self.say(node, "an integer / mh_real")
            elif op in ("+", "-", "<", ">", "<=", ">=", "==", "!=", "+=", "-=", "=") and {left, right} == {True, False}:
                self.say(node, "mh_real %s integer" % op)
        elif kind == "ConditionalOperator":
            if {self.real(inner[1]), self.real(inner[2])} == {True, False}:
                self.say(node, "mh_real or integer")
        elif kind == "ImplicitCastExpr" and node.get("castKind") in ("IntegralCast", "IntegralToFloating") and self.real(inner[0]):
            if bare(node["type"]["qualType"]) not in WIDE:
                self.say(node, "mh_real becomes %s" % node["type"]["qualType"])
        elif kind in ("CStyleCastExpr", "ImplicitCastExpr") and node.get("castKind") == "FloatingToIntegral":
            if bare(node["type"]["qualType"]) == "mh_real":
                self.say(node, "a floating-point number becomes mh_real")
        elif kind == "CStyleCastExpr" and node.get("castKind") != "ToVoid":
            wanted = bare(node["type"]["qualType"])
            if wanted == "mh_real" and self.real(inner[0]) is False:
                self.say(node, "an integer as mh_real (cast)")
            elif self.real(inner[0]) and wanted not in WIDE:
                self.say(node, "mh_real cast to %s" % node["type"]["qualType"])
        elif kind == "VarDecl" and "init" in node and inner:
            wanted = bare(node["type"]["qualType"])
            self.taken(inner[-1], wanted, "initialiser")
            if wanted != "mh_real" and wanted not in WIDE and self.real(inner[-1]):
                self.say(node, "mh_real becomes %s" % wanted)
        elif kind == "InitListExpr":
            wanted = bare(node["type"]["qualType"])
            fields = self.fields.get(wanted) or ["mh_real"] * len(inner) if wanted.startswith("mh_real[") else self.fields.get(wanted, [])
            for field, value in zip(fields, inner):
                self.taken(value, field, "initialiser")
                if field != "mh_real" and field not in WIDE and self.real(value):
                    self.say(value, "mh_real becomes %s" % field)
        elif kind == "CallExpr":
            pointer = bare(inner[0]["type"]["qualType"])
            for value, wanted in zip(inner[1:], parameters(pointer)[1]):
                self.taken(value, wanted, "argument")
                if wanted != "mh_real" and wanted not in WIDE and self.real(value):
                    self.say(value, "mh_real becomes %s" % wanted)
        elif kind == "ReturnStmt" and inner:
            self.taken(inner[0], returns, "result")
            if returns != "mh_real" and returns not in WIDE and self.real(inner[0]):
                self.say(inner[0], "mh_real becomes %s" % returns)
        for child in inner:
            if child:
                self.check(child, returns)


def findings(job):
    clang, folder, command = job
    words = shlex.split(command)
    flags = [word for at, word in enumerate(words) if word[:2] in ("-I", "-D") or "-isystem" in (word, words[at - 1])]
    dump = subprocess.run([clang, "-std=c99", "-fsyntax-only", "-Xclang", "-ast-dump=json", *flags, words[-1]], cwd=folder, stdout=subprocess.PIPE, check=True)
    reader = Reader()
    tree = json.loads(dump.stdout)
    reader.mark(tree)
    reader.check(tree)
    return reader.found


def main():
    clang, database, folders = sys.argv[1], sys.argv[2], tuple(os.path.realpath(folder) + os.sep for folder in sys.argv[3:])
    with open(database) as file:
        jobs = {entry["file"]: (clang, entry["directory"], entry["command"]) for entry in json.load(file)}
    jobs = [job for name, job in sorted(jobs.items()) if os.path.realpath(name).startswith(folders)]
    with multiprocessing.Pool(2) as pool:
        found = set().union(*pool.imap_unordered(findings, jobs))
    for line in sorted(found):
        print(line)
    print("%d sources, %d findings" % (len(jobs), len(found)))
    return 1 if found or not jobs else 0


if __name__ == "__main__":
    sys.exit(main())
