"""How many words and minutes a notebook takes: ``python -m solutions.study.words``.

Words are those of Markdown and of docstrings, as released; a formula is one word.  Reading takes a
minute for 150 words, a question seven for each of its points.
"""

import ast
import json
import re
from collections import Counter
from pathlib import Path

FOLDED = re.compile(r"<details>.*?</details>", re.DOTALL)
FORMULA = re.compile(r"\$\$.*?\$\$|\$[^$]+\$", re.DOTALL)
APPENDIX = "## Appendix"


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


if __name__ == "__main__":
    print(f"{'':22}{'core':>7}{'folded':>8}{'appendix':>10}{'points':>8}{'more':>6}{'minutes':>9}")
    for path in sorted(Path("assignments").glob("0[0-7]_*/*.ipynb")):
        n = counted(path)
        minutes = n["core"] / 150 + 7 * n["core points"]
        print(
            f"{path.stem:22}{n['core']:7}{n['folded']:8}{n['appendix']:10}"
            f"{n['core points']:8g}{n['appendix points']:6g}{minutes:9.0f}"
        )
