"""Print a form of the concept test, then its key: ``python -m solutions.study.concepts a``."""

import sys
import tomllib
from hashlib import sha256
from pathlib import Path

FILE = Path(__file__).parents[1] / "concepts.toml"


def paper(form: str) -> str:
    """One form in Markdown; the order of the answers depends on their texts alone."""
    sheet, key = [f"# Concept test, form {form.upper()}\n"], ["\n# Key\n"]
    for number, item in enumerate(tomllib.loads(FILE.read_text(encoding="utf-8"))["item"], 1):
        said = item[form]
        why = {said["right"]: "right"} | dict(zip(said["wrong"], item["because"], strict=True))
        order = sorted(why, key=lambda text: sha256(f"{said['asks']}{text}".encode()).digest())
        sheet.append(f"\n{number}. {said['asks']}\n")
        sheet += [f"   - ({x}) {text}" for x, text in zip("abcd", order, strict=True)]
        key += [f"- {number} ({x}): {why[text]}" for x, text in zip("abcd", order, strict=True)]
    return "\n".join([*sheet, *key])


if __name__ == "__main__":
    print(paper(sys.argv[1]))
