"""Find the sentences of the book that its data support, and list the others.

Usage: ``python book/_tools/book_claims.py [--read] [PAGE]``.  A sentence counts if it compares or
shows a number with a unit.  It is *bound* if it shows a number that was passed to
`figures.claims.told`, or contains the words of a `claim`, and if these words contain every number
that was typed into the sentence.  It is *caught* if wrong data of every kind stop the build.  The
list of the remaining sentences shows what nobody checks.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from book_pages import BOOK, ROOT
from figures.claims import FOUND, KEPT, kept, near

PAGES = (
    "index",
    "report",
    "plant",
    *(
        f"{folder}/{p.stem}"
        for folder in ("chapters", "deeper")
        for p in (BOOK / folder).glob("*.md")
    ),
)
OUT = ROOT / "build/book_claims.json"
_UNIT = (
    r"mm²?(?:/s²?)?|cm|m²?(?:/s[²³⁵]?)?|N m|N/m|N|m?J|rad/s²?|rad|1/s²?|Hz|ms|s|kg|%|degrees|"
    r"pixels|W|°|per second|per cent"
)
_NUMBER = re.compile(rf"(?<![\w.])\d[\d.,]*[\s\u00a0]?({_UNIT})(?![\w/])")
_COMPARES = re.compile(
    r"\b(more|less|fewer|better|worse|larger|smaller|faster|slower|stiffer|softer|quicker|higher|"
    r"lower|easier|nearer|further|longer|shorter)\b[^.]*\bthan\b|\btwice\b|\bhalf the\b"
)
_TEX = re.compile(r"\$[^$]*\$|\{cite[^}]*\}\S*")
_GLUE = re.compile(r"\{glue:text\}`([^`]+)`")
_CELL = re.compile(r"^```\{code-cell\}\n(?::[^\n]*\n)*(.*?)^```", re.M | re.S)


def sentences(text: str) -> Iterator[str]:
    """The sentences of a page that compare or show a number with a unit."""
    text = re.sub(r"\A---\n.*?\n---\n", "", text, flags=re.S)
    text = re.sub(r"^\$\$[^\n]+\$\$[^\n]*$", "\n\n", text, flags=re.M)  # a formula of one line
    text = re.sub(r"^(```+|:::+|\$\$).*?^\1[^\n]*$", "\n\n", text, flags=re.M | re.S)
    for block in re.split(r"\n\s*\n|\n(?=[:|-] |\|)", text):
        joined = " ".join(block.split())
        for sentence in re.split(r"(?<=[.:?!])\s+(?=[A-Z*$\[{])", joined):
            shown = re.sub(r"\$[^$]*\$|\{cite[^}]*\}`[^`]*`", "x", _GLUE.sub("0 mm", sentence))
            if _NUMBER.search(shown) or _COMPARES.search(shown):
                yield sentence


def run(page: str, *, reading: bool) -> None:
    """Run the cells of a page in a separate process."""
    code = "\n".join(_CELL.findall((BOOK / f"{page}.md").read_text()))
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(map(str, (ROOT, BOOK, os.environ.get("PYTHONPATH", "")))),
        "LAB_BOOK_READ": "1" if reading else "0",
    }
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], env=environment, check=True)


def noted() -> Mapping[str, Any]:
    """What the pages reported, by name; only the last report of a name counts."""
    files = sorted(FOUND.glob("*.jsonl"), key=lambda p: p.stat().st_mtime)
    lines = (json.loads(line) for path in files for line in path.read_text().splitlines())
    return {line["name"]: line for line in lines}


def bound(sentence: str, notes: Mapping[str, Any]) -> list[str]:
    """The names of the numbers and claims on which a sentence rests."""
    claims = [name for name in notes if " " in name and name in plain(sentence)]
    return [*_GLUE.findall(sentence), *claims]


def loose(sentence: str, names: Iterable[str]) -> list[str]:
    """The numbers typed into a sentence that are not within the words of its claims."""
    text = plain(sentence)
    claims = [re.finditer(re.escape(name), text) for name in names if " " in name]
    held = {k for found in claims for one in found for k in range(*one.span())}
    shown = _TEX.sub(lambda tex: "x" * len(tex[0]), text)
    return [one[0] for one in _NUMBER.finditer(shown) if one.start() not in held]


def plain(sentence: str) -> str:
    """A sentence without the marks for emphasis."""
    return re.sub(r"[*`]", "", sentence)


def count(notes: Mapping[str, Any]) -> dict[str, Any]:
    """Count all sentences and the caught ones, and list the rest by page."""
    total, caught, left = 0, 0, {}
    for page in PAGES:
        for sentence in sentences((BOOK / f"{page}.md").read_text()):
            total += 1
            names = bound(sentence, notes)
            known = [notes[name] for name in names if name in notes]
            sound = len(known) == len(names) and not any(x["survived"] for x in known)
            if known and sound and not loose(sentence, names):
                caught += 1
            else:
                left.setdefault(page, []).append(sentence)
    return {"book_claims": total, "book_claims_caught": caught, "survivors": left}


def main() -> None:
    """Run pages, count sentences and keep what the pages report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--read", action="store_true", help="keep what the pages report now")
    parser.add_argument("--count", action="store_true", help="only count; do not run the pages")
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="chapters/velocity, for example")
    chosen = parser.parse_args()
    if not chosen.count and not chosen.pages:
        shutil.rmtree(FOUND, ignore_errors=True)  # reports of older versions of the pages
    for page in () if chosen.count else chosen.pages or PAGES:
        run(page, reading=chosen.read)
    notes, before = noted(), kept()
    if chosen.read:
        after = dict(before)
        for name, x in ((name, note["data"]) for name, note in notes.items()):
            moved = name not in before or not near(tuple(x), tuple(before[name]))
            after[name] = x if moved else before[name]
            if moved and name in before:
                print(f"{name}: {before[name]} before, {x} now")
        rows = ",\n".join(f"{json.dumps(k)}: {json.dumps(x)}" for k, x in sorted(after.items()))
        KEPT.write_text(f"{{\n{rows}\n}}\n")
    found = count(notes)
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n")
    print(f"{found['book_claims_caught']} of {found['book_claims']} sentences are caught; {OUT}")


if __name__ == "__main__":
    main()
