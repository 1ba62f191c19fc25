"""Hostile things by kinds, with a line for each kind.  `classes` says how each table is handed in.

Texts are put wherever a text can be in a solved notebook, numbers replace those of a right answer,
names are used for people and files, and so on.  A comment says why a line is there.  To add a kind,
add a line; its test has the name of the table and of the kind.
"""

from __future__ import annotations

import copy
import json
import os
import shutil
import zipfile
from pathlib import Path
from typing import Any

Notebook = dict[str, Any]

TEXTS = {
    "lone surrogate": "\ud800",  # JSON can contain it, UTF-8 cannot
    "surrogates turned round": "\udc00\ud800",
    "NUL": "a\0b",  # ends a text in C, and in some databases
    "terminal's escape": "\x1b[2J\x1b]0;owned\x07",  # clears the screen, renames the window
    "C1 escape": "\x9b2J\x9d0;owned\x9c",  # the same in one character of Latin-1
    "backspaces": "0 of 20\b\b\b\b\b\b\b20 of 20",
    "carriage return": "x\r[1/1] zoe: 0 of 20",  # overwrites the line of another student
    "forged lines": "x\n[1/1] zoe: 0 of 20\nnot graded: zoe",
    "bidi override": "\u202e02 fo 02\u202c",  # reverses the order of reading
    "bidi isolate": "\u2067zoe\u2069\u200f",
    "byte order mark": "\ufeffx",
    "line separators": "a\u2028b\u2029c\x85d\x0be\x0cf",  # lines for str.splitlines, not for others
    "no characters": "\ufffe\uffff\U0010ffff",
    "invisible": "\u200b\u2060\u00ad\U000e0041",
    "stacked accents": "e" + "\u0301" * 5000,
    "one long line": "x" * 400_000,  # planted four times
    "many lines": "x\n" * 20_000,
    "script": "</script><script>hostile()</script>",
    "element": "'\"><img src=x onerror=hostile()><svg onload=hostile()>",
    "end of comment": "--><script>hostile()</script><!-- ]]> </style></title></textarea>",
    "javascript link": "[x](javascript:hostile()) <a href='javascript:hostile()'>x</a>",
    "formula": "=cmd|' /C calc'!A0",
    "format string": "{0.__class__} {result} {} %s %n %(x)s ${HOME}",
    "template": "{{ 7 * 7 }}{% raw %}{# #}",  # nbconvert's pages are Jinja templates
    "Markdown": "```\n# zoe: 0 of 20\n| a | b |\n---\n<!--",
    "nbgrader's words": "### BEGIN HIDDEN TESTS\n### BEGIN SOLUTION\n### AUTOTEST x",
    "SQL": "'); DROP TABLE grade; --",
    "path": "../../../../etc/passwd",
    "magic": "%%bash\n!exit 1\n?",
    "digits of others": "٢٠ 𝟚𝟘 ²⁰",  # true for str.isdigit, but int rejects some
    "emoji": "👩‍🚀" * 20_000,  # 36 characters each in ASCII JSON
}
"""Put into a comment, an exception, a Markdown cell, ids, metadata and outputs; the answers stay
right, so no points are lost."""

MAGICS = {
    "time": "%%time\n{answer}",  # in a notebook the answer is still defined
    "capture": "%%capture out\n{answer}",
    "lines of magic": "%matplotlib inline\n!true\n{answer}",
    "question mark": "{answer}\n\nlen?",
    "another name for it": "{answer}\n\nNAME = NAME",
    "declared coding": "# -*- coding: rot13 -*-\n{answer}",  # matters in files, not in a text
    "form feed": "\x0c\n{answer}",
    "Windows' line ends": "{crlf}",
}
"""Put around a right answer, which stays right; NAME is replaced by the function's name."""

SOURCES = {
    "writefile": "%%writefile x.py\n{answer}",
    "shell": "%%bash\n{answer}",
    "unknown magic": "%%nothing\n{answer}",
    "deep brackets": "{answer}\nx = " + "(" * 5000 + ")" * 5000,  # Python's parser gives up
    "many signs": "{answer}\nx = " + "-" * 100_000 + "1",  # too deep for the parser's recursion
    "many dots": "{answer}\nx = len" + ".a" * 20_000,
    "many branches": "{answer}\nx = " + "1 if 1 else " * 5_000 + "1",
    "long number": "{answer}\nx = " + "9" * 10_000,  # more digits than int reads
    "not closed": "{answer}\nx = '''",
    "tabs and blanks": "{answer}\nif 1:\n        x = 1\n\ty = 2",
    "lookalike name": "def {wide}(*args):\n    return 0.0",  # Python reads it as the plain one
    "only a comment": "# ",
    "empty": "",
    "two megabytes": "{answer}\n# " + "x" * 1_990_000,
    "emoji": "{answer}\n# " + "🐍" * 300_000,  # 12 bytes each in ASCII JSON
}
"""Replaces an answer; it may earn any points."""

NUMBERS = {
    "largest": "1e308",
    "largest of both signs": "1.7e308 if k % 2 else -1.7e308",  # their difference is infinite
    "largest, once": "1e308 if k == 0 else x",
    "smallest": "5e-324",
    "smallest of both signs": "5e-324 if k % 2 else -5e-324",
    "small": "1e-308 if k else x",
    "infinite": "float('inf')",
    "minus infinite": "float('-inf') if k else x",
    "nan": "float('nan')",
    "nan, once": "float('nan') if k == 0 else x",
    "minus zero": "-0.0",
    "huge int": "10**400",  # too large for a float
    "longest int": "10**5000",  # more digits than Python writes
    "int beyond floats": "2**53 + 1",
    "complex": "1j",
    "complex without imaginary part": "complex(x)",
    "truth value": "True",
    "text": "repr(x)",
    "text of nan": "'nan'",
    "bytes": "b'1'",
    "None": "None",
    "float16": "np.float16(x) * np.float16(60000) * np.float16(60000)",
    "longdouble": "np.longdouble('1e4000')",
    "timedelta": "np.timedelta64('NaT')",
    "Decimal": "__import__('decimal').Decimal('sNaN')",
    "Fraction": "__import__('fractions').Fraction(1, 3)",
    "by a hair": "x * (1 + 1e-7) + 1e-9",
    "0-d arrays": "np.array(x)",
    "nested": "[[[x]]]",
    "large": "1e16 * x + 1e16",
}
"""Replaces each number x of a right answer, of which it is the k-th; shapes stay the same."""

OBJECTS = {
    "empty list": "[]",
    "empty tuple": "()",
    "empty text": "''",
    "Ellipsis": "...",
    "NotImplemented": "NotImplemented",
    "0-d": "np.array(1.0)",
    "empty array": "np.zeros(0)",
    "column": "np.ones((7, 1))",
    "many axes": "np.zeros((1,) * 32)",
    "array of nothing": "np.zeros((10**6, 0))",
    "subnormal array": "np.full(3, 5e-324)",
    "object array": "np.array([object()] * 3)",
    "text array": "np.array(['1', '2', '3'])",
    "records": "np.zeros(3, dtype=[('x', 'f8'), ('y', 'O')])",
    "masked": "np.ma.masked_all(3)",
    "matrix": "np.asmatrix(np.ones((3, 3)))",
    "float16 array": "np.full(3, 65504, np.float16)",
    "ragged": "[[1.0], [1.0, 2.0], [[3.0]]]",
    "deep": "__import__('functools').reduce(lambda x, _: [x], range(900), 1.0)",
    "cyclic": "(lambda x: x.append(x) or x)([])",
    "dict with odd keys": "{None: 1, 1: 2, (): 3}",
    "dict with a surrogate": "{'\\ud800': '\\ud800'}",
    "forged array": "{'$': 'array', 'shape': [-1, 2], 'numbers': ['x']}",
    "list of texts": "['\\x1b[2J', '<script>hostile()</script>', '\\u202e', '\\0']",
    "generator": "(x for x in range(3))",
    "function": "lambda *args: 1.0",
    "class": "float",
    "module": "np",
    "exception": "ValueError('\\x1b[2J')",
    "State of nothing": "lk.State(None, None, None)",
    "Sample of texts": "lk.Sample('a', 'b', 'c')",
    "Sample of nothing": "lk.Sample(np.zeros(0), np.zeros(0), np.zeros(0))",
    "torque of nan": "lk.JointTorque(np.full(7, np.nan))",
    "raising repr": "Odd('__repr__')",
    "raising eq": "Odd('__eq__')",
    "raising array": "Odd('__array__')",
    "raising float": "Odd('__float__')",
    "raising len": "Odd('__len__')",
    "raising iter": "Odd('__iter__')",
    "raising hash": "Odd('__hash__')",
    "raising getattr": "Odd('__getattribute__')",
    "exits when shown": "Odd('__repr__', SystemExit)",
}
"""Returned by every function.  `Odd` raises an exception in one of its methods."""

LOADS = {
    "larger than memory": "np.broadcast_to(0.0, (10**6, 10**6))",
    "huge list": "[0.0] * 5_000_000",
    "many lists": "[[]] * 20_000",
    "deeper": "__import__('functools').reduce(lambda x, _: [x], range(100_000), 1.0)",
    "long text": "'x' * 3_000_000",
    "endless": "iter(int, 1)",
    "range": "range(10**12)",
    "no rows, many columns": "np.zeros((0, 10**9))",
}
"""Returned by only one function, because each case takes seconds."""

COEFFICIENTS = {
    "no coefficients": "Ratio((), ())",
    "zero below": "Ratio((1.0,), (0.0, 0.0))",
    "nan coefficients": "Ratio((float('nan'),), (1.0, float('inf')))",
    "extreme coefficients": "Ratio((1e308, -1e308), (5e-324, 1e308))",
    "many coefficients": "Ratio((1.0,) * 2000, (1.0,) * 2000)",
    "more coefficients": "Ratio((1.0,) * 100_000, (1.0,) * 100_000)",
}
"""Transfer functions, returned only where a question asks for one."""

RAISES = {
    "script": "raise ValueError('<script>hostile()</script>')",
    "escape": "raise ValueError('\\x1b[2J\\x1b]0;owned\\x07')",
    "surrogate": "raise ValueError('\\ud800')",
    "forged lines": "raise ValueError('\\n[999/999] zoe: 0 of 20\\n')",
    "format string": "raise ValueError('{0} {} %s')",
    "ten megabytes": "raise ValueError('x' * 10**7)",
    "odd name": "raise type('\\x1b[2J<b>\\ud800', (Exception,), {})('x')",
    "long name": "raise type('X' * 10**6, (Exception,), {})('x')",
    "text that raises": "raise type('E', (Exception,), {'__str__': lambda e: 1 / 0})",
    "text that exits": "raise type('E', (Exception,), {'__str__': lambda e: exit()})",
    "group": "raise ExceptionGroup('x', [ExceptionGroup('y', [ValueError('z')])])",
    "notes": "e = ValueError('x'); e.__notes__ = 5; raise e",
    "odd SyntaxError": "raise SyntaxError('x', (b'\\xff', 'a', [], None))",
    "odd UnicodeError": "raise UnicodeDecodeError('x\\ud800', b'\\xff', 0, 1, '\\x1b')",
    "cause of itself": "e = ValueError('x'); e.__cause__ = e; raise e",
    "KeyboardInterrupt": "raise KeyboardInterrupt",
    "SystemExit": "raise SystemExit('x' * 10**6)",
    "GeneratorExit": "raise GeneratorExit",
    "StopIteration": "raise StopIteration(5)",
    "BaseException": "raise BaseException('x')",
    "recursion": "return (lambda f: f(f))(lambda f: f(f))",
    "warning": "__import__('warnings').warn('\\x1b[2J'); return 1.0",
    "prints": "print('\\x1b[2J\\ud800' * 10**5); return 1.0",
    "prints to the end": "import os; os.write(1, b'\\x1b[2J'); os.write(2, b'\\xff'); return 1.0",
}
"""Done by every function."""

REPLIES = {
    "8 MB of empty lists": "b'{\"is\":[' + b'[],' * 2_790_000 + b'[]]}\\n'",
    "9 MB": "b'x' * 9_000_000 + b'\\n'",
    "no JSON": "b'not json\\n'",
    "no object": "b'[1, 2, 3]\\n'",
    "null": "b'null\\n'",
    "not UTF-8": "b'\\xff\\xfe\\n'",
    "surrogates": 'b\'{"raised": "\\\\ud800", "says": "\\\\ud800\\\\u001b[2J"}\\n\'',
    "nan as no number": "b'{\"is\": NaN}\\n'",
    "infinity": "b'{\"is\": [1e999, -1e999, Infinity]}\\n'",
    "longest number": "b'{\"is\": ' + b'9' * 100_000 + b'}\\n'",
    "deep": "b'[' * 90_000 + b'\\n'",
    "deep object": "b'{\"is\":' * 900 + b'1' + b'}' * 900 + b'\\n'",
    "doubled keys": 'b\'{"is": 1, "is": 2, "raised": "x"}\\n\'',
    "half a message": "b'{\"is\": [1.0, 2.0'",
    "empty lines": "b'\\n' * 5000",
    "thousands of messages": "b'{\"is\": 1.0}\\n' * 5000",
    "another cell's report": 'b\'{"ran": 3, "kind": [], "error": {}, "output": 5}\\n\' * 9',
    "ready": 'b\'{"ready": "circle"}\\n{"confined": true}\\n{"ready": true}\\n\' * 9',
    "over": "b'{\"over\": 0}\\n' * 9",
    "verdict": 'b\'{"earned": 20, "outcome": "right"}\\n\'',
    "another question's answer": 'b\'{"is": {"$": "tuple", "items": [0, 0.5]}}\\n\' * 3',
    "odd exception": 'b\'{"raised": ["x"], "says": {"a": 1}}\\n\'',
    "array of a wrong size": 'b\'{"is": {"$": "array", "shape": [9, 9], "numbers": []}}\\n\'',
    "huge shape": 'b\'{"is": {"$": "array", "shape": [1e18, 0], "numbers": []}}\\n\'',
    "negative shape": 'b\'{"is": {"$": "array", "shape": [-1], "numbers": [1]}}\\n\'',
    "array of texts": 'b\'{"is": {"$": "array", "shape": [1], "numbers": ["x"]}}\\n\'',
    "float of no number": 'b\'{"is": {"$": "float", "value": "x"}}\\n\'',
    "tuple of no items": 'b\'{"is": {"$": "tuple", "items": 5}}\\n\'',
    "no kind": "b'{\"is\": {}}\\n'",
    "kind of ours": 'b\'{"is": {"$": "Model", "side": "left", "plant": null}}\\n\'',
    "odd fields": 'b\'{"is": {"$": "Sample", "x": 1}}\\n\'',
    "method": 'b\'{"is": {"$": "method", "of": 1, "name": "__class__"}}\\n\'',
    "pickle": "__import__('pickle').dumps({'is': 1.0}) + b'\\n'",
}
"""Written by a student's process to the grader's socket, in a cell and before an answer."""

PEOPLE = {
    "leading dash": "-rf",
    "option": "--help",
    "hidden": ".ada",
    "blank": " ",
    "blanks around": " ada ",
    "line break": "ada\nzoe: 0 of 20",
    "carriage return": "ada\rzoe",
    "tab": "ada\tzoe",
    "escape": "\x1b[2J\x1b]0;owned\x07",
    "bidi": "\u202eadz",
    "not UTF-8": b"\xff\xfe\x80",
    "line separator": "a\u2028b",
    "quotes": "'\"`",
    "plus": "ada+01_paths+2026-03-01",
    "comma": "ada,20.0,20.0",
    "semicolon": "ada;20.0",
    "formula": "=cmd|' 'C calc'!A0",
    "at": "@SUM(A1)",
    "minus": "-1+1",
    "shell": "$(touch owned)`touch owned`",
    "glob": "a*[b]?",
    "percent": "%s%n%(x)s",
    "braces": "{0.__class__}{}",
    "script": "<script>hostile()<",
    "SQL": "'; DROP TABLE student; --",
    "lookalike": "аda",  # the first letter is Cyrillic
    "capital": "ADA",
    "composed": "zo\u00e9",
    "decomposed": "zoe\u0301",
    "dot at the end": "zoe.",
    "255 bytes": "x" * 255,
    "250 bytes": "é" * 125,
    "Windows": "CON",
    "drive": "C:\\x",
    "a result": "zoe.json",
    "the results' own": "old",
    "the assignment": "01_paths",
    "number": "0",
    "None": "None",
    "nan": "nan",
    "full marks": "(full marks)",
    "Canvas's own": "    Points Possible",
    "Moodle's own": "Participant 101",
    "emoji": "👩‍🚀",
    "home": "~",
}
"""Names of folders in ``submitted/``, and of people in a download if it can contain the name."""

ENTRIES = {
    "number in a file's name": "Eve_{n}{m}x_101{m}(9).ipynb",
    "number in a folder's name": "Eve_{n}{m}/_101{m}/x.ipynb",
    "namesake": "Mia Wong_{n}{m}/01_paths.ipynb",
    "another's folder": "zoe_{n}{m}/01_paths.ipynb",
    "wide digits": "Eve_１０１{m}/01_paths.ipynb",  # \d matches them
    "leading zeros": "Eve_000101{m}/01_paths.ipynb",
    "huge number": "Eve_" + "9" * 5000 + "{m}/01_paths.ipynb",
    "no name": "_{n}{m}/01_paths.ipynb",
    "folder above": ".._{n}{m}/01_paths.ipynb",
    "climbs": "Eve_{n}{m}/../../../../owned.ipynb",
    "climbs first": "../../Eve_{n}{m}/01_paths.ipynb",
    "absolute": "/Eve_{n}{m}/01_paths.ipynb",
    "backslashes": "Eve_{n}{m}\\..\\..\\owned.ipynb",
    "escape": "Eve_{n}{m}/\x1b[2J\x1b]0;owned\x07.ipynb",
    "escape elsewhere": "\x1b[2J\x1b]0;owned\x07.ipynb",
    "line break": "Eve_{n}{m}/x\nzoe: taken\n.ipynb",
    "bidi": "Eve_{n}{m}/\u202ebnypi.ipynb",
    "no notebook": "Eve_{n}{m}/x.exe",
    "long": "Eve_{n}{m}/" + "x" * 50_000 + ".ipynb",
    "folder called as a notebook": "Eve_{n}{m}/01_paths.ipynb/x",
    "another assignment": "Eve_{n}{m}/02_model.ipynb",
}
"""Files in Moodle's download, beside those of participant 101, Mia Wong.  n is a unique number,
and m is Moodle's mark."""


def _emptied(path: Path) -> None:
    with zipfile.ZipFile(path, "w"):
        pass


def _locked(path: Path) -> None:
    """Mark the file in the zip as one that needs a password."""
    data = path.read_bytes()
    start = data.index(b"PK\x01\x02")
    path.write_bytes(data[: start + 8] + b"\x01" + data[start + 9 :])


def _bomb(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("Eve_5_assignsubmission_file_/01_paths.ipynb", bytes(300 * 2**20))


def _symbolic(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        entry = zipfile.ZipInfo("Eve_5_assignsubmission_file_/01_paths.ipynb")
        entry.external_attr = 0o120777 << 16
        archive.writestr(entry, "/etc/passwd")


def _names(*names: str) -> Any:
    def change(path: Path) -> None:
        with zipfile.ZipFile(path, "w") as archive:
            for name in names:
                archive.writestr(name, "{}")

    return change


DOWNLOADS = {
    "no zip": lambda path: path.write_bytes(b"<!doctype html><title>Log in</title>"),
    "empty file": lambda path: path.write_bytes(b""),
    "empty zip": _emptied,
    "half": lambda path: os.truncate(path, path.stat().st_size // 2),
    "without its end": lambda path: os.truncate(path, path.stat().st_size - 10),
    "changed": lambda path: path.write_bytes(path.read_bytes().replace(b"cells", b"cell\xff")),
    "password": _locked,
    "bomb": _bomb,
    "link": _symbolic,
    "nobody's": _names("x.ipynb", "../x.ipynb", "/x.ipynb", "x", "\x1b[2J"),
    "gone": lambda path: path.unlink(),
    "folder": lambda path: _folder(path),
    "pipe": lambda path: _pipe(path),
    "link to itself": lambda path: _link(path, path.name),
    "link to a device": lambda path: _link(path, "/dev/zero"),
}
"""Done to a whole download of Moodle; earlier work of students must not change."""

FILE_NAMES = {
    "numbered": "01_paths (1).ipynb",
    "not UTF-8": b"\xff\xfe.ipynb",
    "escape": "\x1b[2J\x1b]0;owned\x07.ipynb",
    "line break": "x\nzoe: 0 of 20.ipynb",
    "bidi": "\u202ebnypi.ipynb",
    "formula": "=1+1.ipynb",
    "dash": "--help.ipynb",
    "only an ending": ".ipynb",
    "capitals": "01_PATHS.IPYNB",
    "twice": "01_paths.ipynb.ipynb",
    "255 bytes": "x" * 249 + ".ipynb",
    "script": "<script>hostile()<.ipynb",
    "quotes": "'\"`$(x).ipynb",
    "glob": "[!x]*?.ipynb",
    "Windows": "CON.ipynb",
    "blank": " .ipynb",
}
"""File names of a solved notebook that was handed in."""


def _link(path: Path, to: str) -> None:
    path.unlink()
    path.symlink_to(to)


def _folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def _pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def _hard_link(path: Path) -> None:
    other = path.with_name("notes.txt")
    path.rename(other)
    os.link(other, path)


def _sparse(path: Path) -> None:
    os.truncate(path, 300 * 2**20)


def _zip(path: Path) -> None:
    data = path.read_bytes()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(path.name, data)


def _recoded(coding: str) -> Any:
    return lambda path: path.write_bytes(path.read_text("utf-8").encode(coding))


def _beside(name: str, text: bytes) -> Any:
    return lambda path: path.with_name(name).write_bytes(text)


def _folder_beside(name: str) -> Any:
    return lambda path: path.with_name(name).mkdir()


def _link_beside(name: str, to: str) -> Any:
    return lambda path: path.with_name(name).symlink_to(to)


def _bytes(data: bytes) -> Any:
    return lambda path: path.write_bytes(data)


FILES = {
    "empty": _bytes(b""),
    "one blank": _bytes(b" \n"),
    "folder": _folder,
    "pipe": _pipe,  # a program that opens it waits for ever
    "link to passwords": lambda path: _link(path, "/etc/passwd"),
    "link to itself": lambda path: _link(path, path.name),
    "link to nothing": lambda path: _link(path, "nothing"),
    "endless device": lambda path: _link(path, "/dev/zero"),
    "hard link": _hard_link,
    "300 MB": _sparse,
    "zip": _zip,
    "byte order mark": _recoded("utf-8-sig"),
    "UTF-16": _recoded("utf-16"),
    "not UTF-8": lambda path: path.write_bytes(path.read_bytes().replace(b"circle", b"\xff")),
    "half": lambda path: os.truncate(path, path.stat().st_size // 2),
    "two in one": lambda path: path.write_bytes(path.read_bytes() * 2),
    "deep": _bytes(b"[" * 200_000 + b"]" * 200_000),
    "deep cells": _bytes(b'{"nbformat":4,"cells":' + b"[" * 5000 + b"]" * 5000 + b"}"),
    "long number": _bytes(b'{"nbformat":4,"cells":[],"x":' + b"9" * 100_000 + b"}"),
    "number": _bytes(b"4"),
    "list": _bytes(b"[]"),
    "text": _bytes(b'"\\ud800"'),
    "null": _bytes(b"null"),
    "no UTF-8 at all": _bytes(bytes(range(256))),
    "NUL": _bytes(b"\0" * 5000),
    "page": _bytes(b"<!doctype html><title>Log in</title>"),  # a platform's page for strangers
    "unreadable": lambda path: path.chmod(0),
    "time of no time": _beside("timestamp.txt", b"\x1b[2J yesterday \xff"),
    "time far off": _beside("timestamp.txt", b"99999-13-45 99:99:99 +99:99"),
    "time of the first year": _beside("timestamp.txt", b"0001-01-01 00:00:00 +14:00"),
    "time in a folder of zones": _beside("timestamp.txt", b"2026-11-06 10:00:00 US"),
    "time as a number": _beside("timestamp.txt", b"1" * 150),
    "time as a folder": _folder_beside("timestamp.txt"),
    "time as a link": _link_beside("timestamp.txt", "/etc/passwd"),
    "secret as a folder": _folder_beside("submission_secret.txt"),
    "secret as a link": _link_beside("submission_secret.txt", "/etc/passwd"),
    "secret without a time": _beside("submission_secret.txt", b"x"),
    "two notebooks": _beside("02_paths.ipynb", b"{}"),
    "notebook of the same name": _beside("01_paths.IPYNB", b"{}"),
    "link to the answers": _link_beside("notes.txt", "/etc/passwd"),
    "pipe beside": lambda path: os.mkfifo(path.with_name("notes.txt")),
    "odd name beside": lambda path: (path.parent / os.fsdecode(b"\xff\x1b[2J")).write_text("x"),
}
"""Done to the file of a solved notebook that was handed in."""


def _each(**fields: Any) -> Any:
    """Change fields of every cell."""

    def change(notebook: Notebook) -> None:
        for cell in notebook["cells"]:
            cell.update(copy.deepcopy(fields))

    return change


def _without(*fields: str) -> Any:
    """Remove fields from every cell."""

    def change(notebook: Notebook) -> None:
        for cell in notebook["cells"]:
            for field in fields:
                cell.pop(field, None)

    return change


def _lab(**fields: Any) -> Any:
    """Change fields of nbgrader's metadata in every cell."""

    def change(notebook: Notebook) -> None:
        for cell in notebook["cells"]:
            cell["metadata"].setdefault("nbgrader", {}).update(copy.deepcopy(fields))

    return change


def _top(**fields: Any) -> Any:
    return lambda notebook: notebook.update(copy.deepcopy(fields))


def _deep(depth: int) -> Any:
    """Tables nested in one another."""
    inner: dict[str, Any] = {}
    for _ in range(depth):
        inner = {"x": inner}
    return inner


def _nest(notebook: Notebook, depth: int) -> None:
    for cell in notebook["cells"]:
        cell["metadata"]["x"] = _deep(depth)


def _twice(notebook: Notebook) -> None:
    notebook["cells"] += copy.deepcopy(notebook["cells"])


def _cells(count: int, source: str) -> Any:
    """Add a number of cells of the student."""
    cell = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}

    def change(notebook: Notebook) -> None:
        notebook["cells"] += [{**cell, "id": f"own-{k}", "source": source} for k in range(count)]

    return change


def _format_3(notebook: Notebook) -> None:
    cells = notebook.pop("cells")
    notebook.update(nbformat=3, worksheets=[{"cells": cells}])


_MUCH = """import gc
for x in gc.get_objects():
    if type(x).__name__ == "Notebook":
        x.most_output = 10**9
print("🐍" * 20_000)
raise ValueError"""

NOTEBOOKS = {
    "format 3": _format_3,
    "format 5": _top(nbformat=5),
    "format of text": _top(nbformat="4"),
    "no format": lambda notebook: notebook.pop("nbformat"),
    "no cells": _top(cells=[]),
    "cells are none": lambda notebook: notebook.pop("cells"),
    "cells are a table": _top(cells={"0": {}}),
    "cells are numbers": _top(cells=[1, None, "x", [], {}]),
    "2000 cells": _cells(2000, "1"),
    "900 cells that fail": _cells(900, "raise ValueError('🐍' * 400)"),
    "60 cells that print": _cells(60, _MUCH),
    "2 million characters": _cells(90, "# " + "🐍" * 20_000),
    "every cell twice": _twice,
    "no ids": _without("id"),
    "ids of one": _each(id="x"),
    "ids are numbers": _each(id=5),
    "ids are lists": _each(id=[]),
    "long ids": _each(id="x" * 100_000),
    "no metadata": _without("metadata"),
    "metadata is a list": _each(metadata=[]),
    "metadata is none": _each(metadata=None),
    "nbgrader's is a list": _each(metadata={"nbgrader": []}),
    "nbgrader's is a text": _each(metadata={"nbgrader": "x"}),
    "grade_ids of one": _lab(grade_id="circle"),
    "grade_ids are lists": _lab(grade_id=[]),
    "no grade_ids": lambda notebook: _each(metadata={})(notebook),
    "points": _lab(points="lots", grade=True, solution=True),
    "schema 99": _lab(schema_version=99),
    "schema 0": _lab(schema_version=0),
    "sources are none": _each(source=None),
    "sources are numbers": _each(source=[1, None, {}]),
    "no sources": _without("source"),
    "no type": _without("cell_type"),
    "type of text": _each(cell_type="\x1b[2J"),
    "type is a list": _each(cell_type=[]),
    "all Markdown": _each(cell_type="markdown"),
    "outputs are a text": _each(outputs="x"),
    "outputs are numbers": _each(outputs=[1, None]),
    "output without type": _each(outputs=[{"text": 5}, {"data": []}]),
    "output of markup": _each(
        outputs=[{"output_type": "display_data", "metadata": {}, "data": {
            "text/html": "<script>hostile()</script>", "image/png": "x"}}]
    ),
    "count is a text": _each(execution_count="x"),
    "count is huge": _each(execution_count=10**30),
    "kernel of nobody": _top(metadata={"kernelspec": {"name": "../x", "display_name": 5}}),
    "notebook's metadata is a list": _top(metadata=[]),
    "NaN": _top(metadata={"x": float("nan"), "y": float("inf"), "z": -float("inf")}),
    "huge number": _top(nbformat_minor=10**3000),
    "deep metadata": lambda notebook: notebook.update(metadata=_deep(900)),
    "deep metadata of cells": lambda notebook: _nest(notebook, 200),
    "minor format is a text": _top(nbformat_minor="x"),
    "minor format is none": _top(nbformat_minor=None),
    "minor format is negative": _top(nbformat_minor=-1),
    "sources are nested": _each(source=[["x = 1"], {"x": 1}]),
    "sources of halves": _each(source=["\ud83d", "\ude00"]),  # two halves of a character
    "outputs of huge numbers": _each(outputs=[{"output_type": "execute_result", "metadata": {},
        "execution_count": 10**400, "data": {"application/json": {"x": float("nan")}}}]),
    "a verdict that is a list": _each(outputs=[
        {"output_type": "display_data", "metadata": {"labkit": [1]}, "data": {}}]),
    "points are nan": _lab(points=float("nan"), grade=True, solution=True),
    "points are huge": _lab(points=10**400, grade=True, solution=True),
    "schema is huge": _lab(schema_version=10**400),
    "schema is none": _lab(schema_version=None),
    "long grade_ids": _lab(grade_id="x" * 100_000),
    "grade_ids of markup": _lab(grade_id="<script>hostile()</script>"),
    "kernel is a list": _top(metadata={"kernelspec": [1], "language_info": 5}),
    "headings": _each(cell_type="heading", level=1),
    "ids of half a character": _each(id="\ud800"),
    "count is infinite": _each(execution_count=float("inf")),
    "field of half a character": _top(**{"\ud800": 1}),
    "attachments": _each(attachments={"x": {"text/html": "<script>hostile()</script>"}}),
}  # fmt: skip
"""Done to a solved notebook, as JSON data."""


def _write(name: str, data: bytes) -> Any:
    return lambda root: (root / name).write_bytes(data)


def _cut(name: str) -> Any:
    return lambda root: os.truncate(root / name, (root / name).stat().st_size // 2)


def _gone(name: str) -> Any:
    return lambda root: (root / name).unlink()


def _as_file(name: str) -> Any:
    def change(root: Path) -> None:
        shutil.rmtree(root / name)
        (root / name).write_bytes(b"")

    return change


def _as_folder(name: str) -> Any:
    def change(root: Path) -> None:
        (root / name).unlink(missing_ok=True)
        (root / name).mkdir(parents=True)

    return change


def _json(name: str, **fields: Any) -> Any:
    """Change fields in a JSON file."""

    def change(root: Path) -> None:
        data = json.loads((root / name).read_text("utf-8"))
        (root / name).write_text(json.dumps(data | fields), "utf-8")

    return change


_RESULT, _BUNDLE = "results/01_paths/kim.json", "build/course/bundle/01_paths.json"
_TERM, _LMS, _BOOK = "course_private/term.json", "course_private/lms.json", "gradebook.db"

STATES = {
    "result: half": _cut(_RESULT),
    "result: empty": _write(_RESULT, b""),
    "result: list": _write(_RESULT, b"[]"),
    "result: null": _write(_RESULT, b"null"),
    "result: no UTF-8": _write(_RESULT, b"\xff"),
    "result: deep": _write(_RESULT, b"[" * 100_000),
    "result: no hashes": _json(_RESULT, hashes={}),
    "result: hashes are a list": _json(_RESULT, hashes=[]),
    "result: score is a text": _json(_RESULT, score="20"),
    "result: score is nan": _json(_RESULT, score=float("nan")),
    "result: score is null": _json(_RESULT, score=None),
    "result: questions are numbers": _json(_RESULT, questions=[1, 2]),
    "result: questions are empty": _json(_RESULT, questions=[{}]),
    "result: cells are texts": _json(_RESULT, cells=["x"]),
    "result: own is a text": _json(_RESULT, own="xyz"),
    "result: seconds are missing": _json(_RESULT, seconds={}),
    "result: another's": _json(_RESULT, student="zoe"),
    "result: folder": _as_folder(_RESULT),
    "result: unreadable": lambda root: (root / _RESULT).chmod(0),
    "result: nobody's": lambda root: (root / "results/01_paths/nobody.json").write_bytes(
        (root / _RESULT).read_bytes()
    ),
    "lock is a folder": _as_folder("results/01_paths/.running"),
    "result: left half written": _write("results/01_paths/.zoe.json.99.new", b"{"),
    "gradebook: garbage": _write(_BOOK, b"garbage" * 1000),
    "gradebook: empty": _write(_BOOK, b""),
    "gradebook: half": _cut(_BOOK),
    "gradebook: gone": _gone(_BOOK),
    "gradebook: folder": _as_folder(_BOOK),
    "gradebook: link to nothing": lambda root: _link(root / _BOOK, "/nowhere/gradebook.db"),
    "gradebook: journal": _write("gradebook.db-journal", b"garbage" * 100),
    "gradebook: lock is a folder": _as_folder("build/course/.gradebook"),
    "bundle: gone": _gone(_BUNDLE),
    "bundle: half": _cut(_BUNDLE),
    "bundle: empty": _write(_BUNDLE, b""),
    "bundle: list": _write(_BUNDLE, b"[]"),
    "bundle: no questions": _json(_BUNDLE, questions=[]),
    "bundle: odd questions": _json(_BUNDLE, questions=[{"name": "circle"}]),
    "bundle: no UTF-8": _write(_BUNDLE, b"\xff"),
    "release: gone": _gone("build/course/source/01_paths/01_paths.ipynb"),
    "release: half": _cut("build/course/source/01_paths/01_paths.ipynb"),
    "lms: half": _cut(_LMS),
    "lms: list": _write(_LMS, b"[]"),
    "lms: odd": _write(_LMS, b'{"01_paths": {"kim": {"x": 1}, "zoe": 5}}'),
    "lms: null": _write(_LMS, b'{"01_paths": null}'),
    "lms: folder": _as_folder(_LMS),
    "term: half": _write(_TERM, b'{"secret": 1'),
    "term: text": _write(_TERM, b'{"secret": "x"}'),
    "term: list": _write(_TERM, b"[]"),
    "term: short": _write(_TERM, b'{"secret": "12"}'),
    "term: no UTF-8": _write(_TERM, b"\xff"),
    "feedback: file": _write("feedback", b""),
    "autograded: file": _as_file("autograded"),
    "config: broken": _write("nbgrader_config.py", b"c = get_config(\n"),
    "config: raises": _write("nbgrader_config.py", b"1 / 0\n"),
    "config: no UTF-8": _write("nbgrader_config.py", b"# \xff\n"),
}
"""Done to a course whose class has been graded."""

_HEAD = b"name,login\n"

LISTS = {
    "half of UTF-16": (_HEAD + b"Ann,ann\n").decode().encode("utf-16")[:-1],
    "UTF-16 without a mark": (_HEAD + b"Ann,ann\n").decode().encode("utf-16-le"),
    "UTF-32": (_HEAD + b"Ann,ann\n").decode().encode("utf-32"),
    "NUL": _HEAD + b"A\0nn,ann\n",
    "long column": b"name,login," + b"x" * 200_000 + b"\nAnn,ann,\n",  # csv reads 131,072
    "long cell": _HEAD + b"x" * 200_000 + b",ann\n",
    "10,000 columns": b"name,login" + b",x" * 10_000 + b"\nAnn,ann\n",
    "columns twice": b"name,name,login,login\nAnn,Bea,a,b\n",
    "old Mac": b"name,login\rAnn,ann\rBea,bea\r",  # its lines end with a carriage return
    "Excel's own": b"sep=;\nname;login\nAnn;ann\n",
    "two marks": b"\xef\xbb\xbf\xef\xbb\xbfname,login\nAnn,ann\n",
    "surrogate": _HEAD + b"\xed\xa0\x80Ann,ann\n",
    "formulas": _HEAD + b"=cmd|' /C calc'!A0,@SUM(A1)\n",
    "paths": _HEAD + b"Ann,../../etc/passwd\nBob,/root\n",
    "line break": _HEAD + b'"Ada\nzoe: 0 of 20",ann\n',
    "escape": _HEAD + b"\x1b[2J\x1b]0;owned\x07,ann\n",
    "only signs": _HEAD + b"***,\n---,\n",
    "open quotation": b'name,"login\nAnn,ann\n',
    "page": b"<html><table><tr><td>name</td></tr></table>",
}
"""Imported as a list of the students of a class that has been graded."""

_DUE = b"[assignments.01_paths]\n"
_LONGER = _DUE + b"due = 2090-11-02T23:59:00\n[[extensions]]\nstudent = 'kim'\ndays = "

RULES = {
    "no TOML": b"[late\n",
    "byte order mark": b"\xef\xbb\xbfzone = 'UTC'\n",
    "UTF-16": "zone = 'UTC'\n".encode("utf-16"),
    "no UTF-8": b"name = '\xe9'\n",
    "deep": b"x = " + b"[" * 100_000,
    "long number": b"x = " + b"9" * 10_000,
    "zone is a folder": b"zone = 'Europe'",
    "zone climbs": b"zone = '../../../etc/passwd'",
    "long zone": b"zone = '" + b"x" * 5000 + b"'",
    "days are infinite": _LONGER + b"inf",
    "days are many": _LONGER + b"1e8",
    "days are nan": _LONGER + b"nan",
    "grace is infinite": b"[late]\ngrace_minutes = inf\n" + _DUE + b"due = 2090-11-02T23:59:00",
    "last year": _DUE + b"due = 9999-12-31T23:59:00",
    "first year": b"zone = 'Asia/Tokyo'\n" + _DUE + b"due = 0001-01-01T00:00:00",
    "due at a time of day": _DUE + b"due = 23:59:00",
    "weight is infinite": _DUE + b"weight = inf",
    "weight is nan": _DUE + b"weight = nan",
    "odd extension": b'[[extensions]]\nstudent = "\\u001b[2J"\ndays = 1',
    "odd assignment": b'[assignments."\\u001b[2J"]\nweight = 1',
}
"""The rules of a course whose class has been graded and in which nobody is late."""

ANSWERS = {
    "gone": lambda path: path.unlink(),
    "folder": _folder,
    "empty": lambda path: path.write_bytes(b""),
    "no Python": lambda path: path.write_bytes(b"MISTAKES = {"),
    "NUL": lambda path: path.write_bytes(b"MISTAKES = {}\0"),
    "no UTF-8": lambda path: path.write_bytes(b"MISTAKES = '\xff'"),
    "raises": lambda path: path.write_bytes(b"1 / 0"),
    "raises oddly": lambda path: path.write_bytes(b"raise ValueError('\\ud800\\x1b[2J')"),
    "exits": lambda path: path.write_bytes(b"raise SystemExit(5)"),
    "list": lambda path: path.write_bytes(b"MISTAKES = [abs]"),
    "odd question": lambda path: path.write_bytes(b"MISTAKES = {None: [abs]}"),
    "nobody's question": lambda path: path.write_bytes(b"MISTAKES = {'\\x1b[2J': [abs]}"),
    "text": lambda path: path.write_bytes(b"MISTAKES = {'joint_error': 'abs'}"),
    "no functions": lambda path: path.write_bytes(b"MISTAKES = {'joint_error': [1, None]}"),
}
"""Done to the file of wrong answers for the report card."""

SAMPLE = frozenset(
    {
        "texts: lone surrogate",
        "texts: terminal's escape",
        "magics: time",
        "objects: raising repr",
        "raises: odd name",
        "replies: deep",
        "people: not UTF-8",
        "people: escape",
        "entries: number in a file's name",
        "file_names: not UTF-8",
        "files: pipe",
        "notebooks: nbgrader's is a list",
        "answers: exits",
    }
)
"""The kinds that the gate tries; `make soak` tries all."""
