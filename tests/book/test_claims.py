"""Sentences bound to data: wrong data stop the build."""

import ast
import os

import pytest
from book_claims import loose, plain, sentences
from book_pages import BOOK
from figures import claims
from figures.claims import ConclusionFails, claim, mutations, told

BINDING = ("claim", "shows", "by_hand", "_is")


@pytest.fixture(autouse=True)
def nothing_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(claims, "KEPT", tmp_path / "told.json")
    monkeypatch.setattr(claims, "FOUND", tmp_path / "claims")
    monkeypatch.delitem(os.environ, "LAB_BOOK_READ", raising=False)
    (tmp_path / "told.json").write_text('{"rms": [7.4], "joint is better": [6.0, 7.4]}')


@pytest.mark.parametrize("wrong", [-7.4, 3.7, 7.9])
def test_a_number_that_moved_stops_the_build(wrong):
    """One of another sign, half as large or 7 % larger asks to read the sentence again."""
    told("rms", 7.41)
    with pytest.raises(ConclusionFails, match="read the sentence again"):
        told("rms", wrong)


def test_a_conclusion_that_is_false_stops_the_build():
    """A comparison that its data contradict is an error."""
    with pytest.raises(ConclusionFails, match="the runs say otherwise"):
        claim("joint is better", lambda e: e[0] < e[1], e=(7.4, 6.0))


@pytest.mark.parametrize(("kind", "wrong"), [*mutations((6.0, 7.4))])
def test_every_mutation_of_the_data_stops_the_build(kind, wrong):
    """Reversed signs, halves, swapped and averaged numbers each break a claim that held."""
    claim("joint is better", lambda e: e[0] < e[1], e=(6.0, 7.4))
    with pytest.raises(ConclusionFails):
        claim("joint is better", lambda e: e[0] < e[1], e=wrong)


def test_sentences_that_count_are_those_with_a_number_or_a_comparison():
    """Glue, units, "larger than" and a row of a table count; code and formulas do not."""
    text = """---
kernelspec: x
---
# Title

It errs by {glue:text}`rms` mm. It is an arm. One is larger than the other. At 5 Hz it rings.

```{code-cell}
x = "5 mm"
```

$$
a = 5 mm
$$

| Claim | 3 mm |
"""
    assert [s.split()[0] for s in sentences(text)] == ["It", "One", "At", "|"]


def test_a_typed_number_is_loose_unless_a_claim_holds_it():
    """Formulas are bound by their derivation, glued numbers by their names."""
    sentence = "Pushed with **10 N** on $k = 200$ N/m it rests {glue:text}`rest` mm and 5 cm away."
    assert loose(sentence, ["rest"]) == ["10 N", "5 cm"]
    assert loose(sentence, ["rest", "Pushed with 10 N on"]) == ["5 cm"]


def test_the_words_of_every_claim_stand_on_a_page():
    """A sentence that is rewritten takes its claim along, or is bound to nothing."""
    sources = (p for p in BOOK.rglob("*.md") if "_build" not in p.parts)
    pages = [plain(" ".join(p.read_text().split())) for p in sources]
    calls = [
        node
        for path in (BOOK / "figures").glob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in BINDING
    ]
    words = [x.args[0].value for x in calls if x.args and isinstance(x.args[0], ast.Constant)]
    assert len(words) > 200
    assert [w for w in words if not any(w in page for page in pages)] == []
