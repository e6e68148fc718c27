"""Reading a published recording and writing it as the CSV files of `motehound replay`: nodes, readings and truth."""

import csv
import math
import os
import sys
import tempfile


class Refused(Exception):
    """One line: file, line, and what was expected."""


def read_rows(path, names, encoding="utf-8"):
    """Yields (line, [text, ...]) for the columns called `names`."""
    try:
        with open(path, newline="", encoding=encoding) as file:
            rows = csv.reader(file)
            header = next(rows, None)
            if header is None:
                raise Refused(f"{path}: empty, expected a line of column names")
            missing = [name for name in names if name not in header]
            if missing:
                raise Refused(f"{path}:1: no column `{missing[0]}`")
            places = [header.index(name) for name in names]
            for row in rows:
                if not row:
                    continue
                line = rows.line_num
                if len(row) != len(header):
                    raise Refused(f"{path}:{line}: {len(row)} columns, expected {len(header)}")
                yield line, [row[place] for place in places]
    except OSError as error:
        raise Refused(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise Refused(f"{path}: not {encoding} text ({error.reason})") from error
    except csv.Error as error:
        raise Refused(f"{path}:{rows.line_num}: {error}") from error


def number(path, line, name, text):
    """`text` as a finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise Refused(f"{path}:{line}: {name}: `{text}`, expected a finite number")
    return value


def read_columns(path, names, encoding="utf-8"):
    """As read_rows, but all are finite numbers, as float."""
    for line, row in read_rows(path, names, encoding):
        yield line, [number(path, line, name, text) for name, text in zip(names, row)]


def write_recording(folder, nodes, readings, truth):
    """nodes: (node, x_m, y_m, z_m); readings: (time_s, node, value); truth: (time_s, x_m, y_m). All three files, or none."""
    write_tables(folder, [
        ("nodes.csv", "node,x_m,y_m,z_m", nodes, "{},{:.4f},{:.4f},{:.4f}"),
        ("readings.csv", "time_s,node,value", readings, "{:.3f},{},{:.6f}"),
        ("truth.csv", "time_s,x_m,y_m", truth, "{:.3f},{:.4f},{:.4f}"),
    ])


def write_tables(folder, tables):
    """tables: (file name, header, rows, format of a row). All files, or none."""
    written = []
    try:
        os.makedirs(folder, exist_ok=True)
        for name, header, rows, form in tables:
            handle, temporary = tempfile.mkstemp(prefix=f".{name}.", dir=folder)
            written.append((temporary, os.path.join(folder, name)))
            with open(handle, "w", encoding="utf-8", newline="\n") as file:
                file.write(header + "\n")
                for row in rows:
                    file.write(form.format(*row) + "\n")
                os.fchmod(file.fileno(), 0o644)
        for temporary, name in written:
            os.replace(temporary, name)
    except OSError as error:
        raise Refused(f"{error.filename or folder}: {error.strerror}") from error
    finally:
        for temporary, _ in written:
            if os.path.exists(temporary):
                os.remove(temporary)


def run(convert, arguments):
    """Exit status: 0, or 1 with one line on standard error."""
    try:
        convert(arguments)
    except Refused as error:
        print(f"{os.path.basename(sys.argv[0])}: {error}", file=sys.stderr)
        return 1
    return 0
