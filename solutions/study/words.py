"""How long a notebook and a page of the book are: ``python -m solutions.study.words``.

Words are those of Markdown and of docstrings, as released; a formula is one word.  Reading takes a
minute for 150 words, a question seven for each of its points.  On a page of the book a formula with
a relation takes 20 s more, and numbers are those of the prose: no formula, table or code.
"""

import ast
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from statistics import median
from typing import Any

import yaml  # type: ignore[import-untyped]

FOLDED = re.compile(r"<details>.*?</details>", re.DOTALL)
FORMULA = re.compile(r"\$\$.*?\$\$|\$[^$]+\$", re.DOTALL)
APPENDIX = "## Appendix"
BOOK = Path("book")


def words(text: str) -> int:
    """How many words a reader sees."""
    seen = re.sub(r"\(attachment:.*?\)|<[^>]*>", "", FORMULA.sub(" formula ", text))
    return sum(bool(re.search(r"\w", word)) for word in seen.split())


def docstrings(code: str) -> str:
    """All docstrings of a cell's code."""
    made = (ast.Module, ast.FunctionDef, ast.ClassDef)
    nodes = (node for node in ast.walk(ast.parse(code)) if isinstance(node, made))
    return " ".join(filter(None, map(ast.get_docstring, nodes)))


def counted(path: Path) -> Counter[str]:
    """Words of the core, of the appendix and of what is folded; points of the core and beyond."""
    found, place = Counter[str](), "core"
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text, meta = "".join(cell["source"]), cell["metadata"]
        if text.startswith("## "):
            place = "appendix" if text.startswith(APPENDIX) else "core"
        if cell["cell_type"] == "code":
            hidden = meta.get("jupyter", {}).get("source_hidden")
            found["folded" if hidden else place] += words(docstrings(text))
        else:
            found["folded"] += sum(map(words, FOLDED.findall(text)))
            found[place] += words(FOLDED.sub("", text))
        found[f"{place} points"] += meta.get("nbgrader", {}).get("points", 0)
    return found


HEAD = re.compile(r"\A---\n.*?\n---\n", re.DOTALL)
CODE = re.compile(r"^```(?:\{(?:code|include|bibl)|\w).*?^```$", re.MULTILINE | re.DOTALL)
MATH = re.compile(r"^```\{math\}\n(?::[^\n]*\n)*(.*?)^```$", re.MULTILINE | re.DOTALL)
DISPLAY = re.compile(r"\n\s*\$\$(.*?)\$\$(?: \(\w+\))?[ \t]*\n\s*", re.DOTALL)
MARKS = re.compile(r"^(?:[`:]{3,}.*|:\w[\w-]*:.*|\(\S+\)=|<.*>)$", re.MULTILINE)
APART = re.compile(r"^(?:\||#).*$", re.MULTILINE)
NAME = re.compile(r"\]\([^)]*\)|\{[\w:]+\}`[^`]*`|`[^`]*`")
ENDS = re.compile(r"(?<=[.?!:])[\"*)]*\s+(?=[\"*(\[]*[A-Z])|\n\s*\n|\n[ \t]*(?:[-:]|\d\.) ")
NUMBER = re.compile(r"(?<![\w.,])(?!^\d\. )\d[\d.,]*+(?!/[ks])", re.M)  # neither s0 nor 1/s
RELATION = re.compile(r"[=<>]|\\(?:le|ge|approx|min|leftarrow)\b")


def prose(page: str) -> tuple[str, int]:
    """The text of a page, with 0 for each number of a run, and how many relations it has."""
    text = CODE.sub("", HEAD.sub("", page).replace("{glue:text}", "0"))
    text = DISPLAY.sub(lambda x: f" $={x[1]}$ ", MATH.sub(r"$$\1$$", text))
    read = sum(bool(RELATION.search(x)) for x in FORMULA.findall(text))
    text = FORMULA.sub(lambda x: " F." if x[0].rstrip("$ \n").endswith(".") else " F", text)
    return NAME.sub(lambda x: "" if x[0][0] == "]" else "Name", MARKS.sub("", text)), read


def page(path: Path) -> tuple[int, float, float, int, float, int]:
    """Measure a page.

    Returns:
        Words, minutes, numbers in 100 words, the most numbers in one paragraph, and the median and
        the largest length of its sentences.
    """
    text, read = prose(path.read_text(encoding="utf-8"))
    told, all_words = APART.sub("\n", text), words(text)
    found = [len(NUMBER.findall(x)) for x in re.split(r"\n\s*\n", told)]
    lengths = [n for n in map(words, ENDS.split(told)) if n > 2] or [0]
    share = 100 * sum(found) / max(words(told), 1)
    return all_words, all_words / 150 + read / 3, share, max(found), median(lengths), max(lengths)


def files(entries: Iterable[dict[str, Any]]) -> Iterator[Path]:
    """The pages of a table of contents that are read, without the reference."""
    for entry in entries:
        if entry.get("file", "reference").split("/")[0] not in ("reference", "generated"):
            yield BOOK / f"{entry['file']}.md"
        yield from files(entry.get("sections", entry.get("chapters", [])))


if __name__ == "__main__":
    print(f"{'':22}{'core':>7}{'folded':>8}{'appendix':>10}{'points':>8}{'more':>6}{'minutes':>9}")
    for path in sorted(Path("assignments").glob("0[0-7]_*/*.ipynb")):
        n = counted(path)
        minutes = n["core"] / 150 + 7 * n["core points"]
        print(
            f"{path.stem:22}{n['core']:7}{n['folded']:8}{n['appendix']:10}"
            f"{n['core points']:8g}{n['appendix points']:6g}{minutes:9.0f}"
        )
    toc = yaml.safe_load((BOOK / "_toc.yml").read_text(encoding="utf-8"))
    print(
        f"\n{'':22}{'words':>7}{'minutes':>8}{'numbers':>8}{'most':>6}{'median':>8}{'longest':>9}"
    )
    for path in files([{"file": toc["root"]}, *toc["parts"]]):
        size, minutes, share, most, half, longest = page(path)
        print(f"{path.stem:22}{size:7}{minutes:8.0f}{share:8.1f}{most:6}{half:8g}{longest:9}")
    print(sum(page(path)[0] for path in files([{"file": toc["root"]}, *toc["parts"]])), "words")
